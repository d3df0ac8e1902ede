#pragma once
#include "dem/contact.hpp"
#include "dem/narrow_phase.hpp"
#include "dem/runtime.hpp"
#include <algorithm>
#include <span>
#include <vector>

namespace trigrain {

/// The springs of a body pair's contacts: those of the same contacts in the last step, or new ones. All are sorted by
/// (feature_a, feature_b).
void carry_springs(std::span<const HeldSpring> last, std::span<const Contact> contacts, std::span<HeldSpring> springs);

/// The contacts of one step in an order that does not depend on who found them. A pair belongs to its first body, or to
/// the second one if the first is fixed: walls have too many pairs to sort. Contacts are sorted by (owner, other body,
/// feature_a, feature_b). Forces on a body are summed in that order: by a thread that has them all, pair by pair, or
/// body by body, each of which finds its own.
class ContactList {
  /// A body pair's contacts: where a worker left them, and their place in the list.
  struct Pair {
    int owner, other;
    int worker, found;
    int first, count;
  };
  static auto within(auto& list, const Pair& pair) { return std::span(list).subspan(pair.first, pair.count); }
  /// The same of pairs [begin, end), which are not none.
  auto within(auto& list, int begin, int end) const {
    const Pair& last = pairs_[end - 1];
    return std::span(list).subspan(pairs_[begin].first, last.first + last.count - pairs_[begin].first);
  }

 public:
  /// Sorts the pairs that the workers found, and remembers the springs of the last step's contacts. The contacts are
  /// there once lay_out() was called for every pair. Allocates only to grow.
  void gather(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team);
  /// Lets every body find the pairs that another one owns, for for_reactions() and for_body(). Nothing if it is done.
  void list_others(const Particles& particles, Team& team);

  const std::vector<Contact>& contacts() const { return contacts_; }

  /// Body pairs that touch.
  int pairs() const { return static_cast<int>(pairs_.size()); }
  /// Lays out what touches in pairs [begin, end), from where workers left it, with the springs of the last step. What a
  /// contact has beyond that is as it was, for contact_forces() to set.
  void lay_out(int begin, int end, std::span<const WorkerBuffer> buffers, const Particles& particles);
  /// The contacts of pairs [begin, end) once they are laid out, and their springs, for the caller to move on.
  std::span<Contact> contacts_of(int begin, int end) { return within(contacts_, begin, end); }
  std::span<HeldSpring> springs_of(int begin, int end) { return within(springs_, begin, end); }
  /// What the pair does to its bodies.
  void set_reaction(int pair, const Reaction& reaction) { reactions_[pair] = reaction; }

  /// Calls visit(reaction) for the pairs of a body that moves, those first which another one owns.
  template <class Visit> void for_reactions(int body, const Visit& visit) const {
    const int later = std::min(body + 4, static_cast<int>(first_of_others_.size()) - 2);
    for (int i = first_of_others_[later]; i < first_of_others_[later + 1]; ++i)
      __builtin_prefetch(&reactions_[pairs_of_others_[i]]);
    for_pairs(body, [&](int pair) { visit(reactions_[pair]); });
  }
  /// Calls visit(contact) for the contacts of a body that moves, in the same order.
  template <class Visit> void for_body(int body, const Visit& visit) const {
    for_pairs(body, [&](int pair) {
      for (const Contact& c : within(contacts_, pairs_[pair])) visit(c);
    });
  }

 private:
  void fetch(int pair, std::span<const WorkerBuffer> buffers, const Particles& particles) const;
  template <class Visit> void for_pairs(int body, const Visit& visit) const {
    for (int i = first_of_others_[body]; i < first_of_others_[body + 1]; ++i) visit(pairs_of_others_[i]);
    for (int i = first_[body]; i < first_[body + 1]; ++i) visit(i);
  }
  void count(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team);
  void sort_pairs(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team);

  std::vector<Contact> contacts_;
  std::vector<HeldSpring> springs_, last_springs_; // of the contacts and of the last step's, in their order
  std::vector<Pair> pairs_, last_pairs_;           // sorted by (owner, other)
  std::vector<Reaction> reactions_;                // of each pair, as far as they were set
  std::vector<int> first_, last_first_;            // pairs that body i owns: [i], ..., [i + 1] - 1
  std::vector<int> first_of_others_;               // the same of the list of pairs in which it is the other one,
  std::vector<int> pairs_of_others_;               // by owner; of bodies that move
  bool others_listed_ = false;                     // those of this step
  std::vector<int> place_;                         // scratch per body
};

} // namespace trigrain
