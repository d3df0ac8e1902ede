#!/usr/bin/python3
"""Simultaneous impacts: a cube that drops nearly flat on its face."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import Drawn, command_line
from stability import RULES, Line, Panel, by_rule, draw_panels, worst

NAME = "stability_flat_drop"
THETA = "Theta = tilt edge frequency / speed"
PANELS = [
    Panel(by_rule("flat-drop", "velocity_over_speed"), THETA, "velocity after / speed before", log=""),
    Panel(by_rule("flat-drop", "spin_edge_over_speed"), THETA, "spin edge / speed", log=""),
    Panel(by_rule("flat-drop", "spread"), THETA, "spread at one Theta", log="y", floor=1e-6),
]


def notes(sweep) -> list[str]:
    return [f"{rule}: outcomes at one Theta differ by up to {worst(sweep, Line('', 'flat-drop', 'spread', {'contact_rule': rule})):.1e}."
            for rule in RULES]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_flat_drop, writes OUT/stability_flat_drop.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
