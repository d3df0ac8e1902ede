"""LIKWID's likwid-perfctr: whether it counts on this machine."""
import csv
import math
import shutil
import subprocess

PROGRAM = "likwid-perfctr"
PROBE_LIMIT_S = 60  # a missing daemon costs LIKWID 10 s


def probe() -> str | None:
    """Why LIKWID does not count here, or None if it does: it must end well and have seen instructions."""
    if not shutil.which(PROGRAM):
        return f"{PROGRAM} is not installed"
    try:
        done = subprocess.run([PROGRAM, "-O", "-c", "0", "-g", "CLOCK", "true"], capture_output=True, text=True,
                              timeout=PROBE_LIMIT_S, check=False)
    except subprocess.TimeoutExpired:
        return f"{PROGRAM} did not answer within {PROBE_LIMIT_S} s"
    except OSError as error:
        return f"{PROGRAM} does not start ({error.strerror})"
    if done.returncode != 0:
        return first_error(done.stdout + done.stderr, done.returncode)
    counts = [number(cell) for row in csv.reader(done.stdout.splitlines()) if row and row[0] == "INSTR_RETIRED_ANY"
              or row and row[0] == "RETIRED_INSTRUCTIONS" for cell in row[2:] if cell]
    return None if any(count and count > 0 for count in counts) else f"{PROGRAM} counted no instructions"


def first_error(output: str, code: int) -> str:
    """The first line that speaks of an error, without the place in LIKWID's source."""
    for line in output.splitlines():
        if "ERROR" in line or "error" in line or "not" in line.lower().split():
            return f"{PROGRAM}: {line.rpartition('] ')[2].strip()}"
    return f"{PROGRAM} ended with exit code {code}"


def number(text: str) -> float | None:
    """A finite number, or None for "-", "nan", "inf" and all else that stands for one."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
