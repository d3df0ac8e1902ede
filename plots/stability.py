"""What the figures of the stability studies share: panels of a metric over a parameter, one line per method."""
import packages  # noqa: F401, I001: before all that need them
import math
import statistics
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from figure import COLOURS, GREY, MARKERS, STYLE, Drawn, foot, head, save
from records import DRAWN, Sweep, load_sweep

RULES = ("all-pairs", "dedupe", "nearest", "features")
GREEN = "#009E73"
HEADER = ["study", "contact_rule", "law", "control", "value", "steps_per_contact", "seed", "metric", "found", "bar", "within"]


@dataclass(frozen=True)
class Line:
    """A metric of the points of `study` that have the parameters `where`; `style` as in matplotlib, if it is not the next one."""
    label: str
    study: str
    metric: str
    where: dict[str, Any] = field(default_factory=dict)
    style: dict[str, Any] = field(default_factory=dict)


def by_rule(study: str, metric: str, rules: tuple[str, ...] = RULES) -> list[Line]:
    """One line per contact rule."""
    return [Line(rule, study, metric, {"contact_rule": rule}) for rule in rules]


@dataclass(frozen=True)
class Panel:
    """Lines over the parameter `over`. On a logarithmic axis sizes are drawn, those below `floor` there; values that are
    not finite, where the method failed, are crosses at the top. `guide` draws what theory says."""
    lines: list[Line]
    xlabel: str
    ylabel: str
    over: str = "value"
    log: str = "xy"
    floor: float = 1e-12
    ticks: dict[float, str] | None = None
    guide: Callable[[Any], None] | None = None
    title: str = ""


def found(sweep: Sweep, line: Line, over: str) -> list[tuple[float, float | None, float | None]]:
    """(parameter, value, bar), ordered. The median where points differ in another parameter; no value if one failed."""
    at: dict[float, list] = {}
    for point in sweep.points:
        params = point.params
        if point.state == DRAWN and params["study"] == line.study and all(params.get(k) == v for k, v in line.where.items()):
            at.setdefault(params[over], []).append(point.record["metrics"][line.metric])
    failed = any_failed(at)
    return [(x, None if failed[x] else statistics.median(m["value"] for m in metrics), metrics[0]["bar"])
            for x, metrics in sorted(at.items())]


def any_failed(at: dict[float, list]) -> dict[float, bool]:
    return {x: any(m["value"] is None for m in metrics) for x, metrics in at.items()}


def worst(sweep: Sweep, line: Line, over: str = "value") -> float:
    """The largest size of the metric; infinite if the method failed, nan without points."""
    sizes = [math.inf if value is None else abs(value) for _, value, _ in found(sweep, line, over)]
    return max(sizes, default=math.nan)


def draw_panel(axis, sweep: Sweep, panel: Panel) -> None:
    bars, drawn = set(), []
    for number, line in enumerate(panel.lines):
        points = found(sweep, line, panel.over)
        size = (lambda y: max(panel.floor, abs(y))) if "y" in panel.log else (lambda y: y)
        known = [(x, size(y)) for x, y, _ in points if y is not None]
        style = {"color": COLOURS[number % len(COLOURS)], "marker": MARKERS[number % len(MARKERS)], "alpha": 0.85,
                 "markersize": 7 - min(number, 4), **line.style}
        if points:
            axis.plot([x for x, _ in known], [y for _, y in known], label=line.label, **style)
        lost = [x for x, y, _ in points if y is None]
        if lost:
            axis.plot(lost, [0.97] * len(lost), linestyle="none", transform=axis.get_xaxis_transform(),
                      **{**style, "marker": "x"})
        bars |= {b for _, _, b in points if b is not None}
        drawn += [y for _, y in known]
    axis.set(title=panel.title, xlabel=panel.xlabel, ylabel=panel.ylabel)
    if not axis.lines:  # an axis without a value cannot be logarithmic
        axis.set(xticks=[], yticks=[])
        axis.text(0.5, 0.5, "not run", transform=axis.transAxes, ha="center", va="center", color=GREY)
        return
    axis.set(xscale="log" if "x" in panel.log else "linear",
             yscale="log" if "y" in panel.log else "linear")
    if "y" in panel.log and drawn and max(drawn) <= panel.floor:
        axis.set_ylim(panel.floor / 3, 1)
    bar = bars.pop() if len(bars) == 1 else None  # one that differs from point to point is in the CSV
    if bar is not None and "y" in panel.log:
        axis.axhspan(panel.floor / 3, max(bar, panel.floor), color=GREEN, alpha=0.12, zorder=0)
    elif bar is not None:
        axis.axhspan(-bar, bar, color=GREEN, alpha=0.12, zorder=0)
    if panel.ticks:
        axis.set_xticks(list(panel.ticks), list(panel.ticks.values()))
        axis.minorticks_off()
    if panel.guide:
        panel.guide(axis)
    low, high = axis.get_xlim()
    if axis.get_xscale() == "log" and not panel.ticks and high < 100 * low:  # too few decades for the powers of ten alone
        axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axis.xaxis.set_minor_formatter(NullFormatter())


def draw_panels(name: str, panels: list[Panel], notes: Callable[[Sweep], list[str]], results: Path, out: Path,
                columns: int = 3, extra: Callable[[Any, Sweep], None] | None = None) -> Drawn:
    """Reads RESULTS/name, writes OUT/name.svg, .png and .csv; `extra` draws into one more panel."""
    sweep = load_sweep(results, name)
    count = len(panels) + (extra is not None)
    columns = min(columns, count)
    rows = -(-count // columns)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(max(6.5, 3.9 * columns), 3.3 * rows + 0.7), layout="constrained")
        head(figure, sweep)
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
        explained: list[list[str]] = []
        for axis, panel in zip(axes, panels):
            draw_panel(axis, sweep, panel)
            labels = [line.label for line in panel.lines]
            if len(labels) > 1 and labels not in explained and axis.lines:
                axis.legend(fontsize=7.5)
                explained.append(labels)
        if extra:
            extra(axes[count - 1], sweep)
        for axis in axes[count:]:
            axis.set_axis_off()
        foot(figure, sweep)
        figure.get_layout_engine().set(rect=(0, 0.06, 1, 0.94))
        return save(figure, Drawn(name, sweep, out, notes(sweep)), HEADER, table(sweep))


def table(sweep: Sweep) -> list[list]:
    """Every metric of every point, under HEADER."""
    return [[*(p.record["params"][key] for key in HEADER[:7]), metric, m["value"], m["bar"], m["within"]]
            for p in sweep.points if p.state == DRAWN for metric, m in p.record["metrics"].items()]


def cell(axis, column: int, row: int, text: str, colour: str) -> None:
    """A coloured field of a matrix with its text."""
    axis.add_patch(Rectangle((column + 0.03, row + 0.05), 0.94, 0.9, color=colour, alpha=0.35, linewidth=0))
    axis.text(column + 0.5, row + 0.5, text, ha="center", va="center", fontsize=8)


def draw_matrix(name: str, columns: tuple[str, ...], cells: Callable[[Sweep], dict], notes: Callable[[Sweep], list[str]],
                results: Path, out: Path) -> Drawn:
    """Words in coloured fields: `cells` gives (text, colour) of (row, column)."""
    sweep = load_sweep(results, name)
    words = cells(sweep)
    rows = list(dict.fromkeys(row for row, _ in words))
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(2.6 + 1.3 * len(columns), 1.6 + 0.3 * len(rows)), layout="constrained")
        axis = figure.add_subplot(title=f"{sweep.title} ({sweep.preset})")
        axis.set_axis_off()
        axis.set(xlim=(-1.4, len(columns)), ylim=(len(rows), -0.8))
        for c, column in enumerate(columns):
            axis.text(c + 0.5, -0.4, column, ha="center", va="center")
        for r, row in enumerate(rows):
            axis.text(-0.05, r + 0.5, row, ha="right", va="center")
            for c, column in enumerate(columns):
                if (row, column) in words:
                    cell(axis, c, r, *words[row, column])
        foot(figure, sweep)
        figure.get_layout_engine().set(rect=(0, 0.1, 1, 0.9))
        return save(figure, Drawn(name, sweep, out, notes(sweep)), HEADER, table(sweep))


def outside(sweep: Sweep) -> list[tuple[Any, str]]:
    """Points and their metrics that are out of their bars."""
    return [(p, metric) for p in sweep.points if p.state == DRAWN
            for metric, m in p.record["metrics"].items() if m["within"] is False]
