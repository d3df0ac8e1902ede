#pragma once
#include "dem/contact.hpp"
#include "dem/narrow_phase.hpp"
#include "dem/runtime.hpp"
#include <algorithm>
#include <span>
#include <vector>

namespace trigrain {

/// The contacts of one step in an order that does not depend on who found them: by (a, b, feature_a, feature_b). Every
/// body finds its own, so that its forces are summed by one thread, in that order.
class ContactList {
  /// A body pair's contacts: where a worker left them, and their place in the list.
  struct Pair {
    int a, b;
    int worker, found;
    int first, count;
  };
  static auto within(auto& list, const Pair& pair) { return std::span(list).subspan(pair.first, pair.count); }

 public:
  /// Sorts the pairs that the workers found, and remembers the springs of the last step's contacts. The contacts are
  /// there once lay_out() was called for every pair. Allocates only to grow.
  void gather(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team);

  const std::vector<Contact>& contacts() const { return contacts_; }

  /// Body pairs that touch.
  int pairs() const { return static_cast<int>(pairs_.size()); }
  /// The contacts of a pair, from where a worker left them.
  std::span<Contact> lay_out(int pair, std::span<const WorkerBuffer> buffers);
  /// What the same two bodies had in the last step; empty if nothing.
  std::span<const HeldSpring> last_of_pair(int pair) const;
  /// The springs of its contacts, for the caller to fill: what last_of_pair() returns in the next step.
  std::span<HeldSpring> springs_of(int pair) { return within(springs_, pairs_[pair]); }
  /// What the pair does to its bodies.
  void set_reaction(int pair, const Reaction& reaction) { reactions_[pair] = reaction; }
  /// Before a pair is laid out: fetches what it needs from far off in memory, while others are worked on.
  void fetch(int pair, std::span<const WorkerBuffer> buffers, const Particles& particles) const;

  /// Calls visit(reaction, is_a) for the pairs of a body, those first in which it is b; of fixed bodies only those in
  /// which they are a.
  template <class Visit> void for_reactions(int body, const Visit& visit) const {
    const int later = std::min(body + 4, static_cast<int>(first_b_.size()) - 2);
    for (int i = first_b_[later]; i < first_b_[later + 1]; ++i) __builtin_prefetch(&reactions_[pairs_of_b_[i]]);
    for (int i = first_b_[body]; i < first_b_[body + 1]; ++i) visit(reactions_[pairs_of_b_[i]], false);
    for (int i = first_a_[body]; i < first_a_[body + 1]; ++i) visit(reactions_[i], true);
  }
  /// Calls visit(contact, is_a) for the contacts of a body, those first in which it is b; of fixed bodies only those in
  /// which they are a.
  template <class Visit> void for_body(int body, const Visit& visit) const {
    for (int i = first_b_[body]; i < first_b_[body + 1]; ++i)
      for (const Contact& c : within(contacts_, pairs_[pairs_of_b_[i]])) visit(c, false);
    for (int i = first_a_[body]; i < first_a_[body + 1]; ++i)
      for (const Contact& c : within(contacts_, pairs_[i])) visit(c, true);
  }

 private:
  void count(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team);
  void sort_pairs(std::span<const WorkerBuffer> buffers, int bodies, Team& team);
  void sort_by_b(const Particles& particles, Team& team);

  std::vector<Contact> contacts_;
  std::vector<HeldSpring> springs_, last_springs_; // of the contacts and of the last step's, in their order
  std::vector<Pair> pairs_, last_pairs_;           // sorted by (a, b)
  std::vector<Reaction> reactions_;                // of each pair
  std::vector<int> first_a_, last_first_a_;        // pairs of body a: [a], ..., [a + 1] - 1
  std::vector<int> first_b_, pairs_of_b_;          // pairs in which a body is b, by a
  std::vector<int> place_, place_b_;               // scratch per body
};

} // namespace trigrain
