"""Runs what is missing, one process at a time, and records what happened."""
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from sweep import process, status
from sweep.bench import Bench, point_command, state_command
from sweep.errors import SweepError
from sweep.points import Point, StartState, comparable
from sweep.progress import Progress, duration
from sweep.rounds import Rounds
from sweep.spec import Spec
from sweep.store import DISK_FULL, Store, load_record, now

CHECK_FAILED_EXIT = 1
OUT_OF_MEMORY = ("bad_alloc", "Cannot allocate memory")  # C++, the system


class Interrupted(Exception):
    """A signal ended the sweep; nothing half is left."""


@dataclass
class Runner:
    """Runs points of one spec into one store."""
    spec: Spec
    store: Store
    bench: Bench
    cores: int
    stop: process.Stop

    def run(self, points: list[Point]) -> None:
        """Runs all `points` in order, whatever becomes of each; compared ones take turns. Interrupted if a signal
        came, SweepError if the disk is full."""
        states = missing_states(points, self.store)
        progress = Progress(len(points) + len(states), self.store.log)
        broken_states: dict[str, str] = {}
        for group in comparable(points, self.spec.interleave):
            ready = []
            for point in group:
                if point.start and point.start in states:
                    states.remove(point.start)
                    trouble = self._prepare(point.start, progress)
                    if trouble:
                        broken_states[point.start.id] = trouble
                if point.start and point.start.id in broken_states:
                    self._fail(point, {"reason": f"its start state failed: {broken_states[point.start.id]}"}, 0, progress)
                else:
                    ready.append(point)
            if len(ready) > 1:
                self._run_in_turns(ready, progress)
            else:
                for point in ready:
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
        trouble = _trouble(outcome, self._limits())
        if trouble is None and not part.exists():
            trouble = "no state was written"
        if trouble is None:
            os.replace(part, final)
        part.unlink(missing_ok=True)
        progress.finish(state.id, name, trouble or duration(outcome.took_s), outcome.took_s, bool(trouble))
        return trouble

    def _run_point(self, point: Point, progress: Progress) -> None:
        record, failure, took_s = self._measure(point, point.name, progress)
        if record is None:
            self._fail(point, failure, took_s, progress)
        else:
            self._keep(point, record, took_s, progress)

    def _run_in_turns(self, points: list[Point], progress: Progress) -> None:
        """Repeats of the points in turn, A B A B, each a process of its own; the machine's moods hit all alike."""
        rounds = {point.id: Rounds(point) for point in points}
        running = list(points)
        for number in range(max(each.wanted for each in rounds.values())):
            for point in list(running):
                mine = rounds[point.id]
                if number >= mine.wanted:
                    continue
                name = f"{point.name} (repeat {number + 1} of {mine.wanted})"
                record, failure, took_s = self._measure(mine.next_point(), name, progress)
                mine.took_s += took_s
                if record is None:
                    running.remove(point)
                    self._fail(point, failure, mine.took_s, progress)
                else:
                    mine.records.append(record)
        for point in running:
            self._keep(point, rounds[point.id].joined(), rounds[point.id].took_s, progress)

    def _measure(self, point: Point, name: str, progress: Progress) -> tuple[dict | None, dict, float]:
        """One process: its record or None, what is to be said of a failure, and how long it ran (s)."""
        part = self.store.record_path(point.id).with_suffix(f".{os.getpid()}.part")
        outputs = ["--record", str(part)]
        if "vtk_every_s" in point.params:
            frames = self.store.frames(point.id)
            frames.parent.mkdir(exist_ok=True)
            outputs += ["--vtk", str(frames)]
        if self.spec.trace:
            trace = self.store.trace_path(point.id)
            trace.parent.mkdir(exist_ok=True)
            outputs += ["--trace", str(trace)]
        start = self.store.state_path(point.start.id) if point.start else None
        command = point_command(self.bench, point, self.spec.folder, outputs, start)
        outcome = self._run(command, name, progress, part)
        trouble, record = _trouble(outcome, self._limits(), may_fail_check=True), None
        if trouble is None:
            record, broken = load_record(part, point.id)
            if record is None:
                what = f"a broken record: {broken}" if broken else "no record"
                trouble = f"exit code {outcome.exit_code}, but {what}"
        part.unlink(missing_ok=True)
        failure = {"exit_code": outcome.exit_code, "reason": trouble, "output": outcome.output, "command": command}
        return record, failure, outcome.took_s

    def _limits(self) -> process.Limits:
        return process.Limits(self.spec.time_limit_s, self.spec.memory_limit_mb)

    def _run(self, command: list[str], name: str, progress: Progress, part: Path) -> process.Outcome:
        if self.stop.signal is None:
            outcome = process.run(command, self._limits(), self.stop, lambda s: progress.tick(name, s))
            if outcome.exit_code and any(os.strerror(number) in line for number in DISK_FULL for line in outcome.output):
                part.unlink(missing_ok=True)
                raise SweepError(f"the disk is full ({self.store.folder}). Free some space; the same command resumes.")
            if not outcome.stopped:
                return outcome
        part.unlink(missing_ok=True)
        raise Interrupted

    def _keep(self, point: Point, record: dict, took_s: float, progress: Progress) -> None:
        self.store.write_record(point.id, record, took_s)
        state, why = status.verdict(point, record["check"])
        said = {status.FINISHED: "", status.EXPECTED: f", {state} ({why})"}.get(state, f", CHECK FAILED ({why})")
        progress.finish(point.id, point.name, duration(took_s) + said, took_s, trouble=state == status.CHECK_FAILED)

    def _fail(self, point: Point, failure: dict, took_s: float, progress: Progress) -> None:
        self.store.write_failure(point.id, point.params, {**failure, "ended_utc": now()}, took_s)
        progress.finish(point.id, point.name, f"FAILED, {failure['reason']}", took_s, trouble=True)


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


def _trouble(outcome: process.Outcome, limits: process.Limits, may_fail_check: bool = False) -> str | None:
    if outcome.timed_out:
        return f"stopped at the time limit of {duration(limits.time_s)}"
    if outcome.exit_code and any(words in line for words in OUT_OF_MEMORY for line in outcome.output):
        of = f" of {limits.memory_mb:g} MB" if limits.memory_mb else ""
        return f"out of memory{of}"
    if outcome.exit_code == -9:
        return "killed by signal 9, as the kernel does when memory runs out"
    if outcome.exit_code < 0:
        return f"killed by signal {-outcome.exit_code}"
    if outcome.exit_code == 0 or (may_fail_check and outcome.exit_code == CHECK_FAILED_EXIT):
        return None
    return ": ".join([f"exit code {outcome.exit_code}", *outcome.output[-1:]])
