"""What became of every point of a spec, and the index that says so to the plots."""
import statistics
from collections import Counter
from dataclasses import dataclass

from sweep.bench import Bench
from sweep.points import Point
from sweep.spec import Spec
from sweep.store import Store, now

FINISHED = "finished"
CHECK_FAILED = "check failed"
EXPECTED = "check failed as expected"
FAILED = "failed"
MISSING = "missing"
BIGGER_MACHINE = "needs a bigger machine"
NOT_AVAILABLE = "not available in this build"
ORDER = (FINISHED, EXPECTED, CHECK_FAILED, FAILED, MISSING, BIGGER_MACHINE, NOT_AVAILABLE)


@dataclass(frozen=True)
class PointStatus:
    """`state` is one of ORDER; `why` says more where there is more to say. `other_commit`: the record was made by
    another build than the present one."""
    point: Point
    state: str
    why: str = ""
    other_commit: bool = False
    broken: str | None = None
    took_s: float | None = None  # of its processes, where it has run
    speed: str = ""  # median time of its samples, where it finished


def status_of(point: Point, store: Store, bench: Bench | None, cores: int) -> PointStatus:
    """Looks at the record first: one that was made elsewhere counts, whatever this machine and build can do."""
    record, broken = store.load(point.id)
    if record is not None:
        commit = record.get("build", {}).get("commit")
        other = bench is not None and bench.commit is not None and commit is not None and commit != bench.commit
        took_s = record.get("sweep", {}).get("took_s")
        if record["status"] == "failed":
            return PointStatus(point, FAILED, record.get("reason", ""), other, took_s=took_s)
        return PointStatus(point, *verdict(point, record["check"]), other, took_s=took_s, speed=_speed(record["samples"]))
    lacking = bench and (bench.lacks(point.params) or (point.start and bench.lacks(point.start.params)))
    if lacking:
        return PointStatus(point, NOT_AVAILABLE, lacking, broken=broken)
    threads = point.params.get("threads", 1)
    if threads > cores:
        return PointStatus(point, BIGGER_MACHINE, f"{threads} threads, {cores} cores here", broken=broken)
    return PointStatus(point, MISSING, broken=broken)


def verdict(point: Point, check: dict) -> tuple[str, str]:
    """State of a point that ran to its end, and why it is not "finished"."""
    if check["passed"]:
        return FINISHED, ""
    failed = dict.fromkeys(str(how.get("what")) for how in check.get("how", []) if not how.get("passed"))
    baseline = point.expected_failure
    if baseline and list(failed) == [baseline.check]:
        return EXPECTED, f"{baseline.check}: {baseline.why}"
    return CHECK_FAILED, ", ".join(failed)


def _speed(samples: list[dict]) -> str:
    """"1.2 ms per step": wall time of a step of the engine, CPU time of a pair of a kernel; empty where there is none."""
    for clock, unit in (("wall_s", "steps"), ("cpu_s", "pairs")):
        times = [sample[clock] / sample[unit] for sample in samples if sample.get(unit) and clock in sample]
        if times:
            return f"{_prefixed(statistics.median(times))}s per {unit[:-1]}"
    return ""


def _prefixed(value: float) -> str:
    """"1.23 m" for 0.00123."""
    factor, prefix = next((each for each in ((1, ""), (1e-3, "m"), (1e-6, "u")) if value >= each[0]), (1e-9, "n"))
    return f"{value / factor:.3g} {prefix}"


def counts(statuses: list[PointStatus]) -> str:
    """"3 finished, 2 missing"."""
    number = Counter(status.state for status in statuses)
    return ", ".join(f"{number[state]} {state}" for state in ORDER if number[state]) or "no points"


def write_index(store: Store, spec: Spec, statuses: list[PointStatus], cores: int) -> None:
    """States of all points of the preset last run, for plots and report."""
    store.write_index({
        "spec": spec.name, "preset": spec.preset, "title": spec.title, "about": spec.about,
        "elsewhere": spec.elsewhere, "cores": cores, "written_utc": now(),
        "points": [{"id": status.point.id, "name": status.point.name, "params": status.point.params,
                    "state": status.state, "why": status.why,
                    "expected_failure": vars(status.point.expected_failure) if status.point.expected_failure else None,
                    "start_state": status.point.start.id if status.point.start else None} for status in statuses]})
