#pragma once
#include "dem/budget.hpp"
#include "dem/contact_list.hpp"
#include "dem/fast_bodies.hpp"
#include "dem/forces.hpp"
#include "dem/particles.hpp"
#include "dem/runtime.hpp"
#include "dem/step_stats.hpp"
#include <cstdint>
#include <vector>

namespace trigrain {

/// Looks in every step for what must not pass in silence: bodies that may fly past a contact between two steps,
/// contacts that their springs will not stop, and now and then a step that is too long for the contacts.
class Watch {
 public:
  explicit Watch(const Particles& particles) : within_(seen_within(particles)) {}

  /// May a body get past another one within `blind_s`, the part of a step (s) in which a contact may begin?
  bool flies_blind(const Particles& particles, int body, double blind_s) const {
    return fastest_point(particles, body) * blind_s > within_[body];
  }
  /// Counts what the forces of a step of step_s (s), beginning at time_s (s), have found, and notes the first of each.
  void look(const Particles& particles, const ContactParameters& law, ContactList& contacts, const KickSums& kick,
            double time_s, double step_s, double blind_s, Team& team, StepStats& stats);

  const FastContact& first_fast_contact() const { return fast_contact_; } ///< a is -1 if there was none
  const FastContact& first_fast_body() const { return fast_body_; }

 private:
  std::vector<double> within_; // m, see seen_within()
  FastContact fast_contact_, fast_body_;
  std::int64_t contact_steps_ = 0;
};

} // namespace trigrain
