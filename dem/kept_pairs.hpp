#pragma once
#include "dem/feature_pairs.hpp"
#include "dem/pair_source.hpp"
#include <array>
#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace trigrain {

/// Where two bodies are, seen from one another.
struct RelativePose {
  Eigen::Quaterniond turn; ///< from the frame of B to that of A
  Eigen::Vector3d centre;  ///< of B, in the frame of A (m)
  Eigen::Vector3d smaller; ///< centre of the body of smaller radius in the frame of the other one (m)
};
RelativePose relative_pose(const Particles& particles, BodyPair pair);
Placement placement_of(const RelativePose& pose);

/// What two meshes have near each other: triangle pairs, or corners, edges and faces. Complete until a point of one may
/// have moved by more than `room` as seen from the other.
class KeptPair {
 public:
  bool of_features = false;         ///< what is kept: `features`, or else triangles
  std::vector<int> triangles_b;     ///< those of B that some pair needs
  std::vector<PairIndex> triangles; ///< i in mesh A, j in triangles_b
  FeaturePairs features;

  /// Keeps the triangle pairs that a kernel found; number_b: of their triangles of B in its mesh.
  void keep_triangles(const Hits& hits, std::span<const int> number_b);
  /// It was searched at `pose`.
  void keep(const RelativePose& pose, double room_m) {
    turn_ = pose.turn;
    smaller_ = pose.smaller;
    room_ = room_m;
  }
  void forget() { room_ = -1; }
  /// Whether it is still complete; `radius` (m) of the smaller body. A point of a body that turns by an angle has moved
  /// by 2 sin(angle / 2) of its distance at most, which is less than twice the distance of the quaternions.
  bool is_complete(const RelativePose& pose, double radius) const {
    if (!(room_ > 0)) return false;
    const double turned = 2 * radius * (pose.turn.coeffs() - turn_.coeffs()).norm();
    return turned + (pose.smaller - smaller_).norm() < room_;
  }

 private:
  Eigen::Quaterniond turn_;
  Eigen::Vector3d smaller_;
  double room_ = -1; // m
};

/// The triangles of a mesh that a sphere is near to, wherever it turns; in one line of the cache while they are few.
class alignas(cache_line) NearTriangles {
 public:
  /// Searched with the sphere's centre (m) there, in the frame of the mesh.
  void keep(std::span<const int> triangles, const Eigen::Vector3d& centre, double room_m);
  void forget() { room_ = -1; }
  bool is_complete(const Eigen::Vector3d& centre) const {
    return room_ > 0 && (centre - centre_).squaredNorm() < room_ * room_;
  }
  std::span<const int> triangles() const { return {count_ <= few ? few_.data() : many_.get(), std::size_t(count_)}; }

 private:
  static constexpr int few = 4;
  Eigen::Vector3d centre_;
  double room_ = -1;             // m
  int count_ = 0, room_for_ = 0; // room_for_: of many_
  std::array<int, few> few_;
  std::unique_ptr<int[]> many_; // if they are more
};

/// What body pairs have near each other, kept from step to step.
template <class Kept> class PairMemory {
 public:
  explicit PairMemory(int bodies) : owners_(bodies) {}
  void begin_step() { ++step_; }
  /// That of a pair, which its caller has for itself during this step. It is new if the pair was not asked for in the
  /// last step and its place has been taken. Any number of threads may call it at once.
  Kept& of(BodyPair pair, const Particles& particles);

 private:
  struct Entry {
    BodyPair bodies{-1, -1};
    std::int64_t step = -2; // when it was last asked for
  };
  /// Memory of some pairs of one body; their names stand together.
  struct Block {
    static constexpr int size = 2;
    std::array<Entry, size> entries;
    std::unique_ptr<Block> next;
    std::array<Kept, size> pairs;
  };
  struct Owner { // the smaller body of its pairs: few others are around it
    std::atomic_flag busy;
    std::unique_ptr<Block> blocks;
  };
  std::int64_t step_ = 0;
  std::vector<Owner> owners_;
};
extern template class PairMemory<KeptPair>;
extern template class PairMemory<NearTriangles>;

struct KeptPairs {
  PairMemory<KeptPair> of_meshes;
  PairMemory<NearTriangles> of_spheres; ///< with meshes

  explicit KeptPairs(int bodies) : of_meshes(bodies), of_spheres(bodies) {}
  /// How far beyond the halos to search two bodies, as a share of the sum of their halos. Wide margins make each step
  /// dearer, narrow ones are used up soon; for packed and for falling grains .03 to .1 cost about the same.
  static constexpr double margin = .05;
  void begin_step() {
    of_meshes.begin_step();
    of_spheres.begin_step();
  }
};

/// For a simulation; null where nothing can be kept: no mesh meets another body, or the kernel is not exact, or its
/// answers depend on the list. InputError for a triangle_search that is not one of Options.
std::unique_ptr<KeptPairs> kept_pairs_for(const std::string& triangle_search, const Kernel& kernel,
                                          const Particles& particles);

} // namespace trigrain
