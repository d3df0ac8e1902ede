#!/usr/bin/python3
"""Impact tests of Chung & Ooi (2011): balls beside theory, bars and what other codes allow; mesh balls converge to them."""
import packages  # noqa: F401, I001: before all that need them
import csv
import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from figure import COLOURS, GREY, MARKERS, ROOT, STYLE, Drawn, command_line, foot, head, legend, save
from records import DRAWN, Point, load_sweep

NAME = "figure_impacts"
SETUPS = {1: "two balls, elastic", 2: "ball on plane, elastic", 3: "damped", 4: "oblique", 5: "oblique, small ball",
          6: "spinning on plane", 7: "two balls, opposite spins", 8: "spinning on ball"}
FLOOR = 1e-16  # smaller errors are drawn here
HEADER = ["test", "setup", "quantity", "triangles", "here", "theory", "error", "bar", "within", "others allow"]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_impacts, writes OUT/figure_impacts.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    points = sorted((p for p in sweep.points if p.state == DRAWN), key=lambda p: (p.params["level"], p.params["value"]))
    others = tolerances()
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(11, 5.4))
        head(figure, sweep)
        balls(figure.add_subplot(1, 2, 1), points, others)
        meshes(figure.add_subplot(1, 2, 2), points)
        foot(figure, sweep)
        figure.tight_layout(rect=(0, 0.05, 1, 0.98))
        rows = [row for p in points for row in table(p, others)]
        notes = [f"{sum(row[8] == 'yes' for row in rows)} of {sum(row[8] != '' for row in rows)} quantities of true balls are "
                 "within their bars. Errors of meshes are root mean squares over 16 orientations and fall as the area that "
                 "a triangle spans. In the table: values here, theory, and the tolerances of other codes' own tests."]
        return save(figure, Drawn(NAME, sweep, out, notes, open_table=True), HEADER, rows)


def quantities(point: Point) -> list[tuple[str, float, dict]]:
    """Name, theory and error of what a point compares."""
    metrics = point.record["metrics"]
    return [(name.removesuffix("_error"), metrics[f"{name.removesuffix('_error')}_theory"]["value"], error)
            for name, error in metrics.items() if name.endswith("_error")]


def balls(axis, points: list[Point], others: dict[int, list[dict]]) -> None:
    """Error of every quantity of true balls; its bar; what others allow."""
    named = False
    for point in (p for p in points if p.params["level"] < 0):
        test, found = int(point.params["value"]), quantities(point)
        places = test + np.linspace(-0.3, 0.3, len(found))
        axis.plot(places, [max(FLOOR, abs(error["value"])) for _, _, error in found], "o", color=COLOURS[0], markersize=4,
                  label="error here" if test == 1 else None)
        axis.plot(places, [error["bar"] for _, _, error in found], "_", color=COLOURS[1], markersize=9,
                  label="bar" if test == 1 else None)
        for other in others.get(test, []):
            axis.plot(test, float(other["tolerance"]), "x", color=GREY, label=None if named else "other codes' tolerances")
            named = True
            axis.annotate(other["code"], (test, float(other["tolerance"])), (4, 3), textcoords="offset points", fontsize=7,
                          color=GREY)
    axis.set(yscale="log", xlabel="test", ylabel="relative error, true balls", xticks=range(1, 9), ylim=(FLOOR / 3, 1))
    legend(axis, fontsize=8, loc="lower left")


def meshes(axis, points: list[Point]) -> None:
    """Root mean square over the quantities of a test, but for the time, which steps resolve to 1 %."""
    for test, colour, marker in zip((1, 2, 4, 6), COLOURS, MARKERS):
        found = []
        for p in points:
            if p.params["value"] == test and p.params["level"] >= 0:
                errors = [e["value"] for name, _, e in quantities(p) if name != "contact_time_s"]
                found.append((p.record["metrics"]["triangles"]["value"], np.sqrt(np.mean(np.square(errors)))))
        if not found:
            continue
        triangles, errors = zip(*sorted(found))
        slope = np.polyfit(np.log(triangles), np.log(errors), 1)[0] if len(found) > 1 else np.nan
        axis.plot(triangles, errors, color=colour, marker=marker, label=f"T{test} {SETUPS[test]}, slope {slope:.2f}")
    guide = np.array([80, 1e5])
    axis.plot(guide, 4 / guide, color=GREY, linewidth=0.8)
    axis.annotate("slope -1", (3e3, 4 / 3e3 * 1.3), color=GREY, fontsize=8)
    axis.set(xscale="log", yscale="log", xlabel="triangles of a ball", ylabel="rms error, 16 orientations")
    legend(axis, fontsize=8, loc="lower left")


def table(point: Point, others: dict[int, list[dict]]) -> list[list]:
    test, mesh = int(point.params["value"]), point.params["level"] >= 0
    allowed = "" if mesh else "; ".join(f"{o['code']} {o['tolerance']} ({o['what']})" for o in others.get(test, []))
    return [[f"T{test}", SETUPS[test], name, int(point.record["metrics"]["triangles"]["value"]) if mesh else "true ball",
             f"{point.record['metrics'][name]['value']:.6g}", f"{theory:.6g}", f"{error['value']:.2e}",
             "" if mesh else f"{error['bar']:.1e}", "" if mesh else "yes" if error["within"] else "no", allowed]
            for name, theory, error in quantities(point)]


def tolerances() -> dict[int, list[dict]]:
    """What tests of other codes allow, by test."""
    with open(ROOT / "results/reference/impact_tolerances.csv", newline="", encoding="utf-8") as file:
        found: dict[int, list[dict]] = {}
        for row in csv.DictReader(file):
            found.setdefault(int(row["test"]), []).append(row)
        return found


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
