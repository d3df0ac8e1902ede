#!/usr/bin/python3
"""Mesh pairs: share of the true contacts that were found against pairs per second."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
from figure import STYLE, Drawn, Figure, command_line, foot, head, save
from kernel_points import PEERS, PRECISION_MARKERS, colour, found, median, ran
from records import DRAWN, Point, load_sweep

HEADER = ["family", "kernel", "precision", "precheck", "state", "median_us_per_mesh_pair", "recall", "contacts_per_pair",
          "times_fcl", "record"]
NOTES = ["A share of 1 is asked for always: a kernel of ours that proves its answers and finds less is a bug, and is not "
         "drawn. FCL answers with the nearest contact only, and ODE only where surfaces cross."]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_w_2, writes OUT/figure_w_2.svg, .png and .csv."""
    sweep = load_sweep(results, "figure_w_2")
    families = list(dict.fromkeys(point.params["family"] for point in sweep.points))
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(max(8, 1 + 4.5 * len(families)), 4.6), layout="constrained")
        for axes, family in zip(figure.subplots(1, len(families), squeeze=False, sharey=True).flat, families):
            axes.set(title=family, xscale="log", xlabel="mesh pairs per second, one thread", ylim=(-0.05, 1.15))
            for point in (p for p in sweep.drawn() if p.params["family"] == family):
                _mark(axes, point)
        figure.axes[0].set_ylabel("share of the true contacts found")
        figure.get_layout_engine().set(rect=(0, 0.06, 1, 0.94))
        head(figure, sweep)
        foot(figure, sweep)
        rows = [_row(point, sweep.drawn()) for point in sweep.points]
        return save(figure, Drawn("figure_w_2", sweep, out, NOTES), HEADER, rows)


def _mark(axes, point: Point) -> None:
    kernel, rate, recall = point.params["kernel"], 1e9 / median(point), found(point, "recall")
    axes.plot(rate, recall, PRECISION_MARKERS[ran(point, "precision")], color=colour(kernel))
    name = kernel if kernel in PEERS else f"{kernel} {ran(point, 'precision')} {ran(point, 'precheck')}"
    low = recall < 0.5
    axes.annotate(name, (rate, recall), xytext=(2, 6) if low else (2, -7), textcoords="offset points", fontsize=7, rotation=60,
                  va="bottom" if low else "top", ha="left" if low else "right", color=colour(kernel))


def _row(point: Point, drawn: list[Point]) -> list:
    params = [point.params[key] for key in ("family", "kernel", "precision", "precheck")]
    if point.state != DRAWN:
        return [*params, point.state, "", "", "", "", point.id]
    fcl = [median(p) for p in drawn if p.params["kernel"] == "fcl" and p.params["family"] == point.params["family"]]
    ratio = f"{fcl[0] / median(point):.4g}" if fcl else ""
    return [*params, point.state, f"{median(point) / 1e3:.6g}", f"{found(point, 'recall'):.6g}",
            f"{found(point, 'contacts_per_pair'):.6g}", ratio, point.id]


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
