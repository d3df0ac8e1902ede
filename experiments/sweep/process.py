"""Runs one child process with a time limit; stops it when the sweep is asked to stop."""
import os
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


def run(command: list[str], time_limit_s: float, stop: Stop, tick: Callable[[float], None]) -> Outcome:
    """Runs to the end, the limit or the stop. The child has its own process group, so that ctrl-C reaches the sweep
    alone, and none of its children outlives it."""
    began = time.monotonic()
    with tempfile.TemporaryFile() as output:
        try:
            child = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                     start_new_session=True)
        except OSError as error:
            return Outcome(127, [str(error)], 0.0)
        timed_out = stopped = False
        try:
            while child.poll() is None:
                took = time.monotonic() - began
                stopped, timed_out = stop.signal is not None, took > time_limit_s
                if stopped or timed_out:
                    break
                tick(took)
                _wait(child, min(TICK_S, max(0.01, time_limit_s - took)))
        finally:
            _end(child)
        return Outcome(child.returncode, _tail(output), time.monotonic() - began, timed_out, stopped)


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
