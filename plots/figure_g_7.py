#!/usr/bin/python3
"""Cells that split in 2^3 or in 3^3: levels, cells, comparisons, structural work and time for each kind of grid."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from figure import COLOURS, GREY, STYLE, Drawn, command_line
from grids import bodies, compared, counts_per_step, finish, step_s
from records import Point, load_sweep

NAME = "figure_g_7"
HEADER = ["size_ratio", "grid", "k", "bodies", "levels", "cells", "compared_per_body", "virtual_copies_per_body",
          "refinements_per_step", "coarsenings_per_step", "settled_bodies_per_step", "us_per_body", "record"]
PANELS = (("levels", "levels down to the finest body"), ("cells", "cells on all levels"),
          ("compared_per_body", "pairs compared per body and step"), ("refinements_per_step", "cells split per step"),
          ("coarsenings_per_step", "cells made whole per step"), ("us_per_body", "time (us per body and step)"))


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_g_7, writes OUT/figure_g_7.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    rows = [dict(zip(HEADER, measures(point))) for point in sweep.drawn()]
    cases = list(dict.fromkeys((row["size_ratio"], row["grid"]) for row in rows))
    ks = sorted({row["k"] for row in rows})
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(12, 7))
        for axis, (column, label) in zip(figure.subplots(2, 3).flat, PANELS):
            for number, k in enumerate(ks):
                value = {(row["size_ratio"], row["grid"]): row[column] for row in rows if row["k"] == k}
                places = [place + 0.4 * (number - 0.5) for place in range(len(cases))]
                axis.bar(places, [value.get(case, 0) for case in cases], 0.36, color=COLOURS[number], label=f"k = {k}")
            axis.set_xticks(range(len(cases)), [f"{grid}\n1:{ratio:g}" for ratio, grid in cases], fontsize=8)
            axis.set_title(label)
            if column in ("cells", "compared_per_body"):
                axis.set_yscale("log")
            elif not any(row[column] for row in rows):
                axis.set_ylim(0, 1)
                axis.text(0.5, 0.5, "none in any of these steps", ha="center", color=GREY, transform=axis.transAxes)
        if rows:
            figure.axes[0].legend(fontsize=8)
        figure.subplots_adjust(left=0.05, right=0.98, top=0.9, bottom=0.15, wspace=0.16, hspace=0.36)
        return finish(figure, sweep, out, notes(rows), (HEADER, [list(row.values()) for row in rows]))


def measures(point: Point) -> list:
    """One row of the table: means over the steps, the median time of the samples."""
    per_step, number = counts_per_step(point), bodies(point)
    return [point.params["size_ratio"], point.params["grid"], point.params["subdivision"], number, per_step["levels"],
            per_step["cells"], compared(point), per_step["virtual_copies"] / number, per_step["refinements"],
            per_step["coarsenings"], per_step["settled_bodies"], 1e6 * step_s(point) / number, point.id]


def notes(rows: list[dict]) -> list[str]:
    """k = 2 beside k = 3, case by case."""
    by_case = {(row["size_ratio"], row["grid"], row["k"]): row for row in rows}
    lines = []
    for (ratio, grid, k), two in by_case.items():
        three = by_case.get((ratio, grid, 3))
        if k == 2 and three:
            lines.append(f"1:{ratio:g}, {grid}: k = 2 has {two['levels']:.2g} levels, k = 3 {three['levels']:.2g}; compared per body "
                         f"and step {two['compared_per_body']:.3g} and {three['compared_per_body']:.3g}; time k = 2 : k = 3 = "
                         f"{two['us_per_body'] / three['us_per_body']:.2f}.")
    return lines


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
