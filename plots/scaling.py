"""Runtime per particle and step over threads: the figures 8.5, 8.6, 8.8 and 8.9 of Krestenitis (2018)."""
import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter, NullLocator

from figure import COLOURS, GREY, MARKERS, STYLE, Drawn, credit, foot, head, save
from projections import Projection, projection_of
from published import figures
from records import DRAWN, Point, Sweep, load_sweep

HEADER = ["panel", "grid", "scheme", "particles", "vertices", "threads", "state", "why", "samples",
          "median_us_per_particle_step", "min_us_per_particle_step", "max_us_per_particle_step",
          "published_scaled_us", "record"]
PROJECTED = "projected"  # the state of rows that nobody measured
# What the notes of these figures say of the published curves and scenes.
PLAIN_CURVES = ("Published curves (Krestenitis and Weinzierl 2018, figure 5, another machine of 2016) show their shape only: each is "
                "scaled so that its one-thread value equals ours.")
TASK_CURVES = ("Published curves (Krestenitis and Weinzierl 2018, figure 7, another machine of 2016) show their shape only. Their "
               "one-thread task run takes half the time of their one-thread plain run, about its own time on two threads: probably "
               "one traversing and one working thread. They are therefore scaled so that the plain one-thread value equals ours.")
VERTICES = ("The source prints \"triangles per particle\" for what is the number of hull input points, here vertices: at most "
            "2 N - 4 triangles for N of them.")
NOMINAL = "10 000 is nominal: the published scene places 30 x 30 x 12 = 10 800 particles, and so does ours."


@dataclass(frozen=True)
class Panel:
    """Points of a sweep whose parameters match `where`. `published`: id of the panel of Krestenitis and Weinzierl
    (2018) to show faintly; `anchor`: id of the panel whose one-thread value is laid on ours, itself if not given."""
    title: str
    where: dict[str, Any]
    published: str | None = None
    anchor: str | None = None


def draw_scaling(name: str, panels: list[Panel], notes: list[str], folders: tuple[Path, Path]) -> Drawn:
    """Draws sweep `name` from folders[0] into folders[1]. NothingToDraw if it has never run."""
    sweep = load_sweep(folders[0], name)
    curves = published_curves()
    rows: list[list] = []
    with matplotlib.rc_context(STYLE):
        columns = len(panels) + len(sweep.elsewhere)
        figure = Figure(figsize=(max(6.4, 5.0 * columns), 5.6))
        axes = figure.subplots(1, columns, sharey=True, squeeze=False)[0]
        for axis, panel in zip(axes, panels):
            rows += _draw_panel(axis, panel, sweep, curves)
        for axis, panel in zip(axes[len(panels):], sweep.elsewhere):
            axis.set_title(panel["what"])
            _say(axis, f"needs {panel['needs']}")
        found = [projection_of(points, sweep.folder) for points in _series(panels, sweep).values()]
        published = any(row[HEADER.index("published_scaled_us")] for row in rows)
        _finish(figure, axes, sweep, [*_projection_handles(found), *(_published_handles(panels) if published else [])])
        notes = [*_counts(sweep), *_ends(panels, sweep), *notes]
        return save(figure, Drawn(name, sweep, folders[1], notes), HEADER, rows)


def published_curves() -> dict[str, dict[int, dict[int, float]]]:
    """Seconds by panel id, vertices per particle and threads. The sources print "triangles per particle" for the
    number of hull input points, which is what we call vertices. P17.F3 is brute force of the panels P17.F3a and b."""
    known = {figure["id"]: figure for figure in figures()}
    curves = {id: {series["params"]["vertices_per_particle"]: _curve(series) for series in figure["series"]}
              for id, figure in known.items() if figure["x"]["name"] == "threads" and id.startswith("C18")}
    curves["P17.F3"] = {series["params"]["triangles_per_particle_printed"]: _curve(series) for id in ("P17.F3a", "P17.F3b")
                        for series in known[id]["series"] if series["params"]["method"] == "brute force"}
    return curves


def _curve(series: dict) -> dict[int, float]:
    return {int(threads): seconds for threads, seconds in series["points"]}


def _draw_panel(axis: Axes, panel: Panel, sweep: Sweep, curves: dict) -> list[list]:
    points = [point for point in sweep.points if panel.where.items() <= point.params.items()]
    axis.set_title(panel.title)
    rows = []
    for vertices in sorted({point.params["vertices"] for point in points}):
        series = sorted((point for point in points if point.params["vertices"] == vertices),
                        key=lambda point: point.params["threads"])
        scaled = _scaled(series, curves, panel, vertices)
        measured = [point for point in series if point.state == DRAWN]
        _draw_series(axis, _style_of(vertices), measured, scaled)
        rows += [_row(panel, point, scaled) for point in series]
        projection = projection_of(series, sweep.folder)
        if projection and projection.trusted:
            rows += _draw_projection(axis, _style_of(vertices)[0], measured, projection, _row(panel, measured[0], {}))
    absent = [point for point in points if point.state != DRAWN]
    if len(absent) == len(points):
        _say(axis, "\n".join(_reasons(absent)) or "no such point in this sweep")
    elif absent:
        text = "\n".join(textwrap.fill(reason, 54) for reason in _reasons(absent))
        axis.text(0.02, 0.02, text, transform=axis.transAxes, fontsize=8, color=GREY, va="bottom",
                  bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1})
        threads = sorted({point.params["threads"] for point in absent})
        axis.plot(threads, [0] * len(threads), "x", color=GREY, markersize=6, clip_on=False,
                  transform=axis.get_xaxis_transform(), zorder=5)
    more = [row[HEADER.index("threads")] for row in rows if row[HEADER.index("state")] == PROJECTED]
    _thread_axis(axis, sorted({*(point.params["threads"] for point in points), *more}))
    return rows


def _draw_projection(axis: Axes, colour: str, measured: list[Point], projection: Projection, like: list) -> list[list]:
    """Line and band beyond the threads that were measured, which a record of a bigger machine replaces; their rows."""
    one, last = measured[0].median(), measured[-1].params["threads"]
    threads = [t for t in projection.speed_up if t >= last]
    times = {t: [one / speed for speed in (projection.speed_up[t], *reversed(projection.band[t]))] for t in threads}
    axis.fill_between(threads, [times[t][1] for t in threads], [times[t][2] for t in threads], color=colour, alpha=0.13, linewidth=0)
    axis.plot(threads, [times[t][0] for t in threads], "--", color=colour, linewidth=1.3, zorder=3)
    rows = []
    for t in threads[1:]:
        row = list(like)
        row[HEADER.index("threads"):] = [t, PROJECTED, projection.sentence(t), 0, *(f"{us:.6g}" for us in times[t]), "", like[-1]]
        rows.append(row)
    return rows


def _series(panels: list[Panel], sweep: Sweep) -> dict[str, list[Point]]:
    """Points over threads, by words that name them."""
    series: dict[str, list[Point]] = {}
    for panel in panels:
        for point in sweep.points:
            if panel.where.items() <= point.params.items():
                series.setdefault(f"{panel.title}, {point.params['vertices']} vertices", []).append(point)
    return series


def _ends(panels: list[Panel], sweep: Sweep) -> list[str]:
    """Per series one sentence: where it stops scaling and why."""
    found = {name: projection_of(points, sweep.folder) for name, points in _series(panels, sweep).items()}
    return [f"{name}: {projection.sentence(24)}." for name, projection in found.items() if projection]


def _style_of(vertices: int) -> tuple[str, str]:
    """Colour and marker: the published 10, 20, 40 always look the same."""
    known = [10, 20, 40]
    place = known.index(vertices) if vertices in known else 3 + vertices % 3
    return COLOURS[place], MARKERS[place]


def _draw_series(axis: Axes, style: tuple[str, str], series: list[Point], scaled: dict[int, float]) -> None:
    colour, marker = style
    if scaled:
        axis.plot(list(scaled), list(scaled.values()), "-", color=colour, alpha=0.3, linewidth=1.1, marker=marker,
                  markersize=3)
    if not series:
        return
    threads = [point.params["threads"] for point in series]
    median = [point.median() for point in series]
    below = [point.median() - point.microseconds()[0] for point in series]
    above = [point.microseconds()[-1] - point.median() for point in series]
    axis.errorbar(threads, median, yerr=[below, above], color=colour, marker=marker, capsize=3, linestyle="-", zorder=4)
    if threads[0] == 1:
        ideal = [1, *(t for t in scaled or threads if t > 1)]
        axis.plot(ideal, [median[0] / t for t in ideal], ":", color=colour, linewidth=1)


def _scaled(series: list[Point], curves: dict, panel: Panel, vertices: int) -> dict[int, float]:
    """The published curve in our unit: its shape, laid on our one-thread value. Empty where either is missing."""
    curve = curves.get(panel.published, {}).get(vertices, {})
    anchor = curves.get(panel.anchor or panel.published, {}).get(vertices, {}).get(1)
    one = [point for point in series if point.params["threads"] == 1 and point.state == DRAWN]
    if not (curve and anchor and one):
        return {}
    return {threads: seconds / anchor * one[0].median() for threads, seconds in curve.items()}


def _row(panel: Panel, point: Point, scaled: dict[int, float]) -> list:
    params = point.params
    known = [panel.title, params.get("grid"), params.get("scheme"), params["particles"], params["vertices"],
             params["threads"], point.state, point.why]
    published = scaled.get(params["threads"])
    last = ["" if published is None else f"{published:.6g}", point.id]
    if point.state != DRAWN:
        return [*known, 0, "", "", "", *last]
    times = point.microseconds()
    return [*known, len(times), *(f"{t:.6g}" for t in (point.median(), times[0], times[-1])), *last]


def _reasons(absent: list[Point]) -> list[str]:
    """"threads 4, 8: needs a bigger machine", one line per reason."""
    groups: dict[str, list[Point]] = {}
    for point in absent:
        what = f"{point.params['grid']}: " if point.state == "not available in this build" else ""
        groups.setdefault(what + point.state, []).append(point)
    lines = []
    for state, points in groups.items():
        threads = sorted({point.params["threads"] for point in points})
        partly = "not available" not in state
        lines.append(f"threads {', '.join(map(str, threads))}: {state}" if partly else state)
    return lines


def _say(axis: Axes, text: str) -> None:
    axis.text(0.5, 0.5, textwrap.fill(text, 40, replace_whitespace=False), transform=axis.transAxes, ha="center",
              va="center", color=GREY, fontsize=11)
    _thread_axis(axis, [])


def _thread_axis(axis: Axes, threads: list[int]) -> None:
    axis.set_xscale("log", base=2)
    axis.set_yscale("log")
    axis.set_xlabel("threads")
    if threads:
        axis.set_xlim(threads[0] / 1.12, threads[-1] * 1.12)
    axis.xaxis.set_major_locator(FixedLocator(threads))
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0f}"))
    axis.xaxis.set_minor_locator(NullLocator())
    axis.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.yaxis.set_minor_formatter(NullFormatter())


def _published_handles(panels: list[Panel]) -> list:
    whose = "its plain 1-thread value" if any(panel.anchor for panel in panels) else "its 1-thread value"
    return [Line2D([], [], color=GREY, alpha=0.4, marker="o", markersize=3, linewidth=1.1,
                   label=f"published shape; {whose} is laid on ours")]


def _projection_handles(projections: list[Projection | None]) -> list:
    """Legend entries for what is projected and what was withheld."""
    handles: list = []
    if any(each and each.trusted for each in projections):
        handles.append(Line2D([], [], color=GREY, linestyle="--", label="projected from a trace of one thread"))
        handles.append(Patch(color=GREY, alpha=0.2, linewidth=0, label="band that every greedy schedule keeps"))
    withheld = sum(each is not None and not each.trusted for each in projections)
    if withheld:
        handles.append(Patch(color="none", label=f"projections withheld: {withheld} of {len(projections)}"))
    return handles


def _finish(figure: Figure, axes: list[Axes], sweep: Sweep, more: list) -> None:
    axes[0].set_ylabel("runtime per particle and step (µs)")
    handles = []
    for vertices in sorted({point.params["vertices"] for point in sweep.points}):
        colour, marker = _style_of(vertices)
        handles.append(Line2D([], [], color=colour, marker=marker, label=f"{vertices} vertices per particle"))
    handles.append(Line2D([], [], color=GREY, linestyle=":", label="ideal"))
    handles += more
    head(figure, sweep)
    figure.legend(handles=handles, loc="lower center", ncol=3, fontsize=8.5, frameon=False, bbox_to_anchor=(0.5, 0.085))
    samples = next((point for point in sweep.drawn()), None)
    what = f"median and range of {len(samples.record['samples'])} samples of {samples.record['samples'][0]['steps']} " \
           "steps; " if samples else ""
    width = 88 if len(axes) == 1 else 150
    foot(figure, sweep, "\n".join(textwrap.fill(line, width) for line in (what + credit(sweep)).split("\n")))
    figure.subplots_adjust(left=0.14 if len(axes) == 1 else 0.08, right=0.98, top=0.88, bottom=0.27, wspace=0.06)


def _counts(sweep: Sweep) -> list[str]:
    absent = len(sweep.points) - len(sweep.drawn())
    if not absent:
        return [f"All {len(sweep.points)} points are drawn."]
    return [f"{len(sweep.drawn())} of {len(sweep.points)} points are drawn.",
            *(f"{reason[0].upper()}{reason[1:]}." for reason in _reasons(
                [point for point in sweep.points if point.state != DRAWN]))]
