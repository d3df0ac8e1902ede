"""LIKWID's likwid-perfctr: whether it counts here, running a program under it, and reading what it prints."""
import csv
import math
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field

from sweep.metrics import EVENT, METRIC, Row

PROGRAM = "likwid-perfctr"
PROBE_LIMIT_S = 60  # a missing daemon costs LIKWID 10 s
REGION, TIME, CALLS = "Region Info", "RDTSC Runtime [s]", "call count"
INSTRUCTIONS = ("INSTR_RETIRED_ANY", "RETIRED_INSTRUCTIONS")


class NotCounted(Exception):
    """Why a run under LIKWID gave no counts that can be used."""


@dataclass
class Region:
    """What LIKWID printed for a region: name of a row -> one cell per CPU, None where it is no finite number."""
    info: dict[str, list[float | None]] = field(default_factory=dict)
    rows: dict[str, dict[str, list[float | None]]] = field(default_factory=lambda: {EVENT: {}, METRIC: {}})

    def value(self, row: Row) -> float:
        """In our unit, summed over the CPUs. NotCounted if a cell is no number or nothing was counted."""
        cells = self.rows[row.kind].get(row.name)
        if cells is None:
            raise NotCounted(f"group {row.group} has no row '{row.name}'")
        entered = [place for place, calls in enumerate(self.info[CALLS]) if calls]
        if not entered or len(cells) != len(self.info[CALLS]) or any(cells[place] is None for place in entered):
            raise NotCounted(f"'{row.name}' is no finite number on every CPU")
        total = row.factor * sum(cells[place] * (self.info[TIME][place] if row.rate else 1) for place in entered)
        if total <= 0:
            raise NotCounted(f"'{row.name}' is {total:g}: nothing was counted")
        return total


def probe() -> str | None:
    """Why LIKWID does not count here, or None if it does: it must end well and have seen instructions."""
    if not shutil.which(PROGRAM):
        return f"{PROGRAM} is not installed"
    try:
        output = _call([PROGRAM, "-O", "-c", "0", "-g", "CLOCK", "true"], _plain)
    except NotCounted as reason:
        return str(reason)
    counts = [number(cell) for row in csv.reader(output.splitlines()) if row and row[0] in INSTRUCTIONS for cell in row[2:]]
    return None if any(count and count > 0 for count in counts) else f"{PROGRAM} counted no instructions"


def architecture() -> str:
    """LIKWID's short name of the processor. NotCounted if it does not say."""
    found = re.search(r"^CPU short:\s*(\S+)", _call([PROGRAM, "-i"], _plain), re.M)
    if not found:
        raise NotCounted(f"{PROGRAM} -i names no architecture")
    return found[1]


def measure(command: list[str], group: str, cpus: list[int], run: Callable) -> dict[str, Region]:
    """Runs `command` with the counters of a group on these CPUs; what it counted by region. -c: LIKWID does not pin,
    the program does. `run(words)` gives exit code and output lines. NotCounted if it cannot be used."""
    output = _call([PROGRAM, "-O", "-m", "-c", ",".join(map(str, cpus)), "-g", group, *command], run)
    return parse(output)


def parse(output: str) -> dict[str, Region]:
    """Regions of likwid-perfctr -O -m. NotCounted if tables break off."""
    regions: dict[str, Region] = {}
    region, kind, expected = None, None, 0
    for row in csv.reader(output.splitlines()):
        if not row:
            continue
        if row[0] == "TABLE":
            _complete(expected)
            named = row[1].startswith("Region ") and not row[2].endswith("STAT")
            region = regions.setdefault(row[1].removeprefix("Region "), Region()) if named else None
            kind = METRIC if "Metric" in row[2] else EVENT
            expected = int(row[4]) + 1 if region is not None and row[4].isdigit() else 0
            continue
        if row[0] in ("STRUCT", "CPU name:", "CPU type:", "CPU clock:") or region is None:
            continue
        if row[0] in (TIME, CALLS):
            region.info[row[0]] = [number(cell) for cell in row[1:] if cell]
        elif row[0] not in (REGION, EVENT, METRIC):
            first = 2 if kind == EVENT else 1
            region.rows[kind][row[0]] = [number(cell) for cell in row[first:] if cell]
            expected -= 1
        elif row[0] != REGION:
            expected -= 1
    _complete(expected)
    return regions


def validate(regions: dict[str, Region], expected: tuple[str, ...], least_calls: int) -> None:
    """NotCounted unless all `expected` regions are there, entered at least so often, and took time."""
    absent = [name for name in expected if name not in regions]
    if absent:
        raise NotCounted(f"{len(regions)} regions, {len(expected)} expected: no {', '.join(absent)}")
    for name in expected:
        times, calls = regions[name].info.get(TIME, []), regions[name].info.get(CALLS, [])
        if not times or any(time is None for time in times) or sum(times) <= 0:
            raise NotCounted(f"region '{name}' took no time that is a number")
        if not calls or any(count is None for count in calls) or sum(calls) < least_calls:
            raise NotCounted(f"region '{name}' was entered {sum(filter(None, calls)):.0f} times, at least {least_calls} "
                             "expected")


def first_error(output: str, code: int) -> str:
    """The first line that speaks of an error, without the place in LIKWID's source."""
    for line in output.splitlines():
        if "error" in line.lower() or "not" in line.lower().split():
            return f"{PROGRAM}: {line.rpartition('] ')[2].strip()}"
    return f"{PROGRAM} ended with exit code {code}"


def number(text: str) -> float | None:
    """A finite number, or None for "-", "nan", "inf" and all else that stands for one."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _plain(words: list[str]) -> tuple[int, str]:
    done = subprocess.run(words, capture_output=True, text=True, timeout=PROBE_LIMIT_S, check=False)
    return done.returncode, done.stdout + done.stderr


def _call(words: list[str], run: Callable) -> str:
    try:
        code, output = run(words)
    except subprocess.TimeoutExpired:
        raise NotCounted(f"{PROGRAM} did not answer within {PROBE_LIMIT_S} s") from None
    except OSError as error:
        raise NotCounted(f"{PROGRAM} does not start ({error.strerror})") from None
    if code != 0:
        raise NotCounted(first_error(output, code))
    return output


def _complete(rows_missing: int) -> None:
    if rows_missing > 0:
        raise NotCounted(f"{PROGRAM}'s output breaks off: {rows_missing} rows of a table are missing")
