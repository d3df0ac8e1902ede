"""What `sweep project` left: per series over threads, what more threads would take, and how far that may be trusted."""
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from records import DRAWN, Point


@dataclass(frozen=True)
class Projection:
    """Speed-ups over one thread by threads: projected, and the band (lower, upper) that any greedy schedule keeps."""
    speed_up: dict[int, float]
    band: dict[int, tuple[float, float]]
    limits: dict[int, dict[str, float]]  # shares of the threads' time, besides work
    validation: dict[str, Any]

    @property
    def trusted(self) -> bool:
        return self.validation["trusted"]

    def sentence(self, threads: int) -> str:
        """Where it stops scaling, and why."""
        if not self.trusted:
            return f"projection withheld: {self.validation['why']}"
        limit, share = max(self.limits[threads].items(), key=lambda item: item[1])
        return (f"on {threads} threads {self.speed_up[threads]:.1f} times as fast as on one (projected; at least "
                f"{self.band[threads][0]:.1f}), limited by {limit}: {100 * share:.1f} % of the threads' time; two threads are "
                f"predicted to {100 * self.validation['residual']:+.1f} %")


def projection_of(series: list[Point], folder: Path) -> Projection | None:
    """The projection of points that differ in threads alone; None if there is none."""
    one = [point for point in series if point.params.get("threads") == 1 and point.state == DRAWN]
    try:
        found = json.loads((folder / "projections" / f"{one[0].id}.json").read_text(encoding="utf-8"))
        if found["schema"] != "trigrain-projection-1":
            return None
        rows = found["rows"]
        return Projection({row["threads"]: row["speed_up"] for row in rows},
                          {row["threads"]: (row["lower"], row["upper"]) for row in rows},
                          {row["threads"]: row["limits"] for row in rows}, found["validation"])
    except (IndexError, OSError, ValueError, KeyError, TypeError):
        return None
