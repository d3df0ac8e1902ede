"""tools/project: replays of small traces whose schedules can be worked out by hand."""
import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "experiments"))
from projection.machine import Machine, machine_of  # noqa: E402
from projection.project import project, serial_share, summary  # noqa: E402
from projection.replay import makespan, span  # noqa: E402
from projection.trace import TraceError, load_trace  # noqa: E402

FREE = Machine()
COSTS = {"schema": "trigrain-machine-costs-1", "threads": 2, "trace_us": 0.05, "triad_GB_s": {"1": 10.0, "2": 16.0},
         "runtimes": {name: {"spawn_us": 0.25, "stolen_us": 0.5, "loop_us": 0.1, "barrier_us": 2.0} for name in ("openmp", "tbb")}}


class Events:
    """Events of one thread, one after the other."""

    def __init__(self):
        self.now, self.events = 0.0, []

    def add(self, name, duration=0.0, task=None, step=0, phase="detect"):
        args = {"step": step, "phase": phase} | ({} if task is None else {"task": task})
        self.events.append({"name": name, "ph": "X", "ts": self.now, "dur": duration, "pid": 1, "tid": 0, "args": args})
        self.now += duration + 0.001
        return self

    def write(self, folder: Path) -> Path:
        path = folder / "trace.json"
        path.write_text(json.dumps({"traceEvents": self.events, "otherData": {}}))
        return path


def independent_tasks(count: int, duration: float) -> Events:
    """A producer that spends 1 us per task before it spawns it; then the tasks."""
    events = Events()
    for task in range(count):
        events.add("traverse", 1).add("spawn", task=task)
    for task in range(count):
        events.add("compare", duration, task)
    return events


def test_work_and_span_of_a_producer_with_tasks(tmp_path):
    (section,) = load_trace(independent_tasks(10, 20).write(tmp_path)).steps[0]
    assert section.work() == pytest.approx(10 + 200)
    assert span(section) == pytest.approx(10 + 20)  # the last task begins when the producer has ended
    assert span(section, burden=2) == pytest.approx(10 + 2 + 20)


def test_two_workers_take_half_and_many_take_the_span(tmp_path):
    (section,) = load_trace(independent_tasks(10, 20).write(tmp_path)).steps[0]
    assert makespan(section, 1, FREE) == pytest.approx(210)
    # the other worker takes tasks 0, 1, ... from t = 1; the producer helps from t = 10: 10 tasks of 20 us
    assert makespan(section, 2, FREE) == pytest.approx(110, abs=1.1)
    assert makespan(section, 64, FREE) == pytest.approx(30)


def test_blocks_of_a_loop_are_dealt_out_in_turn_or_taken(tmp_path):
    events = Events()
    for duration in (9, 1, 9, 1):
        events.add("loop", duration)
    (section,) = load_trace(events.write(tmp_path)).steps[0]
    openmp = Machine(runtime="openmp")
    assert makespan(section, 2, openmp) == 18  # the long ones meet on the first thread
    assert makespan(section, 4, openmp) == 9
    assert makespan(section, 2, Machine(runtime="tbb")) == 10


def test_measured_costs_are_charged_once_per_task_and_join(tmp_path):
    (section,) = load_trace(independent_tasks(10, 20).write(tmp_path)).steps[0]
    machine = machine_of(COSTS, "tbb")
    assert makespan(section, 1, machine) == pytest.approx(210 + 20 * 0.25 + 0.1)
    assert makespan(section, 2, machine) == pytest.approx(makespan(section, 2, Machine(stolen_us=0.5)) + 2)
    assert makespan(section, 8, machine) == pytest.approx(makespan(section, 8, Machine(stolen_us=0.5)) + 6)  # log2
    assert makespan(section, 2, Machine(stolen_us=0.5)) >= 110 + 5 * 0.5
    with pytest.raises(TraceError, match="measured on one core"):
        machine_of({**COSTS, "runtimes": {"tbb": {**COSTS["runtimes"]["tbb"], "stolen_us": None}}}, "tbb")


def test_a_serial_piece_bounds_the_speed_up(tmp_path):
    trace = load_trace(independent_tasks(100, 9).add("serial", 100).write(tmp_path))
    assert serial_share(trace) == pytest.approx(100 / 1100)
    rows = {row.threads: row for row in project(trace, FREE)}
    assert rows[1].projected == pytest.approx(1100)
    assert rows[64].projected > 200
    assert rows[64].least <= rows[64].projected <= rows[64].most


def test_bandwidth_slows_what_is_parallel(tmp_path):
    (section,) = load_trace(independent_tasks(64, 100).write(tmp_path)).steps[0]
    half = Machine(bytes_per_us=5, socket_bytes_per_us=10, cores_per_socket=8)
    assert makespan(section, 8, half) == pytest.approx(4 * makespan(section, 8, FREE))
    assert makespan(section, 16, half) == pytest.approx(4 * makespan(section, 16, FREE))  # of a second socket


def test_the_band_holds_what_is_projected(tmp_path):
    trace = load_trace(independent_tasks(37, 11).add("serial", 30).write(tmp_path))
    for row in project(trace, machine_of(COSTS, "tbb")):
        assert row.least <= row.projected <= row.most
        assert 0.99 < sum(row.limits.values()) + row_work(trace, row) < 1.01


def row_work(trace, row) -> float:
    """Share of the threads' time that is work."""
    return sum(section.work() for section in trace.steps[0]) / row.threads / row.projected


def test_all_that_is_known_is_stored(tmp_path):
    trace = load_trace(independent_tasks(100, 20).add("serial", 21).write(tmp_path))
    found = summary(trace, machine_of(COSTS, "tbb", bytes_per_us=100), 1.9)
    assert found["validation"]["residual"] == pytest.approx(found["validation"]["predicted"] / 1.9 - 1)
    assert found["validation"]["trusted"] and not summary(trace, FREE, None)["validation"]["trusted"]
    assert found["serial_share"] == pytest.approx(21 / 2121)
    assert found["tasks_per_step"] == 100 and found["median_task_us"] == 20
    assert found["rows"][0]["memory_GB_s"] == pytest.approx(0.1)


def test_a_task_goes_on_after_it_has_spawned(tmp_path):
    events = Events().add("traverse", 1).add("spawn", task=1)
    events.add("compare", 5, 1).add("spawn", task=2).add("compare", 7, 1).add("part", 3, 2)
    (section,) = load_trace(events.write(tmp_path)).steps[0]
    assert span(section) == pytest.approx(1 + 5 + 7)
    assert makespan(section, 2, FREE) == pytest.approx(13)


@pytest.mark.parametrize("text", ["", "[]", '{"traceEvents": []}', '{"traceEvents": [{"name": 1}], "otherData": {}}'])
def test_what_is_no_trace_is_refused(tmp_path, text):
    path = tmp_path / "trace.json"
    path.write_text(text)
    with pytest.raises(TraceError, match="dem_bench --trace"):
        load_trace(path)


def record(folder: Path, name: str, wall: float) -> str:
    path = folder / name
    path.write_text(json.dumps({"check": {"passed": True}, "samples": [{"wall_s": wall, "steps": 1}]}))
    return str(path)


@pytest.mark.parametrize(("two", "code"), [(1.10, 0), (1.60, 1)])
def test_a_projection_that_misses_two_threads_is_withheld(tmp_path, two, code):
    trace = independent_tasks(100, 20).write(tmp_path)
    (tmp_path / "costs.json").write_text(json.dumps(COSTS))
    done = subprocess.run([ROOT / "tools/project", trace, "--one", record(tmp_path, "one.json", 2.1),
                           "--two", record(tmp_path, "two.json", two), "--costs", tmp_path / "costs.json",
                           "--json", tmp_path / "out.json"], capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    assert json.loads((tmp_path / "out.json").read_text())["validation"]["trusted"] == (code == 0)
    assert ("WITHHELD" in done.stdout) == (code == 1)
    assert ("64 " in done.stdout) == (code == 0)
