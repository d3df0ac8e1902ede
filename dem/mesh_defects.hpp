#pragma once
#include "dem/mesh.hpp"
#include <optional>
#include <string>

namespace trigrain {

/// Why a mesh has no mass (volume 0), with the place in the shape's own frame (m).
std::string why_massless(const Mesh& mesh);

/// Where the surface crosses itself by more than a millionth of its size (m, the shape's own frame); none if it does
/// not. Its mass would count overlaps twice, and pieces inside out less than nothing.
std::optional<Eigen::Vector3d> self_crossing(const Mesh& mesh);

/// "(0.01, 0, 0.02)" for messages.
std::string in_words(const Eigen::Vector3d& point);

} // namespace trigrain
