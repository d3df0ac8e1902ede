#include "dem/pair_source.hpp"
#include "dem/dense_grid.hpp"
#include "dem/grid.hpp"
#include "dem/verlet_list.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <cmath>

namespace trigrain {

double smallest_diameter(const Particles& p) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < p.size(); ++i)
    if (!p.fixed(i)) smallest = std::min(smallest, 2 * (p.radius[i] + p.halo[i]));
  return smallest;
}

double widest_diameter(const Particles& p) {
  double widest = 0;
  for (int i = 0; i < p.size(); ++i)
    if (!p.fixed(i)) widest = std::max(widest, 2 * (p.radius[i] + p.halo[i]));
  return widest > 0 ? widest : std::numeric_limits<double>::infinity();
}

std::unique_ptr<PairSource> make_pair_source(const PairSourceOptions& options, const Domain& domain,
                                             const Particles& particles) {
  const GridKind& kind = row_named(grid_kinds(), "grid", options.grid);
  if (!(options.skin >= 0 && options.skin <= 10))
    throw InputError("skin is " + std::to_string(options.skin) + " (options). Give 0 to 10 diameters.");
  const double smallest = smallest_diameter(particles);
  const double skin = std::isfinite(smallest) ? options.skin * smallest : 0;
  std::unique_ptr<PairSource> grid;
  if (kind.visits_all)
    grid = std::make_unique<DenseGrid>(kind, options.subdivision, domain, particles, skin);
  else
    grid = std::make_unique<Grid>(kind, options.subdivision, domain, particles, skin);
  if (skin == 0) return grid;
  return std::make_unique<VerletList>(std::move(grid), skin);
}

} // namespace trigrain
