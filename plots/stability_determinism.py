#!/usr/bin/python3
"""Determinism: states that differ from the serial ones, for every scheme, runtime and number of threads."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import Drawn, command_line
from stability import draw_matrix

NAME = "stability_determinism"
SCHEMES = ("plain_openmp", "plain_tbb", "task_openmp", "task_tbb")


def cells(sweep) -> dict:
    """Grids (of three) whose last state differs."""
    found = {}
    for point in sweep.drawn():
        threads = round(point.params["value"])
        row = f"{point.params['contact_rule']}, {threads} thread{'s' if threads > 1 else ''}"
        for scheme in SCHEMES:
            differ = round(point.record["metrics"][f"different_states_{scheme}"]["value"])
            found[row, scheme.replace("_", ", ")] = ("same bits", "#009E73") if differ == 0 else (f"{differ} of 3 differ", "#D55E00")
    return found


def notes(sweep) -> list[str]:
    contacts = min((p.record["metrics"]["contacts"]["value"] for p in sweep.drawn()), default=0)
    return [f"Each cell: three grids after 1000 steps with {contacts:.0f} or more contacts in all, against one serial thread without a grid."]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_determinism, writes OUT/stability_determinism.svg, .png and .csv."""
    return draw_matrix(NAME, tuple(scheme.replace("_", ", ") for scheme in SCHEMES), cells, notes, results, out)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
