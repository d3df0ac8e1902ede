#!/usr/bin/python3
"""The published experiment on kernels: steps until proven, what hybrids redo, what the usual test believes, MFLOP/s beside table
1 of Krestenitis, Weinzierl and Koziara (2017), and how far below the machine's roofline each kernel is."""
import packages  # noqa: F401, I001: before all that need them
import statistics
import sys
from pathlib import Path

import matplotlib
from figure import COLOURS, GREY, MARKERS, STYLE, Drawn, Figure, command_line, foot, head, save
from kernel_points import OURS, colour, found, median, ran
from published import table_1
from records import DRAWN, Point, load_sweep

HEADER = ["family", "kernel", "lanes", "schedule", "steps", "batch", "tolerance_S", "state", "median_ns", "mflop_s", "peak_share",
          "fall_back_share", "wrong_share", "wrong_unflagged_share", "believed_share", "believed_wrong_share", "record"]
NOTES = [
    "Believed: neither point moved by more than the tolerance in the last step, the usual test of convergence; wrong: the "
    "distance is off by more. Ours flags an answer unless its bounds agree.",
    "flop/s count the declared additions, multiplications, divisions and roots of one separated pair.",
    "Roofline: measured peak of fused multiply-adds and bandwidth of one core for data of this size, over declared flops and bytes.",
    "The published table is of one core of a Sandy Bridge at 2 GHz, its penalty method converged to 1e-8; ours takes four steps.",
]
PUBLISHED_PAIRS = 1e7
PRINTED = {"BF": ("brute", 1), "Penalty": ("iterative", 1), "BF+SIMD": ("brute-simd", 0), "Penalty+SIMD": ("iterative", 0)}


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_kernels, writes OUT/figure_kernels.svg, .png and .csv."""
    sweep = load_sweep(results, "figure_kernels")
    drawn = sweep.drawn()
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(14, 11), layout="constrained")
        panels = figure.subplot_mosaic([["histogram", "redone", "believed"], ["rate", "rate", "roofline"], ["table"] * 3],
                                       height_ratios=(4, 4, 2))
        for name, panel in (("histogram", _histogram), ("redone", _redone), ("believed", _believed), ("rate", _rate),
                            ("roofline", _roofline), ("table", _table)):
            panel(panels[name], drawn)
        figure.get_layout_engine().set(rect=(0, 0.06, 1, 0.94))
        head(figure, sweep)
        foot(figure, sweep)
        return save(figure, Drawn("figure_kernels", sweep, out, NOTES), HEADER, [_row(point) for point in sweep.points])


def _of_every_family(points: list[Point]) -> list[Point]:
    return [p for p in points if p.params["family"] == "every"]


def _iterative(points: list[Point], steps: int) -> list[Point]:
    return [p for p in _of_every_family(points) if p.params["kernel"] == "iterative" and p.params["steps"] == steps]


def _histogram(axes, points: list[Point]) -> None:
    chosen = _iterative(points, 4)
    for number, point in enumerate(chosen):
        share = point.record["kernel"]["proven_after_steps"]
        left = [step + 0.27 * (number - (len(chosen) - 1) / 2) for step in range(len(share))]
        axes.bar(left, share, 0.25, color=COLOURS[number],
                 label=f"{point.params['schedule']}: {1 - sum(share):.0%} never")
    axes.set(title="Proven for the first time", xlabel="Newton steps", ylabel="share of pairs", xticks=range(0, 17, 2))
    axes.legend(fontsize=8)


def _redone(axes, points: list[Point]) -> None:
    groups: dict[str, list[Point]] = {}
    for point in _of_every_family(points):
        if point.params["kernel"].startswith("hybrid"):
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
    axes.set(title=f"Wrong by more than {chosen[0].params['tolerance']:g} S" if chosen else "", ylabel="share of pairs",
             ylim=(0, 1.3 * max([found(p, "believed_wrong_share") for p in chosen], default=1) or 1))
    axes.set_xticks(range(len(chosen)), names, fontsize=7)
    axes.legend(fontsize=8)


def _as_published(points: list[Point]) -> list[Point]:
    """Each kernel and number of lanes once, on random pairs as the published table."""
    return [p for p in points if p.params["family"] == "random_mixed"]


def _rate(axes, points: list[Point]) -> None:
    chosen = _as_published(points)
    names = [f"{p.params['kernel']}\n{ran(p, 'lanes')} lane{'s' * (ran(p, 'lanes') > 1)}" for p in chosen]
    values = [_mflops(p) for p in chosen]
    bars = axes.bar(range(len(chosen)), values, color=[COLOURS[0] if ran(p, "lanes") > 1 else GREY for p in chosen])
    axes.bar_label(bars, [f"{v:.0f}\n{median(p):.0f} ns" for v, p in zip(values, chosen)], fontsize=7)
    axes.set(title="Declared work per time, random pairs", ylabel="MFLOP/s, one thread", ylim=(0, 1.2 * max(values, default=1)))
    axes.set_xticks(range(len(chosen)), names, fontsize=7, rotation=30)


def _roofline(axes, points: list[Point]) -> None:
    """Rate over declared flops per byte, below the lower of peak and bandwidth."""
    chosen = _as_published(points)
    axes.set(title="Roofline, random pairs", xscale="log", yscale="log", xlabel="declared flops per byte", ylabel="GFLOP/s, one thread")
    if not chosen:
        return
    peak, bandwidth = (statistics.median(found(p, key) for p in chosen) for key in ("peak_flop_s", "bandwidth_B_s"))
    ridge = peak / bandwidth
    axes.plot([ridge / 8, ridge, 100 * ridge], [peak / 8e9, peak / 1e9, peak / 1e9], color=GREY)
    axes.annotate(f"{peak / 1e9:.0f} GFLOP/s, {bandwidth / 1e9:.0f} GB/s", (ridge, peak / 1e9), xytext=(0, 5),
                  textcoords="offset points", fontsize=8, color=GREY)
    for point in chosen:
        vector, kernel = ran(point, "lanes") > 1, point.params["kernel"]
        axes.plot(found(point, "flops_per_pair") / found(point, "bytes_per_pair"), _mflops(point) / 1e3, MARKERS[OURS.index(kernel)],
                  color=colour(kernel), markerfacecolor=colour(kernel) if vector else "white", label=f"{kernel}{'' if vector else ', 1 lane'}")
    axes.set_ylim(top=2.5 * peak / 1e9)
    axes.legend(fontsize=7, loc="lower left")


def _table(axes, points: list[Point]) -> None:
    """Table 1 as printed, and what it is here."""
    axes.set_axis_off()
    rows = []
    for label, (kernel, lanes) in PRINTED.items():
        printed = table_1()[label]
        here = [p for p in _as_published(points) if (p.params["kernel"], p.params["lanes"]) == (kernel, lanes)]
        ours = ["-"] * 4 if not here else [
            f"{PUBLISHED_PAIRS * median(here[0]) / 1e9:.2f} s", f"{_mflops(here[0]):,.0f}",
            f"{1e6 * _mflops(here[0]) / found(here[0], 'peak_flop_s'):.1%}", f"{found(here[0], 'error_p99_S'):.0e} S"]
        rows.append([label, f"{printed['runtime_s']:g} s", f"{printed['mflops_per_s']:,g}", f"{printed['cpi']:g}",
                     f"{printed['bandwidth_mb_per_s']:,g}", kernel + ("" if lanes == 0 else ", 1 lane"), *ours])
    heads = ["printed", "1e7 pairs", "MFLOP/s", "CPI", "MB/s", "here", "1e7 pairs", "MFLOP/s", "of the peak",
             "99 % of errors below"]
    drawn = axes.table(rows, colLabels=heads, loc="center", cellLoc="center", colWidths=[.1] * 5 + [.12] + [.09] * 3 + [.11])
    drawn.auto_set_font_size(False)
    drawn.set_fontsize(9)
    drawn.scale(1, 1.4)


def _mflops(point: Point) -> float:
    return 1e3 * found(point, "flops_per_pair") / median(point)


def _row(point: Point) -> list:
    params = [point.params[key] for key in ("family", "kernel", "lanes", "schedule", "steps", "batch", "tolerance")]
    if point.state != DRAWN:
        return [*params, point.state, *[""] * 8, point.id]
    params[2] = ran(point, "lanes")
    shares = [found(point, key) for key in ("fall_back_share", "wrong_share", "wrong_unflagged_share", "believed_share",
                                            "believed_wrong_share")]
    values = [median(point), _mflops(point), 1e6 * _mflops(point) / found(point, "peak_flop_s"), *shares]
    return [*params, point.state, *("" if value != value else f"{value:.6g}" for value in values), point.id]


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
