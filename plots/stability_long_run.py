#!/usr/bin/python3
"""Long runs: energy error of 1000 elastic bounces, and what each step control costs for it."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import GREY, COLOURS, MARKERS, Drawn, command_line
from stability import Line, Panel, draw_panels, found

NAME = "stability_long_run"
CONTROLS = ("fixed", "approach", "gap-only")
STEPS = {10.3: "10", 20.3: "20", 40.3: "40", 80.3: "80"}
LAWS = {"spring-dashpot": "linear spring", "hertz-mindlin": "Hertz"}


def lines(metric: str, law: str) -> list[Line]:
    return [Line(control, "long-run", metric, {"control": control, "law": law}) for control in CONTROLS]


PANELS = [Panel(lines("rms_energy_error", law), "steps per contact N", f"rms dE/E, {name}", over="steps_per_contact", floor=1e-8, ticks=STEPS)
          for law, name in LAWS.items()]


def cost(axis, sweep) -> None:
    """Error over steps per bounce; what fails stands at the top."""
    failed = []
    for control, colour, marker in zip(CONTROLS, COLOURS, MARKERS):
        errors, steps = (found(sweep, line, "steps_per_contact") for line in
                         (lines(metric, "spring-dashpot")[CONTROLS.index(control)] for metric in ("rms_energy_error", "steps_per_bounce")))
        known = [(s[1], e[1]) for s, e in zip(steps, errors) if e[1] is not None]
        axis.plot([s for s, _ in known], [e for _, e in known], color=colour, marker=marker, label=control)
        lost = len(errors) - len(known)
        if lost:
            axis.text(0.03, 0.03 + 0.06 * len(failed), f"{control}: through the floor at {lost} of {len(errors)} steps", color=colour,
                      fontsize=8, transform=axis.transAxes)
            failed.append(control)
    axis.axhline(5e-2, color=GREY, linewidth=0.8)
    axis.set(xscale="log", yscale="log", xlabel="steps per bounce", ylabel="rms dE/E, linear spring")
    axis.legend(fontsize=8)


def notes(sweep) -> list[str]:
    at = {control: next((y for x, y, _ in found(sweep, lines("steps_per_bounce", "spring-dashpot")[i], "steps_per_contact")
                         if x == 20.3), None) for i, control in enumerate(CONTROLS)}
    said = [f"At N = 20.3, {control} takes {steps:.0f} steps per bounce." for control, steps in at.items() if steps]
    return [*said, "With approach contacts begin at any phase of a step, so that errors do not add up: at equal error it needs about a "
            "tenth of the steps.", "Crosses: the ball went through the floor, as gap-only lets it, for it looks at gaps and not at speeds."]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_long_run, writes OUT/stability_long_run.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out, extra=cost)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
