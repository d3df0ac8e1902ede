#!/usr/bin/python3
"""Scale and units: answers of kernels that do not scale bit for bit, and the motion of a scaled scene."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import Drawn, command_line
from stability import Line, Panel, draw_panels, worst

NAME = "stability_scale"
KERNELS = ("brute_double", "brute-simd_double", "brute-simd_mixed", "brute-simd_float", "iterative_double", "hybrid-pair_double",
           "hybrid-batch_double")
LINES = [Line(kernel.replace("_", ", "), "scale", f"changed_share_{kernel}") for kernel in KERNELS]
PANELS = [
    Panel(LINES, "k: pairs are scaled by 2$^k$", "share of answers that change", log="y", floor=1e-4),
    Panel([Line("features", "similarity", "trajectory_difference")], "size of the scene", "difference of the motion / size", log="xy",
          floor=1e-17),
]


def notes(sweep) -> list[str]:
    return [f"{line.label}: {worst(sweep, line):.1%} of the answers change at worst." for line in LINES] + [
        "Scenes of 4, 16 and 64 times the size move the same bit for bit; others as rounding and chaos let them."]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_scale, writes OUT/stability_scale.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
