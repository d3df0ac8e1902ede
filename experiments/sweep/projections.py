"""Projections beside the records: of every series over threads, what more threads would take, from a trace of one."""
import subprocess
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from projection.cli import record_wall_us, traced_run
from projection.machine import load_costs, machine_of
from projection.project import limit_of, summary
from projection.trace import TraceError
from sweep import callgrind
from sweep.bench import Bench, point_command
from sweep.errors import SweepError
from sweep.points import Point
from sweep.spec import Spec
from sweep.store import Store, now, write_json


@dataclass
class Projecting:
    """Projects points of one spec that ran on one thread; their records on one and two are what it is held against."""
    spec: Spec
    store: Store
    bench: Bench
    root: Path

    def project(self, one: Point, two: Point | None) -> dict[str, Any]:
        """Traces the point, replays it, and keeps the result."""
        try:
            record = self.store.load(one.id)[0]
            measured = record_wall_us(record, one.name) / record_wall_us(self.store.load(two.id)[0], two.name) if two else None
            costs = load_costs(self.store.folder.parent / "machine_costs.json", self.bench.path.parent / "machine_costs")
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "trace.json"
                subprocess.run(self._command(self.bench, one, ["--trace", str(path)]), check=True, capture_output=True,
                               text=True, timeout=self.spec.time_limit_s)
                trace = traced_run(path)
            traffic, why = self._bytes_per_step(one)
            machine = machine_of(costs, trace.runtime, (traffic or 0) / record_wall_us(record, one.name))
        except TraceError as error:
            raise SweepError(str(error)) from None
        except subprocess.SubprocessError as error:
            raise SweepError(f"the traced run of {one.name} failed ({error}).") from None
        found = summary(trace, machine, measured) | {
            "point_id": one.id, "started_utc": now(), "params": record["params"], "machine_costs": costs,
            "bytes_per_step": {"value": traffic, "source": None if traffic is None else "callgrind, 4 MB of cache per core",
                               "status": "unavailable" if traffic is None else "measured", "reason": why or None}}
        write_json(self.store.projection_path(one.id), found)
        return found

    def _command(self, bench: Bench, point: Point, outputs: list[str]) -> list[str]:
        once = replace(point, params={**point.params, "repeats": 1, "check_steps": 1})
        start = self.store.state_path(point.start.id) if point.start else None
        return point_command(bench, once, self.spec.folder, ["--record", "/dev/null", *outputs], start)

    def _bytes_per_step(self, point: Point) -> tuple[float | None, str]:
        program, why = callgrind.portable_program(self.bench.program.name, self.root)
        if program is None:
            return None, why
        steps = min(2, point.params["steps"])
        short = replace(point, params={**point.params, "steps": steps, "warmup": 1})
        count, why = callgrind.memory_bytes(self._command(replace(self.bench, path=program), short, []), self.spec.time_limit_s)
        return (None, why) if count is None else (count / steps, "")


def sentence(name: str, found: dict[str, Any]) -> str:
    """What came of a projection."""
    check = found["validation"]
    if not check["trusted"]:
        return f"{name}: WITHHELD, {check['why']}"
    at = {row["threads"]: row for row in found["rows"]}
    return (f"{name}: two threads predicted {check['predicted']:.3f}, measured {check['measured']:.3f}; projected "
            + "; ".join(f"{t} threads {at[t]['speed_up']:.1f} (at least {at[t]['lower']:.1f}), limit {limit_of(at[t])}" for t in (24, 64)))
