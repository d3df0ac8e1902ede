#include "dem/contact_list.hpp"
#include <algorithm>
#include <atomic>
#include <numeric>
#include <tuple>
#include <utility>

namespace trigrain {
namespace {

constexpr int grain = 512; // bodies or pairs a worker takes at a time: some ns each

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

std::pair<int, int> owner_first(const Particles& particles, const FoundPair& pair) {
  return particles.fixed(pair.a) ? std::pair(pair.b, pair.a) : std::pair(pair.a, pair.b);
}

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

auto key(const auto& c) { return std::tie(c.feature_a, c.feature_b); }

} // namespace

void carry_springs(std::span<const HeldSpring> last, std::span<const Contact> contacts, std::span<HeldSpring> springs) {
  auto old = last.begin();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    springs[i] = {contacts[i].feature_a, contacts[i].feature_b};
    while (old != last.end() && key(*old) < key(springs[i])) ++old;
    if (old != last.end() && key(*old) == key(springs[i])) springs[i] = *old;
  }
}

void ContactList::gather(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team) {
  last_springs_.swap(springs_);
  last_pairs_.swap(pairs_);
  last_first_.swap(first_);
  count(buffers, particles, team);
  sort_pairs(buffers, particles, team);
  others_listed_ = false;
}

/// How many pairs each body owns.
void ContactList::count(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team) {
  first_.assign(particles.size() + 1, 0);
  const CountUp count_up(team);
  for_found(buffers, team,
            [&](int, const FoundPair& found) { count_up(first_[owner_first(particles, found).first + 1]); });
  add_up(first_);
  resize_closely(pairs_, first_.back());
}

/// Counting sort by owner: where the workers put a pair among those of its owner depends on who is first, sorting by
/// the other body mends it. Where contacts go follows from how many each pair has.
void ContactList::sort_pairs(std::span<const WorkerBuffer> buffers, const Particles& particles, Team& team) {
  const CountUp count_up(team);
  place_.assign(first_.begin(), first_.end());
  for_found(buffers, team, [&](int worker, const FoundPair& f) {
    const auto [owner, other] = owner_first(particles, f);
    pairs_[count_up(place_[owner])] = {owner, other, worker, f.first, 0, f.count};
  });
  team.parallel_for(particles.size(), grain, [&](int begin, int end, int) {
    for (int owner = begin; owner < end; ++owner) {
      const auto own = std::span(pairs_).subspan(first_[owner], first_[owner + 1] - first_[owner]);
      std::sort(own.begin(), own.end(), [](const Pair& l, const Pair& r) { return l.other < r.other; });
      int count = 0;
      for (Pair& pair : own) {
        pair.first = count;
        count += pair.count;
      }
      place_[owner + 1] = count;
    }
  });
  place_[0] = 0;
  add_up(place_);
  team.parallel_for(pairs(), grain, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) pairs_[i].first += place_[pairs_[i].owner];
  });
  resize_closely(contacts_, place_.back());
  resize_closely(springs_, place_.back());
}

/// The same pairs sorted by (other, owner). Fixed bodies feel no forces.
void ContactList::list_others(const Particles& particles, Team& team) {
  if (others_listed_) return;
  others_listed_ = true;
  resize_closely(reactions_, pairs_.size());
  first_of_others_.assign(particles.size() + 1, 0);
  const CountUp count_up(team);
  const auto for_others = [&](const auto& visit) {
    team.parallel_for(pairs(), grain, [&](int begin, int end, int) {
      for (int i = begin; i < end; ++i)
        if (const int other = pairs_[i].other; !particles.fixed(other)) visit(i, other);
    });
  };
  for_others([&](int, int other) { count_up(first_of_others_[other + 1]); });
  add_up(first_of_others_);
  resize_closely(pairs_of_others_, first_of_others_.back());
  place_.assign(first_of_others_.begin(), first_of_others_.end());
  for_others([&](int i, int other) { pairs_of_others_[count_up(place_[other])] = i; });
  team.parallel_for(particles.size(), grain, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i)
      std::sort(pairs_of_others_.begin() + first_of_others_[i], pairs_of_others_.begin() + first_of_others_[i + 1]);
  });
}

void ContactList::lay_out(int begin, int end, std::span<const WorkerBuffer> buffers, const Particles& particles) {
  const auto bodies = [](const Pair& pair) { return std::pair(pair.owner, pair.other); };
  auto last = last_pairs_.begin() + (last_first_.empty() ? 0 : last_first_[pairs_[begin].owner]);
  for (int i = begin; i < end; ++i) {
    fetch(i + 6, buffers, particles);
    const Pair& pair = pairs_[i];
    if (pair.found == FoundPair::of_spheres) {
      const auto [a, b] = std::minmax(pair.owner, pair.other);
      touch_of_spheres(particles, {a, b}, contacts_[pair.first]);
    } else {
      for (int k = 0; k < pair.count; ++k)
        static_cast<Touch&>(contacts_[pair.first + k]) = buffers[pair.worker].contacts[pair.found + k];
    }
    while (last != last_pairs_.end() && bodies(*last) < bodies(pair)) ++last;
    const bool touched = last != last_pairs_.end() && bodies(*last) == bodies(pair);
    carry_springs(touched ? within(last_springs_, *last) : std::span<const HeldSpring>(), within(contacts_, pair),
                  within(springs_, pair));
  }
}

/// What a pair soon to be laid out needs from far off in memory, while others are worked on.
void ContactList::fetch(int i, std::span<const WorkerBuffer> buffers, const Particles& particles) const {
  if (i >= pairs()) return;
  const Pair& pair = pairs_[i];
  if (pair.found != FoundPair::of_spheres) {
    const auto* const found = reinterpret_cast<const char*>(buffers[pair.worker].contacts.data() + pair.found);
    for (std::size_t byte = 0; byte < sizeof(Touch); byte += cache_line) __builtin_prefetch(found + byte);
  }
  __builtin_prefetch(&particles.position[pair.other]);
  __builtin_prefetch(&particles.velocity[pair.other]);
}

} // namespace trigrain
