#include "dem/watch.hpp"
#include "dem/contact_step_limit.hpp"
#include <algorithm>

namespace trigrain {

void Watch::look(const Particles& p, const ContactParameters& law, ContactList& contacts, const KickSums& kick,
                 double time, double step, double blind, Team& team, StepStats& stats) {
  constexpr int rarely = 256, rounds = 30; // steps; a round costs about as much as the forces of a step
  stats.fast_bodies += kick.fast_bodies;
  for (int i = 0; kick.fast_bodies > 0 && fast_body_.a < 0; ++i)
    if (flies_blind(p, i, blind)) fast_body_ = {time, i, -1, fastest_point(p, i), within_[i] / blind};
  stats.fast_contacts += kick.fast_contacts;
  if (kick.fast_contacts > 0 && fast_contact_.a < 0) {
    const auto fast = std::ranges::find_if(contacts.contacts(), &Contact::fast);
    fast_contact_ = fast_contact(p, law, *fast, time);
  }
  if (contacts.contacts().empty() || contact_steps_++ % rarely != 0) return;
  stats.unstable_steps += step > ContactStepLimit().of(p, law, contacts, team, rounds);
}

} // namespace trigrain
