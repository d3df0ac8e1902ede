"""What the figures of the grids share: how each kind looks, and the history of a point."""
import statistics
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from figure import COLOURS, MARKERS, Drawn, credit, foot, head, save
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


def bodies(point: Point) -> int:
    """Those that move."""
    return point.record["scene"]["moving_bodies"]


def counts_per_step(point: Point) -> dict[str, float]:
    """Means over the steps of the last sample."""
    counts = point.record["counts"]
    return {key: value / counts["steps"] for key, value in counts.items()}


def compared(point: Point) -> float:
    """Pairs of bodies that were compared, per body and step."""
    return counts_per_step(point)["candidate_pairs"] / bodies(point)


def step_s(point: Point) -> float:
    """What a step takes (s): median over the samples."""
    return statistics.median(sample["wall_s"] / sample["steps"] for sample in point.record["samples"])


def _origin(sweep: Sweep) -> str:
    """Points that are missing, and where the numbers come from."""
    return "\n".join([*_absent(sweep)[:4], credit(sweep)])


def foot_inches(sweep: Sweep) -> float:
    """Height of the foot."""
    return 0.1 + 0.135 * (1 + _origin(sweep).count("\n"))


def _absent(sweep: Sweep) -> list[str]:
    return [f"{point.name}: {point.state}{f' ({point.why})' if point.why else ''}"
            for point in sweep.points if point.record is None or point.state != "finished"]


def finish(figure: Figure, sweep: Sweep, out: Path, notes: list[str], table: tuple[list[str], list[list]]) -> Drawn:
    """Title, missing points and origin of the numbers; then SVG, PNG, and the table (header, rows) as CSV."""
    head(figure, sweep)
    foot(figure, sweep, _origin(sweep))
    return save(figure, Drawn(sweep.name, sweep, out, [*_absent(sweep), *notes]), *table)
