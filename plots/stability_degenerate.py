#!/usr/bin/python3
"""Meshes with defects and bodies that touch exactly: what runs, what is refused, what fails."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import Drawn, command_line
from stability import draw_matrix

NAME = "stability_degenerate"
OUTCOMES = {0: ("runs", "#009E73"), 1: ("refused", "#56B4E9"), 2: ("FAILS", "#D55E00")}
COLUMNS = ("moving", "fixed", "told")


def cells(sweep) -> dict:
    return {(metric.rpartition("_")[0].replace("_", " "), metric.rpartition("_")[2]): OUTCOMES[round(m["value"])]
            for point in sweep.drawn() for metric, m in point.record["metrics"].items()}


def notes(sweep) -> list[str]:
    failed = [row for (row, _), (word, _) in cells(sweep).items() if word == "FAILS"]
    return [f"{len(failed)} fail{': ' + ', '.join(failed) if failed else ''}. Refused: an open or flat surface has no mass, which is said "
            "in one sentence. Told: surfaces at distance 0 are counted as crossings, which fail a run's check."]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_degenerate, writes OUT/stability_degenerate.svg, .png and .csv."""
    return draw_matrix(NAME, COLUMNS, cells, notes, results, out)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
