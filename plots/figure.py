"""Style, files and command line that all figures share."""
import packages  # noqa: F401, I001: before all that need them
import argparse
import csv
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib.figure import Figure  # noqa: E402

from records import NothingToDraw, Sweep, busy, provenance  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
# Okabe and Ito (2008): told apart by colour-blind readers; the marker says the same in print.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
MARKERS = ("o", "s", "^", "D", "v", "P")
GREY = "#666666"
STYLE = {"font.family": "DejaVu Sans", "font.size": 10, "axes.titlesize": 11, "axes.grid": True, "grid.color": "#dddddd",
         "grid.linewidth": 0.6, "axes.axisbelow": True, "lines.linewidth": 1.6, "lines.markersize": 6,
         "svg.hashsalt": "trigrain", "svg.fonttype": "none", "figure.dpi": 100, "path.simplify": False}


@dataclass(frozen=True)
class Drawn:
    """A figure on disk: NAME.svg, NAME.png and NAME.csv in `folder`; `notes` are sentences about what it shows."""
    name: str
    sweep: Sweep
    folder: Path
    notes: list[str] = field(default_factory=list)
    open_table: bool = False  # the report shows the numbers unfolded

    def path(self, ending: str) -> Path:
        return self.folder / f"{self.name}.{ending}"


def save(figure: Figure, drawn: Drawn, header: list[str], rows: list[list]) -> Drawn:
    """Writes SVG, PNG and CSV. The same records give the same bytes."""
    drawn.folder.mkdir(parents=True, exist_ok=True)
    with matplotlib.rc_context(STYLE):  # the salt of the SVG's names counts when it is written
        figure.savefig(drawn.path("svg"), metadata={"Date": None, "Creator": None})
        figure.savefig(drawn.path("png"), dpi=150, metadata={"Software": None})
    with open(drawn.path("csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)
    return drawn


def credit(sweep: Sweep) -> str:
    """Where the numbers come from, for the foot of a figure."""
    lines = provenance(sweep.points) or ["nothing measured yet"]
    cautions = ["CAUTION: measured on different machines or builds"] if len(lines) > 1 else []
    return "\n".join([*lines, *cautions, *filter(None, [busy(sweep.points)])])


def head(figure: Figure, sweep: Sweep) -> None:
    """Its title and preset above a figure."""
    figure.suptitle(f"{sweep.title} ({sweep.preset})", fontsize=12)


def foot(figure: Figure, sweep: Sweep, text: str | None = None) -> None:
    """Where the numbers come from below a figure, or `text`."""
    figure.text(0.5, 0.008, text or credit(sweep), ha="center", va="bottom", fontsize=7, color=GREY)


def legend(axis, **how) -> None:
    """A legend, where there is something to explain: an empty one is drawn as a small empty box."""
    if axis.get_legend_handles_labels()[0]:
        axis.legend(**how)


def command_line(draw: Callable[[Path, Path], Drawn], about: str) -> int:
    """Draws one figure from the command line; returns the exit code."""
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--results", type=Path, default=ROOT / "results", help="default: %(default)s")
    parser.add_argument("--out", type=Path, help="folder for SVG, PNG and CSV (default: RESULTS/figures)")
    options = parser.parse_args()
    try:
        drawn = draw(options.results, options.out or options.results / "figures")
    except NothingToDraw as error:
        print(error, file=sys.stderr)
        return 3
    print(*drawn.notes, *(drawn.path(ending) for ending in ("svg", "png", "csv")), sep="\n")
    return 0
