#pragma once
#include "dem/pair_source.hpp"
#include <cmath>
#include <limits>
#include <unordered_map>

namespace trigrain {

/// A second source of candidate pairs that shares nothing with Grid but its interface: one level of hashed cells, each
/// body in every cell that its box with halo meets; a pair is reported in the cell of the lower corner of the two
/// boxes' intersection, hence once.
class HashGrid final : public PairSource {
 public:
  explicit HashGrid(const Particles& p) {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (int i = 0; i < p.size(); ++i) {
      if (p.fixed(i)) continue;
      least = std::min(least, p.radius[i] + p.halo[i]);
      most = std::max(most, p.radius[i] + p.halo[i]);
    }
    cell_ = 2 * std::sqrt(least * most); // neither many bodies in a cell nor many cells to a body
  }

  void update(const Particles& p, Team&) override {
    bodies_.clear();
    box_.clear();
    for (int i = 0; i < p.size(); ++i) {
      const double r = p.radius[i] + p.halo[i];
      box_.emplace_back(p.position[i].array() - r, p.position[i].array() + r);
      for_cells(box_[i], [&](std::int64_t key) { bodies_[key].push_back(i); });
    }
  }

  int entries() const override { return static_cast<int>(box_.size()); }

  /// Pairs of body `entry` with bodies of higher index.
  std::int64_t pairs_of(int entry, const Particles& p, Sieve sieve, std::vector<BodyPair>& pairs) const override {
    std::int64_t compared = 0;
    for_cells(box_[entry], [&](std::int64_t key) {
      for (const int other : bodies_.at(key)) {
        if (other <= entry || (p.fixed(entry) && p.fixed(other)) || !box_[entry].intersects(box_[other])) continue;
        if (key_of(cell_of(box_[entry].intersection(box_[other]).min())) != key) continue;
        ++compared;
        if (sieve == Sieve::none || spheres_overlap(p, {entry, other})) pairs.push_back({entry, other});
      }
    });
    return compared;
  }

  double room(int) const override { return 0; }

 private:
  using Cell = Eigen::Array<std::int64_t, 3, 1>;
  Cell cell_of(const Eigen::Vector3d& x) const { return (x.array() / cell_).floor().cast<std::int64_t>(); }
  static std::int64_t key_of(const Cell& c) { return ((c.z() << 21) + c.y()) * (1 << 21) + c.x(); }
  template <class Visit> void for_cells(const Eigen::AlignedBox3d& box, const Visit& visit) const {
    const Cell low = cell_of(box.min()), high = cell_of(box.max());
    for (std::int64_t z = low.z(); z <= high.z(); ++z)
      for (std::int64_t y = low.y(); y <= high.y(); ++y)
        for (std::int64_t x = low.x(); x <= high.x(); ++x) visit(key_of({x, y, z}));
  }

  double cell_; // m
  std::vector<Eigen::AlignedBox3d> box_;
  std::unordered_map<std::int64_t, std::vector<int>> bodies_;
};

} // namespace trigrain
