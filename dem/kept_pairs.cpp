#include "dem/kept_pairs.hpp"

namespace trigrain {

RelativePose relative_pose(const Particles& p, BodyPair pair) {
  const auto [a, b] = pair;
  const Eigen::Quaterniond to_a = p.orientation[a].conjugate();
  RelativePose pose{to_a * p.orientation[b], to_a * (p.position[b] - p.position[a]), {}};
  pose.smaller =
      p.radius[b] <= p.radius[a] ? pose.centre : p.orientation[b].conjugate() * (p.position[a] - p.position[b]);
  return pose;
}

Placement placement_of(const RelativePose& pose) {
  const Eigen::Matrix3d turn = pose.turn.toRotationMatrix();
  const auto row = [&](int i) { return Vec3<double>{turn(i, 0), turn(i, 1), turn(i, 2)}; };
  return {{row(0), row(1), row(2)}, {pose.centre.x(), pose.centre.y(), pose.centre.z()}};
}

void KeptPair::keep_triangles(const Hits& hits, std::span<const int> number_b) {
  static thread_local std::vector<int> place; // of triangles of B in triangles_b; scratch memory that has grown stays
  triangles.clear(), triangles_b.clear();
  place.assign(number_b.size(), -1);
  for (int k = 0; k < hits.size(); ++k) {
    const auto [i, j] = PairIndex{hits[k].i, hits[k].j};
    if (place[j] < 0) {
      place[j] = static_cast<int>(triangles_b.size());
      triangles_b.push_back(number_b[j]);
    }
    triangles.push_back({i, place[j]});
  }
}

KeptPair& KeptPairs::of(BodyPair pair, const Particles& particles) {
  Owner& owner = owners_[particles.radius[pair.b] <= particles.radius[pair.a] ? pair.b : pair.a];
  while (owner.busy.test_and_set(std::memory_order_acquire)) {
  }
  Block *found = nullptr, *unused = nullptr;
  int at = 0;
  std::unique_ptr<Block>* last = &owner.blocks;
  for (; *last && !found; last = &(*last)->next)
    for (int i = 0; i < Block::size && !found; ++i) {
      const Entry& entry = (*last)->entries[i];
      if (entry.bodies.a == pair.a && entry.bodies.b == pair.b)
        found = last->get(), at = i;
      else if (!unused && entry.step < step_ - 1)
        unused = last->get(), at = i;
    }
  if (!found) {
    if (!unused) {
      *last = std::make_unique<Block>();
      unused = last->get(), at = 0;
    }
    found = unused;
    found->entries[at].bodies = pair;
    found->pairs[at].forget();
  }
  found->entries[at].step = step_;
  owner.busy.clear(std::memory_order_release);
  return found->pairs[at];
}

} // namespace trigrain
