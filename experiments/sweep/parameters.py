"""What a point may set: each parameter's option of the point program, its type and its names. After a change here,
`sweep schema > experiments/schema/spec.json` brings the schema up to date."""
import math
from dataclasses import dataclass
from typing import Any

from sweep.errors import InputError, nearest


@dataclass(frozen=True)
class Parameter:
    """One key of a spec's fixed and axes. A build need not have every one of `names`: PROGRAM --list says."""
    option: str
    kind: type
    names: tuple[str, ...] = ()
    least: float = -math.inf


@dataclass(frozen=True)
class Program:
    """A program that runs one point: it takes --point-id ID, --record FILE and the options of its parameters, leaves a
    record (experiments/schema/record.json), and names its variants with --list. Of each pair in `exactly_one` a point
    sets one."""
    name: str
    parameters: dict[str, Parameter]
    exactly_one: tuple[tuple[str, str], ...] = ()

    def check_key(self, key: str, where: str) -> None:
        """InputError for a key that is no parameter."""
        if key not in self.parameters:
            raise InputError(f"unknown parameter '{key}' ({where}). {nearest(key, self.parameters)}")

    def typed(self, key: str, value: Any, where: str) -> Any:
        """The value as the parameter's own type, so that 1 and 1.0 make the same point; InputError if it is none."""
        self.check_key(key, where)
        wanted = self.parameters[key]
        if wanted.kind is str:
            if not isinstance(value, str) or not value:
                raise InputError(f"a name is expected, not {value!r} ({where}). {_examples(wanted)}")
            if wanted.names and value not in wanted.names:
                raise InputError(f"unknown {key} '{value}' ({where}). {nearest(value, wanted.names)}")
            return value
        whole = wanted.kind is int
        if isinstance(value, bool) or not isinstance(value, (int, float)) or _not_finite(value) or (whole and value % 1):
            kind = "whole number" if whole else "number"
            raise InputError(f"a {kind} is expected, not {value!r} ({where}). Give one number.")
        if value < wanted.least:
            raise InputError(f"{value} is too small ({where}). The least is {wanted.least:g}.")
        return wanted.kind(value)

    def arguments(self, params: dict[str, Any]) -> list[str]:
        """Options and values of the program for typed parameters."""
        return [word for key, value in params.items() for word in (self.parameters[key].option, str(value))]


DEM_BENCH = Program("dem_bench", {
    "scene": Parameter("--scene", str, ("hopper", "hopper-dense", "two-particles", "gas")),
    "scene_file": Parameter("--scene-file", str),
    "particles": Parameter("--particles", int, least=1),
    "vertices": Parameter("--vertices", int, least=0),
    "seed": Parameter("--seed", int, least=0),
    "halo": Parameter("--halo", str, ("relative", "published")),
    "size_ratio": Parameter("--size-ratio", float, least=1),
    "fill": Parameter("--fill", float, least=1e-3),
    "gravity": Parameter("--gravity", float, least=0),
    "kernel": Parameter("--kernel", str, ("brute", "brute-simd", "iterative", "hybrid-pair", "hybrid-batch", "sphere")),
    "precheck": Parameter("--precheck", str, ("none", "sphere", "box", "octree")),
    "grid": Parameter("--grid", str, ("none", "regular", "linked-cells", "regular-dense", "adaptive", "reluctant")),
    "contact_rule": Parameter("--contact-rule", str, ("all-pairs", "dedupe", "nearest", "features")),
    "scheme": Parameter("--scheme", str, ("serial", "plain", "task")),
    "runtime": Parameter("--runtime", str, ("default", "tbb", "openmp")),
    "layers": Parameter("--layers", str, ("none", "grid", "particle", "triangle", "grid+particle", "grid+triangle",
                                          "particle+triangle", "grid+particle+triangle")),
    "threads": Parameter("--threads", int, least=1),
    "subdivision": Parameter("--subdivision", int, least=2),
    "skin": Parameter("--skin", float, least=0),
    "triangle_search": Parameter("--triangle-search", str, ("when-needed", "every-step")),
    "step_control": Parameter("--step-control", str, ("fixed", "approach", "gap-only")),
    "steps": Parameter("--steps", int, least=1),
    "end_s": Parameter("--end", float, least=1e-9),
    "repeats": Parameter("--repeats", int, least=1),
    "warmup": Parameter("--warmup", int, least=0),
    "check_steps": Parameter("--check-steps", int, least=1),
    "history": Parameter("--history", int, least=1),
    "vtk_every_s": Parameter("--vtk-every", float, least=1e-9),
}, exactly_one=(("scene", "scene_file"), ("steps", "end_s")))

TRIANGLE_FAMILIES = (
    "random_mixed", "random_sep", "random_far", "near_vf", "near_ee", "near_vv", "near_ve", "touch_vf", "touch_ee",
    "touch_ve", "touch_vv", "touch_rounded", "shared_corner", "shared_edge", "identical", "cross_deep", "cross_shallow",
    "parallel_exact", "parallel_near", "parallel_edges", "coplanar_sep", "coplanar_mixed", "contained", "sliver_near",
    "sliver_cross", "sliver_mixed", "degenerate_seg", "degenerate_pt", "offset_1e4", "scale_1em6", "scale_1em3",
    "scale_1e3", "scale_1e6", "size_ratio", "mesh_near", "lattice", "every")
MESH_FAMILIES = (
    "granulates_10", "granulates_10_apart", "granulates_20", "granulates_20_apart", "granulates_40",
    "granulates_40_apart", "spheres_80", "spheres_320", "spheres_1280", "spheres_5120", "spheres_20480", "spheres_81920")
PEERS = ("fcl", "cgal", "bullet", "ode")

KERNEL_BENCH = Program("kernel_bench", {
    "kernel": Parameter("--kernel", str, ("brute", "brute-simd", "iterative", "hybrid-pair", "hybrid-batch", *PEERS)),
    "precision": Parameter("--precision", str, ("double", "float", "mixed")),
    "lanes": Parameter("--lanes", int, least=0),
    "family": Parameter("--family", str, TRIANGLE_FAMILIES + MESH_FAMILIES),
    "precheck": Parameter("--precheck", str, ("none", "sphere", "box", "octree")),
    "cuts": Parameter("--cuts", str, ("adaptive", "regular")),
    "steps": Parameter("--steps", int, least=0),
    "tolerance": Parameter("--tolerance", float, least=0),
    "batch": Parameter("--batch", int, least=1),
    "schedule": Parameter("--schedule", str, ("constant", "stiff", "growing")),
    "reach_m": Parameter("--reach", float, least=0),
    "pairs": Parameter("--pairs", int, least=1),
    "seed": Parameter("--seed", int, least=0),
    "repeats": Parameter("--repeats", int, least=1),
})

STABILITY = Program("stability", {
    "study": Parameter("--study", str, (
        "tessellation", "loop-work", "face-rest", "impact", "free-top", "rigid-impact", "ellipsoid-impact", "slope", "slope-rest",
        "topple",
        "rolling-ball", "rolling-polygon", "mesh-sphere", "bounce", "similarity", "discharge", "emptying", "critical-step", "rebound",
        "rebound-explicit", "long-run", "tunnelling",
        "detection", "overlap-release", "cut-floor", "mass-ratio", "long-rest", "flat-drop", "grazing", "determinism", "stack", "rule-cost",
        "far-from-origin", "scale", "degenerate")),
    "contact_rule": Parameter("--contact-rule", str, ("all-pairs", "dedupe", "nearest", "features")),
    "law": Parameter("--law", str, ("spring-dashpot", "hertz-mindlin")),
    "control": Parameter("--control", str, ("fixed", "approach", "gap-only")),
    "value": Parameter("--value", float),
    "level": Parameter("--level", int, least=-1),
    "steps_per_contact": Parameter("--steps-per-contact", float, least=1),
    "stiffness": Parameter("--stiffness", float, least=1e-9),
    "particles": Parameter("--particles", int, least=1),
    "vertices": Parameter("--vertices", int, least=0),
    "seed": Parameter("--seed", int, least=0),
})

PEER_BENCH = Program("peer_bench", {"engine": Parameter("--engine", str, ("trigrain", "liggghts", "yade")), **DEM_BENCH.parameters},
                     DEM_BENCH.exactly_one)

PROGRAMS = {program.name: program for program in (DEM_BENCH, KERNEL_BENCH, STABILITY, PEER_BENCH)}


def _not_finite(value: Any) -> bool:
    return isinstance(value, float) and not math.isfinite(value)


def _examples(wanted: Parameter) -> str:
    return f"Known: {', '.join(wanted.names)}." if wanted.names else "Write it in quotes."
