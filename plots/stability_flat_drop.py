#!/usr/bin/python3
"""Simultaneous impacts: a cube that drops nearly flat on its face."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import Drawn, command_line
from stability import RULES, Line, Panel, by_rule, draw_panels, worst

NAME = "stability_flat_drop"
THETA = "Theta = tilt edge frequency / speed"


def theory(metric: str) -> Line:
    return Line("two edges on springs", "flat-drop", metric, {"contact_rule": "features"},
                {"color": "black", "marker": "", "linewidth": 0.8, "zorder": 3})


def near_zero(axis) -> None:
    """Shows small Theta, where the edges still meet at once, as wide as large ones."""
    axis.set_xscale("symlog", linthresh=0.01, linscale=0.3)
    axis.set_xlim(left=-0.003)


PANELS = [
    Panel([*by_rule("flat-drop", "velocity_over_speed"), theory("velocity_theory")], THETA, "velocity after / speed before",
          log="", guide=near_zero),
    Panel([*by_rule("flat-drop", "spin_edge_over_speed"), theory("spin_theory")], THETA, "spin edge / speed", log="",
          guide=near_zero),
    Panel(by_rule("flat-drop", "error"), THETA, "error against two edges on springs", log="y", floor=1e-6, guide=near_zero),
    Panel(by_rule("flat-drop", "spread"), THETA, "spread at one Theta", log="y", floor=1e-6, guide=near_zero),
]


def notes(sweep) -> list[str]:
    def most(rule: str, metric: str) -> float:
        return worst(sweep, Line("", "flat-drop", metric, {"contact_rule": rule}))

    return [*(f"{rule}: outcomes at one Theta differ by up to {most(rule, 'spread'):.1e}, and from those of a small turn on two "
              f"springs by {most(rule, 'error'):.1e}." for rule in RULES),
            "At Theta = 0 the cube returns its speed, at large Theta one edge meets after the other: velocity 0.92, spin 0.96."]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_flat_drop, writes OUT/stability_flat_drop.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out, columns=2)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
