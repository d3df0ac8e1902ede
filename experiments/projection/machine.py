"""What the replay knows of the machine it is for."""
import json
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from projection.trace import Section, TraceError

SCHEMA = "trigrain-machine-costs-1"


@dataclass(frozen=True)
class Machine:
    """Costs in us beside the work itself, as machine_costs measures them, and the bandwidth of a socket."""
    runtime: str = "tbb"
    spawn_us: float = 0.0  # per task, on one thread
    stolen_us: float = 0.0  # per task, where others may take it
    loop_us: float = 0.0  # per loop or join, on one thread
    barrier_us: float = 0.0  # per loop or join on two threads; on more it grows with log2 of their number
    trace_us: float = 0.0  # per piece of work that was recorded
    bytes_per_us: float = 0.0  # that one thread of this run moves to and from memory
    socket_bytes_per_us: float = float("inf")  # STREAM triad
    cores_per_socket: int = 64

    def slowdown(self, workers: int) -> float:
        """Roofline: work cannot be faster than the bandwidth of the sockets in use allows."""
        sockets = -(-workers // self.cores_per_socket)
        return max(1.0, self.bytes_per_us * workers / (sockets * self.socket_bytes_per_us))

    def barrier(self, workers: int) -> float:
        return self.barrier_us * max(0, workers - 1).bit_length()

    def overhead_of_one(self, section: Section) -> float:
        return self.loop_us + (self.spawn_us * len(section.pieces) if section.kind == "tasks" else 0.0)


def machine_of(costs: dict[str, Any], runtime: str, bytes_per_us: float = 0.0, cores_per_socket: int = 64) -> Machine:
    """The machine that left `costs`. TraceError if it could not measure two threads."""
    own = costs["runtimes"][runtime]
    if own["stolen_us"] is None:
        raise TraceError("the costs of sharing work are not known: they were measured on one core (machine_costs). "
                         "Measure them on two or more.")
    triad = costs["triad_GB_s"][str(costs["threads"])] * 1e3
    # A cost that is lost in the noise of the measurement is none.
    known = {key: max(0.0, own[key]) for key in ("spawn_us", "stolen_us", "loop_us", "barrier_us")}
    return Machine(runtime, **known, trace_us=costs["trace_us"], bytes_per_us=bytes_per_us, socket_bytes_per_us=triad, cores_per_socket=cores_per_socket)


def load_costs(path: Path, program: Path) -> dict[str, Any]:
    """The costs in that file, which `program` writes first if it is missing."""
    if not path.exists():
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            subprocess.run([program, "--out", path], check=True, capture_output=True, text=True)
        except (OSError, subprocess.CalledProcessError) as error:
            raise TraceError(f"cannot measure the costs of sharing work ({program}: {error}). Build machine_costs, or name "
                             "its file.") from None
    try:
        costs = json.loads(path.read_text(encoding="utf-8"))
        if costs["schema"] != SCHEMA:
            raise ValueError(f"schema is {costs['schema']}")
        return costs
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise TraceError(f"cannot read the costs of sharing work ({path}: {error}). machine_costs --out writes them.") from None
