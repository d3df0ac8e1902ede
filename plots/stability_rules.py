#!/usr/bin/python3
"""Every contact rule against every bar: cut faces, closed paths, rest on a face, a stack; and what the rule costs."""
import packages  # noqa: F401, I001: before all that need them
import math
import sys
from pathlib import Path

from figure import GREY, Drawn, command_line
from stability import RULES, Line, Panel, by_rule, cell, draw_panels, found, outside, worst

NAME = "stability_rules"
CUTS = {1: "1", 2: "2", 4: "4", 8: "8", 16: "16"}


def up_to(most: int) -> dict[int, str]:
    return {cuts: label for cuts, label in CUTS.items() if cuts <= most}


CUT_FACES = {"overlap_change": "static overlap, change", "contact_time_change": "contact time, change",
             "restitution_change": "restitution, change", "critical_step_change": "critical step, change"}
PANELS = [
    *(Panel(by_rule("tessellation", metric), "cuts of a face's edge", label, ticks=CUTS) for metric, label in CUT_FACES.items()),
    Panel(by_rule("loop-work", "loop_work"), "cuts of a face's edge", "work of a closed path / energy stored", ticks=up_to(4)),
    Panel([Line(f"{rule}, {points} points", "loop-work", metric, {"contact_rule": rule})
           for rule in ("dedupe", "nearest", "features")
           for points, metric in ((2500, "loop_work_at_2500_points"), (40000, "loop_work"))],
          "cuts of a face's edge", "the same, coarse and fine", ticks=up_to(4)),
    Panel(by_rule("face-rest", "wander_of_edge"), "cuts of a face's edge", "wander of the contact point / edge", ticks=CUTS),
    Panel(by_rule("face-rest", "torque_of_weight_edge"), "cuts of a face's edge", "torque at rest / (weight edge)", ticks=CUTS),
    Panel(by_rule("stack", "interface_load_error"), "cuts of a face's edge", "load of an interface / i m g - 1", ticks=up_to(2)),
    Panel(by_rule("stack", "kinetic_of_m_g_overlap"), "cuts of a face's edge", "kinetic energy of a stack / (m g overlap)",
          ticks=up_to(2)),
    Panel(by_rule("rule-cost", "microseconds"), "cuts of a face's edge", "microseconds per body pair", ticks=CUTS),
]
BARS = [("tessellation", metric) for metric in CUT_FACES] + [
    ("loop-work", "loop_work"), ("face-rest", "wander_of_edge"), ("face-rest", "torque_of_weight_edge"),
    ("stack", "interface_load_error"), ("stack", "lateral_of_edge"), ("stack", "kinetic_of_m_g_overlap")]


def held(sweep, rule: str) -> list[str]:
    """The metrics whose bar a rule holds at every cut that was run."""
    bad = {(p.params["study"], metric) for p, metric in outside(sweep) if p.params["contact_rule"] == rule}
    seen = {(study, metric) for study, metric in BARS if found(sweep, Line("", study, metric, {"contact_rule": rule}), "value")}
    return [f"{study} {metric}" for study, metric in BARS if (study, metric) in seen - bad]


def verdicts(axis, sweep) -> None:
    """Rows of metrics, columns of rules: green where every cut is within the bar; the number is the worst value."""
    axis.set_axis_off()
    axis.set(xlim=(-1.6, len(RULES)), ylim=(len(BARS), -1))
    for column, rule in enumerate(RULES):
        axis.text(column + 0.5, -0.5, rule, ha="center", va="center", fontsize=8)
        for row, (study, metric) in enumerate(BARS):
            value = worst(sweep, Line("", study, metric, {"contact_rule": rule}))
            good = f"{study} {metric}" in held(sweep, rule)
            cell(axis, column, row, "not run" if math.isnan(value) else f"{value:.0e}",
                 "#CCCCCC" if math.isnan(value) else "#009E73" if good else "#D55E00")
    for row, (study, metric) in enumerate(BARS):
        axis.text(-0.1, row + 0.5, metric.replace("_", " "), ha="right", va="center", fontsize=7, color=GREY)


def notes(sweep) -> list[str]:
    return ["Green: within the bar. Values below 1e-12 are drawn at 1e-12.",
            *(f"{rule} holds {len(held(sweep, rule))} of {len(BARS)} bars." for rule in RULES),
            "nearest is a potential too: its work falls with the number of points on the path, dedupe's does not.",
            "Choose features for bodies with flat faces; all-pairs and dedupe are the published rules."]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_rules, writes OUT/stability_rules.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out, columns=4, extra=verdicts)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
