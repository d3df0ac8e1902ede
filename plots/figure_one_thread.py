#!/usr/bin/python3
"""Time per particle and step of packed grains and spheres on one thread, ours beside that of other engines on the same bodies."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from figure import COLOURS, STYLE, Drawn, command_line
from grids import bodies, counts_per_step, finish, foot_inches
from records import DRAWN, Point, load_sweep

NAME = "figure_one_thread"
OURS = "trigrain"
ENGINES = (OURS, "liggghts", "yade")
HEADER = ["bodies", "vertices", "engine", "version", "state", "us_per_body", "least_us", "most_us", "times_ours", "contacts_per_body",
          "differs", "record"]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_one_thread, writes OUT/figure_one_thread.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    problems: dict[tuple[int, int], list[Point]] = {}
    for point in sweep.points:
        problems.setdefault((point.params["particles"], point.params["vertices"]), []).append(point)
    rows, ticks = [], []
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(10, 1.3 + foot_inches(sweep) + 0.42 * (len(sweep.points) + len(problems))))
        axis = figure.subplots()
        place = 0.0
        for points in problems.values():
            ours = next((point.median() for point in points if point.params["engine"] == OURS and point.state == DRAWN), None)
            for point in sorted(points, key=lambda each: ENGINES.index(each.params["engine"])):
                rows.append(row(point, ours))
                ticks.append((place, label(point)))
                bar(axis, place, point, ours)
                place += 1
            place += 0.6
        axis.set_yticks([at for at, _ in ticks], [text for _, text in ticks])
        axis.set_ylim(place - 0.9, -0.7)
        axis.set_xscale("log")
        axis.grid(axis="y", visible=False)
        axis.set_xlim(right=6 * axis.get_xlim()[1])  # room for the words
        axis.set_xlabel("us per particle and step on one thread: median, least and most; at the right times ours")
        inch = 1 / figure.get_figheight()
        figure.subplots_adjust(left=0.27, right=0.97, top=1 - 0.5 * inch, bottom=(0.6 + foot_inches(sweep)) * inch)
        return finish(figure, sweep, out, notes(rows), (HEADER, rows))


def bar(axis, place: float, point: Point, ours: float | None) -> None:
    """A point with its range, or the word why there is none."""
    if point.state != DRAWN:
        axis.text(0.02, place, point.state, va="center", fontsize=9, transform=axis.get_yaxis_transform())
        return
    times, middle = point.microseconds(), point.median()
    colour = COLOURS[ENGINES.index(point.params["engine"])]
    axis.plot([times[0], times[-1]], [place, place], color=colour, linewidth=5, alpha=0.4, solid_capstyle="butt")
    axis.plot(middle, place, "o", color=colour)
    times_ours = "" if ours is None or point.params["engine"] == OURS else f", {middle / ours:.3g} x"
    axis.annotate(f"{middle:.3g} us{times_ours}", (times[-1], place), xytext=(8, 0), textcoords="offset points", va="center", fontsize=9)


def label(point: Point) -> str:
    vertices = point.params["vertices"]
    what = f"grains of {vertices} points" if vertices else "spheres"
    return f"{point.params['particles']} {what}, {point.params['engine']}"


def row(point: Point, ours: float | None) -> list:
    """One line of the table. Contacts of a peer are touching pairs of bodies, ours are points of contact."""
    params, record = point.params, point.record
    first = [params["particles"], params["vertices"], params["engine"]]
    if point.state != DRAWN:
        return [*first, "", point.state, "", "", "", "", "", point.why, point.id]
    times, peer = point.microseconds(), record.get("peer")
    contacts = peer["touching_pairs"] if peer else counts_per_step(point)["contacts"]
    return [*first, peer["version"] if peer else record["build"]["version"], point.state, f"{point.median():.4g}", f"{times[0]:.4g}",
            f"{times[-1]:.4g}", f"{point.median() / ours:.4g}" if ours else "", f"{contacts / bodies(point):.3g}",
            peer["differs"] if peer else "", point.id]


def notes(rows: list[list]) -> list[str]:
    """How each peer's model is not ours, once."""
    each = [dict(zip(HEADER, values)) for values in rows]
    return list(dict.fromkeys(f"{one['engine']} {one['version']}, {'grains' if one['vertices'] else 'spheres'}: {one['differs']}."
                              for one in each if one["state"] == DRAWN and one["differs"]))


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
