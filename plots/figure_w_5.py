#!/usr/bin/python3
"""Time per mesh pair against the number of triangles, and what error of the gap that time buys."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
from figure import COLOURS, GREY, MARKERS, STYLE, Drawn, Figure, command_line, foot, head, save
from kernel_points import found, median, nanoseconds
from records import DRAWN, Point, Sweep, load_sweep

HEADER = ["kernel", "precheck", "cuts", "triangles_per_mesh", "state", "median_us", "min_us", "max_us", "gap_error_radii", "record"]
NOTES = ["Thin lines: T squared, as every triangle against every other costs, and log T, both from the leftmost point. Right: "
         "the difference of the gap from that of two smooth spheres, the largest over all pairs."]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_w_5, writes OUT/figure_w_5.svg, .png and .csv."""
    sweep = load_sweep(results, "figure_w_5")
    methods = list(dict.fromkeys(_method(point) for point in sweep.points))
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(11, 4.6), layout="constrained")
        growth, cost = figure.subplots(1, 2)
        for method, colour, marker in zip(methods, COLOURS, MARKERS):
            points = [point for point in sweep.drawn() if _method(point) == method]
            triangles, times = [found(p, "triangles_per_mesh") for p in points], [median(p) / 1e3 for p in points]
            growth.plot(triangles, times, marker=marker, color=colour, label=method)
            for point, size in zip(points, triangles):
                low, *_, high = [nanoseconds(point)[0], nanoseconds(point)[-1]]
                growth.plot([size, size], [low / 1e3, high / 1e3], color=colour)
            cost.plot(times, [found(p, "gap_error_radii") for p in points], marker=marker, color=colour, label=method)
        _guides(growth, sweep)
        growth.set(xscale="log", yscale="log", xlabel="triangles per mesh, T", ylabel="CPU time per mesh pair (us)")
        cost.set(xscale="log", yscale="log", xlabel="CPU time per mesh pair (us)", ylabel="error of the gap (radii)")
        growth.legend(fontsize=8)
        figure.get_layout_engine().set(rect=(0, 0.06, 1, 0.94))
        head(figure, sweep)
        foot(figure, sweep)
        return save(figure, Drawn("figure_w_5", sweep, out, NOTES), HEADER, [_row(point) for point in sweep.points])


def _method(point: Point) -> str:
    if point.params["kernel"] == "fcl":
        return "FCL"
    cuts = ", regular cuts" if point.params["cuts"] == "regular" else ""
    return f"{point.params['kernel']}, {point.params['precheck']}{cuts}"


def _guides(axes, sweep: Sweep) -> None:
    import math
    for method, law in (("none", lambda t: t * t), ("octree", math.log)):
        points = [p for p in sweep.drawn() if _method(p) == f"brute-simd, {method}"]
        sizes = sorted(found(p, "triangles_per_mesh") for p in points)
        if len(sizes) > 1:
            start = min(points, key=lambda p: found(p, "triangles_per_mesh"))
            axes.plot(sizes, [median(start) / 1e3 * law(t) / law(sizes[0]) for t in sizes], color=GREY, linewidth=0.7,
                      linestyle="--")


def _row(point: Point) -> list:
    names = [point.params["kernel"], point.params["precheck"], point.params["cuts"]]
    if point.state != DRAWN:
        return [*names, point.params["family"].removeprefix("spheres_"), point.state, "", "", "", "", point.id]
    times = nanoseconds(point)
    return [*names, f"{found(point, 'triangles_per_mesh'):g}", point.state,
            *(f"{time / 1e3:.6g}" for time in (median(point), times[0], times[-1])),
            f"{found(point, 'gap_error_radii'):.6g}", point.id]


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
