"""Where the built programs are: TRIGRAIN_BIN, else the release build."""
import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def dem_bench():
    """Runs dem_bench with these words; returns the finished process."""
    program = Path(os.environ.get("TRIGRAIN_BIN", ROOT / "build/release/bin")) / "dem_bench"
    if not program.exists():
        pytest.skip(f"{program} is not built")

    def run(*words: object) -> subprocess.CompletedProcess:
        return subprocess.run([program, *map(str, words)], capture_output=True, text=True, timeout=300)

    return run
