#include "dem/step_size.hpp"
#include "dem/fast_bodies.hpp"
#include "dem/vectors.hpp"
#include "kernels/sphere.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace trigrain {
namespace {

using Eigen::Vector3d;

constexpr double growth = 1.1; // from one step to the next (Krestenitis 2018, 9.1)

double fixed_step(const StepView& v) { return v.contact_step; }

Vector3d acceleration(const StepView& v, int i) {
  if (v.particles.fixed(i)) return Vector3d::Zero();
  return v.gravity + v.particles.inverse_mass[i] * v.loads.force[i];
}

/// Time t (s) in which a gap (m) cannot close at this speed (m/s) and acceleration (m/s2): a step after a last one of
/// `last` s moves by t (speed + acceleration (last + t) / 2).
double time_to_close(double gap, double speed, double acceleration, double last) {
  if (gap <= 0) return 0;
  speed += acceleration * last / 2;
  const double denominator = speed + std::sqrt(speed * speed + 2 * acceleration * gap);
  return denominator > 0 ? 2 * gap / denominator : std::numeric_limits<double>::infinity();
}

/// Distance of x (m, world) from the triangles of a body, or `far` if that is less.
double distance_to_mesh(const Particles& p, int body, const Vector3d& x, double far, std::vector<int>& scratch) {
  const Vec3<double> local = vec3(p.to_body(body, x));
  const TrianglesView triangles = p.mesh[body]->triangles.view();
  triangles_near_point(triangles, local, far, scratch);
  double least2 = far * far;
  for (const int i : scratch) least2 = std::min(least2, closest_point(local, triangles[i]).distance2);
  return std::sqrt(least2);
}

/// What is left between the halos of two bodies, at least (m): exact against fixed meshes up to `horizon`, else of
/// their bounding spheres.
double gap_of(const Particles& p, BodyPair pair, double horizon, std::vector<int>& scratch) {
  const double halos = p.halo[pair.a] + p.halo[pair.b];
  for (const auto& [wall, body] : {std::pair(pair.a, pair.b), std::pair(pair.b, pair.a)})
    if (p.fixed(wall) && p.mesh[wall]) {
      const double reach = p.radius[body] + halos;
      return distance_to_mesh(p, wall, p.position[body], reach + horizon, scratch) - reach;
    }
  return (p.position[pair.a] - p.position[pair.b]).norm() - p.radius[pair.a] - p.radius[pair.b] - halos;
}

template <class Visit> void for_pairs(const StepView& v, const Visit& visit) {
  std::vector<BodyPair> pairs;
  for (int entry = 0; entry < v.source.entries(); ++entry) {
    pairs.clear();
    v.source.pairs_of(entry, v.particles, Sieve::none, pairs);
    for (const BodyPair pair : pairs)
      if (!visit(pair)) return;
  }
}

/// In [0, 1), from the last digits of a time: as good as random, the same for every team, and for a scene at 4 times
/// the size.
double any_phase(double time) {
  int exponent;
  const double digits = std::ldexp(std::frexp(time, &exponent), 27);
  return digits - std::floor(digits);
}

/// Longest step (s) after which no pair that is apart can come to overlap within another contact step, and of those
/// that are not reported none can use up the room between them. So the step before a contact is a contact step: its
/// first force kicks over half of the last step too, and a long one would turn damping into a blow. A step that leads
/// to a contact ends a little earlier: contacts begin at any phase of a step, and the errors of many do not add up.
double approach(const StepView& v) {
  const Particles& p = v.particles;
  double step = growth * v.last_step;
  const auto limit = [&](double gap, double speed, double pull) {
    const double time = time_to_close(gap, speed, pull, v.last_step), all = time - v.contact_step;
    if (all < step) step = all < v.last_step ? all - any_phase(time) * v.contact_step : all;
  };
  for (int i = 0; i < p.size(); ++i) {
    if (p.fixed(i)) continue;
    const double speed = fastest_point(p, i);
    limit(v.source.room(i), speed, acceleration(v, i).norm());
  }
  std::vector<int> scratch;
  for_pairs(v, [&](BodyPair pair) {
    const double speed =
        (p.velocity[pair.a] - p.velocity[pair.b]).norm() + turning_speed(p, pair.a) + turning_speed(p, pair.b);
    const double pull = (acceleration(v, pair.a) - acceleration(v, pair.b)).norm();
    if (speed == 0 && pull == 0) return true; // they stay as they are
    const double t = step + v.contact_step, horizon = t * (speed + (v.last_step + t) / 2 * pull);
    limit(gap_of(p, pair, horizon, scratch), speed, pull);
    return step > v.contact_step;
  });
  return std::max(step, v.contact_step);
}

/// As published: looks at gaps and not at speeds, but for the bound that no body crosses more than its own width. A
/// body that is fast and not yet near jumps over the halo of what it should hit.
double gap_only(const StepView& v) {
  const Particles& p = v.particles;
  double step = growth * v.last_step;
  for (int i = 0; i < p.size(); ++i)
    if (!p.fixed(i)) step = std::min(step, time_to_close(2 * (p.radius[i] + p.halo[i]), p.velocity[i].norm(), 0, 0));
  std::vector<int> scratch;
  for_pairs(v, [&](BodyPair pair) {
    const double near = p.halo[pair.a] + p.halo[pair.b]; // the contact-critical length
    if (gap_of(p, pair, near, scratch) < near) step = 0;
    return step > 0;
  });
  return std::max(step, v.contact_step);
}

constexpr StepControl table[] = {
    {"fixed", "the scene's step throughout", fixed_step, false},
    {"approach", "no pair comes to overlap within a step; contacts get the scene's step (Krestenitis 2018, safe)",
     approach, true},
    {"gap-only", "the scene's step near contact, whatever the speed; fast bodies pass through (Krestenitis 2018)",
     gap_only, false},
};

} // namespace

std::span<const StepControl> step_controls() { return table; }

} // namespace trigrain
