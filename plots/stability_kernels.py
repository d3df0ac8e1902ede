#!/usr/bin/python3
"""The iterative kernel after each number of steps: error, and whether it knows when it is wrong; hybrid beside."""
import packages  # noqa: F401, I001: before all that need them
import math
import sys
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from figure import COLOURS, MARKERS, STYLE, Drawn, command_line, foot, head, save
from kernel_points import found
from records import Sweep, load_sweep

NAME = "stability_kernels"
SCHEDULES = ("constant", "stiff", "growing")
METRICS = {"error_p99_S": "99th percentile of |d - d*| / S", "wrong_share": "share wrong",
           "believed_wrong_share": "share that passes the usual test and is wrong",
           "wrong_unflagged_share": "share wrong and unflagged"}
FLOOR = {"error_p99_S": 1e-17}  # shares: 1e-6
HEADER = ["kernel", "schedule", "steps", *METRICS, "fall_back_share", "record"]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_kernels, writes OUT/stability_kernels.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(11, 7), layout="constrained")
        head(figure, sweep)
        for axis, (metric, label) in zip(figure.subplots(2, 2).ravel(), METRICS.items()):
            panel(axis, sweep, metric)
            axis.set(xscale="log", yscale="log", xlabel="Newton steps", ylabel=label, ylim=(FLOOR.get(metric, 1e-6) / 3, 3))
            axis.set_xticks([1, 2, 4, 8, 16], ["1", "2", "4", "8", "16"])
            axis.minorticks_off()
        figure.axes[0].legend(fontsize=8)
        foot(figure, sweep)
        figure.get_layout_engine().set(rect=(0, 0.05, 1, 0.95))
        rows = [[p.params["kernel"], p.params["schedule"], p.params["steps"], *(found(p, m) for m in METRICS),
                 found(p, "fall_back_share"), p.id] for p in sweep.drawn()]
        return save(figure, Drawn(NAME, sweep, out, notes(sweep)), HEADER, rows)


def panel(axis, sweep: Sweep, metric: str) -> None:
    """Solid: iterative; dashed: hybrid-pair."""
    floor = FLOOR.get(metric, 1e-6)
    for kernel, dash in (("iterative", "-"), ("hybrid-pair", "--")):
        for schedule, colour, marker in zip(SCHEDULES, COLOURS, MARKERS):
            points = sorted((p.params["steps"], found(p, metric)) for p in sweep.drawn()
                            if p.params["kernel"] == kernel and p.params["schedule"] == schedule)
            points = [(x, max(floor, y)) for x, y in points if math.isfinite(y)]
            axis.plot([x for x, _ in points], [y for _, y in points], dash, color=colour, marker=marker,
                      label=f"{kernel}, {schedule}" if points else None)


def notes(sweep: Sweep) -> list[str]:
    def most(kernel: str, metric: str, schedule: str | None = None) -> float:
        return max((found(p, metric) for p in sweep.drawn()
                    if p.params["kernel"] == kernel and schedule in (None, p.params["schedule"])), default=math.nan)

    return [f"Hybrids: wrong and unflagged at most {most('hybrid-pair', 'wrong_unflagged_share'):.1%}.",
            f"Growing, the published schedule: up to {most('iterative', 'wrong_share', 'growing'):.0%} wrong, and "
            f"{most('iterative', 'believed_wrong_share', 'growing'):.0%} of all answers pass their own test and are wrong.",
            "The bounds flag every wrong answer of the iterative kernel: it is never wrong and proven."
            if most("iterative", "wrong_unflagged_share") == 0 else "Some answers of the iterative kernel are wrong and proven.",
            "Shares below 1e-6, zero among them, are drawn there."]


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
