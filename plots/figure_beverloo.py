#!/usr/bin/python3
"""Discharge rate of a bin over its opening, to the power 2/5, with a line fitted as Beverloo et al. (1961) propose; how much
the flow from a bin that is kept full changes with time; and how it follows the height of the grains when the bin empties."""
import packages  # noqa: F401, I001: before all that need them
import sys
from collections import Counter
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from figure import COLOURS, MARKERS, STYLE, Drawn, command_line, foot, head, legend, save
from records import DRAWN, Sweep, load_sweep
from stability import outside

NAME = "figure_beverloo"
DENSITY, GRAVITY = 1000, 9.81  # of the grains, kg/m3; m/s2
BAR = 3  # %, how steady the flow must be
LEFT = range(95, 15, -10)  # % of the grains, in the middle of the tenths of an emptying


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_beverloo, writes OUT/figure_beverloo.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    rows, notes = [], []
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(15, 5))
        head(figure, sweep)
        flow, change, sinking = figure.subplots(1, 3, width_ratios=(1.4, 1, 1))
        flow.set(xlabel="opening D / grain diameter d", ylabel=r"(mass flow / ($\rho\, g^{1/2} d^{5/2}$))$^{2/5}$")
        change.set(xlabel="opening D / grain diameter d", ylabel="bin kept full: change of the flow (%)")
        sinking.set(xlabel="height of the grains over the opening / D", ylabel="bin that empties: flow / that of a full bin - 1 (%)")
        for axis in (change, sinking):
            axis.axhspan(-BAR, BAR, color="#009E73", alpha=0.12)
        kinds = sorted({p.params["vertices"] for p in sweep.points if p.state == DRAWN})
        for kind, colour, marker in zip(kinds, COLOURS, MARKERS):
            name = "spheres" if kind == 0 else f"granulates of {kind} points"
            style = {"color": colour, "marker": marker, "linestyle": "none", "capsize": 3}
            stiffness = sorted({p.params["stiffness"] for p in sweep.points if p.state == DRAWN and p.params["vertices"] == kind})
            found = ensembles(sweep, kind, stiffness[0])
            rates = {opening: [rate(m) for m in runs] for opening, runs in found.items()}
            if found:
                notes += [fitted(flow, rates, name, style), steady(change, found, name, style)]
            for times in stiffness[1:]:
                for opening, runs in ensembles(sweep, kind, times).items():
                    factor, stiff = times / stiffness[0], [rate(m) for m in runs]
                    with_quartiles(flow, {opening: [w**0.4 for w in stiff]}, label=f"springs {factor:g} times as stiff",
                                   **style | {"marker": "x"})
                    if opening in rates:
                        notes.append(f"{name}: with springs {factor:g} times as stiff the mean flow at D = {opening:g} d changes by "
                                     f"{percent(stiff, rates[opening])} ({seeds(len(stiff))}).")
                    rows.append(row(kind, times, opening, runs))
            notes += left_out(sweep, kind, name)
            rows += [row(kind, stiffness[0], opening, runs) for opening, runs in found.items()]
            notes += [emptying(sinking, runs, rates.get(opening), f"{name}, D = {opening:g} d", style)
                      for opening, runs in ensembles(sweep, kind, stiffness[0], "emptying").items() if opening in rates]
        flow.set(xlim=(0, None), ylim=(0, 1.2 * flow.get_ylim()[1]))  # with room for the legend
        legend(flow, fontsize=9, loc="upper left")
        legend(sinking, fontsize=9)
        sinking.invert_xaxis()
        foot(figure, sweep)
        figure.tight_layout(rect=(0, 0.06, 1, 1))
        return save(figure, Drawn(NAME, sweep, out, notes),
                    ["vertices", "stiffness", "opening_d", "seeds", "median_flow", "flow_quartile_25", "flow_quartile_75",
                     "median_change", "change_quartile_25", "change_quartile_75", "level_of_opening"], rows)


def ensembles(sweep: Sweep, kind: int, stiffness: float, study: str = "discharge") -> dict[float, list[dict[str, float]]]:
    """Over the openings: the metrics of every sound seed that flowed to the end."""
    found: dict[float, list[dict[str, float]]] = {}
    unsound = {point.id for point, _ in outside(sweep)}
    for point in sweep.points:
        p = point.params
        if point.state != DRAWN or (p["vertices"], p["stiffness"], p["study"]) != (kind, stiffness, study):
            continue
        metrics = {name: metric["value"] for name, metric in point.record["metrics"].items()}
        if None not in metrics.values() and point.id not in unsound:
            found.setdefault(p["value"], []).append(metrics)
    return dict(sorted(found.items()))


def left_out(sweep: Sweep, kind: int, name: str) -> list[str]:
    """A note of the runs that miss a bar of soundness: contacts too fast for their springs, steps too long, energy."""
    unsound = [(point.id, metric) for point, metric in outside(sweep) if point.params["vertices"] == kind]
    if not unsound:
        return []
    runs = sum(point.state == DRAWN and point.params["vertices"] == kind for point in sweep.points)
    why = ", ".join(f"{metric.replace('_', ' ')} in {count}" for metric, count in Counter(metric for _, metric in unsound).items())
    return [f"{name}: {len({id for id, _ in unsound})} of {runs} runs missed a bar of soundness and are left out ({why})."]


def rate(m: dict[str, float], name: str = "rate_kg_s") -> float:
    """Flow in units of density, gravity and grain diameter."""
    return m[name] / (DENSITY * np.sqrt(GRAVITY) * m["grain_diameter_m"]**2.5)


def row(kind: int, stiffness: float, opening: float, runs: list[dict[str, float]]) -> list:
    """Of the table: medians and quartiles of the seeds."""
    return [kind, stiffness, opening, len(runs), *np.percentile([rate(m) for m in runs], (50, 25, 75)),
            *np.percentile([m["rate_change"] for m in runs], (50, 25, 75)), np.median([m["level_of_opening"] for m in runs])]


def error(values) -> float:
    """Standard error of the mean; nan of one value."""
    return float(np.std(values, ddof=1) / np.sqrt(len(values))) if len(values) > 1 else float("nan")


def with_error(mean: float, its_error: float) -> str:
    """Both in percent; one run has no error."""
    return f"{mean:+.1f} %" if np.isnan(its_error) else f"{mean:+.1f} +- {its_error:.1f} %"


def percent(values: list[float], others: list[float]) -> str:
    """By how much one mean differs from another, with its standard error."""
    ratio = np.mean(values) / np.mean(others)
    return with_error(100 * (ratio - 1), 100 * ratio * np.hypot(error(values) / np.mean(values), error(others) / np.mean(others)))


def with_quartiles(axis, groups: dict[float, list[float]], **style) -> None:
    """Medians over the keys, bars from the first to the third quartile."""
    low, middle, high = np.transpose([np.percentile(group, (25, 50, 75)) for group in groups.values()])
    axis.errorbar(list(groups), middle, yerr=[middle - low, high - middle], **style)


def seeds(count: int) -> str:
    return f"{count} seed{'s' * (count != 1)}"


def seeds_of(groups: dict[float, list]) -> str:
    few, many = min(map(len, groups.values())), max(map(len, groups.values()))
    return seeds(few) if few == many else f"{few} to {seeds(many)}"


def fitted(axis, rates: dict[float, list[float]], name: str, style: dict) -> str:
    """Draws flows to the power 2/5 and the line through their medians; says where it ends and how well it fits."""
    powers = {opening: [w**0.4 for w in group] for opening, group in rates.items()}
    with_quartiles(axis, powers, **style)
    x, y = np.array(list(powers)), np.array([np.median(group) for group in powers.values()])
    if len(x) < 3:
        return f"{name}: {len(x)} openings are too few for a fit."
    slope, offset = np.polyfit(x, y, 1)
    r2 = 1 - ((y - slope * x - offset)**2).sum() / ((y - y.mean())**2).sum()
    stop = -offset / slope
    axis.plot([stop, x.max()], [0, slope * x.max() + offset], color=style["color"],
              label=f"{name}, {seeds_of(rates)}: k = {stop:.2f}, R$^2$ = {r2:.4f}")
    return (f"{name}: flow stops at D = {stop:.2f} d (Beverloo: 1 to 2), R2 = {r2:.4f}, {seeds_of(rates)} per opening; "
            "bars are quartiles.")


def steady(axis, found: dict[float, list], name: str, style: dict) -> str:
    """Draws how much the flow of the second half of the grains differs from that of the first: means with standard errors."""
    changes = {opening: [100 * m["rate_change"] for m in runs] for opening, runs in found.items()}
    means = {opening: float(np.mean(group)) for opening, group in changes.items()}
    axis.errorbar(list(means), list(means.values()), yerr=np.nan_to_num([error(group) for group in changes.values()]), **style)
    worst = max(means, key=lambda opening: abs(means[opening]))
    every = np.concatenate(list(changes.values()))
    levels = [np.median([m["level_of_opening"] for m in runs]) for runs in found.values()]
    return (f"{name}, bin kept full {min(levels):.1f} to {max(levels):.1f} D high: from the first to the second quarter of the grains that "
            f"leave the flow changes by {with_error(means[worst], error(changes[worst]))} at most (D = {worst:g} d, mean of the seeds and "
            f"its standard error; asked for: {BAR} %), over all openings by {with_error(every.mean(), error(every))}.")


def emptying(axis, runs: list[dict[str, float]], full: list[float] | None, name: str, style: dict) -> str:
    """Draws the flow of a bin that empties over the height of its grains; says down to where it is that of a full one."""
    levels = [np.median([m[f"level_of_opening_{left}"] for m in runs]) for left in LEFT]
    flows = [[rate(m, f"rate_kg_s_{left}") for m in runs] for left in LEFT]
    changes = [100 * (np.mean(group) / np.mean(full) - 1) for group in flows]
    errors = [100 * np.hypot(error(group), error(full)) / np.mean(full) for group in flows]
    axis.errorbar(levels, changes, yerr=np.nan_to_num(errors), label=name, **style | {"linestyle": "-"})
    within = next((i for i, c in enumerate(changes) if abs(c) > BAR), len(changes))
    if within == 0:
        return f"{name}: while the bin empties the flow differs by more than {BAR} % from the start."
    return (f"{name}: while the bin empties the flow stays within {BAR} % of that of a full one down to {LEFT[within - 1] - 5} % of the "
            f"grains, which stand {levels[within - 1]:.1f} D high.")


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
