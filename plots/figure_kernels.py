#!/usr/bin/python3
"""The published experiment on kernels: steps until proven, what hybrids redo, what the usual test believes, MFLOP/s."""
import sys
from pathlib import Path

import matplotlib
from figure import COLOURS, GREY, MARKERS, STYLE, Drawn, Figure, command_line, credit, save
from kernel_points import found, median, ran
from records import DRAWN, Point, load_sweep

HEADER = ["kernel", "lanes", "schedule", "steps", "batch", "tolerance_S", "state", "median_ns", "mflop_s", "peak_share",
          "fall_back_share", "wrong_share", "wrong_unflagged_share", "believed_share", "believed_wrong_share", "record"]
NOTES = [
    "Believed: neither point moved by more than the tolerance in the last step, the usual test of convergence; wrong: the "
    "distance is off by more. Ours flags an answer unless its bounds agree.",
    "flop/s count the declared additions, multiplications, divisions and roots of one separated pair.",
]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_kernels, writes OUT/figure_kernels.svg, .png and .csv."""
    sweep = load_sweep(results, "figure_kernels")
    drawn = sweep.drawn()
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(12, 8.4), layout="constrained")
        (histogram, redone), (believed, rate) = figure.subplots(2, 2)
        _histogram(histogram, drawn)
        _redone(redone, drawn)
        _believed(believed, drawn)
        _rate(rate, drawn)
        figure.get_layout_engine().set(rect=(0, 0.06, 1, 0.94))
        figure.text(0.01, 0.01, credit(sweep), fontsize=7, va="bottom")
        return save(figure, Drawn("figure_kernels", sweep, out, NOTES), HEADER, [_row(point) for point in sweep.points])


def _iterative(points: list[Point], steps: int) -> list[Point]:
    chosen = [p for p in points if p.params["kernel"] == "iterative" and p.params["steps"] == steps and p.params["lanes"] == 0]
    return chosen


def _histogram(axes, points: list[Point]) -> None:
    chosen = _iterative(points, 4)
    for number, point in enumerate(chosen):
        share = point.record["kernel"]["proven_after_steps"]
        left = [step + 0.27 * (number - (len(chosen) - 1) / 2) for step in range(len(share))]
        axes.bar(left, share, 0.25, color=COLOURS[number],
                 label=f"{point.params['schedule']}: {1 - sum(share):.0%} never")
    axes.set(title="Proven for the first time", xlabel="Newton steps", ylabel="share of pairs")
    axes.legend(fontsize=8)


def _redone(axes, points: list[Point]) -> None:
    groups: dict[str, list[Point]] = {}
    for point in points:
        if point.params["kernel"].startswith("hybrid") and point.params["lanes"] == 0:
            batch = f", batch {point.params['batch']}" if point.params["kernel"] == "hybrid-batch" else ""
            groups.setdefault(point.params["kernel"] + batch, []).append(point)
    for number, (name, group) in enumerate(groups.items()):
        group.sort(key=lambda p: p.params["tolerance"])
        axes.plot([p.params["tolerance"] for p in group], [found(p, "fall_back_share") for p in group],
                  marker=MARKERS[number % len(MARKERS)], color=COLOURS[number % len(COLOURS)], label=name)
    axes.set(title="Redone by brute force", xscale="log", xlabel="tolerance (S)", ylabel="share of pairs", ylim=(0, 1.05))
    axes.legend(fontsize=8)


def _believed(axes, points: list[Point]) -> None:
    chosen = [p for steps in (4, 8) for p in _iterative(points, steps)]
    names = [f"{p.params['schedule']}\n{p.params['steps']} steps" for p in chosen]
    for offset, key, colour, label in ((-0.2, "believed_wrong_share", COLOURS[1], "step test: believed, yet wrong"),
                                       (0.2, "wrong_unflagged_share", COLOURS[0], "bounds: unflagged, yet wrong")):
        bars = axes.bar([k + offset for k in range(len(chosen))], [found(p, key) for p in chosen], 0.38, color=colour,
                        label=label)
        axes.bar_label(bars, fmt="%.3g", fontsize=7)
    axes.set(title=f"Wrong by more than {chosen[0].params['tolerance']:g} S" if chosen else "", ylabel="share of pairs")
    axes.set_xticks(range(len(chosen)), names, fontsize=7)
    axes.legend(fontsize=8)


def _rate(axes, points: list[Point]) -> None:
    chosen = [p for p in points if p.params["tolerance"] == 1e-3 and p.params["schedule"] == "constant"
              and p.params["steps"] == 4 and p.params["batch"] == 8]
    names = [f"{p.params['kernel']}\n{ran(p, 'lanes')} lane{'s' * (ran(p, 'lanes') > 1)}" for p in chosen]
    values = [_mflops(p) for p in chosen]
    bars = axes.bar(range(len(chosen)), values, color=[COLOURS[0] if ran(p, "lanes") > 1 else GREY for p in chosen])
    axes.bar_label(bars, [f"{v:.0f}\n{median(p):.0f} ns" for v, p in zip(values, chosen)], fontsize=7)
    axes.set(title="Declared work per time", ylabel="MFLOP/s, one thread", ylim=(0, 1.2 * max(values, default=1)))
    axes.set_xticks(range(len(chosen)), names, fontsize=7, rotation=30)


def _mflops(point: Point) -> float:
    return 1e3 * found(point, "flops_per_pair") / median(point)


def _row(point: Point) -> list:
    params = [point.params[key] for key in ("kernel", "lanes", "schedule", "steps", "batch", "tolerance")]
    if point.state != DRAWN:
        return [*params, point.state, *[""] * 8, point.id]
    params[1] = ran(point, "lanes")
    shares = [found(point, key) for key in ("fall_back_share", "wrong_share", "wrong_unflagged_share", "believed_share",
                                            "believed_wrong_share")]
    values = [median(point), _mflops(point), 1e6 * _mflops(point) / found(point, "peak_flop_s"), *shares]
    return [*params, point.state, *("" if value != value else f"{value:.6g}" for value in values), point.id]


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
