#!/usr/bin/python3
"""Kernels: time per triangle pair against the error of the distance, with failures in a gutter."""
import packages  # noqa: F401, I001: before all that need them
import math
import sys
from pathlib import Path

import matplotlib
from figure import GREY, STYLE, Drawn, command_line, foot, head, save
from kernel_points import PEERS, PRECISION_MARKERS, WALL, colour, family_panels, found, label_outside, median, nanoseconds, ran
from records import DRAWN, Point, load_sweep

COLUMNS = 4  # of panels, at most
GUTTER = 10.0  # height at which pairs without a usable answer are drawn
HEADER = ["family", "kernel", "precision", "lanes", "steps", "state", "median_ns", "min_ns", "max_ns", "error_p50_S",
          "error_p99_S", "error_max_S", "wrong_share", "wrong_unflagged_share", "fall_back_share", "peak_share",
          "roofline_share", "record"]
NOTES = [
    "A method is worth its time where no other mark lies both left of and below its own.",
    "Errors of 0 are drawn at 1e-17. The gutter holds methods with answers that are no number, and names those "
    "that failed their check and were not timed. The larger the mark, the more lanes; numbers beside marks: Newton steps of the iterative kernel.",
]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_w_1, writes OUT/figure_w_1.svg, .png and .csv."""
    sweep = load_sweep(results, "figure_w_1")
    with matplotlib.rc_context(STYLE):
        figure, panels = family_panels(sweep, COLUMNS, 3.6, (3.2, 1.6))
        for family, axes in panels.items():
            _panel(axes, family, [p for p in sweep.points if p.params["family"] == family])
        below = 0.5 / figure.get_figheight()
        figure.get_layout_engine().set(rect=(0, below, 1 - 1.6 / figure.get_figwidth(), 1 - below))
        _legend(figure)
        label_outside(figure, COLUMNS, "CPU time per triangle pair (ns), one thread", "99th percentile of |d - d*| / S")
        head(figure, sweep)
        foot(figure, sweep)
        return save(figure, Drawn("figure_w_1", sweep, out, NOTES), HEADER, [_row(point) for point in sweep.points])


def _panel(axes, family: str, points: list[Point]) -> None:
    axes.set(title=family, xscale="log", yscale="log", ylim=(WALL / 3, 10 * GUTTER))
    axes.axhspan(GUTTER / 4, 10 * GUTTER, color="#f3d9d9", zorder=0)
    axes.axhline(2.2e-16, color=GREY, linewidth=0.7, linestyle=":")
    failed = dict.fromkeys(point.params["kernel"] for point in points if "failed" in point.state)
    if failed:
        axes.text(0.02, GUTTER, f"failed: {', '.join(failed)}", transform=axes.get_yaxis_transform(), fontsize=7, va="center")
    for point in points:
        if not (point.record and point.record["samples"]):
            continue
        error, times = found(point, "error_p99_S"), nanoseconds(point)
        good = point.state == DRAWN and math.isfinite(error)
        kernel = point.params["kernel"]
        middle, height = median(point), max(error, WALL) if good else GUTTER
        axes.plot(times[::len(times) - 1] if len(times) > 1 else times, [height] * min(len(times), 2), color=colour(kernel))
        axes.plot(middle, height, PRECISION_MARKERS[ran(point, "precision")], color=colour(kernel),
                  markersize=4 + 1.5 * math.log2(ran(point, "lanes")), markerfacecolor=colour(kernel) if found(point, "wrong_share") == 0 else "white")
        note = ran(point, "steps") if kernel == "iterative" else kernel if kernel in PEERS else ""
        axes.annotate(note, (middle, height), xytext=(4, 4), textcoords="offset points", fontsize=7, color=colour(kernel))


def _legend(figure) -> None:
    from matplotlib.lines import Line2D
    kernels = ("brute", "brute-simd", "hybrid-pair", "hybrid-batch", "iterative", "peers")
    marks = [Line2D([], [], color=colour(name), marker="s", linestyle="", label=name) for name in kernels]
    marks += [Line2D([], [], color=GREY, marker=marker, linestyle="", label=name)
              for name, marker in PRECISION_MARKERS.items()]
    marks.append(Line2D([], [], color=GREY, marker="o", markerfacecolor="white", linestyle="", label="some answers wrong"))
    figure.legend(handles=marks, loc="upper right", fontsize=7, ncols=1)


def _row(point: Point) -> list:
    if point.state != DRAWN:
        return [point.params["family"], point.params["kernel"], point.params.get("precision"), point.params.get("lanes"),
                point.params.get("steps"), point.state, *[""] * 11, point.id]
    times, ns = nanoseconds(point), median(point)
    flops, peak, roofline = (found(point, key) for key in ("flops_per_pair", "peak_flop_s", "roofline_ns_per_pair"))
    values = [ns, times[0], times[-1], *(found(point, key) for key in (
        "error_p50_S", "error_p99_S", "error_max_S", "wrong_share", "wrong_unflagged_share", "fall_back_share")),
        flops / ns * 1e9 / peak, roofline / ns]
    shown = [f"{value:.6g}" if math.isfinite(value) else "" for value in values]
    return [point.params["family"], point.params["kernel"], ran(point, "precision"), ran(point, "lanes"),
            ran(point, "steps"), point.state, *shown, point.id]


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
