#pragma once
#include "dem/contact.hpp"
#include "dem/narrow_phase.hpp"
#include "dem/runtime.hpp"
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
  template <class T> static std::span<const T> within(const std::vector<T>& list, const Pair& pair) {
    return std::span(list).subspan(pair.first, pair.count);
  }

 public:
  /// Takes over what the workers found, and remembers the springs of the last step's contacts. Allocates only to grow.
  void gather(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team);

  std::vector<Contact>& contacts() { return contacts_; }
  const std::vector<Contact>& contacts() const { return contacts_; }

  /// Body pairs that touch.
  int pairs() const { return static_cast<int>(pairs_.size()); }
  std::span<Contact> of_pair(int pair) { return std::span(contacts_).subspan(pairs_[pair].first, pairs_[pair].count); }
  /// What the same two bodies had in the last step; empty if nothing.
  std::span<const HeldSpring> last_of_pair(int pair) const;

  /// Calls visit(contact, is_a) for the contacts of a body, those first in which it is b; of fixed bodies only those in
  /// which they are a.
  template <class Visit> void for_body(int body, const Visit& visit) const {
    for (int i = first_b_[body]; i < first_b_[body + 1]; ++i)
      for (const Contact& c : within(contacts_, pairs_[pairs_of_b_[i]])) visit(c, false);
    for (int i = first_a_[body]; i < first_a_[body + 1]; ++i)
      for (const Contact& c : within(contacts_, pairs_[i])) visit(c, true);
  }

 private:
  void keep_springs(Team& team);
  void count(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team);
  void sort_pairs(std::span<const WorkerBuffer> buffers, int bodies, Team& team);
  void place_contacts(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team);

  std::vector<Contact> contacts_;
  std::vector<HeldSpring> last_springs_;    // of the last step's contacts, in their order
  std::vector<Pair> pairs_, last_pairs_;    // sorted by (a, b)
  std::vector<int> first_a_, last_first_a_; // pairs of body a: [a], ..., [a + 1] - 1
  std::vector<int> first_b_, pairs_of_b_;   // pairs in which a body is b, by a
  std::vector<int> place_, place_b_;        // scratch per body
};

} // namespace trigrain
