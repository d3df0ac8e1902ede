#include "dem/contact_list.hpp"
#include <algorithm>
#include <atomic>
#include <numeric>

namespace trigrain {
namespace {

constexpr int grain = 64; // bodies or pairs a worker takes at a time

/// Adds one to counters that the team shares; what they were.
class CountUp {
 public:
  explicit CountUp(const Team& team) : alone_(team.threads() == 1) {}
  int operator()(int& counter) const {
    return alone_ ? counter++ : std::atomic_ref(counter).fetch_add(1, std::memory_order_relaxed);
  }

 private:
  bool alone_; // then atomic additions, a tenth of a step of spheres, are not needed
};

/// Resizes to `count` with a sixteenth of room to grow, where vectors left alone take twice of what they need.
template <class T> void resize_closely(std::vector<T>& list, std::size_t count) {
  if (count > list.capacity()) list.reserve(count + count / 16);
  list.resize(count);
}

/// first[i + 1] holds the count of i; then first[i] is where i begins.
void add_up(std::vector<int>& first) { std::partial_sum(first.begin(), first.end(), first.begin()); }

/// Calls visit(worker, pair) for every body pair that a worker found; the team shares them, however many one has.
template <class Visit> void for_found(std::span<const WorkerBuffer> buffers, Team& team, const Visit& visit) {
  int total = 0;
  for (const WorkerBuffer& buffer : buffers) total += static_cast<int>(buffer.found.size());
  team.parallel_for(total, grain, [&](int begin, int end, int) {
    int first = 0; // of this buffer's pairs, numbered through
    for (int w = 0; w < static_cast<int>(buffers.size()) && first < end; ++w) {
      const std::vector<FoundPair>& found = buffers[w].found;
      const int count = static_cast<int>(found.size());
      for (int i = std::max(begin, first); i < std::min(end, first + count); ++i) visit(w, found[i - first]);
      first += count;
    }
  });
}

} // namespace

void ContactList::gather(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team) {
  last_springs_.swap(springs_);
  last_pairs_.swap(pairs_);
  last_first_a_.swap(first_a_);
  count(buffers, particles, team);
  sort_pairs(buffers, particles.size(), team);
  sort_by_b(particles, team);
}

/// How many pairs each body has as a and as b. Fixed bodies feel no forces.
void ContactList::count(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team) {
  first_a_.assign(particles.size() + 1, 0);
  first_b_.assign(particles.size() + 1, 0);
  const CountUp count_up(team);
  for_found(buffers, team, [&](int, const FoundPair& found) {
    count_up(first_a_[found.a + 1]);
    if (!particles.fixed(found.b)) count_up(first_b_[found.b + 1]);
  });
  add_up(first_a_);
  add_up(first_b_);
  resize_closely(pairs_, first_a_.back());
  resize_closely(reactions_, first_a_.back());
  resize_closely(pairs_of_b_, first_b_.back());
}

/// Counting sort by a: where the workers put a pair among those of its a depends on who is first, sorting by b mends
/// it. Where contacts go follows from how many each pair has.
void ContactList::sort_pairs(std::span<const WorkerBuffer> buffers, int bodies, Team& team) {
  const CountUp count_up(team);
  place_.assign(first_a_.begin(), first_a_.end());
  for_found(buffers, team, [&](int worker, const FoundPair& f) {
    pairs_[count_up(place_[f.a])] = {f.a, f.b, worker, f.first, 0, f.count};
  });
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
  resize_closely(contacts_, place_.back());
  resize_closely(springs_, place_.back());
}

/// The same pairs sorted by (b, a); those of a body know now where its contacts begin.
void ContactList::sort_by_b(const Particles& particles, Team& team) {
  const CountUp count_up(team);
  place_b_.assign(first_b_.begin(), first_b_.end());
  team.parallel_for(pairs(), grain, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      Pair& pair = pairs_[i];
      pair.first += place_[pair.a];
      if (!particles.fixed(pair.b)) pairs_of_b_[count_up(place_b_[pair.b])] = i;
    }
  });
  team.parallel_for(particles.size(), grain, [&](int begin, int end, int) {
    for (int b = begin; b < end; ++b)
      std::sort(pairs_of_b_.begin() + first_b_[b], pairs_of_b_.begin() + first_b_[b + 1]);
  });
}

std::span<Contact> ContactList::lay_out(int i, std::span<const WorkerBuffer> buffers) {
  const Pair& pair = pairs_[i];
  const auto found = buffers[pair.worker].contacts.begin() + pair.found;
  std::transform(found, found + pair.count, contacts_.begin() + pair.first, [](const Touch& t) { return Contact{t}; });
  return within(contacts_, pair);
}

void ContactList::fetch(int i, std::span<const WorkerBuffer> buffers, const Particles& particles) const {
  if (i >= pairs()) return;
  const Pair& pair = pairs_[i];
  const auto* const found = reinterpret_cast<const char*>(buffers[pair.worker].contacts.data() + pair.found);
  for (std::size_t byte = 0; byte < sizeof(Touch); byte += 64) __builtin_prefetch(found + byte);
  __builtin_prefetch(&particles.position[pair.b]);
  __builtin_prefetch(&particles.velocity[pair.b]);
}

std::span<const HeldSpring> ContactList::last_of_pair(int pair) const {
  const auto [a, b] = std::pair(pairs_[pair].a, pairs_[pair].b);
  if (last_first_a_.empty()) return {};
  const auto first = last_pairs_.begin() + last_first_a_[a], last = last_pairs_.begin() + last_first_a_[a + 1];
  const auto found = std::lower_bound(first, last, b, [](const Pair& p, int body) { return p.b < body; });
  return found != last && found->b == b ? within(last_springs_, *found) : std::span<const HeldSpring>();
}

} // namespace trigrain
