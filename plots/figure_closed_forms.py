#!/usr/bin/python3
"""Motions of single bodies against their closed forms: convergence with stiffness and triangles, and errors beside bars."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from figure import COLOURS, GREY, MARKERS, STYLE, Drawn, command_line, foot, head, legend, save
from records import DRAWN, Sweep, load_sweep

NAME = "figure_closed_forms"
FLOOR = 1e-17  # smaller errors are drawn here
SINGLE = ("free-top", "slope", "topple", "rolling-ball", "similarity", "stack")
# label, metric, power of the number of triangles in it
MISSES = (("gap", "gap_times_triangles", 1), ("volume", "volume_error_times_triangles", 1),
          ("inertia", "inertia_error_times_triangles", 1), ("spin of a drop", "spurious_spin_times_triangles", 1),
          ("tilt of the normal", "normal_tilt_times_root_of_triangles", 0.5))


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_closed_forms, writes OUT/figure_closed_forms.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(12, 8))
        head(figure, sweep)
        axes = figure.subplots(2, 3).ravel()
        notes = [
            converges(axes[0], sweep, "rigid-impact", "stiffness", ("velocity_error", "spin_error"), "tilted cube, {:g} deg",
                      "stiffness / that of a turn of 1e-4 rad", -0.5),
            converges(axes[1], sweep, "ellipsoid-impact", "triangles", ("velocity_error", "spin_error"),
                      "ellipsoid, {:g} deg", "triangles", -1),
            balls(axes[2], sweep),
            converges(axes[3], sweep, "rolling-polygon", "stiffness", ("spin_ratio_error",), "prism of {:g} corners",
                      "stiffness / 1e8 N/m", None),
            converges(axes[4], sweep, "bounce", "stiffness", ("time_to_rest_error",), "bouncing, e = {:g}",
                      "stiffness / 1e9 N/m", -0.5),
            beside_bars(axes[5], sweep)]
        foot(figure, sweep)
        figure.tight_layout(rect=(0, 0.04, 1, 0.98))
        rows = [[p.params["study"], p.params["value"], p.params["level"], p.params["stiffness"], name, m["value"], m["bar"],
                 m["within"]] for p in sweep.points if p.state == DRAWN for name, m in p.record["metrics"].items()]
        return save(figure, Drawn(NAME, sweep, out, [note for note in notes if note]),
                    ["study", "value", "level", "stiffness", "metric", "found", "bar", "within"], rows)


def converges(axis, sweep: Sweep, study: str, over: str, errors: tuple[str, ...], label: str, below: str,
              order: float | None) -> str:
    """The root of the sum of squared errors over a parameter or metric, a line per value; a guide of that slope,
    if there is one: a prism keeps what twice the critical damping returns, however stiff."""
    found: dict[float, list[tuple[float, float]]] = {}
    for p in sweep.points:
        if p.state == DRAWN and p.params["study"] == study:
            metrics = p.record["metrics"]
            x = metrics[over]["value"] if over in metrics else p.params[over]
            values = [metrics[name]["value"] for name in errors]
            if None not in values:
                found.setdefault(p.params["value"], []).append((x, max(FLOOR, float(np.hypot.reduce(values)))))
    for (value, line), colour, marker in zip(sorted(found.items()), COLOURS, MARKERS):
        x, y = zip(*sorted(line))
        axis.plot(x, y, color=colour, marker=marker, label=label.format(value))
    if found and order is not None:
        x0, y0 = min(max(found.values(), key=len))
        x1 = max(x for line in found.values() for x, _ in line)
        axis.plot([x0, x1], [y0, y0 * (x1 / x0)**order], color=GREY, linewidth=0.8, label=f"slope {order:g}")
    if found:
        legend(axis, fontsize=8, framealpha=0.5)
    axis.set(xscale="log", yscale="log", xlabel=below, ylabel="error")
    return ""


def balls(axis, sweep: Sweep) -> str:
    """What an icosphere misses of a ball: one over the triangles, the tilt of its normal one over their root."""
    points = sorted((p.record["metrics"]["triangles"]["value"], p.record["metrics"]) for p in sweep.points
                    if p.state == DRAWN and p.params["study"] == "mesh-sphere")
    said = []
    for (name, metric, power), colour, marker in zip(MISSES, COLOURS, MARKERS):
        triangles, errors = np.array([(t, m[metric]["value"] / t**power) for t, m in points]).reshape(-1, 2).T
        if len(triangles) > 1:
            slope = np.polyfit(np.log(triangles), np.log(errors), 1)[0]
            axis.plot(triangles, errors, color=colour, marker=marker, label=f"{name}, slope {slope:.2f}")
            said.append(f"{name} {points[-1][1][metric]['value']:.3g}/{'T' if power == 1 else 'sqrt(T)'}")
    axis.set(xscale="log", yscale="log", xlabel="triangles T of an icosphere", ylabel="error of what a ball has")
    legend(axis, fontsize=8, framealpha=0.5)
    return f"An icosphere misses of a ball: {', '.join(said)}." if said else ""


def beside_bars(axis, sweep: Sweep) -> str:
    """Every error that has a bar, over that bar."""
    rows = [(f"{p.params['study']} {p.params['value']:g}: {name.removesuffix('_error').replace('_', ' ')}", m)
            for study in SINGLE for p in sweep.points if p.state == DRAWN and p.params["study"] == study
            for name, m in p.record["metrics"].items() if m["bar"] is not None]
    for place, (name, m) in enumerate(rows):
        bar = m["bar"] or 1
        value = FLOOR if m["value"] is None else max(FLOOR, abs(m["value"]))
        axis.plot(value, place, "o", color="#009E73" if m["within"] else "#D55E00", markersize=4)
        axis.plot(bar if m["bar"] else FLOOR, place, "|", color=GREY, markersize=9)
    axis.set(xscale="log", xlabel="error (dot) and its bar (stroke)", xlim=(FLOOR / 3, 1), ylim=(len(rows) - 0.5, -0.5))
    axis.set_yticks(range(len(rows)), [name for name, _ in rows], fontsize=6)
    within = sum(bool(m["within"]) for _, m in rows)
    return f"{within} of {len(rows)} errors with a bar are within it."


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
