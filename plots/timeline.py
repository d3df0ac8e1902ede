"""Traces of dem_bench: what every thread did in a step."""
import json
from dataclasses import dataclass
from pathlib import Path

from records import NothingToDraw


@dataclass(frozen=True)
class Bar:
    """Uninterrupted work of a thread (us from the step's beginning)."""
    thread: int
    what: str  # serial, traverse, compare, or the phase of a loop
    begin: float
    length: float


@dataclass(frozen=True)
class Timeline:
    """A step: its bars, threads 0, 1, ... in the order in which they first work, and how long it took (us)."""
    step: int
    bars: list[Bar]
    threads: int
    wall: float

    def share(self, what: str) -> float:
        """Of the wall time of all threads."""
        return sum(bar.length for bar in self.bars if bar.what == what) / (self.wall * self.threads)


def median_step(path: Path, threads: int) -> Timeline:
    """The step of median wall time. NothingToDraw if the file is no trace."""
    try:
        events = json.loads(path.read_text(encoding="utf-8"))["traceEvents"]
        steps: dict[int, list[dict]] = {}
        for event in events:
            if event["name"] != "spawn":
                steps.setdefault(event["args"]["step"], []).append(event)
        timelines = sorted((_timeline(step, found, threads) for step, found in steps.items()), key=lambda t: t.wall)
        return timelines[len(timelines) // 2]
    except (OSError, ValueError, KeyError, IndexError) as error:
        raise NothingToDraw(f"cannot read the trace ({path}: {type(error).__name__}). Remove the record of its point and run "
                            "the sweep again.") from None


def _timeline(step: int, events: list[dict], threads: int) -> Timeline:
    events = sorted(events, key=lambda event: event["ts"])
    begin = events[0]["ts"]
    number: dict[int, int] = {}
    bars = [Bar(number.setdefault(event["tid"], len(number)), _what(event), event["ts"] - begin, event["dur"])
            for event in events]
    return Timeline(step, bars, max(threads, len(number)), max(bar.begin + bar.length for bar in bars))


def _what(event: dict) -> str:
    name = {"part": "compare", "loop": event["args"]["phase"]}.get(event["name"], event["name"])
    return "compare" if name == "detect" else name
