#include "dem/fast_bodies.hpp"
#include <algorithm>
#include <limits>

namespace trigrain {

std::vector<double> seen_within(const Particles& p) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> sorted = p.halo, within(p.size());
  std::sort(sorted.begin(), sorted.end());
  const auto positive = std::upper_bound(sorted.begin(), sorted.end(), 0.);
  for (int i = 0; i < p.size(); ++i) {
    const double own = p.halo[i];
    if (own == 0)
      within[i] = positive == sorted.end() ? infinity : *positive;
    else if (sorted.size() > 1)
      within[i] = own + (own == sorted[0] ? sorted[1] : sorted[0]);
    else
      within[i] = infinity;
  }
  return within;
}

} // namespace trigrain
