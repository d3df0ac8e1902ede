#pragma once
#include "experiments/stability/study.hpp"

namespace trigrain {

// Motions of single bodies that are known in closed form.
std::vector<Metric> free_top(const StudyRequest& request);         ///< value: 1 or 2, which of the two tops
std::vector<Metric> rigid_impact(const StudyRequest& request);     ///< value: tilt of a cube (degrees)
std::vector<Metric> ellipsoid_impact(const StudyRequest& request); ///< value: tilt (degrees); level: of the mesh
std::vector<Metric> mesh_sphere(const StudyRequest& request);      ///< level: of the mesh
std::vector<Metric> bounce(const StudyRequest& request);           ///< value: restitution
std::vector<Metric> similarity(const StudyRequest& request);       ///< value: scale of all lengths

} // namespace trigrain
