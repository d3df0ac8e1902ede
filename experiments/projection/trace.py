"""Reads a trace of dem_bench into sections: stretches of a step that end when all workers are done."""
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


class TraceError(Exception):
    """The file is no trace, or one that cannot be replayed; says why."""


@dataclass
class Piece:
    """Uninterrupted work (us); afterwards it hands the tasks `spawns` over and goes on with `then`, if there is one."""
    name: str
    duration: float
    spawns: list["Piece"] = field(default_factory=list)
    then: "Piece | None" = None


@dataclass
class Section:
    """What lies between two barriers: one serial piece, the blocks of a loop, or a producer and what comes of it."""
    phase: str
    kind: str  # serial, loop, tasks
    roots: list[Piece]
    pieces: list[Piece]

    def work(self) -> float:
        return sum(piece.duration for piece in self.pieces)


@dataclass(frozen=True)
class Trace:
    about: dict[str, Any]
    steps: list[list[Section]]
    walls: list[float]  # us, per step: first begin to last end
    threads: int

    @property
    def runtime(self) -> str:
        """What ran it, so that its loops are dealt out alike."""
        return self.about.get("runtime", "tbb")


def load_trace(path: Path) -> Trace:
    """TraceError if the file is not what dem_bench --trace writes."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        events, about = document["traceEvents"], document["otherData"]
        by_step: dict[int, list[dict]] = {}
        for event in events:
            by_step.setdefault(event["args"]["step"], []).append(event)
    except OSError as error:
        raise TraceError(f"cannot read the trace ({path}: {error.strerror}). Make one with dem_bench --trace.") from None
    except (ValueError, KeyError, TypeError) as error:
        raise TraceError(f"cannot read the trace ({path}: {type(error).__name__}: {error}). Make one with dem_bench --trace.") \
            from None
    threads = max(len({event["tid"] for event in events}), about.get("params", {}).get("threads", 1))
    ordered = [sorted(step, key=lambda e: (e["ts"], e["ts"] + e["dur"])) for _, step in sorted(by_step.items())]
    walls = [max(e["ts"] + e["dur"] for e in step) - step[0]["ts"] for step in ordered]
    return Trace(about, [_sections(step) for step in ordered] if threads == 1 else [], walls, threads)


def _sections(events: list[dict]) -> list[Section]:
    """Sections of one step that one thread ran, from its events in order of time."""
    sections: list[Section] = []
    tasks: dict[int, Piece] = {}  # first piece of each task that was spawned
    last: dict[int | None, Piece] = {}  # latest piece of each task, None for the producer
    latest: Piece | None = None
    for event in events:
        name, phase, task = event["name"], event["args"]["phase"], event["args"].get("task")
        if name == "spawn":
            tasks[task] = Piece("", 0)
            latest.spawns.append(tasks[task])
            continue
        kind = {"serial": "serial", "loop": "loop"}.get(name, "tasks")
        if not sections or sections[-1].kind != kind or sections[-1].phase != phase or kind == "serial":
            sections.append(Section(phase, kind, [], []))
            last.clear()
        section = sections[-1]
        if kind != "tasks":
            latest = Piece(name, event["dur"])
            section.roots.append(latest)
        elif task in last:  # goes on after a spawn
            latest = Piece(name, event["dur"])
            last[task].then = latest
        elif task is None:
            latest = Piece(name, event["dur"])
            section.roots.append(latest)
        else:
            latest = tasks[task]
            latest.name, latest.duration = name, event["dur"]
        last[task] = latest
        section.pieces.append(latest)
    return sections
