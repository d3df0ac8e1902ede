#!/usr/bin/python3
"""Grazing impacts: energy that bodies gain from the floor."""
import packages  # noqa: F401, I001: before all that need them
import math
import sys
from pathlib import Path

from figure import Drawn, command_line
from stability import RULES, Line, Panel, by_rule, draw_panels, worst

NAME = "stability_grazing"
PANELS = [
    Panel(by_rule("grazing", "energy_gained"), "angle from the normal (degrees)", "energy gained / energy before, damped", log="y", floor=1e-12),
    Panel(by_rule("grazing", "energy_gained_undamped"), "angle from the normal (degrees)", "the same without damping", log="y", floor=1e-12),
    Panel(by_rule("grazing", "energy_kept"), "angle from the normal (degrees)", "most energy kept / energy before, damped", log=""),
]


def notes(sweep) -> list[str]:
    gains = {rule: [worst(sweep, Line("", "grazing", metric, {"contact_rule": rule}))
                    for metric in ("energy_gained", "energy_gained_undamped")] for rule in RULES}
    return [f"{rule}: gains up to {damped:.1e} with damping, {undamped:.1e} without."
            for rule, (damped, undamped) in gains.items() if not math.isnan(damped)]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_grazing, writes OUT/stability_grazing.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
