#pragma once
#include "dem/scene.hpp"

namespace trigrain {

/// Two elastic spheres, or one and a rigid body: force k overlap^(3/2), tangential stiffness times sqrt(overlap).
struct HertzPair {
  double k;          ///< N/m^(3/2)
  double tangential; ///< N/m^(3/2)
};

/// Hertz (1882), Mindlin (1949): k = 4/3 E* sqrt(R*), tangential = 8 G* sqrt(R*), for radii (m) of the same material.
HertzPair hertz_pair(const ContactParameters& law, double radius_a, double radius_b, bool one_is_rigid);

/// Of one contact of the scene at its largest overlap, the sum of halos (N/m); the stiffness of a linear law.
double largest_stiffness(const Scene& scene);

/// Damping ratio with which an impact under the contact law has restitution 0 < e <= 1.
double damping_ratio_for(const std::string& law, double restitution);

} // namespace trigrain
