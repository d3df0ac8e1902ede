#pragma once
#include "dem/contact.hpp"
#include "dem/particles.hpp"
#include <span>
#include <string_view>
#include <vector>

namespace trigrain {

/// Which of the touching triangle pairs of one body pair become contacts.
struct ContactRule {
  std::string_view name;
  std::string_view about;
  bool of_features;   ///< two meshes, neither of them curved, touch by corners and edges instead of triangles
  bool one_per_piece; ///< of triangle pairs, only the closest of two connected surface pieces is a contact
  /// Reduces contacts[first...], all of one body pair in the order of (feature_a, feature_b), which are triangles (0
  /// for spheres), and sets their spring (`push`, `couple`, `share`) and `mass`. May find that none is left.
  void (*reduce)(const Particles& particles, std::vector<Touch>& contacts, std::size_t first);
};

std::span<const ContactRule> contact_rules();

/// By (feature_a, feature_b).
bool by_features(const Touch& l, const Touch& r);

/// Sets the mass of all contacts of a body pair.
void set_collective_mass(const Particles& particles, std::span<Touch> contacts);

/// What a rule with one contact per pair of pieces does with those of one body pair, whose features are the pieces:
/// sorts them, and sets their springs and masses.
void settle_pieces(const Particles& particles, std::span<Touch> contacts);

} // namespace trigrain
