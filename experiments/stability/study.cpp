#include "experiments/stability/study.hpp"
#include "experiments/stability/closed_forms.hpp"
#include "experiments/stability/impacts.hpp"
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
    {"stack", "ten cubes on each other: heights, sideways drift, kinetic energy that stays", stack},
};

} // namespace

bool Metric::within() const { return std::isfinite(value) && (!bar || std::abs(value) <= *bar); }

std::span<const Study> studies() { return table; }

} // namespace trigrain
