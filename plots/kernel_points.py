"""What the figures about kernels share: times, names and styles of the points of kernel_bench."""
import statistics

from figure import COLOURS, GREY, Figure
from records import Point, Sweep

OURS = ("brute", "brute-simd", "hybrid-pair", "hybrid-batch", "iterative")
PEERS = ("fcl", "cgal", "bullet", "ode")
PRECISION_MARKERS = {"double": "o", "float": "^", "mixed": "D"}
WALL = 1e-17  # errors below are drawn here: the exact distances are rounded to double


def family_panels(sweep: Sweep, most_columns: int, panel: float, margins: tuple[float, float]) -> tuple[Figure, dict]:
    """A figure with a panel (axes) for each family of triangles; sizes in inches, margins beside and below all panels."""
    families = list(dict.fromkeys(point.params["family"] for point in sweep.points))
    columns = min(len(families), most_columns)
    rows = -(-len(families) // columns)
    figure = Figure(figsize=(max(8, margins[0] + panel * columns), margins[1] + panel * rows), layout="constrained")
    return figure, dict(zip(families, figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).flat))


def label_outside(figure: Figure, most_columns: int, x: str, y: str) -> None:
    """Labels the lowest panels of family_panels() and those at the left."""
    columns = min(len(figure.axes), most_columns)
    for axes in figure.axes[-columns:]:
        axes.set_xlabel(x, fontsize=9)
    for axes in figure.axes[::columns]:
        axes.set_ylabel(y, fontsize=9)


def nanoseconds(point: Point) -> list[float]:
    """CPU time (ns) per pair of every sample, sorted. One thread is timed, and other work does not count."""
    return sorted(1e9 * sample["cpu_s"] / sample["pairs"] for sample in point.record["samples"])


def median(point: Point) -> float:
    """Median of nanoseconds()."""
    return statistics.median(nanoseconds(point))


def colour(name: str) -> str:
    """Of a kernel; peers are grey."""
    return COLOURS[OURS.index(name)] if name in OURS else GREY


def found(point: Point, key: str) -> float:
    """A number of the record's "kernel" part; nan where it is null."""
    value = point.record["kernel"].get(key)
    return float("nan") if value is None else value


def ran(point: Point, key: str):
    """A parameter as it was run: 0 lanes are as many as fill a register."""
    return point.record["params"][key]
