"""Where the built programs are (TRIGRAIN_BIN, else the release build), and a folder in which to try the sweep."""
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "experiments"))
from sweep_bench import Bench  # noqa: E402


@pytest.fixture(scope="session")
def dem_bench():
    """Runs dem_bench with these words; returns the finished process."""
    program = Path(os.environ.get("TRIGRAIN_BIN", ROOT / "build/release/bin")) / "dem_bench"
    if not program.exists():
        pytest.skip(f"{program} is not built")

    def run(*words: object) -> subprocess.CompletedProcess:
        return subprocess.run([program, *map(str, words)], capture_output=True, text=True, timeout=300)

    return run


@pytest.fixture(name="bench")
def _bench(tmp_path) -> Bench:
    return Bench(tmp_path)
