#!/usr/bin/python3
"""Tunnelling: what passes through a plate, what is seen, what passes in silence, with each step control."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import numpy as np

from figure import GREY, Drawn, command_line
from stability import Line, Panel, draw_panels, found, worst

NAME = "stability_tunnelling"
CONTROLS = ("fixed", "approach", "gap-only")


def lines(study: str, metric: str) -> list[Line]:
    return [Line(control, study, metric, {"control": control}) for control in CONTROLS]


def limit(axis) -> None:
    axis.axvline(1, color=GREY, linewidth=0.8)


def expected(axis) -> None:
    ways = np.geomspace(0.5, 8, 100)
    axis.plot(ways, np.minimum(1, 1 / ways), color=GREY, linewidth=0.8)
    axis.annotate("min(1, w / (V h))", (3, 0.4), color=GREY, fontsize=8)


PANELS = [
    Panel(lines("tunnelling", "passed_through"), "speed / response limit E sqrt(k / m)", "passed through", log="x", guide=limit),
    Panel(lines("tunnelling", "speed_after_over_before"), "speed / response limit E sqrt(k / m)", "speed after / before", log="x", guide=limit),
    Panel(lines("detection", "seen_share"), "way per contact step V h / width w", "share that is seen", log="x", guide=expected),
    Panel(lines("detection", "silent_share"), "way per contact step V h / width w", "share that passes in silence", log="x"),
]


def slowest(sweep) -> float:
    """Least speed after an elastic impact over that before, below the response limit."""
    return min((y for x, y, _ in found(sweep, lines("tunnelling", "speed_after_over_before")[2], "value") if x < 1), default=float("nan"))


def notes(sweep) -> list[str]:
    silent = max(worst(sweep, line) for line in [*lines("detection", "silent_share"), *lines("tunnelling", "unreported")])
    return ["Below the response limit no ball passes; faster ones do, even if they are seen in every step.",
            f"The largest share that passed without being reported is {silent:g}.",
            "What moves by more than the width per contact step can be missed by every control, and is reported.",
            f"gap-only leaves as little as {slowest(sweep):.0%} of the speed: its long step before the contact kicks at the wrong time."]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_tunnelling, writes OUT/stability_tunnelling.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out, columns=2)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
