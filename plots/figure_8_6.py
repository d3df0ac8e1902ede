#!/usr/bin/python3
"""Figure 8.6 of Krestenitis (2018): plain grid parallelism with 10 000 particles, runtime over threads."""
import sys
from pathlib import Path

from figure import Drawn, command_line
from scaling import NOMINAL, PLAIN_CURVES, VERTICES, Panel, draw_scaling

PANELS = [
    Panel("adaptive grid", {"grid": "adaptive"}, "C18.F5c"),
    Panel("regular grid (ours, not published)", {"grid": "regular"}),
]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_8_6, writes OUT/figure_8_6.svg, .png and .csv."""
    return draw_scaling("figure_8_6", PANELS, [PLAIN_CURVES, VERTICES, NOMINAL], (results, out))


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
