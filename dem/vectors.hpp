#pragma once
#include "kernels/vec3.hpp"
#include <Eigen/Core>

namespace trigrain {

/// Between the vectors of bodies and those of kernels.
inline Vec3<double> vec3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline Eigen::Vector3d eigen(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

} // namespace trigrain
