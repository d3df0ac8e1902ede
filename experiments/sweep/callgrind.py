"""Instruction counts by valgrind's callgrind: exactly repeatable, at one thread, with a build that valgrind can run."""
import re
import shutil
import subprocess
from pathlib import Path

TIMED_PART = "*run_slice*"  # of dem_bench: what happens on the clock


def available() -> bool:
    return shutil.which("valgrind") is not None


def instructions(command: list[str], limit_s: float) -> tuple[int | None, str]:
    """Instructions of the timed part of a dem_bench command, and, if there are none, why."""
    if not available():
        return None, "valgrind is not installed"
    words = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", f"--toggle-collect={TIMED_PART}", *command]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=limit_s, check=False)
    except subprocess.TimeoutExpired:
        return None, f"callgrind needed more than {limit_s:g} s"
    found = re.search(r"Collected\s*:\s*(\d+)", done.stderr)
    if done.returncode != 0 or not found:
        trouble = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        return None, f"callgrind: {trouble}"
    return (int(found[1]), "") if int(found[1]) > 0 else (None, "callgrind counted nothing")


def portable_program(name: str, root: Path) -> tuple[Path | None, str]:
    """The build for valgrind, which dies on AVX-512; or what to do to get it."""
    path = root / "build/portable/bin" / name
    if path.exists():
        return path, ""
    return None, "no portable build (cmake --preset portable && cmake --build --preset portable)"
