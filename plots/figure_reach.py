#!/usr/bin/python3
"""Kernels whose answers are proven: time per triangle pair against the reach beyond which no answer is wanted."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
from figure import STYLE, Drawn, command_line, foot, head, save
from kernel_points import PRECISION_MARKERS, colour, family_panels, label_outside, median, nanoseconds, ran
from records import DRAWN, Point, load_sweep

COLUMNS = 3  # of panels, at most
NO_REACH = 1e6  # m: as good as none
HEADER = ["family", "reach_m", "kernel", "precision", "lanes", "steps", "batch", "state", "median_ns", "min_ns", "max_ns",
          "fastest", "record"]
NOTES = [
    "A kernel with a reach may leave pairs out as soon as it has proven that they are further apart; all of them report the "
    "same contacts. The triangles are about 1 m large.",
    "With lanes, the branch-free brute force makes the iteration pointless for pairs that are near; hybrids win where the "
    "direction between the middles proves most pairs to be beyond reach before any step is taken.",
]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_reach, writes OUT/figure_reach.svg, .png and .csv."""
    sweep = load_sweep(results, "figure_reach")
    drawn = sweep.drawn()
    with matplotlib.rc_context(STYLE):
        figure, panels = family_panels(sweep, COLUMNS, 3.6, (3.6, 1.2))
        for family, axes in panels.items():
            _panel(axes, family, [point for point in drawn if point.params["family"] == family])
        handles = {line.get_label(): line for axes in figure.axes for line in axes.lines}
        figure.legend(handles.values(), handles.keys(), loc="upper right", fontsize=8)
        label_outside(figure, COLUMNS, "reach (m)", "CPU time per pair (ns), one thread")
        figure.get_layout_engine().set(rect=(0, 0.06, 1 - 2.4 / figure.get_figwidth(), 0.94))
        head(figure, sweep)
        foot(figure, sweep)
        return save(figure, Drawn("figure_reach", sweep, out, NOTES), HEADER, [_row(point, drawn) for point in sweep.points])


def _panel(axes, family: str, points: list[Point]) -> None:
    reaches = sorted({point.params["reach_m"] for point in points})
    for method in dict.fromkeys(_method(point) for point in points):
        chosen = sorted((p for p in points if _method(p) == method), key=lambda p: p.params["reach_m"])
        first = chosen[0]
        axes.plot([reaches.index(p.params["reach_m"]) for p in chosen], [median(p) for p in chosen], _line_style(first),
                  marker=PRECISION_MARKERS[ran(first, "precision")], color=colour(first.params["kernel"]), label=method)
    axes.set(title=family, yscale="log")
    axes.set_xticks(range(len(reaches)), [f"{reach:g}" if reach < NO_REACH else "none" for reach in reaches])


def _line_style(point: Point) -> str:
    """Of what tells points of one kernel apart."""
    kernel, lanes, steps, batch = (point.params[key] for key in ("kernel", "lanes", "steps", "batch"))
    if kernel.startswith("brute"):
        return {0: "-", 1: ":"}.get(lanes, "--")
    return "-" if (steps, batch) == (4, 8) else "-." if batch > 8 else "--"


def _method(point: Point) -> str:
    """The kernel with what tells its points apart."""
    kernel = point.params["kernel"]
    if kernel == "hybrid-batch":
        return f"{kernel} of {point.params['batch']}"
    if kernel == "hybrid-pair":
        return f"{kernel}, {point.params['steps']} steps"
    lanes = ran(point, "lanes")
    return f"{kernel} {ran(point, 'precision')}, {lanes} lane{'s' * (lanes > 1)}"


def _row(point: Point, drawn: list[Point]) -> list:
    params = [point.params[key] for key in ("family", "reach_m", "kernel", "precision", "lanes", "steps", "batch")]
    if point.state != DRAWN:
        return [*params, point.state, *[""] * 4, point.id]
    params[4] = ran(point, "lanes")
    rivals = [p for p in drawn if (p.params["family"], p.params["reach_m"]) == (point.params["family"], point.params["reach_m"])]
    fastest = median(point) == min(median(rival) for rival in rivals)
    times = nanoseconds(point)
    return [*params, point.state, *(f"{value:.6g}" for value in (median(point), times[0], times[-1])),
            "yes" if fastest else "", point.id]


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
