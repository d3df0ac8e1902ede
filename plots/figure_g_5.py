#!/usr/bin/python3
"""Cost of the grid: time per step, its share, memory, and comparisons saved, over the number of bodies."""
import packages  # noqa: F401, I001: before all that need them
import math
import statistics
import sys
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from figure import STYLE, Drawn, command_line
from grids import finish, look
from records import Point, load_sweep

NAME = "figure_g_5"
HEADER = ["grid", "skin", "particles", "ms_per_step", "grid_and_search_us_per_body", "heap_bytes_per_body",
          "compared_per_body", "share_of_comparisons_saved", "searches_per_step", "record"]
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
            axis.set(xscale="log", yscale="log", xlabel="bodies", ylabel=label)
        if rows:
            figure.axes[0].legend(fontsize=8)
        figure.subplots_adjust(left=0.08, right=0.98, top=0.93, bottom=0.13, wspace=0.2, hspace=0.22)
        return finish(figure, sweep, out, notes(rows), (HEADER, [list(row.values()) for row in rows]))


def measures(point: Point) -> list:
    """One row of the table."""
    record, bodies = point.record, point.record["scene"]["moving_bodies"]
    counts, samples = record["counts"], record["samples"]
    per_step = statistics.median(s["wall_s"] / s["steps"] for s in samples)
    search = statistics.median((s["phases_s"]["grid"] + s["phases_s"]["detect"]) / s["steps"] for s in samples)
    compared = counts["candidate_pairs"] / counts["steps"]
    heap = record["heap_bytes"]
    return [point.params["grid"], point.params["skin"], bodies, 1e3 * per_step, 1e6 * search / bodies,
            None if heap is None else heap / bodies, compared / bodies, 1 - compared / (bodies * (bodies - 1) / 2),
            counts["searches"] / counts["steps"], point.id]


def notes(rows: list[dict]) -> list[str]:
    """Slopes in log-log, and comparisons saved with 1000 bodies."""
    lines = []
    for grid, skin in dict.fromkeys((row["grid"], row["skin"]) for row in rows):
        mine = sorted((row["particles"], row["ms_per_step"]) for row in rows
                      if (row["grid"], row["skin"]) == (grid, skin))
        (n0, t0), (n1, t1) = mine[0], mine[-1]
        if n1 > n0:
            slope = math.log(t1 / t0) / math.log(n1 / n0)
            lines.append(f"{grid}, skin {skin:g}: time per step grows as bodies^{slope:.2f} from {n0} to {n1}.")
    for row in rows:
        if row["particles"] == 1000 and not row["skin"]:
            lines.append(f"{row['grid']}, 1000 bodies: {100 * row['share_of_comparisons_saved']:.1f} % of the comparisons "
                         "of all pairs are saved (published 92 %).")
    return lines


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
