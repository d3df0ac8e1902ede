"""The program that runs a point: where it is, what this build of it can do, and the command line of a point."""
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sweep.errors import SweepError
from sweep.parameters import Program
from sweep.points import Point, StartState


@dataclass(frozen=True)
class Bench:
    """A build of a program: the names it lists per parameter and what it says of them ("grid": {"none": "all pairs"}), and
    the commit of the sources. What "missing_engine" lists is not there, and why."""
    program: Program
    path: Path
    variants: dict[str, dict[str, str]]
    commit: str | None

    def lacks(self, params: dict[str, Any]) -> str | None:
        """What of `params` this build does not have, as "grid 'adaptive'", and why if it says so."""
        for key, names in self.variants.items():
            if isinstance(params.get(key), str) and params[key] not in names:
                why = self.variants.get(f"missing_{key}", {}).get(params[key])
                return f"{key.replace('_', ' ')} '{params[key]}'" + (f": {why}" if why else "")
        return None


def find_bench(program: Program, folder: Path | None, root: Path) -> Bench:
    """The program in `folder`; None: beside the program that was started, then in the release build under `root`.
    SweepError if there is none or it cannot say what it knows."""
    places = [folder] if folder else [Path(sys.argv[0]).resolve().parent, root / "build/release/bin"]
    for place in places:
        if os.access(place / program.name, os.X_OK):
            return _describe(program, (place / program.name).resolve(), root)
    raise SweepError(f"no {program.name} (looked in {', '.join(map(str, places))}). "
                     "Build first (tools/build) or give --bin DIR.")


def point_command(bench: Bench, point: Point, spec_folder: Path, outputs: list[str], start: Path | None) -> list[str]:
    """The command of a point; `outputs` are the options that say what to write where."""
    begin = ["--start-state", str(start)] if start else []
    options = bench.program.arguments(_at(point.params, spec_folder))
    return [str(bench.path), *options, *begin, "--point-id", point.id, *outputs]


def state_command(bench: Bench, state: StartState, spec_folder: Path, cores: int, outputs: list[str]) -> list[str]:
    """The command of a start state; a parallel scheme uses all cores, as it gives the same bits for every number."""
    threads = 1 if state.params.get("scheme", "serial") == "serial" else cores
    once = ["--threads", str(threads), "--repeats", "1", "--warmup", "0", "--check-steps", "5"]
    options = bench.program.arguments(_at(state.params, spec_folder))
    return [str(bench.path), *options, *once, "--point-id", state.id, *outputs]


def complaint(done: subprocess.CompletedProcess) -> str:
    """Why a program did not end well: the check that failed, else its last line (valgrind's begin with ==)."""
    said = [line for line in done.stderr.splitlines() if line.strip() and not line.startswith("==")]
    failed = [line for line in done.stdout.splitlines() if line.startswith("check ") and "FAILED" in line]
    return f"exit code {done.returncode}: {([*failed, *said[-1:], *done.stderr.splitlines()[-1:]] or ['it said nothing'])[0]}"


def _at(params: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Scene files are named relative to their spec."""
    if "scene_file" not in params:
        return params
    return {**params, "scene_file": str((folder / params["scene_file"]).resolve())}


def usable_cores() -> int:
    """Physical cores of the machine, or the CPUs this process may use if they are fewer; so counts dem_bench too."""
    allowed = len(os.sched_getaffinity(0))
    siblings = Path("/sys/devices/system/cpu").glob("cpu[0-9]*/topology/thread_siblings_list")
    try:
        cores = len({path.read_text() for path in siblings})
    except OSError:
        cores = 0
    return min(cores, allowed) if cores else allowed


def _describe(program: Program, path: Path, root: Path) -> Bench:
    try:
        answer = subprocess.run([path, "--list"], capture_output=True, text=True, timeout=60, check=True)
    except subprocess.CalledProcessError as error:
        trouble = f"exit code {error.returncode}: {error.stderr.strip()[-200:]}"
        raise SweepError(f"{path} does not run (--list: {trouble}). Build it again.") from None
    except (OSError, subprocess.TimeoutExpired) as error:
        raise SweepError(f"{path} does not run (--list: {error}). Build it again.") from None
    variants: dict[str, dict[str, str]] = {}
    for line in answer.stdout.splitlines():
        if line.startswith("  ") and variants:
            name, _, about = line.strip().partition(":")
            names[name] = about.strip()
        elif line:
            names = variants.setdefault(_singular(line.strip()).replace(" ", "_"), {})
    if "runtime" in variants:
        variants["runtime"]["default"] = ""
    if not set(variants) & set(program.parameters):
        raise SweepError(f"{path} --list names no {', '.join(k for k, p in program.parameters.items() if p.names)}. "
                         "Build it again.")
    return Bench(program, path, variants, _commit(root))


def _singular(title: str) -> str:
    """"kernels" and "families" head the lists of the parameters kernel and family."""
    return title.removesuffix("ies") + "y" if title.endswith("ies") else title.removesuffix("s")


def _commit(root: Path) -> str | None:
    """The commit that is checked out: every build of it carries that name."""
    try:
        answer = subprocess.run(["git", "-C", root, "rev-parse", "HEAD"], capture_output=True, text=True, timeout=60)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return answer.stdout.strip() if answer.returncode == 0 else None
