"""List scheduling of traced sections on P workers, and the bounds that hold for every schedule."""
import heapq
from collections import deque

from projection.machine import Machine
from projection.trace import Piece, Section


def span(section: Section, burden: float = 0.0) -> float:
    """Longest chain (us) of pieces that must follow each other; `burden` is added for every task on it."""
    memo: dict[int, float] = {}
    order: list[Piece] = []
    stack = list(section.roots)
    while stack:
        piece = stack.pop()
        order.append(piece)
        stack += piece.spawns + ([piece.then] if piece.then else [])
    for piece in reversed(order):
        rest = [memo[id(piece.then)]] if piece.then else []
        rest += [memo[id(child)] + burden for child in piece.spawns]
        memo[id(piece)] = piece.duration + max(rest, default=0.0)
    return max((memo[id(root)] for root in section.roots), default=0.0)


def makespan(section: Section, workers: int, machine: Machine) -> float:
    """Time (us) that the section takes on so many workers, with what the machine charges for sharing it out."""
    if section.kind == "serial":
        return section.work()
    if workers == 1:
        return section.work() + machine.overhead_of_one(section)
    slow = machine.slowdown(workers)
    if section.kind == "tasks":
        return slow * _taken(section, workers, machine.stolen_us) + machine.barrier(workers)
    dealt = machine.runtime == "openmp"
    return slow * (_dealt_out(section, workers) if dealt else _taken(section, workers, 0.0)) + machine.barrier(workers)


def _dealt_out(section: Section, workers: int) -> float:
    """Blocks in turn, as OpenMP's schedule(static, 1) deals them."""
    load = [0.0] * workers
    for number, piece in enumerate(section.pieces):
        load[number % workers] += piece.duration
    return max(load)


def _taken(section: Section, workers: int, burden: float) -> float:
    """Greedy: a worker goes on with its own piece, an idle one takes the oldest that is waiting."""
    waiting: deque[Piece] = deque(section.roots)
    idle = list(range(workers))
    running: list[tuple[float, int, int, Piece]] = []  # end, ticket, worker, piece
    now, ticket = 0.0, 0
    while waiting or running:
        while waiting and idle:
            worker, piece = idle.pop(), waiting.popleft()
            heapq.heappush(running, (now + burden + piece.duration, ticket, worker, piece))
            ticket += 1
        now, _, worker, piece = heapq.heappop(running)
        waiting.extend(piece.spawns)
        if piece.then:
            heapq.heappush(running, (now + piece.then.duration, ticket, worker, piece.then))
            ticket += 1
        else:
            idle.append(worker)
    return now
