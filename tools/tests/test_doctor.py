"""What the doctor says of machines that are not this one."""
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

TOOLS = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TOOLS.parent / "experiments"))
from sweep import likwid  # noqa: E402

RECORD = {"build": {"compiler": "GNU 12", "build_type": "Release", "arch": "native", "arch_resolved": "knl", "commit": None,
                    "dirty": False},
          "machine": {"cpu": "Imagined", "sockets": 2, "cores": 16, "logical_cores": 16, "memory_bytes": 2**30,
                      "caches_bytes": {"l1d": 32768, "l2": None, "l3": 2**20}},
          "placement": {"asked_threads": 2, "observed_threads": 2, "cpus": [0, 1]},
          "counters": {"instructions": {"status": "unavailable", "reason": "no such thing"}}}
HEALTHY = "TABLE,Group 1 Raw,CLOCK,1\nEvent,Counter,HWThread 0\nINSTR_RETIRED_ANY,FIXC0,123456"


def program(folder: Path, name: str, text: str) -> None:
    (folder / name).write_text(f"#!/bin/bash\n{text}\n")
    (folder / name).chmod(0o755)


def doctor(*arguments: object, **environment: str) -> subprocess.CompletedProcess:
    return subprocess.run([TOOLS / "doctor", *map(str, arguments)], capture_output=True, text=True, timeout=120, check=False,
                          env={**os.environ, **environment})


def stand_in(folder: Path, **changes) -> None:
    """A dem_bench that leaves this record, and a LIKWID that refuses at once."""
    (folder / "kept.json").write_text(json.dumps({**RECORD, **changes}))
    program(folder, "dem_bench", f'cp {folder}/kept.json "${{@: -1}}"')
    program(folder, "likwid-perfctr", "echo 'ERROR - [./src/x.c:12] Unsupported Processor'; exit 1")


def test_a_healthy_machine_lacks_nothing(tmp_path):
    stand_in(tmp_path)
    done = doctor("--bin", tmp_path, PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert done.returncode == 0, done.stdout + done.stderr
    for words in ("Imagined: 2 sockets, 16 cores", "l1d 32 KiB, l3 1024 KiB", "2 threads asked, 2 observed on CPUs [0, 1]",
                  "likwid-perfctr: Unsupported Processor", "no such thing", "Here: ", "hardware counts by"):
        assert words in done.stdout, words
    assert len(done.stdout.splitlines()) <= 40, "one screen"


def test_threads_that_are_not_there_are_missing(tmp_path):
    stand_in(tmp_path, placement={"asked_threads": 2, "observed_threads": 1, "cpus": [0]})
    done = doctor("--bin", tmp_path, PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert done.returncode == 4 and "missing: tbb, openmp" in done.stdout and "a pinning wrapper" in done.stdout


def test_programs_that_are_not_built_are_missing(tmp_path):
    program(tmp_path, "likwid-perfctr", "exit 1")
    done = doctor("--bin", tmp_path, PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert done.returncode == 4 and "missing: programs" in done.stdout and "tools/build" in done.stdout
    assert doctor("--loud").returncode == 3


@pytest.mark.parametrize("text,reason", [
    (f"echo '{HEALTHY}'", None), (f"echo '{HEALTHY}' | sed s/123456/0/", "counted no instructions"),
    (f"echo '{HEALTHY}' | sed s/123456/-/", "counted no instructions"), ("echo hello", "counted no instructions"),
    ("echo 'ERROR - [./src/perfmon.c:1427] Unsupported Processor'; exit 1", "likwid-perfctr: Unsupported Processor"),
    ("exit 7", "ended with exit code 7")])
def test_likwid_counts_only_if_it_saw_instructions(tmp_path, monkeypatch, text, reason):
    program(tmp_path, "likwid-perfctr", text)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    found = likwid.probe()
    assert found is None if reason is None else reason in found
