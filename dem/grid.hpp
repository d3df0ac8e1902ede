#pragma once
#include "dem/pair_source.hpp"
#include "dem/spacetree.hpp"
#include "dem/sphere_array.hpp"
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace trigrain {

/// Who is where in the spacetree (Krestenitis 2018). A body lives at the vertex nearest to its centre that does not
/// hang, on the finest such level whose cells are at least as wide as its 2 (radius + halo + skin), so two bodies of
/// one level can only touch if their vertices are those of a common cell. It drops to a finer level where the cells
/// around its vertex are split or the grid's kind lets it split them, and is lifted where it comes to cells that are
/// whole. A body of a coarser level appears as a virtual copy at every finer vertex whose bodies it may reach. Bodies
/// outside the domain count at its border; no pair is lost. Only vertices that hold bodies and cells that are split
/// take memory.
class Grid final : public PairSource {
 public:
  /// Bodies are taken for wider by a skin (m) on every side.
  Grid(const GridKind& kind, int subdivision, const Domain& domain, const Particles& particles, double skin = 0);

  /// Brings every body to its vertex, splits and joins cells, and rebuilds the virtual copies. Cells and sorted arrays
  /// are touched only if a body changed its vertex, virtual copies also if their body moved. The result does not depend
  /// on the team.
  void update(const Particles& particles, Team& team) override;

  /// Entry e is one body in the order of vertices.
  int entries() const override { return static_cast<int>(order_.size()); }
  /// Also notes which bodies the kind wants to be on a finer level in the next step.
  std::int64_t pairs_of(int entry, const Particles& particles, Sieve sieve,
                        std::vector<BodyPair>& pairs) const override;
  /// Two bodies that share no cell are at least half of (cell - diameter) of the one and half of that of the other
  /// apart.
  double room(int body) const override;
  void count(StepStats& stats) const override;

  const Spacetree* tree() const override { return &tree_; }
  /// Where a body lives.
  int level_of(int body) const { return body_level_[body]; }
  std::uint64_t vertex_of(int body) const { return body_key_[body]; }
  int levels() const { return tree_.levels(); }       ///< that there may be
  int occupied_levels() const { return finest_ + 1; } ///< down to the finest that holds a body
  int occupied_vertices() const { return static_cast<int>(vertex_.size()); }
  std::int64_t virtual_copies() const { return static_cast<std::int64_t>(copies_.size()); }

 private:
  struct Range {
    int begin, end; // entries
  };
  /// A vertex that holds bodies. Its partners are the vertices that follow it in key order and share a cell with it;
  /// in key order (x fastest) these are runs in five rows: its own, (y+1), (z+1, y-1), (z+1), (z+1, y+1).
  struct Vertex {
    std::uint64_t key;
    Range bodies;
    Range partners[5]; // partners[0] begins behind the vertex's own bodies
    Range copies;      // into copies_
  };
  struct Copy {
    int vertex, body;
  };
  struct Fixed {
    Eigen::AlignedBox3d box;
    std::unordered_map<std::uint64_t, bool> reaches; // vertices asked so far, by key
  };

  bool is_at_home(int body, const Particles& particles) const;
  int vertices_of(int level) const { return level_vertices_[level + 1] - level_vertices_[level]; }
  bool above_target(int body) const { return body_level_[body] < target_[body]; }
  void settle(int body, const Eigen::Vector3d& x);
  void settle_all(const Particles& particles, Team& team);
  void note_wishes(int body, std::int64_t compared, const Particles& particles, std::span<const BodyPair> pairs) const;
  void find_coarse(const Particles& particles);
  void move_changed();
  void rebuild_vertices();
  void find_partners(int level, int row);
  void project(const Particles& particles, Team& team);
  void project_to_vertices(const Particles& particles, int body, std::vector<Copy>& into);
  bool reaches(const Particles& particles, int body, int level, const Index3& index);
  Eigen::AlignedBox3d box_of(const Particles& particles, int body) const;

  double skin_; // m
  Spacetree tree_;
  std::vector<double> diameter_;         // 2 (radius + halo + skin) (m)
  std::vector<int> target_;              // finest level that a body fits on
  std::vector<double> level_room_;       // per level: half of (cell - diameter) of the widest body there may be (m)
  std::vector<int> body_level_;          // where it lives
  std::vector<std::uint64_t> body_key_;  // of its vertex
  std::vector<Eigen::Vector3d> anchor_;  // where it was when it came there: the cells above it are entered from here
  mutable std::vector<char> wish_;       // bodies that shall drop, noted by pairs_of() for the next update
  int above_target_ = 0, finest_ = 0;    // number of bodies; level
  std::vector<int> order_;               // bodies sorted by (key, index)
  SphereArray sphere_;                   // of each entry, with halo and skin
  std::vector<int> entry_vertex_;        // vertex of each entry
  std::vector<Vertex> vertex_;           // sorted by key
  std::vector<int> level_vertices_;      // vertices of level l: [l], ..., [l + 1] - 1
  std::vector<int> copies_;              // virtual copies: bodies, by vertex
  std::vector<int> coarse_;              // bodies with occupied levels below their own
  std::unordered_map<int, Fixed> fixed_; // bodies that are fixed
  bool coarse_moves_ = false;
  std::int64_t refinements_ = 0, coarsenings_ = 0, settled_ = 0; // of the last update
  std::vector<int> changed_, merged_;                            // scratch
  std::vector<char> has_changed_, leaves_;
  std::vector<std::vector<Copy>> projected_; // scratch: of some coarse bodies each
};

} // namespace trigrain
