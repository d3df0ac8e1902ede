#!/usr/bin/python3
"""Discharge rate of a bin over its opening, to the power 2/5, with a line fitted as Beverloo et al. (1961) propose; and how
much the flow from 45 to 70 % emptied differs from that from 20 to 45 %."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from figure import COLOURS, MARKERS, STYLE, Drawn, command_line, foot, head, legend, save
from records import DRAWN, load_sweep

NAME = "figure_beverloo"
DENSITY, GRAVITY = 1000, 9.81  # of the grains, kg/m3; m/s2


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_beverloo, writes OUT/figure_beverloo.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    rows, notes = [], []
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(11, 5))
        head(figure, sweep)
        flow, change = figure.subplots(1, 2, width_ratios=(1.5, 1))
        flow.set(xlabel="opening D / grain diameter d", ylabel=r"(mass flow / ($\rho\, g^{1/2} d^{5/2}$))$^{2/5}$")
        change.axhspan(-3, 3, color="#009E73", alpha=0.12)
        change.set(xlabel="opening D / grain diameter d", ylabel="change of the flow while it empties (%)")
        kinds = sorted({p.params["vertices"] for p in sweep.points if p.state == DRAWN})
        for kind, colour, marker in zip(kinds, COLOURS, MARKERS):
            name = "spheres" if kind == 0 else f"granulates of {kind} points"
            style = {"color": colour, "marker": marker, "linestyle": "none", "capsize": 3}
            found = ensembles(sweep, kind, 1)
            if found:
                notes.append(fitted(flow, found, name, style))
                changes = {x: [100 * c for _, c in runs] for x, runs in found.items()}
                with_quartiles(change, changes, **style)
                most = max((float(np.median(group)) for group in changes.values()), key=abs)
                notes.append(f"{name}: the flow from 45 to 70 % emptied differs from that before by {most:+.0f} % at most (median of "
                             "the seeds), where 3 % are asked for; the last 30 % of the grains fill little more than the funnel.")
            stiff = ensembles(sweep, kind, 4)
            for opening in set(stiff) & set(found):
                with_quartiles(flow, {opening: [w**0.4 for w, _ in stiff[opening]]},
                               label="springs 4 times as stiff", **style | {"marker": "x"})
                ratio = np.median([w for w, _ in stiff[opening]]) / np.median([w for w, _ in found[opening]])
                notes.append(f"{name}: with springs 4 times as stiff the median flow at D = {opening:g} d changes by "
                             f"{100 * (ratio - 1):+.1f} % ({len(stiff[opening])} seeds).")
            rows += [[kind, stiffness, opening, len(runs), *np.percentile([w for w, _ in runs], (50, 25, 75)),
                      *np.percentile([c for _, c in runs], (50, 25, 75))]
                     for stiffness, group in ((1, found), (4, stiff)) for opening, runs in group.items()]
        flow.set(xlim=(0, None), ylim=(0, None))
        legend(flow, fontsize=9)
        foot(figure, sweep)
        figure.tight_layout(rect=(0, 0.06, 1, 1))
        return save(figure, Drawn(NAME, sweep, out, notes),
                    ["vertices", "stiffness", "opening_d", "seeds", "median_flow", "flow_quartile_25", "flow_quartile_75",
                     "median_change", "change_quartile_25", "change_quartile_75"], rows)


def with_quartiles(axis, groups: dict[float, list[float]], **style) -> None:
    """Medians over the keys, bars from the first to the third quartile."""
    low, middle, high = np.transpose([np.percentile(group, (25, 50, 75)) for group in groups.values()])
    axis.errorbar(list(groups), middle, yerr=[middle - low, high - middle], **style)


def fitted(axis, found: dict[float, list], name: str, style: dict) -> str:
    """Draws flows to the power 2/5 and the line through their medians; says where it ends and how well it fits."""
    powers = {opening: [w**0.4 for w, _ in runs] for opening, runs in found.items()}
    with_quartiles(axis, powers, **style)
    x, y = np.array(list(powers)), np.array([np.median(group) for group in powers.values()])
    few, many = min(map(len, powers.values())), max(map(len, powers.values()))
    seeds = f"{few} seed(s)" if few == many else f"{few} to {many} seeds"
    if len(x) < 3:
        return f"{name}: {len(x)} openings are too few for a fit."
    slope, offset = np.polyfit(x, y, 1)
    r2 = 1 - ((y - slope * x - offset)**2).sum() / ((y - y.mean())**2).sum()
    stop = -offset / slope
    axis.plot([stop, x.max()], [0, slope * x.max() + offset], color=style["color"],
              label=f"{name}, {seeds}: k = {stop:.2f}, R$^2$ = {r2:.4f}")
    return (f"{name}: flow stops at D = {stop:.2f} d (Beverloo: 1 to 2), R2 = {r2:.4f}, {seeds} per opening; "
            "bars are quartiles.")


def ensembles(sweep, kind: int, stiffness: float) -> dict[float, list[tuple[float, float]]]:
    """Over the openings: flow, in units of density, gravity and grain diameter, and its change of every seed that emptied."""
    found: dict[float, list[tuple[float, float]]] = {}
    for point in sweep.points:
        if point.state != DRAWN:
            continue
        params = point.record["params"]
        if params["vertices"] == kind and params["stiffness"] == stiffness:
            m = {name: metric["value"] for name, metric in point.record["metrics"].items()}
            if m["rate_kg_s"] is not None:
                unit = DENSITY * np.sqrt(GRAVITY) * m["grain_diameter_m"]**2.5
                found.setdefault(params["value"], []).append((m["rate_kg_s"] / unit, m["rate_change"]))
    return dict(sorted(found.items()))


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
