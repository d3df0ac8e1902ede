"""How a sweep goes: a live line on a terminal, one line per point elsewhere, and one line per point in a log file."""
import sys
import time
from pathlib import Path

from sweep.store import now


class Progress:
    """Done, time left and the current job on one live line of a terminal, where only troubles stay; where there is no
    terminal, a line per job. The log file gets a line per job: time, id, seconds, name and result, by tabs."""

    def __init__(self, total: int, log: Path):
        self.total = total
        self.done = 0
        self.began = time.monotonic()
        self.live = sys.stdout.isatty()
        self.log = log

    def tick(self, name: str, took_s: float) -> None:
        """Redraws the live line for a job that has run for `took_s`."""
        if self.live:
            self._write(f"\r\033[K[{self.done + 1}/{self.total}] {name}: {duration(took_s)}{self._eta()}")

    def finish(self, id: str, name: str, result: str, took_s: float = 0, trouble: bool = False) -> None:
        """Notes a job that is done."""
        self.done += 1
        with open(self.log, "a", encoding="utf-8") as file:
            file.write(f"{now()}\t{id}\t{took_s:.3f}\t{name}\t{result}\n")
        start, end = ("\r\033[K", "") if self.live and not trouble else ("\r\033[K" if self.live else "", "\n")
        self._write(f"{start}[{self.done}/{self.total}] {name}: {result}{self._eta()}{end}")
        if self.live and self.done == self.total and not trouble:
            self._write("\r\033[K")

    def _eta(self) -> str:
        if not 0 < self.done < self.total:
            return ""
        return f", about {duration((time.monotonic() - self.began) / self.done * (self.total - self.done))} left"

    def _write(self, text: str) -> None:
        sys.stdout.write(text)
        sys.stdout.flush()


def duration(seconds: float) -> str:
    """"850 ms", "12 s", "3 min 20 s", "2 h 05 min"."""
    if seconds < 1:
        return f"{seconds * 1000:.0f} ms"
    whole = round(seconds)
    if whole < 60:
        return f"{seconds:.1f} s" if seconds < 10 else f"{whole} s"
    minutes = whole // 60
    return f"{minutes} min {whole % 60:02d} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"
