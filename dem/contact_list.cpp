#include "dem/contact_list.hpp"
#include <algorithm>
#include <atomic>
#include <numeric>

namespace trigrain {
namespace {

constexpr int grain = 128; // bodies or pairs a worker takes at a time

int count_up(int& counter, int by = 1) { return std::atomic_ref(counter).fetch_add(by, std::memory_order_relaxed); }

/// first[i + 1] holds the count of i; then first[i] is where i begins.
void add_up(std::vector<int>& first) { std::partial_sum(first.begin(), first.end(), first.begin()); }

} // namespace

void ContactList::gather(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team) {
  last_contacts_.swap(contacts_);
  last_pairs_.swap(pairs_);
  last_first_a_.swap(first_a_);
  sort_pairs(buffers, particles.size(), team);
  place_contacts(particles.size(), team);
  team.parallel_for(pairs(), grain, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const auto from = buffers[pairs_[i].worker].contacts.begin() + pairs_[i].found;
      std::copy_n(from, pairs_[i].count, contacts_.begin() + pairs_[i].first);
    }
  });
  find_partners(particles, team);
}

/// Counting sort by a: where the workers put a pair among those of its a depends on who is first, sorting by b mends
/// it.
void ContactList::sort_pairs(std::span<const WorkerBuffer> buffers, int bodies, Team& team) {
  first_a_.assign(bodies + 1, 0);
  const int workers = static_cast<int>(buffers.size());
  team.parallel_for(workers, 1, [&](int begin, int end, int) {
    for (int w = begin; w < end; ++w)
      for (const FoundPair& found : buffers[w].found) count_up(first_a_[found.a + 1]);
  });
  add_up(first_a_);
  pairs_.resize(first_a_.back());
  place_.assign(first_a_.begin(), first_a_.end() - 1);
  team.parallel_for(workers, 1, [&](int begin, int end, int) {
    for (int w = begin; w < end; ++w)
      for (const FoundPair& f : buffers[w].found) pairs_[count_up(place_[f.a])] = {f.a, f.b, w, f.first, 0, f.count};
  });
}

/// Sorts the pairs of each body by b, and lays their contacts out one after the other.
void ContactList::place_contacts(int bodies, Team& team) {
  place_.resize(bodies + 1);
  team.parallel_for(bodies, grain, [&](int begin, int end, int) {
    for (int a = begin; a < end; ++a) {
      const auto own = std::span(pairs_).subspan(first_a_[a], first_a_[a + 1] - first_a_[a]);
      std::sort(own.begin(), own.end(), [](const Pair& l, const Pair& r) { return l.b < r.b; });
      int count = 0;
      for (Pair& pair : own) {
        pair.first = count;
        count += pair.count;
      }
      place_[a + 1] = count;
    }
  });
  place_[0] = 0;
  add_up(place_);
  contacts_.resize(place_.back());
  team.parallel_for(pairs(), grain, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) pairs_[i].first += place_[pairs_[i].a];
  });
}

/// The same pairs sorted by (b, a). Fixed bodies feel no forces.
void ContactList::find_partners(const Particles& particles, Team& team) {
  const int bodies = particles.size();
  first_b_.assign(bodies + 1, 0);
  team.parallel_for(pairs(), grain, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i)
      if (!particles.fixed(pairs_[i].b)) count_up(first_b_[pairs_[i].b + 1]);
  });
  add_up(first_b_);
  pairs_of_b_.resize(first_b_.back());
  place_.assign(first_b_.begin(), first_b_.end() - 1);
  team.parallel_for(pairs(), grain, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i)
      if (!particles.fixed(pairs_[i].b)) pairs_of_b_[count_up(place_[pairs_[i].b])] = i;
  });
  team.parallel_for(bodies, grain, [&](int begin, int end, int) {
    for (int b = begin; b < end; ++b)
      std::sort(pairs_of_b_.begin() + first_b_[b], pairs_of_b_.begin() + first_b_[b + 1]);
  });
}

std::span<const Contact> ContactList::last_of_pair(int pair) const {
  const auto [a, b] = std::pair(pairs_[pair].a, pairs_[pair].b);
  if (last_first_a_.empty()) return {};
  const auto first = last_pairs_.begin() + last_first_a_[a], last = last_pairs_.begin() + last_first_a_[a + 1];
  const auto found = std::lower_bound(first, last, b, [](const Pair& p, int body) { return p.b < body; });
  return found != last && found->b == b ? within(last_contacts_, *found) : std::span<const Contact>();
}

} // namespace trigrain
