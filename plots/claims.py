"""The published figures and headline numbers, one row each, and how records decide whether they hold here."""
import packages  # noqa: F401, I001: before all that need them
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from figure_counters import NAME as COUNTED, load_counters
from frames import read_frame, read_frames, standing
from kernel_points import found, median
from records import BIGGER_MACHINE, DRAWN, NothingToDraw, Point, Sweep, busy, load_sweep
from scaling import published_curves

PASS, FAIL, UNTESTABLE = "PASS", "FAIL", "NOT-TESTABLE-HERE"
MEASURED, HARDWARE, NOT_RUN, DISTURBED = "measured", "needs hardware", "not run", "disturbed"
OPENING_M = 0.5 - 0.1333 / 2  # height of the hopper's opening


@dataclass(frozen=True)
class Verdict:
    """PASS, FAIL or NOT-TESTABLE-HERE, where the word comes from, and what was seen or is needed."""
    word: str
    status: str
    seen: str


@dataclass(frozen=True)
class Claim:
    """`source` says where it was published. `spec` is what is swept to test it; None: another kind of machine is
    needed, `test` then only says which."""
    id: str
    claim: str
    source: str
    spec: str | None
    expected: str
    tolerance: str
    test: Callable[[Sweep | None], Verdict]

    @property
    def command(self) -> str:
        return f"build/release/bin/sweep run {self.spec}" if self.spec else "-"


def judge(claim: Claim, results: Path) -> Verdict:
    """What the records under `results` say."""
    if claim.spec is None:
        return claim.test(None)
    try:
        sweep = load_sweep(results, claim.spec)
        if sweep.preset == "smoke":
            return Verdict(UNTESTABLE, NOT_RUN, "the preset 'smoke' is too small to say anything")
        return claim.test(sweep)
    except NothingToDraw as reason:
        return Verdict(UNTESTABLE, NOT_RUN, str(reason))


def minutes(claim: Claim, results: Path) -> float | None:
    """How long the processes of its points took, all together."""
    try:
        points = load_sweep(results, claim.spec).points if claim.spec else []
    except NothingToDraw:
        return None
    took = [point.record["sweep"]["took_s"] for point in points if point.record and "sweep" in point.record]
    return sum(took) / 60 if took else None


def needs(what: str) -> Callable[[Sweep | None], Verdict]:
    return lambda _sweep: Verdict(UNTESTABLE, HARDWARE, f"needs {what}")


def speedup(where: dict[str, Any], panel: str, anchor: str, threads: int, tolerance: float, one: str):
    """Time of one thread over time of `threads`, at least that of the published panel less `tolerance`. `anchor` and
    `one`: panel and sweep whose one-thread run is the reference; tasks are compared with plain loops. Wall time on a
    machine that does other work says nothing."""
    def test(sweep: Sweep) -> Verdict:
        curves = published_curves()
        base = load_sweep(sweep.folder.parent, one)
        seen, holds, used = [], [], []
        for vertices in sorted(curves[panel]):
            published = curves[anchor][vertices][1] / curves[panel][vertices][threads]
            first = _point(base, {**where, "vertices": vertices, "threads": 1})
            many = _point(sweep, {**where, "vertices": vertices, "threads": threads})
            if not (first and many):
                continue
            used += [first, many]
            here = first.median() / many.median()
            holds.append(here >= published * (1 - tolerance))
            seen.append(f"{here:.2f} ({published:.2f}) at {vertices}")
        if not holds:
            return _absent(sweep, {**where, "threads": threads})
        text = f"{', '.join(seen)} vertices (published in brackets)"
        if caution := busy(used):
            return Verdict(UNTESTABLE, DISTURBED, f"{caution}: {text}")
        return Verdict(PASS if all(holds) else FAIL, MEASURED, text)
    return test


def ratio(slow: dict[str, Any], fast: dict[str, Any], least: float, what: Callable[[Point], float], each: str):
    """what(slow) / what(fast) is at least `least`, for every value of the parameter `each`."""
    def test(sweep: Sweep) -> Verdict:
        seen = {}
        for value in sorted({point.params[each] for point in sweep.points}):
            one, other = _point(sweep, {**slow, each: value}), _point(sweep, {**fast, each: value})
            if one and other:
                seen[value] = what(one) / what(other)
        if not seen:
            return _absent(sweep, slow) if not _any(sweep, slow) else _absent(sweep, fast)
        text = ", ".join(f"{number:.3g} at {each.replace('_', ' ')} {value:g}" for value, number in seen.items())
        return Verdict(PASS if min(seen.values()) >= least else FAIL, MEASURED, text)
    return test


def flow(sweep: Sweep) -> Verdict:
    """The grains' mean height falls from frame to frame, and some end below the hopper's opening."""
    point = _point(sweep, {})
    if point is None:
        return _absent(sweep, {})
    frames = [read_frame(*each) for each in read_frames(sweep.folder / "frames" / point.id)]
    walls = standing(frames[0], frames[-1])
    heights = [float(frame.corners[~walls][..., 1].mean()) for frame in frames]
    last = frames[-1].corners[~walls][..., 1]
    below = float((last.max(axis=1) < OPENING_M).mean())
    falls = all(later < earlier for earlier, later in zip(heights, heights[1:]))
    return Verdict(PASS if falls and below > 0 else FAIL, MEASURED,
                   f"mean height {', '.join(f'{height:.3f}' for height in heights)} m; {100 * below:.0f} % below the opening")


def counted_mflops(sweep: Sweep) -> Verdict:
    """MFLOP/s of brute-simd over those of brute, as counted; `sweep counters` comes after the sweep."""
    rates = []
    for kernel in ("brute-simd", "brute"):
        point = _point(sweep, {"kernel": kernel})
        if point is None:
            return _absent(sweep, {"kernel": kernel})
        counters = load_counters(sweep.folder / "counters" / f"{point.id}.json", point)
        flops = counters["whole"].get("flops_dp")
        if flops is None:
            return Verdict(UNTESTABLE, NOT_RUN, f"not counted: build/release/bin/sweep counters {COUNTED}")
        if flops["value"] is None:
            return Verdict(UNTESTABLE, HARDWARE, f"needs hardware counters ({flops['reason']})")
        rates.append(1e-6 * flops["value"] / counters["steps"] / cpu(point))
    text = f"{rates[0]:.0f} and {rates[1]:.0f} MFLOP/s"
    return Verdict(PASS if rates[0] >= 2.9 * rates[1] else FAIL, MEASURED, text)


def penalty(sweep: Sweep) -> Verdict:
    """Time of a pair by brute force over that of the penalty method, one lane and the published schedule each."""
    settings = {"lanes": 1, "schedule": "constant", "steps": 4, "tolerance": 1e-3}
    brute, ours = (_point(sweep, {"kernel": kernel, **settings}) for kernel in ("brute", "iterative"))
    if not (brute and ours):
        return _absent(sweep, {"kernel": "iterative" if brute else "brute", **settings})
    gain, unflagged = median(brute) / median(ours), found(ours, "wrong_unflagged_share")
    text = f"{gain:.3g}; 99 % of its errors are below {found(ours, 'error_p99_S'):.1g} S, {100 * unflagged:.3g} % wrong without a flag"
    return Verdict(PASS if gain >= 1.45 and unflagged == 0 else FAIL, MEASURED, text)


def cpu(point: Point) -> float:
    """Median CPU time (s) of a step."""
    return statistics.median(sample["cpu_s"] / sample["steps"] for sample in point.record["samples"])


def candidates(point: Point) -> float:
    """Pairs of bodies that the grid hands on, per step."""
    return point.record["counts"]["candidate_pairs"] / point.record["counts"]["steps"]


def _any(sweep: Sweep, where: dict[str, Any]) -> list[Point]:
    return [point for point in sweep.points if where.items() <= point.params.items()]


def _point(sweep: Sweep, where: dict[str, Any]) -> Point | None:
    return next((point for point in _any(sweep, where) if point.state == DRAWN), None)


def _absent(sweep: Sweep, where: dict[str, Any]) -> Verdict:
    """Why there is nothing to compare."""
    states = {f"{point.state}{f' ({point.why})' if point.why else ''}": point.state for point in _any(sweep, where)}
    text = "; ".join(list(states)[:2]) or "no such point in this preset"
    bigger = set(states.values()) == {BIGGER_MACHINE}
    wrong = "check failed" in states.values()
    return Verdict(UNTESTABLE, HARDWARE if bigger else MEASURED if wrong else NOT_RUN, text)


def _scaling(figure: str, panel: str, grid: str, particles: str, scheme: str, anchor: str, one: str) -> list[Claim]:
    rows = []
    for threads in (2, 24):
        name = f"figure_{figure.replace('.', '_')}"
        curves = published_curves()
        low, high = (bound(curves[anchor][n][1] / curves[panel][n][threads] for n in curves[panel]) for bound in (min, max))
        rows.append(Claim(f"{figure}-{grid}-{threads}", f"Figure {figure}, {grid} grid, {particles} particles, {scheme}: "
                          f"speed-up on {threads} threads", panel.replace(".F", " figure "), name, f"at least {low:.2f} to {high:.2f}, by "
                          "vertices", "10 %", speedup({"grid": grid}, panel, anchor, threads, 0.1, one)))
    return rows


CLAIMS: list[Claim] = [
    Claim("8.4", "Figure 8.4: grains flow through the hopper onto the floor", "thesis 8.4", "figure_8_4",
          "mean height falls; some grains below the opening", "none", flow),
    *_scaling("8.5", "C18.F5a", "regular", "1000", "plain", "C18.F5a", "figure_8_5"),
    *_scaling("8.5", "C18.F5b", "adaptive", "1000", "plain", "C18.F5b", "figure_8_5"),
    *_scaling("8.6", "C18.F5c", "adaptive", "10 000", "plain", "C18.F5c", "figure_8_6"),
    *_scaling("8.8", "C18.F7a", "regular", "1000", "tasks over one plain thread", "C18.F5a", "figure_8_5"),
    *_scaling("8.8", "C18.F7b", "adaptive", "1000", "tasks over one plain thread", "C18.F5b", "figure_8_5"),
    *_scaling("8.9", "C18.F7c", "adaptive", "10 000", "tasks over one plain thread", "C18.F5c", "figure_8_6"),
    Claim("8.9-knl", "Figure 8.9, right: 10 000 particles on Knights Landing, up to 64 threads", "thesis 8.9", None,
          "no value is published", "-", needs("an Intel Xeon Phi (Knights Landing)")),
    Claim("hybrid-1", "Hybrid over brute force inside the hopper, one thread", "P17 figure 3", "published_kernels",
          "at least 2.0", "none", ratio({"kernel": "brute"}, {"kernel": "hybrid-pair"}, 2.0, cpu, "vertices")),
    Claim("hybrid-24", "Hybrid over brute force inside the hopper, 24 threads", "P17 figure 3", None, "at least 1.85", "-",
          needs("24 cores")),
    Claim("simd", "Brute force gains from vector lanes", "P17 table 1: 22.5 s / 7.8 s", "published_kernels", "at least 2.9",
          "none", ratio({"kernel": "brute"}, {"kernel": "brute-simd"}, 2.9, cpu, "vertices")),
    Claim("penalty", "The iterative kernel, whose answers are bounds, is faster than brute force", "P17 table 1: 22.5 s / 15.5 s",
          "figure_kernels", "at least 1.45, no wrong answer without a flag", "none", penalty),
    Claim("checks", "A grid removes 92 % of the comparisons of 1000 particles", "C18 section 5", "published_grids",
          "all pairs / regular grid at least 12.5", "none",
          ratio({"grid": "none", "particles": 1000}, {"grid": "regular", "particles": 1000}, 12.5, candidates, "size_ratio")),
    Claim("triangle-layer", "The triangle layer alone gains up to 13x on 24 cores", "P17 figure 3", None, "up to 13", "-",
          needs("24 cores")),
    Claim("counters", "Vector lanes multiply the MFLOP/s of brute force", "P17 table 1: 2808 / 962 MFLOP/s", COUNTED,
          "at least 2.9", "none", counted_mflops),
]
