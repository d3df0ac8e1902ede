#pragma once
#include <Eigen/Core>
#include <vector>

namespace trigrain {

/// Force (N) and torque about the centre of mass (N m) per body, world frame.
struct Loads {
  std::vector<Eigen::Vector3d> force, torque;
};

} // namespace trigrain
