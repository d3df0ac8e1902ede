#pragma once
#include "dem/contact.hpp"
#include "dem/feature_pairs.hpp"
#include "dem/pair_source.hpp"
#include "dem/particles.hpp"
#include <vector>

namespace trigrain {

/// Appends the contacts of the corners and edges of two meshes (ShapeFeatures), sorted by feature; `near` holds all
/// that are within reach (m). With phi(d) = max(0, E - d)^2 the energy is k / 2 times
///
///     sum over corners c of A  phi(c, B)  +  sum over corners c of B  phi(c, A)  +  sum over edges e of A, f of B  X
///     X = (phi - a)(phi - b) / phi,    phi = phi(e, f),    a = psi(1 - s) phi(e0, f) + psi(s) phi(e1, f),
///                                                          b = psi(1 - t) phi(e, f0) + psi(t) phi(e, f1)
///
/// where s, t say where on the edges the closest points are, psi(x) = 3 x^2 - 2 x^3, and X = 0 where one of them is an
/// end. X is what crossing edges have beyond their ends, which the corners count already: phi far from the ends, 0 at
/// them and where edges are parallel, with a continuous gradient everywhere. The energy is a function of where the
/// bodies are, it does not depend on how faces are cut, and it is at least phi(A, B): a lone contact has stiffness k, a
/// box on a plane k at each of its corners.
void add_feature_contacts(const Particles& particles, BodyPair pair, const Placement& b_in_a, const FeaturePairs& near,
                          double reach, std::vector<Touch>& contacts);

} // namespace trigrain
