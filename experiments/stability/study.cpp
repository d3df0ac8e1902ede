#include "experiments/stability/study.hpp"
#include "experiments/stability/closed_forms.hpp"
#include "experiments/stability/discharge.hpp"
#include "experiments/stability/impacts.hpp"
#include "experiments/stability/limits.hpp"
#include "experiments/stability/rules.hpp"
#include <cmath>

namespace trigrain {
namespace {

constexpr Study table[] = {
    {"tessellation",
     "a face cut `value` x `value` against a whole one: overlap, contact time, restitution, critical step",
     tessellation},
    {"loop-work", "work of the contact forces around closed paths of position and turn, over the largest energy stored",
     loop_work},
    {"face-rest", "wander of the contact point and torque of a cube at rest on a face", face_rest},
    {"impact", "tests 1 to 8 (`value`) of Chung & Ooi (2011) with Hertz-Mindlin, as a ball or an icosphere (`level`)",
     impact},
    {"free-top", "period, energy and momentum of a cuboid near its unstable axis", free_top},
    {"rigid-impact", "a cube tilted by `value` degrees drops on an edge: velocity and spin", rigid_impact},
    {"ellipsoid-impact", "the same of a mesh ellipsoid (1, 1, 2)", ellipsoid_impact},
    {"slope", "a block slides (`value` 30) or rests (20 degrees)", slope},
    {"topple", "a map of blocks that slide, topple or rest", topple},
    {"mesh-sphere", "what an icosphere of `level` misses of a sphere", mesh_sphere},
    {"bounce", "time to rest of a bouncing ball of restitution `value`", bounce},
    {"similarity", "the same motion at `value` times the size", similarity},
    {"discharge", "rate at which a bin empties through an opening of `value` grain diameters", discharge},
    {"step-limit", "observed against predicted critical step: ball (`value` 0), cube on its face (1), three cubes (2)",
     step_limit},
    {"rebound", "restitution of an undamped impact at so many steps per contact", rebound},
    {"long-run", "energy error over `value` bounces", long_run},
    {"tunnelling", "does a ball at `value` times the response limit pass through a plane?", tunnelling},
    {"overlap-release", "speed of a ball released from `value` of the largest overlap", overlap_release},
    {"cut-floor", "a cube slides over a floor cut `value` x `value`: ripple of the force, tilt of the normal",
     cut_floor},
    {"mass-ratio", "a cube of `value` times the mass on another", mass_ratio},
    {"stack", "ten cubes on each other: heights, sideways drift, kinetic energy that stays", stack},
};

} // namespace

bool Metric::within() const { return std::isfinite(value) && (!bar || std::abs(value) <= *bar); }

std::span<const Study> studies() { return table; }

} // namespace trigrain
