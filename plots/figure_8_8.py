#!/usr/bin/python3
"""Figure 8.8 of Krestenitis (2018): producer-consumer tasks with 1000 particles, runtime over threads."""
import sys
from pathlib import Path

from figure import Drawn, command_line
from scaling import Panel, draw_scaling

PANELS = [
    Panel("regular grid", {"grid": "regular"}, "C18.F7a", anchor="C18.F5a"),
    Panel("adaptive grid", {"grid": "adaptive"}, "C18.F7b", anchor="C18.F5b"),
]
NOTES = [
    "Published curves (Krestenitis and Weinzierl 2018, figure 7, another machine of 2016) show their shape only. Their "
    "one-thread task run takes half the time of their one-thread plain run, about its own time on two threads: probably "
    "one traversing and one working thread. They are therefore scaled so that the plain one-thread value equals ours.",
    "The source prints \"triangles per particle\" for what is the number of hull input points, here vertices: at most "
    "2 N - 4 triangles for N of them.",
]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_8_8, writes OUT/figure_8_8.svg, .png and .csv."""
    return draw_scaling("figure_8_8", PANELS, NOTES, (results, out))


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
