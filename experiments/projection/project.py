"""From a trace to numbers: time per step over threads, its bounds, and what ends the scaling."""
import statistics
from dataclasses import dataclass, replace
from typing import Any

from projection.machine import Machine
from projection.replay import makespan, span
from projection.trace import Section, Trace

SCHEMA = "trigrain-projection-1"
THREADS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
TRUSTED = 0.05  # a projection whose prediction of two threads is further off is withheld


@dataclass(frozen=True)
class Row:
    """Times per step (us) on so many threads. Every greedy schedule of these pieces takes at least max(work / threads,
    span) and at most work / threads + burdened span (Brent 1974): the band [least, most]."""
    threads: int
    projected: float
    least: float
    most: float
    limits: dict[str, float]  # what the threads' time goes to, besides work: shares that add up with it to 1


def typical_steps(trace: Trace, most: int = 9) -> list[list[Section]]:
    """Steps around the median wall time."""
    order = sorted(range(len(trace.steps)), key=lambda i: trace.walls[i])
    first = max(0, (len(order) - most) // 2)
    return [trace.steps[i] for i in order[first:first + most]]


def project(trace: Trace, machine: Machine, threads: tuple[int, ...] = THREADS) -> list[Row]:
    """Medians over typical steps."""
    rows = [[_row(step, count, machine) for step in typical_steps(trace)] for count in threads]
    return [_median(row) for row in rows]


def serial_share(trace: Trace) -> float:
    """Share of a step's work that one thread does while the others wait."""
    return statistics.median(_serial(step) / _work(step) for step in typical_steps(trace))


def task_lengths(trace: Trace) -> list[float]:
    """Of all compared batches and parts (us), sorted."""
    return sorted(piece.duration for step in typical_steps(trace) for section in step for piece in section.pieces
                  if piece.name in ("compare", "part"))


def summary(trace: Trace, machine: Machine, measured_on_two: float | None) -> dict[str, Any]:
    """All that is known of the run on more threads, as JSON. `measured_on_two`: speed-up that records show."""
    rows = project(trace, machine)
    steps, lengths = typical_steps(trace), task_lengths(trace)
    one, two = rows[0].projected, next(row.projected for row in rows if row.threads == 2)
    tasks = statistics.median(sum(_tasks(section) for section in step) for step in steps)
    return {
        "schema": SCHEMA,
        "validation": _validation(one / two, measured_on_two),
        "work_us": statistics.median(map(_work, steps)),
        "span_us": statistics.median(sum(map(span, step)) for step in steps),
        "burdened_span_us": statistics.median(_burdened_span(step, 2, machine) for step in steps),
        "serial_share": serial_share(trace),
        "tasks_per_step": tasks,
        "median_task_us": statistics.median(lengths) if lengths else None,
        "spawn_share": tasks * machine.spawn_us / one,
        "trace_share": statistics.median(sum(len(section.pieces) for section in step) for step in steps) * machine.trace_us / one,
        "rows": [{"threads": row.threads, "us_per_step": row.projected, "speed_up": one / row.projected,
                  "lower": one / row.most, "upper": one / row.least, "limits": row.limits,
                  "memory_GB_s": machine.bytes_per_us * one / row.projected / 1e3} for row in rows],
    }


def _validation(predicted: float, measured: float | None) -> dict[str, Any]:
    if measured is None:
        return {"predicted": predicted, "measured": None, "residual": None, "trusted": False,
                "why": "nothing was measured on two threads"}
    residual = predicted / measured - 1
    trusted = abs(residual) <= TRUSTED
    why = "" if trusted else f"it misses two threads by {100 * residual:+.1f} %, more than {100 * TRUSTED:.0f} %"
    return {"predicted": predicted, "measured": measured, "residual": residual, "trusted": trusted, "why": why}


def limit_of(row: dict[str, Any]) -> str:
    """What takes most of the threads' time beside work, in words."""
    name, share = max(row["limits"].items(), key=lambda item: item[1])
    return f"{name} ({100 * share:.1f} % of the threads' time)"


def _work(step: list[Section]) -> float:
    return sum(section.work() for section in step)


def _serial(step: list[Section]) -> float:
    return sum(section.work() for section in step if section.kind == "serial")


def _tasks(section: Section) -> int:
    return sum(len(piece.spawns) for piece in section.pieces) if section.kind == "tasks" else 0


def _burdened_span(step: list[Section], threads: int, machine: Machine) -> float:
    joins = sum(machine.barrier(threads) for section in step if section.kind != "serial")
    return sum(span(section, machine.stolen_us) for section in step) + joins


def _row(step: list[Section], threads: int, machine: Machine) -> Row:
    work, serial = _work(step), _serial(step)
    taken = sum(makespan(section, threads, machine) for section in step)
    slow = machine.slowdown(threads)
    free = replace(machine, spawn_us=0, stolen_us=0, loop_us=0, barrier_us=0, bytes_per_us=0)
    unburdened = sum(makespan(section, threads, free) for section in step) - serial
    limits = {"serial": serial * (1 - 1 / threads), "imbalance and span": unburdened - (work - serial) / threads,
              "bandwidth": (slow - 1) * unburdened, "overhead": taken - serial - slow * unburdened}
    least = max(work / threads, sum(map(span, step)))
    burden = sum(_tasks(section) for section in step) * machine.stolen_us
    most = slow * (work + burden) / threads + _burdened_span(step, threads, machine) if threads > 1 else taken
    return Row(threads, taken, least, max(most, taken), {name: value / taken for name, value in limits.items()})


def _median(rows: list[Row]) -> Row:
    return sorted(rows, key=lambda row: row.projected)[len(rows) // 2]
