#!/usr/bin/python3
"""The time step that follows the contacts: over time in the hopper, and steps saved over the density of a gas."""
import packages  # noqa: F401, I001: before all that need them
import math
import sys
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from figure import COLOURS, STYLE, Drawn, command_line
from grids import finish, history
from records import Point, load_sweep

NAME = "figure_g_4"
HEADER = ["scene", "packing_density", "steps", "fixed_steps", "share_saved", "crossings", "record"]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_g_4, writes OUT/figure_g_4.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(11, 5))
        over_time, over_density = figure.subplots(1, 2)
        gases = []
        for point in sweep.drawn():
            if point.params["scene"] != "gas":
                draw_time(over_time, point)
            else:
                gases.append((density(point), saved(point)))
        over_density.plot(*zip(*sorted(gases)) if gases else ((), ()), "o-", color=COLOURS[0])
        over_time.set(xlabel="simulated time (s)", ylabel="time step (s)", yscale="log", title="hopper")
        over_density.set(xlabel="packing density of the gas (volume of bodies / volume)", ylabel="share of steps saved",
                         ylim=(0, 1), title="gas in a reflecting cube")
        if over_time.lines:
            over_time.legend(fontsize=8)
        figure.subplots_adjust(left=0.08, right=0.98, top=0.86, bottom=0.24, wspace=0.22)
        notes = [f"{point.params['scene']}: {taken(point)} steps instead of {fixed(point)}, no surfaces crossed."
                 for point in sweep.drawn() if point.record["counts"]["crossings"] == 0]
        rows = [[point.params["scene"], f"{density(point):.4g}" if point.params["scene"] == "gas" else "", taken(point),
                 fixed(point), f"{saved(point):.4g}", point.record["counts"]["crossings"], point.id]
                for point in sweep.drawn()]
        return finish(figure, sweep, out, notes, (HEADER, rows))


def draw_time(axis, point: Point) -> None:
    seen = history(point)
    axis.plot(seen["time_s"], seen["step_s"], color=COLOURS[0], label="approach")
    axis.axhline(point.record["scene"]["step_s"], color=COLOURS[1], label="fixed: what a contact needs")


def density(point: Point) -> float:
    """Solid share of a lattice of spheres whose diameter is `fill` of its spacing."""
    return math.pi / 6 * point.params["fill"] ** 3


def taken(point: Point) -> int:
    return point.record["counts"]["steps"]


def fixed(point: Point) -> int:
    """Steps that the fixed step would have needed for the same simulated time."""
    return round(point.params["end_s"] / point.record["scene"]["step_s"])


def saved(point: Point) -> float:
    return 1 - taken(point) / fixed(point)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
