"""Instruction counts by valgrind's callgrind: exactly repeatable, at one thread, with a build that valgrind can run."""
import re
import shutil
import subprocess
from pathlib import Path

from sweep.bench import complaint

TIMED_PART = "*run_slice*"  # of dem_bench: what happens on the clock
CACHE_SHARE = 1 << 22  # bytes of the last cache that a core of a server has for itself


def available() -> bool:
    return shutil.which("valgrind") is not None


def instructions(command: list[str], limit_s: float) -> tuple[int | None, str]:
    """Instructions of the timed part of a dem_bench command, and, if there are none, why."""
    counts, why = _counts(command, [], limit_s)
    return (counts[0], "") if counts else (None, why)


def memory_bytes(command: list[str], limit_s: float) -> tuple[int | None, str]:
    """Bytes that the timed part moves to and from memory through a core's share of the last cache: a line for every
    miss, and another one to write back what a write missed."""
    counts, why = _counts(command, ["--cache-sim=yes", f"--LL={CACHE_SHARE},16,64"], limit_s)
    if not counts:
        return None, why
    if len(counts) != 9:
        return None, "callgrind simulated no cache"
    instruction, read, write = counts[6:]  # after Ir Dr Dw and the misses of the first cache
    return 64 * (instruction + read + 2 * write), ""


def _counts(command: list[str], options: list[str], limit_s: float) -> tuple[list[int], str]:
    """What callgrind collected, instructions first; or nothing and why."""
    if not available():
        return [], "valgrind is not installed"
    words = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", f"--toggle-collect={TIMED_PART}", *options, *command]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=limit_s, check=False)
    except subprocess.TimeoutExpired:
        return [], f"callgrind needed more than {limit_s:g} s"
    found = re.search(r"Collected\s*:((?:\s+\d+)+)", done.stderr)
    if done.returncode != 0 or not found:
        return [], f"callgrind: {complaint(done)}"
    counts = [int(word) for word in found[1].split()]
    return (counts, "") if counts[0] > 0 else ([], "callgrind counted nothing")


def portable_program(name: str, root: Path) -> tuple[Path | None, str]:
    """The build for valgrind, which dies on AVX-512; or what to do to get it."""
    path = root / "build/portable/bin" / name
    if path.exists():
        return path, ""
    return None, "no portable build (cmake --preset portable && cmake --build --preset portable)"
