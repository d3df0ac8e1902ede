#pragma once
#include "dem/pair_source.hpp"
#include <memory>

namespace trigrain {

/// Pairs of another source that takes bodies for wider by a skin (m), kept until a body has moved that far (Verlet
/// 1967): exact, and without a search in most steps.
class VerletList final : public PairSource {
 public:
  VerletList(std::unique_ptr<PairSource> source, double skin) : source_(std::move(source)), skin_(skin) {}

  void update(const Particles& particles, Team& team) override;
  int entries() const override { return entries_; }
  std::int64_t pairs_of(int entry, const Particles& particles, Sieve sieve,
                        std::vector<BodyPair>& pairs) const override;
  double room(int body) const override { return skin_ - moved_[body]; }
  void count(StepStats& stats) const override;
  const Spacetree* tree() const override { return source_->tree(); }

 private:
  static constexpr int block_entries = 64; ///< of the other source, searched by one worker
  struct Block {
    std::vector<BodyPair> pairs;
    int begin[block_entries + 1]; ///< of each entry's pairs
    std::int64_t compared;
  };

  bool note_moves(const Particles& particles, Team& team);
  void search(Block& block, int first, int count, const Particles& particles) const;

  std::unique_ptr<PairSource> source_;
  double skin_;
  int entries_ = 0;
  bool searched_ = false;             ///< in the last update
  std::vector<Eigen::Vector3d> then_; ///< where bodies were at the last search
  std::vector<double> moved_;         ///< since then (m)
  std::vector<Block> blocks_;
};

} // namespace trigrain
