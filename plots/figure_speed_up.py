#!/usr/bin/python3
"""Speed-up of two threads over one, and the schemes on one thread beside serial, from repeats that took turns."""
import packages  # noqa: F401, I001: before all that need them
import statistics
import sys
from pathlib import Path

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figure import COLOURS, GREY, MARKERS, STYLE, Drawn, command_line, foot, head, save
from records import Point, Sweep, load_sweep

NAME = "figure_speed_up"
HEADER = ["what", "grid", "scheme", "repeats", "median_ratio", "least_ratio", "largest_ratio", "of", "over"]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_speed_up, writes OUT/figure_speed_up.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    grids = list(dict.fromkeys(point.params["grid"] for point in sweep.points))
    schemes = [scheme for scheme in dict.fromkeys(p.params["scheme"] for p in sweep.points) if scheme != "serial"]
    rows: list[list] = []
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(9, 4.8))
        left, right = figure.subplots(1, 2)
        for number, (grid, scheme) in enumerate((grid, scheme) for grid in grids for scheme in schemes):
            style = (COLOURS[schemes.index(scheme)], MARKERS[schemes.index(scheme)])
            one, two, serial = (_find(sweep, grid, *which) for which in ((scheme, 1), (scheme, 2), ("serial", 1)))
            rows += _draw_ratios(left, number, style, ("two threads over one", one, two))
            rows += _draw_ratios(right, number, style, ("serial over this scheme, one thread", serial, one))
        labels = [f"{grid}\n{scheme}" for grid in grids for scheme in schemes]
        for axis, title, ideal in ((left, "speed-up of two threads", 2), (right, "speed on one thread, serial = 1", 1)):
            axis.axhline(ideal, color=GREY, linestyle=":")
            axis.set_title(title)
            axis.set_xticks(range(len(labels)), labels)
            axis.set_xlim(-0.5, len(labels) - 0.5)
        head(figure, sweep)
        foot(figure, sweep)
        figure.subplots_adjust(left=0.07, right=0.98, top=0.86, bottom=0.22, wspace=0.15)
        return save(figure, Drawn(NAME, sweep, out, [_sentence(row) for row in rows]), HEADER, rows)


def _find(sweep: Sweep, grid: str, scheme: str, threads: int) -> Point | None:
    wanted = {"grid": grid, "scheme": scheme, "threads": threads}
    return next((point for point in sweep.drawn() if wanted.items() <= point.params.items()), None)


def ratios(slow: Point, fast: Point) -> list[float]:
    """Per repeat: their processes ran one after the other."""
    times = [[sample["wall_s"] / sample["steps"] for sample in point.record["samples"]] for point in (slow, fast)]
    return sorted(one / other for one, other in zip(*times))


def _draw_ratios(axis: Axes, place: int, style: tuple[str, str], pair: tuple[str, Point | None, Point | None]) -> list[list]:
    """Every repeat, and their median as a bar with its number; the row of the table."""
    what, slow, fast = pair
    if slow is None or fast is None:
        return []
    found = ratios(slow, fast)
    median = statistics.median(found)
    axis.plot([place] * len(found), found, style[1], color=style[0], alpha=0.35, markersize=5, linestyle="none")
    axis.plot([place - 0.25, place + 0.25], [median, median], color=style[0], linewidth=2)
    axis.annotate(f"{median:.3f}", (place + 0.12, median), xytext=(0, 4), textcoords="offset points", fontsize=8.5)
    return [[what, fast.params["grid"], fast.params["scheme"], len(found), f"{median:.5g}", f"{found[0]:.5g}", f"{found[-1]:.5g}",
             slow.id, fast.id]]


def _sentence(row: list) -> str:
    what, grid, scheme, repeats, median, least, most = row[:7]
    return f"{grid} {scheme}, {what}: {median} ({least} to {most}, {repeats} repeats in turn)."


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
