#!/usr/bin/python3
"""What finding pairs takes of a step: grid, search, comparison of triangles, and the rest, for each grid and skin."""
import packages  # noqa: F401, I001: before all that need them
import statistics
import sys
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from figure import COLOURS, STYLE, Drawn, command_line
from grids import bodies, compared, counts_per_step, finding_pairs, finish, foot_inches
from records import Point, load_sweep

NAME = "figure_g_6"
PARTS = ("grid", "search", "comparison", "forces", "motion")
HEADER = ["scene", "grid", "skin", "bodies", *(f"{part}_us_per_body" for part in PARTS), "share_of_grid_and_search",
          "compared_per_body", "record"]
BAR = 0.1  # of the step, for grid and search together


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_g_6, writes OUT/figure_g_6.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    points = [point for point in sweep.drawn() if finding_pairs(point) is not None]
    shares = [finding_pairs(point) for point in points]
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(10, 1.4 + foot_inches(sweep) + 0.45 * len(points)))
        axis = figure.subplots()
        for row, (point, share) in enumerate(zip(points, shares)):
            left = 0.0
            for part, colour, width in zip(PARTS, COLOURS, parts(point)):
                axis.barh(row, width, left=left, color=colour, label=part if row == 0 else None)
                left += width
            axis.text(left, row, f"  {100 * share:.1f} %", va="center", fontsize=9)
        axis.set_yticks(range(len(points)), [label(point) for point in points])
        axis.invert_yaxis()
        axis.margins(x=0.12)
        axis.set_xlabel("us per body and step; at the right the share of grid and search")
        if points:
            axis.legend(fontsize=8, ncols=len(PARTS), loc="lower center", bbox_to_anchor=(0.5, 1))
        inch = 1 / figure.get_figheight()
        figure.subplots_adjust(left=0.27, right=0.97, top=1 - 0.8 * inch, bottom=(0.6 + foot_inches(sweep)) * inch)
        rows = [[point.params["scene"], point.params["grid"], point.params["skin"], bodies(point),
                 *(f"{part:.5g}" for part in parts(point)), f"{share:.4g}", f"{compared(point):.5g}", point.id]
                for point, share in zip(points, shares)]
        return finish(figure, sweep, out, notes(points, shares), (HEADER, rows))


def label(point: Point) -> str:
    return f"{point.params['scene']}, {point.params['grid']}, skin {point.params['skin']:g}"


def parts(point: Point) -> list[float]:
    """PARTS in us per body and step: medians over the samples."""
    def each(sample: dict) -> list[float]:
        phases = {phase: seconds / sample["steps"] for phase, seconds in sample["phases_s"].items()}
        search = sample["search_s"]
        return [phases["grid"], search, max(0.0, phases["detect"] - search), phases["merge"] + phases["forces"],
                phases["integrate"]]

    samples = zip(*map(each, point.record["samples"]))
    return [1e6 * statistics.median(seconds) / bodies(point) for seconds in samples]


def notes(points: list[Point], shares: list[float]) -> list[str]:
    """Who keeps to the bar, who does not, and with how many contacts."""
    lines = []
    for point, share in zip(points, shares):
        contacts = counts_per_step(point)["contacts"] / bodies(point)
        lines.append(f"{label(point)}: {100 * share:.1f} % of the step, {'within' if share <= BAR else 'above'} the bar of "
                     f"{100 * BAR:.0f} %, with {contacts:.2g} contacts per body.")
    return lines


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
