#!/usr/bin/python3
"""Time and hardware counters per phase of a step, and runtime, MFLOP/s, CPI and bandwidth as table 1 of Krestenitis,
Weinzierl and Koziara (2017) has them; what no counter could say is "unavailable"."""
import packages  # noqa: F401, I001: before all that need them
import json
import statistics
import sys
from pathlib import Path

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figure import COLOURS, GREY, STYLE, Drawn, command_line, foot, head, save
from published import table_1
from records import DRAWN, EXPECTED, Point, Sweep, load_sweep

NAME = "figure_counters"
SCHEMA = "trigrain-counters-1"
PHASES = ("grid", "detect", "merge", "forces", "integrate")
METRICS = ("instructions", "cycles", "flops_dp", "flops_sp", "dram_bytes", "l2_bytes", "l3_bytes", "branch_misses", "energy_J")
COUNTED = ("candidate_pairs", "triangle_pairs", "newton_steps", "fall_backs", "contacts")
NO_COUNTERS = {"whole": {}, "phases": {}, "steps": 1}
HEADER = ["kernel", "phase", "quantity", "per step", "unit", "source", "reason"]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_counters and its counters, writes OUT/figure_counters.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    points = [point for point in sweep.points if point.state in (DRAWN, EXPECTED)]
    counters = {point.id: load_counters(sweep.folder / "counters" / f"{point.id}.json", point) for point in points}
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(10, 6.8))
        grid = figure.add_gridspec(2, 2, height_ratios=(3, 2), left=0.07, right=0.9, top=0.9, bottom=0.13, hspace=0.2,
                                   wspace=0.45)
        head(figure, sweep)
        stacked(figure.add_subplot(grid[0, 0]), points, "wall time per step (us above the bars)", times)
        stacked(figure.add_subplot(grid[0, 1]), points, "instructions per step (above the bars)",
                lambda point: instructions(counters[point.id]))
        table(figure.add_subplot(grid[1, :]), points, counters)
        foot(figure, sweep)
        return save(figure, Drawn(NAME, sweep, out, notes(sweep, counters)), HEADER, rows(points, counters))


def load_counters(path: Path, point: Point) -> dict:
    """What `sweep counters` left of this point; nothing counted if it has not run."""
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
        return value if value["schema"] == SCHEMA and value["point_id"] == point.id else NO_COUNTERS
    except (OSError, ValueError, KeyError, TypeError):
        return NO_COUNTERS


def times(point: Point) -> dict[str, float]:
    """us per step and phase, of the sample with the median time; nothing of a baseline whose answers are wrong."""
    if point.state != DRAWN:
        return {}
    samples = sorted(point.record["samples"], key=lambda sample: sample["wall_s"] / sample["steps"])
    sample = samples[(len(samples) - 1) // 2]
    return {phase: 1e6 * sample["phases_s"][phase] / sample["steps"] for phase in PHASES}


def instructions(counters: dict) -> dict[str, float]:
    """Per step and phase, or of all phases where only the whole was counted; empty if nobody counted."""
    phases = {phase: metrics["instructions"]["value"] for phase, metrics in counters["phases"].items()
              if metrics["instructions"]["value"]}
    whole = counters["whole"].get("instructions", {}).get("value")
    found = phases or ({"all phases": whole} if whole else {})
    return {phase: value / counters["steps"] for phase, value in found.items()}


def stacked(axis: Axes, points: list[Point], title: str, parts_of) -> None:
    """A bar per kernel, a colour per phase: shares, with the sum above."""
    colours = {**dict(zip(PHASES, COLOURS)), "all phases": "#bbbbbb"}
    seen: dict[str, None] = {}
    for place, point in enumerate(points):
        parts = parts_of(point)
        whole, bottom = sum(parts.values()), 0.0
        for phase, value in parts.items():
            share = 100 * value / whole
            axis.bar(place, share, 0.6, bottom, color=colours[phase], label=None if phase in seen else phase)
            seen[phase] = None
            bottom += share
        text = number(whole) if parts else "unavailable" if point.state == DRAWN else "answers wrong:\nnot timed"
        axis.text(place, bottom, text, ha="center", va="bottom", fontsize=8.5, color="black" if parts else GREY)
    axis.set_xticks(range(len(points)), [point.params["kernel"] for point in points])
    axis.set(ylabel="share (%)", title=title, xlim=(-0.5, len(points) - 0.5), ylim=(0, 112))
    if seen:
        axis.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def table(axis: Axes, points: list[Point], counters: dict[str, dict]) -> None:
    """Runtime, MFLOP/s, CPI and bandwidth of a kernel."""
    axis.set_axis_off()
    heads = ["kernel", "runtime", "MFLOP/s", "CPI", "bandwidth (MB/s)", "source"]
    cells = [[point.params["kernel"], *(text for _, text in table_row(point, counters[point.id])), source(counters[point.id])]
             for point in points]
    if not cells:
        axis.text(0.5, 0.5, "no point to show", ha="center", color=GREY)
        return
    drawn = axis.table(cells + published(), colLabels=heads, loc="center", cellLoc="center")
    drawn.auto_set_font_size(False)
    drawn.set_fontsize(8.5)
    drawn.scale(1, 1.3)


def published() -> list[list[str]]:
    """Rows of the printed table: one core of a Sandy Bridge at 2 GHz, seconds for all its pairs."""
    return [[f"P17: {label}", f"{values['runtime_s']:g} s", f"{values['mflops_per_s']:,g}", f"{values['cpi']:g}",
             f"{values['bandwidth_mb_per_s']:,g}", "likwid"] for label, values in table_1().items()]


def table_row(point: Point, counters: dict) -> list[tuple[str, str]]:
    """Names and texts of a row of table 1."""
    if point.state != DRAWN:
        return [("runtime", "answers wrong"), ("MFLOP/s", "-"), ("CPI", "-"), ("bandwidth", "-")]
    seconds = statistics.median(sample["wall_s"] / sample["steps"] for sample in point.record["samples"])

    def per_step(name: str) -> float | None:
        value = counters["whole"].get(name, {}).get("value")
        return None if value is None else value / counters["steps"]

    flops, cycles, count, bytes_ = (per_step(name) for name in ("flops_dp", "cycles", "instructions", "dram_bytes"))
    ratios = {"MFLOP/s": flops and 1e-6 * flops / seconds, "CPI": cycles and count and cycles / count,
              "bandwidth": bytes_ and 1e-6 * bytes_ / seconds}
    texts = [(name, "unavailable" if value is None else number(value)) for name, value in ratios.items()]
    return [("runtime", f"{1e3 * seconds:.3g} ms per step"), *texts]


def number(value: float) -> str:
    """Three digits, without a power of ten."""
    return f"{value:.3g}" if value < 1000 else f"{value:,.0f}"


def source(counters: dict) -> str:
    """Who counted."""
    found = dict.fromkeys(each["source"] for each in counters["whole"].values() if each["source"])
    return ", ".join(found) or "none"


def rows(points: list[Point], counters: dict[str, dict]) -> list[list]:
    """Every number of the figure and every reason for one that is not there."""
    table_rows: list[list] = []
    for point in points:
        kernel, found = point.params["kernel"], counters[point.id]
        if point.state != DRAWN:
            table_rows.append([kernel, "all", "wall time", "", "us", "", f"{point.state}: {point.why}"])
            continue
        table_rows += [[kernel, phase, "wall time", f"{value:.6g}", "us", "clock", ""] for phase, value in times(point).items()]
        for phase, metrics in {**found["phases"], "all": found["whole"]}.items():
            for name in METRICS:
                each = metrics.get(name)
                value = "" if each is None or each["value"] is None else f"{each['value'] / found['steps']:.8g}"
                reason = "not counted yet: sweep counters figure_counters" if each is None else each["reason"] or ""
                table_rows.append([kernel, phase, name, value, "1", each["source"] if each and each["source"] else "", reason])
        counts = point.record["counts"]
        table_rows += [[kernel, "all", name, f"{counts[name] / counts['steps']:.8g}", "1", "algorithm", ""] for name in COUNTED]
    return table_rows


def notes(sweep: Sweep, counters: dict[str, dict]) -> list[str]:
    """Why values are missing, once each."""
    reasons = dict.fromkeys(reason for found in counters.values() for each in found["whole"].values()
                            for reason in (each["reason"] or "").split("; ") if reason)
    absent = [f"{point.params['kernel']}: {point.state} ({point.why})." for point in sweep.points if point.state != DRAWN]
    uncounted = any(counters[point.id] is NO_COUNTERS for point in sweep.drawn())
    return [*absent, *(["Not every point has been counted: run sweep counters figure_counters."] if uncounted else []),
            *([f"Unavailable here: {'; '.join(reasons)}."] if reasons else [])]


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
