#!/usr/bin/python3
"""Where the step and the halo fail: rebound, long runs, response limit, critical step, overlap release, cut floors."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from figure import COLOURS, GREY, MARKERS, STYLE, Drawn, command_line, credit, save
from records import DRAWN, Sweep, load_sweep

NAME = "figure_stability_limits"
LAWS = ("spring-dashpot", "hertz-mindlin")


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_stability_limits, writes OUT/figure_stability_limits.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(11, 7.2))
        figure.suptitle(f"{sweep.title} ({sweep.preset})", fontsize=12)
        axes = figure.subplots(2, 3).ravel()
        over_steps(axes[0], sweep, "rebound", "restitution_error", "|e - 1|, worst phase")
        steps = np.array([5, 200])
        axes[0].plot(steps, (np.pi / steps) ** 2 / 8, color=GREY, linewidth=0.8)
        axes[0].annotate("(pi/N)$^2$/8", (60, (np.pi / 60) ** 2 / 8 * 1.4), color=GREY, fontsize=8)
        over_steps(axes[1], sweep, "long-run", "rms_energy_error", "rms dE/E of 1000 bounces")
        over_value(axes[2], sweep, "tunnelling", "passed_through", "passed through", "speed / response limit")
        axes[2].axvline(1, color=GREY, linewidth=0.8)
        over_value(axes[3], sweep, "step-limit", "observed_over_predicted_less_1", "observed / predicted step - 1", "")
        axes[3].set_xticks([0, 1, 2], ["ball", "cube on face", "three cubes"])
        axes[3].axhspan(-0.05, 0.02, color="#009E73", alpha=0.12)
        over_value(axes[4], sweep, "cut-floor", "ripple_of_weight", "ripple of the force / weight", "cuts of the floor")
        axes[4].set(xscale="log", yscale="log")
        over_value(axes[5], sweep, "mass-ratio", "height_error_of_edge", "height error / edge", "mass ratio")
        axes[5].set(xscale="log", yscale="log")
        figure.text(0.5, 0.008, credit(sweep), ha="center", va="bottom", fontsize=7.5, color=GREY)
        figure.tight_layout(rect=(0, 0.04, 1, 0.97))
        rows = [[p.params["study"], p.params["law"], p.params["contact_rule"], p.params["steps_per_contact"],
                 p.params["value"], name, m["value"], m["bar"], m["within"]]
                for p in sweep.points if p.state == DRAWN for name, m in p.record["metrics"].items()]
        notes = ["N is the number of steps per contact; 20 keep the restitution within 0.3 %, 50 within 0.05 %.",
                 "Below the response limit no ball passes; what passes above it is reported by the run."]
        return save(figure, Drawn(NAME, sweep, out, notes), ["study", "law", "contact_rule", "steps_per_contact", "value",
                                                             "metric", "found", "bar", "within"], rows)


def found(sweep: Sweep, study: str, key: str, group: str, metric: str, name: str) -> tuple[list, list]:
    """Values of a metric over a parameter, for one law or rule."""
    pairs = sorted((p.params[key], p.record["metrics"][metric]["value"]) for p in sweep.points
                   if p.state == DRAWN and p.params["study"] == study and p.params[group] == name)
    pairs = [(x, y) for x, y in pairs if y is not None]
    return [x for x, _ in pairs], [y for _, y in pairs]


def over_steps(axis, sweep: Sweep, study: str, metric: str, label: str) -> None:
    for law, colour, marker in zip(LAWS, COLOURS, MARKERS):
        steps, errors = found(sweep, study, "steps_per_contact", "law", metric, law)
        slope = np.polyfit(np.log(steps), np.log(errors), 1)[0] if len(steps) > 1 and min(errors) > 0 else np.nan
        axis.plot(steps, errors, color=colour, marker=marker, label=f"{law}, slope {slope:.2f}")
    axis.set(xscale="log", yscale="log", xlabel="steps per contact N", ylabel=label)
    axis.legend(fontsize=8)


def over_value(axis, sweep: Sweep, study: str, metric: str, label: str, below: str) -> None:
    for rule, colour, marker in zip(("features", "nearest", "dedupe"), COLOURS, MARKERS):
        values, errors = found(sweep, study, "value", "contact_rule", metric, rule)
        if values:
            axis.plot(values, errors if "observed" in metric or "passed" in metric else [max(1e-16, abs(e)) for e in errors],
                      color=colour, marker=marker, label=rule)
    axis.set(xlabel=below, ylabel=label)
    if study == "cut-floor":
        axis.legend(fontsize=8)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
