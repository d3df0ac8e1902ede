"""Lines that tell how a sweep goes."""
import sys
import time


class Progress:
    """One line per finished job; on a terminal a live line below it."""

    def __init__(self, total: int):
        self.total = total
        self.done = 0
        self.began = time.monotonic()
        self.live = sys.stdout.isatty()

    def tick(self, name: str, took_s: float) -> None:
        """Redraws the live line for a job that has run for `took_s`."""
        if self.live:
            self._write(f"\r\033[K[{self.done + 1}/{self.total}] {name}: {duration(took_s)}{self._eta()}")

    def finish(self, name: str, result: str) -> None:
        """Prints the line of a job that is done."""
        self.done += 1
        start = "\r\033[K" if self.live else ""
        self._write(f"{start}[{self.done}/{self.total}] {name}: {result}{self._eta()}\n")

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
