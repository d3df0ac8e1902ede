#!/usr/bin/python3
"""Every contact rule against every bar: cut faces, closed paths, rest on a face, a stack; and what the rule costs."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from figure import COLOURS, GREY, MARKERS, STYLE, Drawn, command_line, credit, save
from records import DRAWN, load_sweep

NAME = "figure_stability_rules"
RULES = ("all-pairs", "dedupe", "nearest", "features")
PANELS = (("tessellation", "overlap_change", "change of the static overlap"),
          ("tessellation", "restitution_change", "change of the restitution"),
          ("tessellation", "critical_step_change", "change of the critical step"),
          ("loop-work", "loop_work", "work of a closed path / energy stored"),
          ("face-rest", "torque_of_weight_edge", "torque at rest / (weight edge)"),
          ("stack", "kinetic_of_m_g_overlap", "kinetic energy of a stack / (m g overlap)"))
FLOOR = 1e-12  # smaller values, exact zeros among them, are drawn here


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_stability_rules, writes OUT/figure_stability_rules.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    rows = []
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(11, 7.2))
        figure.suptitle(f"{sweep.title} ({sweep.preset})", fontsize=12)
        for place, (study, metric, label) in enumerate(PANELS):
            axis = figure.add_subplot(2, 3, place + 1)
            for rule, colour, marker in zip(RULES, COLOURS, MARKERS):
                found = sorted((p.params["value"], p.record["metrics"][metric]) for p in sweep.points
                               if p.state == DRAWN and p.params["study"] == study and p.params["contact_rule"] == rule)
                known = [(cuts, m) for cuts, m in found if m["value"] is not None]
                axis.plot([c for c, _ in known], [max(FLOOR, abs(m["value"])) for _, m in known], color=colour,
                          marker=marker, label=rule)
                bar = next((m["bar"] for _, m in found if m["bar"] is not None), None)
                if bar is not None and rule == RULES[-1]:
                    axis.axhspan(FLOOR / 3, bar, color="#009E73", alpha=0.12, zorder=0)
                rows += [[study, rule, cuts, metric, m["value"], m["bar"], m["within"]] for cuts, m in found]
            axis.set(xscale="log", yscale="log", ylabel=label, xlabel="cuts of a face's edge", ylim=(FLOOR / 3, 1e2))
            axis.set_xticks([1, 2, 4, 8, 16], ["1", "2", "4", "8", "16"])
            axis.minorticks_off()
            if place == 0:
                axis.legend(fontsize=8)
        figure.text(0.5, 0.008, credit(sweep), ha="center", va="bottom", fontsize=7.5, color=GREY)
        figure.tight_layout(rect=(0, 0.04, 1, 0.97))
        notes = ["Green: within the bar. Values below 1e-12 are drawn at 1e-12.",
                 "Choose features for bodies with flat faces; all-pairs and dedupe are the published rules."]
        return save(figure, Drawn(NAME, sweep, out, notes),
                    ["study", "contact_rule", "cuts", "metric", "value", "bar", "within"], rows)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
