#!/usr/bin/python3
"""Figure 8.9 of Krestenitis (2018): producer-consumer tasks with 10 000 particles, runtime over threads."""
import sys
from pathlib import Path

from figure import Drawn, command_line
from scaling import NOMINAL, TASK_CURVES, VERTICES, Panel, draw_scaling

PANELS = [
    Panel("adaptive grid", {"grid": "adaptive"}, "C18.F7c", anchor="C18.F5c"),
]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_8_9, writes OUT/figure_8_9.svg, .png and .csv."""
    return draw_scaling("figure_8_9", PANELS, [TASK_CURVES, VERTICES, NOMINAL], (results, out))


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
