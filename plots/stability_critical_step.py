#!/usr/bin/python3
"""Critical step: the largest step that is stable, found by bisection, over the one that the engine predicts."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import GREY, Drawn, command_line
from stability import GREEN, Line, Panel, draw_panels, outside, worst

NAME = "stability_critical_step"
SCENES = {0: "ball", 1: "cube,\nsmooth", 2: "cube", 3: "cube,\ncut", 4: "three\ncubes", 5: "turned\ncubes"}
DAMPING = (0, 30, 80)


def bar(axis) -> None:
    axis.axhspan(0.95, 1.02, color=GREEN, alpha=0.12, zorder=0)
    axis.axhline(1, color=GREY, linewidth=0.8)


PANELS = [
    Panel([Line(f"damping ratio {z / 100:g}", "critical-step", f"observed_over_predicted_at_damping_{z}_percent",
                {"law": "spring-dashpot"}) for z in DAMPING] +
          [Line("Hertz-Mindlin, undamped", "critical-step", "observed_over_predicted_at_damping_0_percent",
                {"law": "hertz-mindlin"})], "", "observed / predicted critical step", log="", ticks=SCENES, guide=bar),
    Panel([Line("2 sqrt(m / k)", "critical-step", "textbook_over_observed", {"law": "spring-dashpot"})], "",
          "textbook 2 sqrt(m / k) over observed", log="", ticks=SCENES, guide=lambda axis: axis.axhline(1, color=GREY, linewidth=0.8)),
]


def notes(sweep) -> list[str]:
    smooth = worst(sweep, Line("", "critical-step", "textbook_over_observed", {"value": 1, "law": "spring-dashpot"}))
    return [f"{len(outside(sweep))} of the observed steps are outside .95 to 1.02 of the predicted ones.",
            f"The textbook's 2 sqrt(m / k) is {smooth:.2f} times too long for a cube on its face (sqrt(6) = 2.45)."]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_critical_step, writes OUT/stability_critical_step.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
