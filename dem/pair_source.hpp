#pragma once
#include "dem/particles.hpp"
#include "dem/runtime.hpp"
#include "dem/spacetree.hpp"
#include "dem/step_stats.hpp"
#include <memory>
#include <string_view>
#include <vector>

namespace trigrain {

/// Two bodies that may touch; a < b.
struct BodyPair {
  int a, b;
};

/// Which of its candidates a source hands out: all, or those whose bounding spheres with halo overlap.
enum class Sieve { none, spheres };

inline bool spheres_overlap(const Particles& p, BodyPair pair) {
  const double r = p.radius[pair.a] + p.radius[pair.b] + p.halo[pair.a] + p.halo[pair.b];
  return (p.position[pair.a] - p.position[pair.b]).squaredNorm() <= r * r * (1 + 1e-12); // rounding must lose no pair
}

/// Of the bodies that move, 2 (radius + halo) (m); infinite if none does.
double smallest_diameter(const Particles& particles);
double widest_diameter(const Particles& particles);

/// Where the engine gets its candidate pairs from. Whatever the source, every pair whose halos overlap is among them,
/// and none comes twice in a step.
class PairSource {
 public:
  virtual ~PairSource() = default;
  /// Bodies have moved. The same bodies must come in every call.
  virtual void update(const Particles& particles, Team& team) = 0;
  /// Units of work: their pairs are asked for one by one, in any order and by several threads.
  virtual int entries() const = 0;
  /// Appends the pairs that entry `entry` reports; pairs of two fixed bodies are left out. How many it compared.
  virtual std::int64_t pairs_of(int entry, const Particles& particles, Sieve sieve,
                                std::vector<BodyPair>& pairs) const = 0;
  /// So far (m) each point of the body may move from now on, and of all others as theirs, until a pair may overlap that
  /// is not reported.
  virtual double room(int body) const = 0;
  /// Adds what the last update did.
  virtual void count(StepStats&) const {}
  /// The cells it works with; null if there are none.
  virtual const Spacetree* tree() const { return nullptr; }
};

/// The source that a grid kind's name and the other options ask for. `skin`, in diameters of the smallest moving body:
/// the grid's pairs are kept until a body has moved so far; 0: it is asked in every step. InputError for unknown names
/// and senseless values.
struct PairSourceOptions {
  std::string_view grid;
  int subdivision = 3;
  double skin = 0;
};
std::unique_ptr<PairSource> make_pair_source(const PairSourceOptions& options, const Domain& domain,
                                             const Particles& particles);

} // namespace trigrain
