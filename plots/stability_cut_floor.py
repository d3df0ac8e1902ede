#!/usr/bin/python3
"""Sliding over a floor cut into triangles: ripple of the force, tilt of the normal."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import Drawn, command_line
from stability import RULES, Line, Panel, by_rule, draw_panels, worst

NAME = "stability_cut_floor"
CUTS = {1: "1", 2: "2", 4: "4", 8: "8", 16: "16", 32: "32"}
PANELS = [
    Panel(by_rule("cut-floor", "ripple_of_weight"), "cuts of the floor's edge", "ripple of the force / weight", ticks=CUTS),
    Panel(by_rule("cut-floor", "tilt_of_normal_deg"), "cuts of the floor's edge", "worst tilt of a normal (degrees)", ticks=CUTS, floor=1e-6),
]


def notes(sweep) -> list[str]:
    return [f"{rule}: ripple up to {worst(sweep, Line('', 'cut-floor', 'ripple_of_weight', {'contact_rule': rule})):.1e} of the weight."
            for rule in RULES]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_cut_floor, writes OUT/stability_cut_floor.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
