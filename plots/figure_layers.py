#!/usr/bin/python3
"""Layers of parallelism, alone and combined: runtime over threads for 10 to 120 vertices per particle."""
import sys
from pathlib import Path

from figure import Drawn, command_line
from records import Point, load_sweep
from scaling import Panel, draw_scaling

NAME = "figure_layers"
PUBLISHED = {"triangle": "P17.F3"}
NOTES = [
    "Published curves (Krestenitis, Weinzierl and Koziara 2017, figure 3, brute force; another machine of 2013) show their shape "
    "only: each is scaled so that its one-thread value equals ours. Krestenitis and Weinzierl (2018), figure 4, print seconds "
    "of two particles that are probably CPU time over cores, and are not laid on.",
    "Krestenitis, Weinzierl and Koziara (2017), figure 4, give grid and triangles threads of their own, 1 x 12 to 12 x 1; here "
    "one team serves both layers, and whoever is idle takes what there is.",
]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_layers, writes OUT/figure_layers.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    layers = dict.fromkeys(point.params["layers"] for point in sweep.points)
    panels = [Panel(f"layers: {each}", {"layers": each}, PUBLISHED.get(each)) for each in layers]
    return draw_scaling(NAME, panels, [*NOTES, *_triangles_to_share(sweep.drawn())], (results, out))


def _triangles_to_share(points: list[Point]) -> list[str]:
    """What the pre-check leaves of a body pair for the triangle layer, measured on one thread."""
    left = {}
    for point in points:
        counts = point.record.get("counts", {})
        if point.params["layers"] == "triangle" and point.params["threads"] == 1 and counts.get("searched_pairs"):
            left[point.params["vertices"]] = counts["triangle_pairs"] / counts["searched_pairs"]
    if not left:
        return []
    few, many = min(left), max(left)
    return [f"Of a body pair the pre-check leaves {left[few]:.0f} triangle pairs on average ({few} vertices) to {left[many]:.0f} ({many}). "
            "The triangle layer hands out parts of 256: with much fewer it has little to share, and stops at one thread."]


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
