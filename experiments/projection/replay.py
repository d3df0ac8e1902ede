"""List scheduling of traced sections on P workers, and the bounds that hold for every schedule."""
import heapq
from collections import deque
from dataclasses import dataclass

from projection.trace import Piece, Section


@dataclass(frozen=True)
class Machine:
    """What the replay knows of the machine it is for (us; B/us)."""
    spawn_us: float = 0.2  # burden of a task that another worker takes
    barrier_us: float = 1.0  # per section, times log2 of the workers
    one_thread_share: float = 0.0  # of the memory bandwidth of a socket that one thread of this run needs
    cores_per_socket: int = 1 << 30

    def slowdown(self, workers: int) -> float:
        """Roofline: work cannot be faster than the bandwidth of the sockets in use allows."""
        sockets = -(-workers // self.cores_per_socket)
        return max(1.0, self.one_thread_share * workers / sockets)


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
    """Time (us) that the section takes on so many workers."""
    if section.kind == "serial":
        return section.work()
    slow = machine.slowdown(workers)
    barrier = machine.barrier_us * max(0, workers - 1).bit_length()
    if workers == 1:
        return section.work()
    if section.kind == "loop":
        return slow * _dealt_out(section, workers) + barrier
    return slow * _stolen(section, workers, machine.spawn_us) + barrier


def _dealt_out(section: Section, workers: int) -> float:
    """Blocks in turn, as OpenMP's schedule(static, 1) deals them."""
    load = [0.0] * workers
    for number, piece in enumerate(section.pieces):
        load[number % workers] += piece.duration
    return max(load)


def _stolen(section: Section, workers: int, burden: float) -> float:
    """Greedy: a worker goes on with its own newest piece, an idle one takes the oldest that is waiting."""
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
