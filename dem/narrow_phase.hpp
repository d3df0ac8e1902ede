#pragma once
#include "dem/contact_rule.hpp"
#include "dem/kept_pairs.hpp"
#include "dem/pair_source.hpp"
#include "dem/runtime.hpp"
#include "kernels/precheck.hpp"
#include "kernels/sphere.hpp"
#include <atomic>
#include <deque>
#include <span>
#include <string_view>
#include <vector>

namespace trigrain {

/// How body pairs are turned into contacts.
struct NarrowPhase {
  const Kernel* kernel;
  const Precheck* precheck;
  const ContactRule* rule;
  KeptPairs* kept_pairs; ///< what bodies have near each other; null: they are searched in every step
};

/// A body pair that touches: its contacts are [first, first + count) of a worker's. Two spheres have one that
/// touch_of_spheres() tells, which is cheaper than to keep it.
struct FoundPair {
  static constexpr int of_spheres = -1; ///< first
  int a, b;
  int first, count;
};
/// Sets all of `touch`.
void touch_of_spheres(const Particles& particles, BodyPair pair, Touch& touch);

/// A body pair whose triangle pairs are many: any worker may solve any part of them, the last one makes the contacts.
struct SplitPair {
  BodyPair pair;
  Placement b_in_a;
  double reach; ///< m
  Candidates candidates;
  std::vector<Hits> hits; ///< of each part
  int parts = 0;
  std::atomic<int> parts_left = 0;
};
/// Those of a step; refilling does not allocate, and references stay valid.
struct SplitPairs {
  std::deque<SplitPair> all;
  int used = 0;
  SplitPair& next() {
    if (used == static_cast<int>(all.size())) all.emplace_back();
    return all[used++];
  }
};

/// What one worker finds during a step, and its scratch memory. Written by that worker only; two of them share no cache
/// line.
struct alignas(128) WorkerBuffer {
  std::vector<Touch> contacts; ///< contacts of one body pair stand together, in the order of their features
  std::vector<FoundPair> found;
  std::int64_t candidate_pairs = 0, body_pairs = 0, searched_pairs = 0;
  std::int64_t crossings = 0; ///< triangle or sphere pairs found at distance 0
  KernelCounts kernel;

  double reach = 0; ///< of the pair at hand: sum of its halos (m)
  std::vector<BodyPair> pairs;
  Candidates candidates;
  Hits hits;
  NearFaces near_faces_a, near_faces_b;
  KeptPair kept_pair; ///< of a pair that is not kept

  struct NearMesh { ///< of a sphere: its triangles that are near are [first, first + count)
    BodyPair pair;
    int first, count;
  };
  std::vector<NearMesh> near_meshes;        ///< whose contacts are still to be found
  std::vector<int> near_numbers;            ///< of their triangles, in the meshes
  Triangles near_triangles;                 ///< seen from the spheres' centres, in the frames of the meshes (m)
  std::vector<PointOnTriangle> near_points; ///< of those triangles
  std::vector<int> found_triangles;         ///< near the sphere at hand

  void clear();
};

/// Finds the contacts of body pairs and appends them to the buffer. Crossing surfaces have no normal: they are counted
/// and give no contact. If a pair has more triangle pairs than one part, and `split` is given, it is left there for
/// solve_part() instead, and on_split is told.
void collide(
    const Particles& particles, std::span<const BodyPair> pairs, const NarrowPhase& narrow, WorkerBuffer& buffer,
    SplitPairs* split = nullptr, FunctionRef<void(SplitPair&)> on_split = [](SplitPair&) {});

/// Solves one of split.parts; the last of them to end appends the contacts to its worker's buffer.
void solve_part(const Particles& particles, SplitPair& split, int part, const NarrowPhase& narrow,
                WorkerBuffer& buffer);

} // namespace trigrain
