"""What the figures of the grids share: how each kind looks, and the history of a point."""
import statistics
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from figure import COLOURS, GREY, MARKERS, Drawn, credit, save
from records import Point, Sweep

KINDS = ("regular-dense", "regular", "adaptive", "reluctant", "none", "linked-cells")


def look(grid: str) -> dict:
    """Colour and marker of a kind, the same in all figures."""
    place = KINDS.index(grid)
    return {"color": COLOURS[place], "marker": MARKERS[place]}


def history(point: Point) -> dict[str, np.ndarray]:
    """Columns of the record's history as arrays, and "steps" per row."""
    columns = {key: np.array(values) for key, values in point.record["history"].items() if key != "every"}
    return {**columns, "steps": np.full(len(columns["time_s"]), point.record["history"]["every"])}


def finding_pairs(point: Point) -> float | None:
    """Share of a step that the grid and the search for body pairs take; None for records that do not know."""
    samples = point.record["samples"]
    if any("search_s" not in sample for sample in samples):
        return None
    return statistics.median((s["phases_s"]["grid"] / s["steps"] + s["search_s"]) * s["steps"] / s["wall_s"] for s in samples)


def finish(figure: Figure, sweep: Sweep, out: Path, notes: list[str], table: tuple[list[str], list[list]]) -> Drawn:
    """Title, missing points and origin of the numbers; then SVG, PNG, and the table (header, rows) as CSV."""
    absent = [f"{point.name}: {point.state}{f' ({point.why})' if point.why else ''}"
              for point in sweep.points if point.record is None or point.state != "finished"]
    figure.suptitle(f"{sweep.title} ({sweep.preset})", fontsize=12)
    figure.text(0.5, 0.008, "\n".join([*absent[:4], credit(sweep)]), ha="center", va="bottom", fontsize=7.5, color=GREY)
    return save(figure, Drawn(sweep.name, sweep, out, [*absent, *notes]), *table)
