#include "dem/surface.hpp"
#include <algorithm>
#include <tuple>
#include <utility>

namespace trigrain {

using Face = std::array<int, 3>;

std::vector<char> bounding_faces(const std::vector<Face>& faces) {
  std::vector<std::pair<Face, int>> sorted;
  std::vector<char> bounds(faces.size(), 0);
  for (int i = 0; i < static_cast<int>(faces.size()); ++i) {
    Face f = faces[i];
    if (f[0] == f[1] || f[1] == f[2] || f[2] == f[0]) continue;
    std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    sorted.emplace_back(f, i);
  }
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < sorted.size(); ++i)
    bounds[sorted[i].second] = i == 0 || sorted[i].first != sorted[i - 1].first;
  return bounds;
}

std::vector<EdgeUse> edge_uses(const std::vector<Face>& faces, const std::vector<char>& bounds) {
  std::vector<std::tuple<int, int, bool>> sides; // low, high, whether upward
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (!bounds[i]) continue;
    for (int k = 0; k < 3; ++k) {
      const int from = faces[i][k], to = faces[i][(k + 1) % 3];
      sides.emplace_back(std::min(from, to), std::max(from, to), from < to);
    }
  }
  std::sort(sides.begin(), sides.end());
  std::vector<EdgeUse> uses;
  for (const auto& [low, high, upward] : sides) {
    if (uses.empty() || uses.back().low != low || uses.back().high != high) uses.push_back({low, high, 0, 0});
    ++(upward ? uses.back().up : uses.back().down);
  }
  return uses;
}

} // namespace trigrain
