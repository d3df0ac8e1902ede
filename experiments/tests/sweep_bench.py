"""A folder in which the sweep is tried, run as a program with a stand-in for dem_bench."""
import json
import os
import shutil
import subprocess
import time
from pathlib import Path

from stand_in_dem_bench import BEHAVIOUR

EXPERIMENTS = Path(__file__).resolve().parents[1]
FIXED = {"scene": "hopper", "steps": 3, "kernel": "brute"}


class Bench:
    """A folder with a stand-in dem_bench, a spec and results; `run` starts the real program."""

    def __init__(self, folder: Path):
        self.folder, self.spec, self.calls_file = folder, folder / "tried.json", folder / "calls"
        self.results = folder / "results" / "tried"
        (folder / "bin").mkdir()
        shutil.copy(EXPERIMENTS / "tests/stand_in_dem_bench.py", folder / "bin/dem_bench")
        (folder / "bin/dem_bench").chmod(0o755)

    def write(self, **spec) -> None:
        self.spec.write_text(json.dumps({"fixed": FIXED, **spec}))

    def command(self, *arguments: str) -> list[str]:
        return ["/usr/bin/python3", "-m", "sweep", arguments[0], str(self.spec), "--results",
                str(self.folder / "results"), "--bin", str(self.folder / "bin"), "--cores", "4", *arguments[1:]]

    def environment(self, **more: str) -> dict[str, str]:
        return {**os.environ, "PYTHONPATH": str(EXPERIMENTS), "PYTHONDONTWRITEBYTECODE": "1",
                "STAND_IN_CALLS": str(self.calls_file), **more}

    def run(self, *arguments: str, expect: int = 0, **environment: str) -> subprocess.CompletedProcess:
        done = subprocess.run(self.command(*arguments), capture_output=True, text=True, timeout=60,
                              env=self.environment(**environment), check=False)
        assert done.returncode == expect, done.stdout + done.stderr
        return done

    def calls(self) -> list[str]:
        return self.calls_file.read_text().split("\n")[:-1] if self.calls_file.exists() else []

    def records(self) -> dict[str, dict]:
        return {path.stem: json.loads(path.read_text()) for path in self.results.glob("*.json")
                if path.stem != "index"}

    def index(self) -> dict:
        return json.loads((self.results / "index.json").read_text())

    def states(self) -> dict[str, str]:
        return {point["name"]: point["state"] for point in self.index()["points"]}


def seeds(*names: str) -> list[int]:
    return [BEHAVIOUR[name] for name in names]


def wait_until(condition, seconds: float = 20) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "nothing happened in time"
        time.sleep(0.02)


def alive(text: str) -> list[str]:
    """Command lines of running processes that contain `text`."""
    lines = []
    for entry in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            lines.append(entry.read_bytes().replace(b"\0", b" ").decode(errors="replace"))
        except OSError:
            continue
    return [line for line in lines if text in line and "-m sweep" not in line]
