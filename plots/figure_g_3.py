#!/usr/bin/python3
"""Slices of the grids over the hopper at three times, as the thesis shows its grids."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from figure import GREY, STYLE, Drawn, command_line
from frames import Frame, cells_of, read_frame, read_frames
from grids import finish
from records import DRAWN, NothingToDraw, Point, Sweep, load_sweep

NAME = "figure_g_3"
PLANE = 0.5  # m, along z; the hopper's middle
HEADER = ["grid", "time_s", "level", "cells", "cells_in_slice"]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_g_3 and its frames, writes OUT/figure_g_3.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    rows: list[list] = []
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(10, 3.5 * len(sweep.points) + 1))
        axes = figure.subplots(len(sweep.points), 3, squeeze=False)
        for line, point in zip(axes, sweep.points):
            line[0].set_ylabel(f"{point.params['grid']}\ny (m)")
            if point.state != DRAWN:
                line[0].text(0.5, 0.5, point.state, transform=line[0].transAxes, ha="center", color=GREY)
                continue
            for axis, (time, cells, frame) in zip(line, three_times(sweep, point)):
                rows += draw_slice(axis, point.params["grid"], time, cells, frame)
        for axis in axes[-1]:
            axis.set_xlabel("x (m)")
        figure.subplots_adjust(left=0.09, right=0.98, top=0.94, bottom=0.09, wspace=0.12, hspace=0.24)
        return finish(figure, sweep, out, ["Lines are the borders of the cells that the plane z = .5 m cuts; grains are "
                                           "drawn if they are nearer to it than .03 m."], (HEADER, rows))


def three_times(sweep: Sweep, point: Point) -> list[tuple[float, Path, Frame]]:
    """Time (s), cells and bodies of three frames, not the first: the grid is made in the first step. NothingToDraw if gone."""
    folder = sweep.folder / "frames" / point.id
    try:
        grids, bodies = read_frames(folder, "grid.pvd"), read_frames(folder)
        return [(time, cells, read_frame(*frame)) for (time, cells), frame in zip(grids[1:4], bodies[1:4])]
    except (OSError, ValueError, KeyError, SyntaxError) as error:
        raise NothingToDraw(f"cannot read the frames ({folder}: {error}). Remove {point.id}.json beside them and run "
                            f"`build/release/bin/sweep run {NAME}` again.") from None


def draw_slice(axis, grid: str, time: float, file: Path, frame: Frame) -> list[list]:
    """Draws one slice; returns its rows of the table: cells per level."""
    low, high, level = cells_of(file)
    cut = (low[:, 2] <= PLANE) & (high[:, 2] > PLANE)
    corners = np.stack([low[cut][:, [0, 1]], np.stack([high[cut][:, 0], low[cut][:, 1]], 1), high[cut][:, [0, 1]],
                        np.stack([low[cut][:, 0], high[cut][:, 1]], 1)], 1)
    axis.add_collection(PolyCollection(corners, facecolors="none", edgecolors="#0072B2", linewidths=0.35))
    middle = frame.corners[..., 2].mean(1)
    near = np.abs(middle - PLANE) < 0.03
    wall = np.isin(frame.body, [0, 1])  # hopper and floor
    for chosen, colour in ((near & ~wall, "#D55E00"), (wall & crossing(frame), "black")):
        edges = frame.corners[chosen][:, [0, 1, 2, 0], :2]
        axis.add_collection(LineCollection(edges, colors=colour, linewidths=0.5, rasterized=True))
    axis.set(xlim=(0.25, 0.75), ylim=(0.3, 0.85), aspect="equal", title=f"t = {time:.3g} s")
    axis.grid(False)
    return [[grid, f"{time:.6g}", each, int((level == each).sum()), int((level[cut] == each).sum())]
            for each in np.unique(level)]


def crossing(frame: Frame) -> np.ndarray:
    """For each triangle whether the plane cuts it."""
    z = frame.corners[..., 2]
    return (z.min(1) <= PLANE) & (z.max(1) >= PLANE)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
