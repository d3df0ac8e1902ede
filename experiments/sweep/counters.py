"""Counter runs beside the timing runs: per point one file, every value with its source, every null with its reason."""
import json
import subprocess
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sweep import callgrind, likwid
from sweep.bench import Bench, point_command
from sweep.likwid import NotCounted
from sweep.metrics import NAMES, Metric, groups_of, metrics_of
from sweep.points import Point
from sweep.spec import Spec
from sweep.store import Store, now, write_json

SCHEMA = "trigrain-counters-1"
PHASES = ("grid", "detect", "merge", "forces", "integrate")


@dataclass
class Counting:
    """Counts points of one spec. LIKWID first; what it cannot say, the kernel's perf_event may have said in the timing
    run; instructions at one thread come from callgrind at last."""
    spec: Spec
    store: Store
    bench: Bench
    root: Path

    def __post_init__(self):
        self.arch: str | None = None
        self.no_likwid = likwid.probe()
        if self.no_likwid is None:
            try:
                self.arch = likwid.architecture()
            except NotCounted as reason:
                self.no_likwid = str(reason)

    def sources(self) -> str:
        """One sentence for the user."""
        return f"counters by likwid on {self.arch}" if self.arch else \
            f"no likwid ({self.no_likwid}): perf_event where the kernel counts, and callgrind for instructions"

    def counts_more_than(self, found: dict[str, Any]) -> bool:
        """Whether another try may say more than `found`: nothing was measured, or LIKWID counts now and did not then."""
        nothing = all(each["status"] != "measured" for each in found["whole"].values())
        return nothing or (self.arch is not None and found["arch"] is None)

    def count(self, point: Point, record: dict) -> dict[str, Any]:
        """Counts a point whose timing run left `record`, and keeps the result."""
        metrics = metrics_of(self.arch) if self.arch else []
        phases = self._by_likwid(point, record, metrics) if self.arch else {}
        whole = {name: self._whole(name, phases, point, record) for name in NAMES}
        result = {"schema": SCHEMA, "point_id": point.id, "started_utc": now(), "params": record["params"],
                  "arch": self.arch, "steps": record["samples"][-1]["steps"], "whole": whole, "phases": phases,
                  "algorithm": record["counts"]}
        write_json(self.store.counters_path(point.id), result)
        return result

    def _by_likwid(self, point: Point, record: dict, metrics: list[Metric]) -> dict[str, dict[str, dict]]:
        """Per phase and metric; each group is a run of its own."""
        cpus = cpus_for(record)
        regions: dict[str, dict[str, likwid.Region] | str] = {}
        for group in groups_of(metrics):
            try:
                regions[group] = self._run_group(point, group, cpus, record)
            except NotCounted as reason:
                regions[group] = str(reason)
        return {phase: {metric.name: _of_phase(metric, phase, regions) for metric in metrics} for phase in PHASES}

    def _run_group(self, point: Point, group: str, cpus: list[int], record: dict) -> dict[str, likwid.Region]:
        regions = likwid.measure(self._command(self.bench, point), group, cpus, self._limited)
        likwid.validate(regions, PHASES, record["samples"][-1]["steps"])
        return regions

    def _command(self, bench: Bench, point: Point) -> list[str]:
        once = replace(point, params={**point.params, "repeats": 1, "check_steps": 1})
        start = self.store.state_path(point.start.id) if point.start else None
        return point_command(bench, once, self.spec.folder, [], start)

    def _limited(self, words: list[str]) -> tuple[int, str]:
        with tempfile.TemporaryFile("w+") as errors:
            try:
                done = subprocess.run(words, stdout=subprocess.PIPE, stderr=errors, text=True, check=False,
                                      timeout=self.spec.time_limit_s)
            except subprocess.TimeoutExpired:
                raise NotCounted(f"the run needed more than {self.spec.time_limit_s:g} s") from None
            errors.seek(0)
            return done.returncode, done.stdout + (errors.read() if done.returncode else "")

    def _whole(self, name: str, phases: dict, point: Point, record: dict) -> dict:
        """A metric of the whole timed part: the sum of LIKWID's phases, else perf_event, else callgrind, else null."""
        parts = [phase[name] for phase in phases.values()]
        if parts and all(part["status"] == "measured" for part in parts):
            return measured(sum(part["value"] for part in parts), "likwid")
        reasons = [next((part["reason"] for part in parts if part["reason"]), f"likwid: {self.no_likwid}")]
        timed = record["counters"].get(name)
        if timed and timed["status"] == "measured":
            return timed
        if timed:
            reasons.append(timed["reason"])
        if name == "instructions":
            count, why = self._by_callgrind(point)
            if count is not None:
                return measured(count, "callgrind")
            reasons.append(why)
        return unavailable("; ".join(dict.fromkeys(reasons)))

    def _by_callgrind(self, point: Point) -> tuple[int | None, str]:
        if point.params.get("threads", 1) != 1:
            return None, "callgrind: one thread only"
        program, why = callgrind.portable_program(self.bench.program.name, self.root)
        if program is None:
            return None, why
        return callgrind.instructions(self._command(replace(self.bench, path=program), point), self.spec.time_limit_s)


def cpus_for(record: dict) -> list[int]:
    """One hardware thread per core for every thread of the point, a socket filled before the next is begun."""
    threads = record["params"]["threads"]
    return record["machine"].get("core_cpus", list(range(threads)))[:threads]


def measured(value: float, source: str) -> dict:
    return {"value": value, "source": source, "status": "measured", "reason": None}


def unavailable(reason: str) -> dict:
    return {"value": None, "source": None, "status": "unavailable", "reason": reason}


def load_counters(path: Path, id: str) -> dict | None:
    """What count() left, if it is of this point."""
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
        return value if value["schema"] == SCHEMA and value["point_id"] == id else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _of_phase(metric: Metric, phase: str, regions: dict) -> dict:
    if not metric.rows:
        return unavailable(metric.why_not)
    total = 0.0
    for row in metric.rows:
        found = regions[row.group]
        if isinstance(found, str):
            return unavailable(found)
        try:
            total += found[phase].value(row)
        except NotCounted as reason:
            return unavailable(str(reason))
    return measured(total, "likwid")
