#include "dem/kept_pairs.hpp"
#include "dem/vectors.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>

namespace trigrain {

RelativePose relative_pose(const Particles& p, BodyPair pair) {
  const auto [a, b] = pair;
  RelativePose pose{p.orientation[a].conjugate() * p.orientation[b], p.to_body(a, p.position[b]), {}};
  pose.smaller = p.smaller(a, b) == b ? pose.centre : p.to_body(b, p.position[a]);
  return pose;
}

Placement placement_of(const RelativePose& pose) {
  const Eigen::Matrix3d turn = pose.turn.toRotationMatrix();
  return {{vec3(turn.row(0)), vec3(turn.row(1)), vec3(turn.row(2))}, vec3(pose.centre)};
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

void NearTriangles::keep(std::span<const int> triangles, const Eigen::Vector3d& centre, double room_m) {
  const int count = static_cast<int>(triangles.size());
  if (count > few && count > room_for_) many_ = std::make_unique<int[]>(room_for_ = 2 * count);
  std::copy(triangles.begin(), triangles.end(), count > few ? many_.get() : few_.data());
  count_ = count;
  centre_ = centre;
  room_ = room_m;
}

template <class Kept> Kept& PairMemory<Kept>::of(BodyPair pair, const Particles& particles) {
  Owner& owner = owners_[particles.smaller(pair.a, pair.b)];
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

template class PairMemory<KeptPair>;
template class PairMemory<NearTriangles>;

std::unique_ptr<KeptPairs> kept_pairs_for(const std::string& triangle_search, const Kernel& kernel,
                                          const Particles& particles) {
  const bool every_step = triangle_search == "every-step";
  if (!every_step && triangle_search != "when-needed")
    throw InputError("unknown triangle_search '" + triangle_search + "'. Known: when-needed, every-step.");
  int meshes = 0, moving = 0;
  for (int i = 0; i < particles.size(); ++i) meshes += !particles.is_sphere(i), moving += !particles.fixed(i);
  if (every_step || meshes == 0 || moving == 0 || !kernel.exact || kernel.name == "hybrid-batch") return nullptr;
  return std::make_unique<KeptPairs>(particles.size());
}

} // namespace trigrain
