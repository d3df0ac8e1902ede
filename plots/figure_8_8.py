#!/usr/bin/python3
"""Figure 8.8 of Krestenitis (2018): producer-consumer tasks with 1000 particles, runtime over threads."""
import sys
from pathlib import Path

from figure import Drawn, command_line
from scaling import TASK_CURVES, VERTICES, Panel, draw_scaling

PANELS = [
    Panel("regular grid", {"grid": "regular"}, "C18.F7a", anchor="C18.F5a"),
    Panel("adaptive grid", {"grid": "adaptive"}, "C18.F7b", anchor="C18.F5b"),
]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_8_8, writes OUT/figure_8_8.svg, .png and .csv."""
    return draw_scaling("figure_8_8", PANELS, [TASK_CURVES, VERTICES], (results, out))


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
