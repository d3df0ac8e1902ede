#pragma once
#include "dem/pair_source.hpp"
#include "dem/spacetree.hpp"

namespace trigrain {

/// The regular grid as published (Krestenitis 2018): all vertices of all levels are stored, and each step visits all of
/// them, whether bodies live there or not. The baseline for grids that follow the bodies.
class DenseGrid final : public PairSource {
 public:
  /// Bodies are taken for wider by a skin (m) on every side. InputError if there are too many vertices to store.
  DenseGrid(const GridKind& kind, int subdivision, const Domain& domain, const Particles& particles, double skin);

  void update(const Particles& particles, Team& team) override;
  /// Entry e is the vertex of key e.
  int entries() const override { return static_cast<int>(first_.size()); }
  std::int64_t pairs_of(int entry, const Particles& particles, Sieve sieve,
                        std::vector<BodyPair>& pairs) const override;
  double room(int body) const override;
  void count(StepStats& stats) const override;
  const Spacetree* tree() const override { return &tree_; }

 private:
  template <class Visit> void for_coarser_bodies(int level, std::uint64_t key, const Visit& visit) const;
  double diameter(const Particles& p, int i) const { return 2 * (p.radius[i] + p.halo[i] + skin_); }

  double skin_; // m
  Spacetree tree_;
  std::vector<int> level_;   // where each body lives
  std::vector<double> room_; // per body (m)
  std::vector<int> first_;   // per vertex: its first body, or -1
  std::vector<int> next_;    // per body: the next one at its vertex, or -1
  int finest_ = 0;           // level that holds a body
};

} // namespace trigrain
