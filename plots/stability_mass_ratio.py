#!/usr/bin/python3
"""Mass ratio: where a cube of another mass comes to rest on a cube."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import Drawn, command_line
from stability import Line, Panel, draw_panels, outside

NAME = "stability_mass_ratio"
PANELS = [
    Panel([Line("features", "mass-ratio", "height_error_of_edge")], "mass of the upper cube / lower", "height error / edge", floor=1e-17),
    Panel([Line("features", "mass-ratio", "steps_to_rest")], "mass of the upper cube / lower", "steps until it rests"),
    Panel([Line("features", "mass-ratio", "kinetic_of_m_g_overlap")], "mass of the upper cube / lower",
          "kinetic energy left / (m g overlap)", floor=1e-30),
]


def notes(sweep) -> list[str]:
    return [f"{len(outside(sweep))} values are out of their bars. The step follows the lightest cube, the period the heaviest, and dashpots "
            "made for the light one hardly damp the heavy one above it: a ratio q costs some q more steps."]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_mass_ratio, writes OUT/stability_mass_ratio.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
