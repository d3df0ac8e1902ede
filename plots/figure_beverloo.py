#!/usr/bin/python3
"""Discharge rate of a bin over its opening, to the power 2/5, with a line fitted as Beverloo et al. (1961) propose."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from figure import COLOURS, GREY, MARKERS, STYLE, Drawn, command_line, credit, save
from records import DRAWN, load_sweep

NAME = "figure_beverloo"


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_beverloo, writes OUT/figure_beverloo.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    rows, notes = [], []
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.5, 5))
        axis = figure.add_subplot(title=f"{sweep.title} ({sweep.preset})", xlabel="opening D / grain diameter d",
                                  ylabel="(mass flow / (kg/s))$^{2/5}$")
        kinds = sorted({p.params["vertices"] for p in sweep.points if p.state == DRAWN})
        for kind, colour, marker in zip(kinds, COLOURS, MARKERS):
            name = "spheres" if kind == 0 else f"granulates of {kind} points"
            openings, groups = rates(sweep, kind)
            if not openings:
                continue
            medians = [np.median(group) for group in groups]
            low, high = ([np.percentile(group, share) for group in groups] for share in (25, 75))
            axis.errorbar(openings, np.power(medians, 0.4), color=colour, marker=marker, linestyle="none",
                          yerr=[np.power(medians, 0.4) - np.power(low, 0.4), np.power(high, 0.4) - np.power(medians, 0.4)])
            slope, offset = np.polyfit(openings, np.power(medians, 0.4), 1) if len(openings) > 1 else (np.nan, np.nan)
            line = np.array([-offset / slope, max(openings)])
            fit = np.polyval((slope, offset), openings)
            spread = np.power(medians, 0.4)
            r2 = 1 - ((spread - fit) ** 2).sum() / max(1e-300, ((spread - spread.mean()) ** 2).sum())
            axis.plot(line, slope * line + offset, color=colour, label=f"{name}: k = {line[0]:.2f}, R$^2$ = {r2:.4f}")
            notes.append(f"{name}: flow stops at D = {line[0]:.2f} d (Beverloo: 1 to 2), R2 = {r2:.4f}, "
                         f"{min(map(len, groups))} or more seeds per opening; bars are quartiles.")
            rows += [[kind, opening, len(group), m, lo, hi] for opening, group, m, lo, hi in
                     zip(openings, groups, medians, low, high)]
        axis.set(xlim=(0, None), ylim=(0, None))
        axis.legend(fontsize=9)
        figure.text(0.5, 0.008, credit(sweep), ha="center", va="bottom", fontsize=7.5, color=GREY)
        figure.tight_layout(rect=(0, 0.06, 1, 1))
        return save(figure, Drawn(NAME, sweep, out, notes),
                    ["vertices", "opening_d", "seeds", "median_kg_s", "quartile_25_kg_s", "quartile_75_kg_s"], rows)


def rates(sweep, kind: int) -> tuple[list[float], list[list[float]]]:
    """Openings, and the flow (kg/s) of every seed at each that emptied."""
    found: dict[float, list[float]] = {}
    for point in sweep.points:
        if point.state == DRAWN and point.params["vertices"] == kind:
            flow = point.record["metrics"]["rate_kg_s"]["value"]
            if flow is not None:
                found.setdefault(point.params["value"], []).append(flow)
    return sorted(found), [found[opening] for opening in sorted(found)]


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
