"""From a trace to numbers: time per step over threads, its bounds, and what ends the scaling."""
import statistics
from dataclasses import dataclass

from projection.replay import Machine, makespan, span
from projection.trace import Section, Trace

THREADS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
TRUSTED = 0.05  # a projection whose prediction of two threads is further off is withheld


@dataclass(frozen=True)
class Row:
    """Times per step (us) on so many threads; every schedule lies within [least, most]."""
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
    shares = []
    for step in typical_steps(trace):
        serial = sum(section.work() for section in step if section.kind == "serial")
        shares.append(serial / sum(section.work() for section in step))
    return statistics.median(shares)


def task_lengths(trace: Trace) -> list[float]:
    """Of all compared batches and parts (us), sorted."""
    return sorted(piece.duration for step in typical_steps(trace) for section in step for piece in section.pieces
                  if piece.name in ("compare", "part"))


def _row(step: list[Section], threads: int, machine: Machine) -> Row:
    work = sum(section.work() for section in step)
    chain = sum(span(section, machine.spawn_us) for section in step)
    taken = sum(makespan(section, threads, machine) for section in step)
    serial = sum(section.work() for section in step if section.kind == "serial")
    parts = [section for section in step if section.kind != "serial"]
    slow = machine.slowdown(threads)
    free = Machine(spawn_us=0, barrier_us=0)
    balanced = sum(section.work() for section in parts) / threads
    unburdened = sum(makespan(section, threads, free) for section in parts)
    limits = {"serial": serial * (1 - 1 / threads), "imbalance and span": unburdened - balanced,
              "bandwidth": (slow - 1) * unburdened,
              "overhead": taken - serial - slow * unburdened}
    return Row(threads, taken, max(work / threads, chain), work / threads + chain,
               {name: value / taken for name, value in limits.items()})


def _median(rows: list[Row]) -> Row:
    return sorted(rows, key=lambda row: row.projected)[len(rows) // 2]
