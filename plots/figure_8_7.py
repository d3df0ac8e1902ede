#!/usr/bin/python3
"""Figure 8.7 of Krestenitis (2018): what the threads do during a step of the producer-consumer scheme."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from figure import COLOURS, STYLE, Drawn, command_line, foot, head, save
from records import load_sweep
from timeline import Timeline, median_step

NAME = "figure_8_7"
KINDS = {"traverse": ("traversal of the grid", COLOURS[1]), "compare": ("comparison of bodies", COLOURS[0]),
         "merge": ("merge", COLOURS[4]), "forces": ("forces", COLOURS[2]), "integrate": ("integration", COLOURS[3]),
         "grid": ("grid", COLOURS[5]), "serial": ("one thread alone", "black")}


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_8_7 and its traces, writes OUT/figure_8_7.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    drawn = sorted(sweep.drawn(), key=lambda point: point.params["threads"])
    steps = [median_step(sweep.folder / "traces" / f"{point.id}.json", point.params["threads"]) for point in drawn]
    with matplotlib.rc_context(STYLE):
        height = 2.4 + 0.5 * sum(step.threads + 1 for step in steps)
        figure = Figure(figsize=(9, height))
        if steps:
            heights = [step.threads + 0.6 for step in steps]
            axes = figure.subplots(len(steps), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
            for axis, step in zip(axes, steps):
                draw_step(axis, step)
            axes[-1].set_xlabel("time since the beginning of the step (µs)")
            figure.legend(handles=[Patch(color=colour, label=label) for label, colour in KINDS.values()], ncol=4, fontsize=8.5,
                          loc="lower center", frameon=False, bbox_to_anchor=(0.5, 0.4 / height))
        head(figure, sweep)
        foot(figure, sweep)
        figure.subplots_adjust(left=0.1, right=0.96, top=1 - 0.7 / height, bottom=1.3 / height, hspace=0.25)
    rows = [[step.threads, step.step, bar.thread, bar.what, f"{bar.begin:.3f}", f"{bar.length:.3f}"]
            for step in steps for bar in step.bars]
    notes = [sentence(step) for step in steps]
    absent = [f"{point.name}: {point.state}." for point in sweep.points if point not in drawn]
    return save(figure, Drawn(NAME, sweep, out, [*notes, *absent]),
                ["threads", "step", "thread", "what", "begin_us", "length_us"], rows)


def draw_step(axis, step: Timeline) -> None:
    """A row of bars per thread; white is idle."""
    for what, (_, colour) in KINDS.items():
        for thread in range(step.threads):
            spans = [(bar.begin, bar.length) for bar in step.bars if bar.thread == thread and bar.what == what]
            axis.broken_barh(spans, (thread - 0.4, 0.8), facecolors=colour, linewidth=0)
    axis.set(yticks=range(step.threads), ylim=(step.threads - 0.5, -0.5), ylabel="thread")
    axis.set_title(f"{step.threads} thread{'s' if step.threads > 1 else ''}, {step.wall:.0f} µs", fontsize=10, loc="left")
    axis.grid(visible=False)


def sentence(step: Timeline) -> str:
    """What the threads' time of the step went to."""
    shares = {what: step.share(what) for what in KINDS}
    idle = 1 - sum(shares.values())
    return (f"{step.threads} thread{'s' * (step.threads > 1)}, step of median time: {100 * shares['compare']:.1f} % of the threads' time compares bodies, "
            f"{100 * shares['traverse']:.1f} % traverses, one thread alone works for {100 * shares['serial'] * step.threads:.2f} % "
            f"of the step, {100 * idle:.1f} % is idle or overhead.")


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
