"""Runs one child process within limits; stops it when the sweep is asked to stop, and when the sweep is killed."""
import ctypes
import os
import resource
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

KEPT_LINES = 20
TICK_S = 0.5
GRACE_S = 5.0
PR_SET_PDEATHSIG = 1  # linux/prctl.h
LIBC = ctypes.CDLL(None)


@dataclass(frozen=True)
class Limits:
    """What a process may use: wall time (s) and, if given, address space (MB)."""
    time_s: float
    memory_mb: float | None = None


class Stop:
    """Set by the first SIGINT, SIGTERM or SIGHUP."""

    def __init__(self):
        self.signal: int | None = None

    @contextmanager
    def listening(self) -> Iterator[None]:
        def note(number: int, _frame) -> None:
            self.signal = self.signal or number

        before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


@dataclass(frozen=True)
class Outcome:
    """How a process ended. exit_code is negative for the signal that killed it; output holds its last lines."""
    exit_code: int
    output: list[str]
    took_s: float
    timed_out: bool = False
    stopped: bool = False


def run(command: list[str], limits: Limits, stop: Stop, tick: Callable[[float], None]) -> Outcome:
    """Runs to the end, the limit or the stop. The child has its own process group, so that ctrl-C reaches the sweep
    alone, and none of its children outlives it; it dies with a sweep that is killed."""
    began = time.monotonic()
    with tempfile.TemporaryFile() as output:
        try:
            child = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                     start_new_session=True, preexec_fn=lambda: _prepare_child(limits))
        except OSError as error:
            return Outcome(127, [str(error)], 0.0)
        timed_out = stopped = False
        try:
            while child.poll() is None:
                took = time.monotonic() - began
                stopped, timed_out = stop.signal is not None, took > limits.time_s
                if stopped or timed_out:
                    break
                tick(took)
                _wait(child, min(TICK_S, max(0.01, limits.time_s - took)))
        finally:
            _end(child)
        return Outcome(child.returncode, _tail(output), time.monotonic() - began, timed_out, stopped)


def _prepare_child(limits: Limits) -> None:
    """Runs in the child before its program does."""
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if limits.memory_mb:
        limit = int(limits.memory_mb * 1e6)
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    try:  # where memory runs out, the kernel shall take the point and not the sweep
        with open("/proc/self/oom_score_adj", "w", encoding="ascii") as file:
            file.write("900")
    except OSError:
        pass


def _end(child: subprocess.Popen) -> None:
    if child.poll() is None:
        _signal_group(child, signal.SIGTERM)
        _wait(child, GRACE_S)
    _signal_group(child, signal.SIGKILL)
    child.wait()


def _signal_group(child: subprocess.Popen, number: int) -> None:
    try:
        os.killpg(child.pid, number)
    except (ProcessLookupError, PermissionError):
        pass


def _wait(child: subprocess.Popen, seconds: float) -> None:
    try:
        child.wait(seconds)
    except subprocess.TimeoutExpired:
        pass


def _tail(output) -> list[str]:
    size = output.seek(0, os.SEEK_END)
    output.seek(max(0, size - 200 * KEPT_LINES))
    return output.read().decode(errors="replace").splitlines()[-KEPT_LINES:]
