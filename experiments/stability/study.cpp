#include "experiments/stability/study.hpp"
#include "experiments/stability/closed_forms.hpp"
#include "experiments/stability/discharge.hpp"
#include "experiments/stability/friction.hpp"
#include "experiments/stability/halo.hpp"
#include "experiments/stability/impacts.hpp"
#include "experiments/stability/numbers.hpp"
#include "experiments/stability/rules.hpp"
#include "experiments/stability/scenes.hpp"
#include "experiments/stability/steps.hpp"
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
    {"rule-cost", "time to find the contacts of two such cubes and their forces", rule_cost},
    {"impact", "tests 1 to 8 (`value`) of Chung & Ooi (2011) with Hertz-Mindlin, as a ball or an icosphere (`level`)",
     impact},
    {"free-top", "period, energy and momentum of a cuboid near its unstable axis", free_top},
    {"rigid-impact", "a cube tilted by `value` degrees drops on an edge: velocity and spin", rigid_impact},
    {"ellipsoid-impact", "the same of a mesh ellipsoid (1, 1, 2)", ellipsoid_impact},
    {"slope", "a block slides down a slope of `value` degrees", slope},
    {"slope-rest", "a block rests below the friction angle for `value` steps: creep, and that of a dashpot alone",
     slope_rest},
    {"topple", "a map of blocks that slide, topple or rest", topple},
    {"rolling-ball", "a ball slides until it rolls (`value` 0), or rolls down a slope of `value` degrees",
     rolling_ball},
    {"rolling-polygon", "spin that a prism of `value` corners keeps at each facet it rolls over", rolling_polygon},
    {"mesh-sphere", "what an icosphere of `level` misses of a sphere", mesh_sphere},
    {"bounce", "time to rest of a bouncing ball of restitution `value`", bounce},
    {"similarity", "the same motion at `value` times the size", similarity},
    {"discharge", "rate at which grains leave a bin, kept full, through an opening of `value` of their diameters",
     discharge},
    {"emptying", "the same while the bin empties, and how high its grains stand over the opening", emptying},
    {"critical-step",
     "observed against predicted: ball (`value` 0), cube on its face (1: no friction, 2, 3: faces cut), three cubes "
     "(4), "
     "a cube turned on another (5)",
     critical_step_study},
    {"rebound", "restitution of an impact that should have `value`, at so many steps per contact", rebound},
    {"rebound-explicit", "the same undamped by explicit Euler, which the engine does not use", rebound_explicit},
    {"long-run", "energy error over `value` bounces", long_run},
    {"tunnelling", "does a ball at `value` times the response limit pass through a plate?", tunnelling},
    {"detection", "is a ball seen that moves `value` times the width of a thin plate per step?", detection},
    {"overlap-release", "energy of bodies released from `value` of the largest overlap", overlap_release},
    {"cut-floor", "a cube slides over a floor cut `value` x `value`: ripple of the force, tilt of the normal",
     cut_floor},
    {"mass-ratio", "a cube of `value` times the mass on another", mass_ratio},
    {"long-rest", "a cube rests for `value` steps: drift, turn, kinetic energy", long_rest},
    {"flat-drop", "a cube drops on its face, tilted by `value` = tilt edge frequency / speed", flat_drop},
    {"grazing", "bodies meet the floor at `value` degrees from its normal: does any gain energy?", grazing},
    {"determinism", "a heap's last state with every scheme and grid on `value` threads", determinism},
    {"far-from-origin", "error of overlaps `value` m from the origin, in several precisions and frames",
     far_from_origin},
    {"scale", "share of the kernels' answers that do not scale bit for bit by 2^`value`", scale_invariance},
    {"degenerate", "meshes with defects and bodies that touch exactly: 0 runs, 1 is refused, 2 fails", degenerate},
    {"stack", "ten cubes on each other: heights, sideways drift, kinetic energy that stays", stack},
};

} // namespace

bool Metric::within() const { return std::isfinite(value) && (!bar || std::abs(value) <= *bar); }

std::span<const Study> studies() { return table; }

} // namespace trigrain
