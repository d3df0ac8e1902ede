"""Reads one sweep's folder under results/: its index and the records of its points."""
import hashlib
import json
import statistics
from dataclasses import dataclass
from pathlib import Path
from typing import Any

DRAWN = "finished"
BIGGER_MACHINE = "needs a bigger machine"
EXPECTED = "check failed as expected"  # a baseline whose answers are known to be wrong


class NothingToDraw(Exception):
    """There are no results of that sweep; says what to do."""


@dataclass(frozen=True)
class Point:
    """A point of a sweep. `state` is "finished" only if its record may be drawn; `why` says more about other states."""
    id: str
    name: str
    params: dict[str, Any]
    state: str
    why: str
    record: dict | None

    def microseconds(self) -> list[float]:
        """Wall time (us) per particle and step of every sample, sorted."""
        particles = self.record["scene"]["moving_bodies"]
        return sorted(1e6 * s["wall_s"] / s["steps"] / particles for s in self.record["samples"])

    def median(self) -> float:
        """Median of microseconds()."""
        return statistics.median(self.microseconds())


@dataclass(frozen=True)
class Sweep:
    """What is known about a sweep: title, panels that need another machine, and all its points in order."""
    name: str
    preset: str
    title: str
    about: str
    elsewhere: list[dict[str, str]]
    points: list[Point]
    folder: Path

    def drawn(self) -> list[Point]:
        return [point for point in self.points if point.state == DRAWN]


def load_sweep(results: Path, name: str) -> Sweep:
    """The sweep `name` as its last run left it. NothingToDraw if it has never run."""
    folder = results / name
    try:
        index = json.loads((folder / "index.json").read_text(encoding="utf-8"))
        entries = index["points"]
    except (OSError, ValueError, KeyError) as error:
        raise NothingToDraw(f"no results to draw ({folder / 'index.json'}: {type(error).__name__}). "
                            f"Run `build/release/bin/sweep run {name}` first.") from None
    return Sweep(name, index["preset"], index["title"], index["about"], index["elsewhere"],
                 [_point(folder, entry) for entry in entries], folder)


def _point(folder: Path, entry: dict) -> Point:
    state, why, record = entry["state"], entry["why"], _record(folder / f"{entry['id']}.json", entry["id"])
    if record is None:
        state, why = ("missing", "its record is not there, or was changed by hand") if state == DRAWN else (state, why)
    else:
        state, why = _verdict(record, why, entry.get("expected_failure"))
    return Point(entry["id"], entry["name"], entry["params"], state, why, record)


def _verdict(record: dict, why: str, baseline: dict | None) -> tuple[str, str]:
    """Whether a record may be drawn. The record decides, whatever the index says."""
    if record["status"] != "finished":
        return "failed", record.get("reason", why)
    if record["check"]["passed"] is not True:
        failed = dict.fromkeys(how["what"] for how in record["check"]["how"] if not how["passed"])
        if baseline and list(failed) == [baseline["check"]]:
            return EXPECTED, f"{baseline['check']}: {baseline['why']}"
        return "check failed", ", ".join(failed)
    if record.get("placement", {}).get("oversubscribed"):
        return "oversubscribed", f"{record['placement']['asked_threads']} threads on fewer cores"
    if not record["samples"]:
        return "failed", "no sample"
    return DRAWN, ""


def _record(path: Path, id: str) -> dict | None:
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        known = record["schema"] == "trigrain-record-1" and record["point_id"] == id
        return record if known and _unchanged(record) else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _unchanged(record: dict) -> bool:
    """Whether the record is as the sweep wrote it: SHA-256 of compact JSON with sorted keys, without "sweep" itself."""
    if "sweep" not in record:
        return True
    bare = {key: value for key, value in record.items() if key != "sweep"}
    text = json.dumps(bare, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest() == record["sweep"]["sha256"]


def provenance(points: list[Point]) -> list[str]:
    """One line for every combination of machine, compiler and commit that the drawn points come from."""
    lines = dict.fromkeys(_origin(point.record) for point in points if point.state == DRAWN)
    return list(lines)


def busy(points: list[Point]) -> str | None:
    """A caution if other work ran beside measured points: the load average exceeded their threads by one or more."""
    loads = [(sample.get("load_average_1min") or 0, point.params.get("threads", 1))
             for point in points if point.state == DRAWN for sample in point.record["samples"]]
    cores = [point.record["machine"]["cores"] for point in points if point.state == DRAWN]
    disturbed = [load for load, threads in loads if load >= threads + 1 and load > min(cores)]
    if not disturbed:
        return None
    return (f"CAUTION: other work ran on the machine during {len(disturbed)} of {len(loads)} samples "
            f"(load average up to {max(disturbed):.1f})")


def _origin(record: dict) -> str:
    machine, build = record["machine"], record["build"]
    commit = (build["commit"] or "unknown")[:10] + (" with changes" if build["dirty"] else "")
    return (f"{machine['cpu']}, {machine['cores']} cores, {machine['os_kernel']}; {build['compiler']}, "
            f"{build['build_type']}, {build['arch_resolved'] or build['arch']}; commit {commit}")
