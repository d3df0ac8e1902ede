#include "experiments/stability/study.hpp"
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
    {"stack", "ten cubes on each other: heights, sideways drift, kinetic energy that stays", stack},
};

} // namespace

bool Metric::within() const { return std::isfinite(value) && (!bar || std::abs(value) <= *bar); }

std::span<const Study> studies() { return table; }

} // namespace trigrain
