#!/usr/bin/python3
"""Cost of the grid: time per step, its share, memory, and comparisons saved, over the number of bodies."""
import packages  # noqa: F401, I001: before all that need them
import statistics
import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from figure import GREY, STYLE, Drawn, command_line
from grids import bodies, compared, counts_per_step, finding_pairs, finish, look, step_s
from records import Point, load_sweep

NAME = "figure_g_5"
HEADER = ["grid", "skin", "particles", "ms_per_step", "grid_and_search_us_per_body", "heap_bytes_per_body",
          "compared_per_body", "share_of_comparisons_saved", "searches_per_step", "share_of_grid_and_search", "record"]
BAR_BYTES = 1000
PANELS = (("ms_per_step", "wall time per step (ms)"), ("grid_and_search_us_per_body", "grid and detection (us per body)"),
          ("heap_bytes_per_body", "memory beside the mesh (bytes per body)"),
          ("compared_per_body", "pairs compared per body and step"))


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_g_5, writes OUT/figure_g_5.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    rows = [dict(zip(HEADER, measures(point))) for point in sweep.drawn()]
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(11, 9))
        for axis, (column, label) in zip(figure.subplots(2, 2).flat, PANELS):
            for grid, skin in dict.fromkeys((row["grid"], row["skin"]) for row in rows):
                mine = sorted((row["particles"], row[column]) for row in rows
                              if (row["grid"], row["skin"]) == (grid, skin) and row[column] is not None)
                axis.plot(*zip(*mine) if mine else ((), ()), linestyle="--" if skin else "-",
                          label=f"{grid}, skin {skin:g}", **look(grid))
            axis.set(xscale="log", xlabel="bodies", ylabel=label)
            if column == "heap_bytes_per_body":
                axis.set_ylim(0, 1.1 * BAR_BYTES)
                axis.axhline(BAR_BYTES, color=GREY, linewidth=0.8, linestyle=":", label="bar")
            elif column == "compared_per_body":  # 0 where no step searched
                axis.set_yscale("symlog", linthresh=1e-3)
                axis.set_ylim(0, 3 * max((row[column] for row in rows), default=1))
            else:
                axis.set_yscale("log")
        if rows:
            least = min(rows, key=lambda row: row["ms_per_step"])
            sizes = np.array(sorted({row["particles"] for row in rows}))
            figure.axes[0].plot(sizes, least["ms_per_step"] * sizes / least["particles"], color=GREY, linewidth=0.8,
                                linestyle=":", label="slope 1")
            figure.axes[0].legend(fontsize=8)
        figure.subplots_adjust(left=0.08, right=0.98, top=0.93, bottom=0.13, wspace=0.2, hspace=0.22)
        return finish(figure, sweep, out, notes(rows), (HEADER, [list(row.values()) for row in rows]))


def measures(point: Point) -> list:
    """One row of the table."""
    number, heap = bodies(point), point.record["heap_bytes"]
    search = statistics.median((s["phases_s"]["grid"] + s["phases_s"]["detect"]) / s["steps"] for s in point.record["samples"])
    return [point.params["grid"], point.params["skin"], number, 1e3 * step_s(point), 1e6 * search / number,
            None if heap is None else heap / number, compared(point), 1 - compared(point) / ((number - 1) / 2),
            counts_per_step(point)["searches"], finding_pairs(point), point.id]


def power_law(points: list[tuple[int, float]]) -> tuple[float, float] | None:
    """Exponent of the least-squares fit in log-log, and the largest deviation from it; None for fewer than two sizes."""
    if len({n for n, _ in points}) < 2:
        return None
    logs = np.log(points)
    slope, start = np.polyfit(logs[:, 0], logs[:, 1], 1)
    off = np.abs(logs[:, 1] - start - slope * logs[:, 0]).max()
    return float(slope), float(np.exp(off) - 1)


def notes(rows: list[dict]) -> list[str]:
    """Slopes in log-log, and comparisons saved with 1000 bodies."""
    lines = []
    for grid, skin in dict.fromkeys((row["grid"], row["skin"]) for row in rows):
        mine = sorted((row["particles"], row["ms_per_step"]) for row in rows
                      if (row["grid"], row["skin"]) == (grid, skin))
        fit = power_law(mine)
        if fit:
            slope, off = fit
            lines.append(f"{grid}, skin {skin:g}: time per step grows as bodies^{slope:.2f} from {mine[0][0]} to {mine[-1][0]}; no "
                         f"point is farther than {100 * off:.0f} % from the fit (bar: 1.0 +- 0.1).")
    for row in rows:
        if row["particles"] == 1000 and not row["skin"]:
            lines.append(f"{row['grid']}, 1000 bodies: {100 * row['share_of_comparisons_saved']:.1f} % of the comparisons "
                         "of all pairs are saved (published 92 %).")
    return lines


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
