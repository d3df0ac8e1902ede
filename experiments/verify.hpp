#pragma once
#include "dem/simulation.hpp"
#include "kernels/kernels.hpp"
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace trigrain {

/// One thing that was checked before the timing.
struct CheckItem {
  std::string what;
  bool passed = false;
  std::string detail; ///< what was compared, and the worst that was found
};

struct Check {
  std::vector<CheckItem> how;
  std::vector<std::string> warnings; ///< what is allowed and yet worth knowing
  bool passed() const;
};

/// State hash that a run with these options ends in.
using HashAfter = std::function<std::uint64_t(const Options&)>;

/// The scheme ends in the same bits as `serial` on one thread with everything else equal.
CheckItem check_scheme(const Options& options, const HashAfter& hash_after);

/// The grid misses no pair: the same bits as with all body pairs compared (grid `none`).
CheckItem check_grid(const Options& options, const HashAfter& hash_after);

/// Some triangles of one body against some of another, in the first one's body frame.
struct TriangleBlock {
  Triangles a, b;
  double reach; ///< sum of the halos (m)
};

/// Blocks of up to 8 x 8 triangle pairs of the scene's own bodies, about `pairs` in all: bodies in contact, else
/// neighbours; per body the triangles nearest to the other one and seeded random ones. Every second block is moved
/// until its surfaces are half a reach apart, so that contacts are among the answers. Empty if only spheres meet.
std::vector<TriangleBlock> sample_triangle_pairs(const Simulation& simulation, int pairs, std::uint64_t seed);

/// `kernel` against `reference` on every pair of the blocks: distances equal within 1e-12 S, S = max(longest edge,
/// largest |coordinate|) of the pair; |p - q| is that distance; and the same pairs within reach (but for a rounding's
/// width).
CheckItem check_kernel(const Kernel& kernel, const Kernel& reference, std::span<const TriangleBlock> blocks);

/// Every number of the state is finite and every orientation a unit quaternion.
CheckItem check_state(const Particles& particles);

/// Moving bodies whose centre is outside of the domain.
int bodies_outside(const Particles& particles, const Domain& domain);

/// All checks, over `steps` steps from the scene's state.
Check verify(const Scene& scene, const Options& options, std::int64_t steps);

} // namespace trigrain
