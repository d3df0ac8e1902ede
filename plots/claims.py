"""The published figures and headline numbers, one row each, and how records decide whether they hold here."""
import packages  # noqa: F401, I001: before all that need them
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from figure_counters import NAME as COUNTED, load_counters
from frames import read_frame, read_frames, standing
from grids import history
from kernel_points import found, median
from records import BIGGER_MACHINE, DRAWN, NothingToDraw, Point, Sweep, busy, load_sweep
from scaling import published_curves

PASS, FAIL, UNTESTABLE = "PASS", "FAIL", "NOT-TESTABLE-HERE"
MEASURED, HARDWARE, NOT_RUN, DISTURBED = "measured", "needs hardware", "not run", "disturbed"
OPENING_M = 0.5 - 0.1333 / 2  # height of the hopper's opening
PENALTY = {"kernel": "iterative", "family": "random_mixed", "schedule": "constant", "steps": 4}
CONTACT_S, FAR_S = 2.68, 2.0  # when the two bodies of C18 figure 3 meet; until when they are far from each other


@dataclass(frozen=True)
class Verdict:
    """PASS, FAIL or NOT-TESTABLE-HERE, where the word comes from, and what was seen or is needed."""
    word: str
    status: str
    seen: str


def measured(holds: bool, seen: str) -> Verdict:
    return Verdict(PASS if holds else FAIL, MEASURED, seen)


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
        return measured(all(holds), text)
    return test


def ratio(slow: dict[str, Any], fast: dict[str, Any], least: float, what: Callable[[Point], float], each: str | None = None):
    """what(slow) / what(fast) is at least `least`, for every value of the parameter `each` if one is named."""
    def test(sweep: Sweep) -> Verdict:
        seen = {}
        for same in [{each: value} for value in sorted({point.params[each] for point in sweep.points})] if each else [{}]:
            one, other = _point(sweep, {**slow, **same}), _point(sweep, {**fast, **same})
            if one and other:
                seen["".join(f" at {each.replace('_', ' ')} {value:g}" for value in same.values())] = what(one) / what(other)
        if not seen:
            return _absent(sweep, fast if _point(sweep, slow) else slow)
        text = ", ".join(f"{number:.3g}{where}" for where, number in seen.items())
        return measured(min(seen.values()) >= least, text)
    return test


def of_grids(limits: dict[str, float], look_at: Callable[[Point, float], tuple[bool, str]]):
    """look_at(point, limit) of each grid says whether the claim holds, and what was seen."""
    def test(sweep: Sweep) -> Verdict:
        points = {grid: _point(sweep, {"grid": grid}) for grid in limits}
        missing = next((grid for grid, point in points.items() if point is None), None)
        if missing:
            return _absent(sweep, {"grid": missing})
        seen = {grid: look_at(point, limits[grid]) for grid, point in points.items()}
        text = "; ".join(f"{grid} {words}" for grid, (_, words) in seen.items())
        return measured(all(holds for holds, _ in seen.values()), text)
    return test


def compared_at_contact(point: Point, most: float) -> tuple[bool, str]:
    """Two bodies are compared only near each other (t > 2 s), and then at most so often in a step."""
    seen = history(point)
    pairs, far = seen["candidate_pairs"] / seen["steps"], seen["time_s"] < FAR_S
    return (pairs[far].max() == 0 and 1 <= pairs.max() <= most,
            f"{pairs[far].max():g} far apart, at most {pairs.max():g}")


def step_at_contact(point: Point, least: float) -> tuple[bool, str]:
    """The step is shortest at the contact of two bodies, by so large a factor below the longest before."""
    seen = history(point)
    step, time = seen["step_s"], seen["time_s"]
    shortest = int(np.argmin(np.where(time > FAR_S, step, np.inf)))
    factor = step[:shortest].max() / step[shortest]
    return (abs(time[shortest] - CONTACT_S) <= 0.05 and factor >= least,
            f"1/{factor:.0f} of {step[:shortest].max():.3f} s at {time[shortest]:.2f} s")


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
    seen = f"mean height {', '.join(f'{height:.3f}' for height in heights)} m; {100 * below:.0f} % below the opening"
    return measured(falls and below > 0, seen)


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
    return measured(rates[0] >= 2.9 * rates[1], text)


def penalty(sweep: Sweep) -> Verdict:
    """Time of a pair by brute force over that of the penalty method, one lane and the published schedule each."""
    settings = {"lanes": 1, "schedule": "constant", "steps": 4, "tolerance": 1e-3}
    brute, ours = (_point(sweep, {"kernel": kernel, **settings}) for kernel in ("brute", "iterative"))
    if not (brute and ours):
        return _absent(sweep, {"kernel": "iterative" if brute else "brute", **settings})
    gain, unflagged = median(brute) / median(ours), found(ours, "wrong_unflagged_share")
    text = f"{gain:.3g}; 99 % of its errors are below {found(ours, 'error_p99_S'):.1g} S, {100 * unflagged:.3g} % wrong without a flag"
    return measured(gain >= 1.45 and unflagged == 0, text)


def newton_steps(sweep: Sweep) -> Verdict:
    """Most answers of the penalty method are proven for the first time after 3 to 6 Newton steps."""
    settings = {**PENALTY, "lanes": 1}
    point = _point(sweep, settings)
    if point is None:
        return _absent(sweep, settings)
    share = point.record["kernel"]["proven_after_steps"]
    within, later = sum(share[3:7]), 1 - sum(share[:7])
    return measured(within > 0.5, f"{within:.0%}; {later:.0%} later or never")


def rate(kernel: str, least: float):
    """A kernel of one lane on one core answers at least so many million pairs per second."""
    def test(sweep: Sweep) -> Verdict:
        settings = {"kernel": kernel, "lanes": 1, "family": "random_mixed"}
        point = _point(sweep, settings)
        if point is None:
            return _absent(sweep, settings)
        seen = 1e3 / median(point)
        return measured(seen >= least, f"{seen:.2f}")
    return test


def cpu_of_run(point: Point) -> float:
    """Median CPU time (s) of a whole run: steps are of different length."""
    return statistics.median(sample["cpu_s"] for sample in point.record["samples"])


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
    Claim("two-bodies-pairs", "Two bodies on a collision course are compared only near each other", "C18 figure 3, left",
          "figure_g_1", "none far apart; then at most 8 (regular), 9 (adaptive) in a step", "none",
          of_grids({"regular": 8, "adaptive": 9}, compared_at_contact)),
    Claim("two-bodies-step", "The step of two bodies falls at their contact", "C18 figure 3, middle", "figure_g_1",
          "at 2.68 s to at most 1/100 of the longest before", "0.05 s", of_grids({"adaptive": 100, "reluctant": 100}, step_at_contact)),
    *(Claim(f"two-bodies-{grid}", f"Two bodies: time on a regular grid over that on the {grid} one", "C18 figure 3, right", "figure_g_1",
            f"at least {least}", "none", ratio({"grid": "regular-dense"}, {"grid": grid}, least, cpu_of_run))
      for grid, least in (("adaptive", 30), ("reluctant", 47))),
    Claim("newton-steps", "Penalty method: most answers are found after 3 to 6 Newton steps", "P17 figure 2", "figure_kernels",
          "more than half of the pairs; published: all", "none", newton_steps),
    *(Claim(f"rate-{name}", f"Million triangle pairs per second and core: {name}", "P17", "figure_kernels", f"at least {least}",
            "none", rate(kernel, least))
      for name, kernel, least in (("brute", "brute", 1.68), ("hybrid", "hybrid-batch", 1.93), ("penalty", "iterative", 2.75))),
    Claim("penalty-simd", "The iterative kernel gains from vector lanes", "P17 table 1: 15.5 s / 4.5 s", "figure_kernels",
          "at least 3.4", "none", ratio({**PENALTY, "lanes": 1}, {**PENALTY, "lanes": 0}, 3.4, median)),
    Claim("triangle-layer", "The triangle layer alone gains up to 13x on 24 cores", "P17 figure 3", None, "up to 13", "-",
          needs("24 cores")),
    Claim("two-bodies-layer", "The triangle layer of two bodies of 120 vertices gains 6.6x on 24 cores", "C18 figure 4", None,
          "at least 4.4 (with lanes) to 6.6", "-", needs("24 cores")),
    Claim("grid-and-triangles", "Threads are best given to triangles: 1 x 24 is faster than 24 x 1 grid threads", "P17 figure 4", None,
          "1 x 24 is 4.8 times as fast", "-", needs("24 cores")),
    Claim("counters", "Vector lanes multiply the MFLOP/s of brute force", "P17 table 1: 2808 / 962 MFLOP/s", COUNTED,
          "at least 2.9", "none", counted_mflops),
]
