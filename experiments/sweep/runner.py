"""Runs what is missing, one process at a time, and records what happened."""
import os
import sys
from dataclasses import dataclass, field
from pathlib import Path

from sweep import process, status
from sweep.bench import Bench, point_command, state_command
from sweep.points import Point, StartState
from sweep.progress import Progress, duration
from sweep.spec import Spec
from sweep.store import Store, load_record, now

CHECK_FAILED_EXIT = 1


class Interrupted(Exception):
    """A signal ended the sweep; nothing half is left."""


@dataclass
class Runner:
    """Runs points of one spec into one store. `took_s` gathers how long each process ran, by point id."""
    spec: Spec
    store: Store
    bench: Bench
    cores: int
    stop: process.Stop
    took_s: dict[str, float] = field(default_factory=dict)

    def run(self, points: list[Point]) -> None:
        """Runs all `points` in order, whatever becomes of each. Interrupted if a signal came."""
        states = missing_states(points, self.store)
        progress = Progress(len(points) + len(states))
        broken_states: dict[str, str] = {}
        for point in points:
            if point.start and point.start in states:
                states.remove(point.start)
                trouble = self._prepare(point.start, progress)
                if trouble:
                    broken_states[point.start.id] = trouble
            if point.start and point.start.id in broken_states:
                self._fail(point, {"reason": f"its start state failed: {broken_states[point.start.id]}"}, progress)
            else:
                self._run_point(point, progress)

    def _prepare(self, state: StartState, progress: Progress) -> str | None:
        """Computes a start state; what went wrong, or None."""
        self.store.states.mkdir(parents=True, exist_ok=True)
        final = self.store.state_path(state.id)
        part = final.with_suffix(f".{os.getpid()}.part")
        record = final.with_suffix(".record")
        outputs = ["--final-state", str(part), "--record", str(record)]
        command = state_command(self.bench, state, self.spec.folder, self.cores, outputs)
        name = f"start state {state.id}"
        outcome = self._run(command, name, progress, part)
        trouble = _trouble(outcome, self.spec.time_limit_s)
        if trouble is None and not part.exists():
            trouble = "no state was written"
        if trouble is None:
            os.replace(part, final)
        part.unlink(missing_ok=True)
        progress.finish(name, trouble or duration(outcome.took_s))
        return " | ".join([trouble, *outcome.output[-1:]]) if trouble else None

    def _run_point(self, point: Point, progress: Progress) -> None:
        part = self.store.record_path(point.id).with_suffix(f".{os.getpid()}.part")
        outputs = ["--record", str(part)]
        if "vtk_every_s" in point.params:
            frames = self.store.frames(point.id)
            frames.parent.mkdir(exist_ok=True)
            outputs += ["--vtk", str(frames)]
        start = self.store.state_path(point.start.id) if point.start else None
        command = point_command(self.bench, point, self.spec.folder, outputs, start)
        outcome = self._run(command, point.name, progress, part)
        self.took_s[point.id] = round(outcome.took_s, 3)
        trouble = _trouble(outcome, self.spec.time_limit_s, may_fail_check=True)
        if trouble is None:
            record, broken = load_record(part, point.id)
            if record is not None:
                os.replace(part, self.store.record_path(point.id))
                passed = record["status"] == "finished" and record["check"]["passed"]
                progress.finish(point.name, duration(outcome.took_s) + ("" if passed else ", CHECK FAILED"))
                return
            trouble = f"exit code {outcome.exit_code}, but {'a broken record: ' + broken if broken else 'no record'}"
        part.unlink(missing_ok=True)
        self._fail(point, {"exit_code": outcome.exit_code, "reason": trouble, "output": outcome.output,
                           "took_s": round(outcome.took_s, 3), "command": command}, progress)

    def _run(self, command: list[str], name: str, progress: Progress, part: Path) -> process.Outcome:
        if self.stop.signal is None:
            outcome = process.run(command, self.spec.time_limit_s, self.stop, lambda s: progress.tick(name, s))
            if not outcome.stopped:
                return outcome
        part.unlink(missing_ok=True)
        raise Interrupted

    def _fail(self, point: Point, failure: dict, progress: Progress) -> None:
        self.store.write_failure(point.id, point.params, {**failure, "ended_utc": now()})
        progress.finish(point.name, f"FAILED, {failure['reason']}")


def missing_states(points: list[Point], store: Store) -> list[StartState]:
    """Start states that these points need and that are not there yet, each once, in order of need."""
    needed = dict.fromkeys(point.start for point in points if point.start)
    return [state for state in needed if not store.state_path(state.id).exists()]


def set_aside_broken(statuses: list[status.PointStatus], store: Store) -> None:
    """Renames files that are no records and says so."""
    for each in statuses:
        if each.broken:
            aside = store.set_aside_broken(each.point.id)
            print(f"warning: {store.record_path(each.point.id)} is no record ({each.broken}). "
                  f"Renamed to {aside.name}; the point counts as missing.", file=sys.stderr)


def _trouble(outcome: process.Outcome, limit_s: float, may_fail_check: bool = False) -> str | None:
    if outcome.timed_out:
        return f"stopped at the time limit of {duration(limit_s)}"
    if outcome.exit_code < 0:
        return f"killed by signal {-outcome.exit_code}"
    if outcome.exit_code == 0 or (may_fail_check and outcome.exit_code == CHECK_FAILED_EXIT):
        return None
    return f"exit code {outcome.exit_code}"
