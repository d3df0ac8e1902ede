#!/usr/bin/python3
"""Figure 8.5 of Krestenitis (2018): plain grid parallelism with 1000 particles, runtime over threads."""
import sys
from pathlib import Path

from figure import Drawn, command_line
from scaling import PLAIN_CURVES, VERTICES, Panel, draw_scaling

PANELS = [
    Panel("regular grid", {"grid": "regular"}, "C18.F5a"),
    Panel("adaptive grid", {"grid": "adaptive"}, "C18.F5b"),
]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_8_5, writes OUT/figure_8_5.svg, .png and .csv."""
    return draw_scaling("figure_8_5", PANELS, [PLAIN_CURVES, VERTICES], (results, out))


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
