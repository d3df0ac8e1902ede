#!/usr/bin/python3
"""Two bodies of sizes 1:10 on each kind of grid, beside figure 3 of Krestenitis and Weinzierl (2018)."""
import packages  # noqa: F401, I001: before all that need them
import statistics
import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from figure import STYLE, Drawn, command_line
from grids import finish, history, look
from published import figures
from records import Point, load_sweep

NAME = "figure_g_1"
PANELS = (("C18.F3a", "pairs compared per step"), ("C18.F3b", "time step (s)"), ("C18.F3c", "wall time so far (s)"))


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_g_1, writes OUT/figure_g_1.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    points = {point.params["grid"]: point for point in sweep.drawn()}
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(14, 5.4))
        axes = figure.subplots(1, 3)
        for axis, (published, label) in zip(axes, PANELS):
            draw_published(axis, published)
            axis.set(xlabel="simulated time (s)", ylabel=label, xlim=(0, 4))
        rows = [row for grid, point in points.items() for row in draw_point(axes, grid, point)]
        axes[1].set_yscale("log")
        axes[2].set_yscale("log")
        if points:
            axes[0].legend(fontsize=8, title="faint: published", title_fontsize=8)
        figure.subplots_adjust(left=0.06, right=0.98, top=0.88, bottom=0.22, wspace=0.25)
        header = ["grid", "time_s", "step_s", "compared", "visited_vertices", "wall_so_far_s"]
        return finish(figure, sweep, out, notes(points), (header, rows))


def draw_published(axis, id: str) -> None:
    for series in next(figure for figure in figures() if figure["id"] == id)["series"]:
        grid = {"regular": "regular-dense"}.get(series["params"]["grid"], series["params"]["grid"])
        axis.plot(*zip(*series["points"]), "-", color=look(grid)["color"], alpha=0.3, linewidth=3)


def draw_point(axes, grid: str, point: Point) -> list[list]:
    """Draws one grid's curves; returns its rows of the table."""
    seen = history(point)
    columns = (seen["candidate_pairs"] / seen["steps"], seen["step_s"], np.cumsum(seen["wall_s"]))
    for axis, values in zip(axes, columns):
        axis.plot(seen["time_s"], values, label=grid, **{**look(grid), "marker": None})
    values = zip(seen["time_s"], seen["step_s"], seen["candidate_pairs"], seen["visited_vertices"], columns[2])
    return [[grid, *(f"{x:.6g}" for x in row)] for row in values]


def notes(points: dict[str, Point]) -> list[str]:
    """The ratios that are compared with the published ones."""
    wall = {grid: statistics.median(s["wall_s"] for s in point.record["samples"]) for grid, point in points.items()}
    lines = ["A step takes the same time on every grid but for the grid itself; each pair is compared once in a step, "
             "where the published code meets it at up to 8 vertices and once more at a hanging one."]
    for grid, published in (("adaptive", 30), ("reluctant", 47)):
        if {"regular-dense", grid} <= wall.keys():
            lines.append(f"Wall time regular-dense : {grid} = {wall['regular-dense'] / wall[grid]:.3g} : 1 (published "
                         f"regular : {grid} {published} : 1).")
    if {"regular", "adaptive"} <= wall.keys():
        lines.append(f"Our regular grid stores only vertices in use: regular : adaptive = "
                     f"{wall['regular'] / wall['adaptive']:.3g} : 1.")
    return lines


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
