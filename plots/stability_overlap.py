#!/usr/bin/python3
"""Release of an overlap: energy returned over energy stored, for bodies and contact rules."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import Drawn, command_line
from stability import RULES, Panel, by_rule, draw_panels, worst

NAME = "stability_overlap"
SHAPES = ("ball", "mesh_ball", "cube_on_face", "cube_on_edge", "cube_on_corner", "tilted_cube", "granulate")
PANELS = [Panel(by_rule("overlap-release", f"energy_error_{shape}"), "overlap / sum of halos",
                "energy returned / stored - 1", log="y", floor=1e-6, title=shape.replace("_", " ")) for shape in SHAPES]


def notes(sweep) -> list[str]:
    return [f"{rule}: at most {max(worst(sweep, line) for panel in PANELS for line in panel.lines if line.label == rule):.1e}."
            for rule in RULES]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_overlap, writes OUT/stability_overlap.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out, columns=4)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
