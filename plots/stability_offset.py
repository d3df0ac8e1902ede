#!/usr/bin/python3
"""Far from the origin: error of the overlap in several precisions and frames."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import Drawn, command_line
from stability import Line, Panel, draw_panels, found

NAME = "stability_offset"
METHODS = {"float_positions": "positions in float", "float_world": "float, world frame", "float_relative": "float, frame of a body",
           "double_world": "double, world frame", "mixed_relative": "mixed, frame of a body", "engine": "engine: double, frame of a body"}
LINES = [Line(label, "far-from-origin", f"overlap_error_{method}") for method, label in METHODS.items()]


def limits(axis) -> None:
    axis.set(xscale="log", ylim=(1e-22, 10))
    axis.axhline(1, color="#666666", linewidth=0.8)
    axis.annotate("the whole overlap", (1, 1.5), color="#666666", fontsize=8)


PANELS = [Panel(LINES, "distance from the origin (m)", "worst error of the overlap / sum of halos (2 mm)", log="y", floor=1e-16, guide=limits)]


def notes(sweep) -> list[str]:
    def lost(line: Line) -> str:
        far = [x for x, y, _ in found(sweep, line, "value") if y is None or y > 1e-2]
        return f"from {min(far):g} m on" if far else "nowhere"

    return [f"{line.label}: wrong by more than 1 % of the halos {lost(line)}." for line in LINES]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_offset, writes OUT/stability_offset.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
