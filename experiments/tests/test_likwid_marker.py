"""Regions for LIKWID, with a stand-in for its library: one per phase and thread, balanced, each thread on its CPU."""
import os
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
STAND_IN = Path(os.environ.get("TRIGRAIN_BIN", ROOT / "build/release/bin")).parent / "stand_in"
PHASES = {"grid", "detect", "merge", "forces", "integrate"}
HOPPER = ("--scene", "hopper-dense", "--particles", 64, "--vertices", 10, "--halo", "published", "--steps", 20, "--warmup", 3,
          "--repeats", 2)


@pytest.fixture(name="marked")
def _marked(dem_bench, tmp_path, monkeypatch):
    """Runs dem_bench as likwid-perfctr -m does; returns the process and calls by region and CPU."""
    if not (STAND_IN / "liblikwid.so.5").exists():
        pytest.skip(f"{STAND_IN} is not built")

    def run(cpus: list[int], *words: object):
        monkeypatch.setenv("LIKWID_FILEPATH", str(tmp_path / "regions"))
        monkeypatch.setenv("LIKWID_THREADS", ",".join(map(str, cpus)))
        monkeypatch.setenv("LD_LIBRARY_PATH", str(STAND_IN))
        done = dem_bench(*words, "--record", tmp_path / "record.json")
        calls: dict[str, dict[int, int]] = defaultdict(dict)
        for line in (tmp_path / "regions").read_text().splitlines():
            assert not line.startswith("wrong"), line
            region, cpu, count = line.split()
            calls[region][int(cpu)] = int(count)
        return done, calls

    return run


def allowed(count: int) -> list[int]:
    cpus = sorted(os.sched_getaffinity(0))
    if len(cpus) < count:
        pytest.skip(f"needs {count} CPUs")
    return cpus[:count]


@pytest.mark.parametrize("scheme,runtime", [("plain", "openmp"), ("plain", "tbb"), ("task", "tbb"), ("task", "openmp")])
def test_every_phase_is_a_region_of_every_thread_that_works(marked, scheme, runtime):
    cpus = allowed(2)
    done, calls = marked(cpus, *HOPPER, "--scheme", scheme, "--runtime", runtime, "--threads", 2)
    assert done.returncode == 0, done.stdout + done.stderr
    assert set(calls) == PHASES
    assert all(set(by_cpu) <= set(cpus) for by_cpu in calls.values()), calls
    if (scheme, runtime) == ("plain", "openmp"):  # deals blocks out in turn; the others may leave all to one thread
        assert len(calls["detect"]) == 2, "both threads compare"


def test_only_timed_steps_are_counted(marked):
    done, calls = marked(allowed(1), *HOPPER, "--scheme", "serial")
    assert done.returncode == 0, done.stdout
    for phase, by_cpu in calls.items():  # two samples of 20 steps, each phase as often in every step
        assert list(by_cpu) == allowed(1)[:1] and sum(by_cpu.values()) % (2 * 20) == 0, (phase, calls)


def test_more_threads_than_watched_cpus_fail_the_check(marked):
    allowed(2)
    done, _ = marked(allowed(1), *HOPPER, "--scheme", "plain", "--threads", 2)
    assert done.returncode == 1 and "2 threads worked on 1 watched CPUs" in done.stdout


def test_a_library_that_is_not_there_is_told(dem_bench, tmp_path, monkeypatch):
    monkeypatch.setenv("LIKWID_FILEPATH", str(tmp_path / "regions"))
    for name in ("liblikwid.so.5", "liblikwid.so"):
        (tmp_path / name).write_text("no library")
    monkeypatch.setenv("LD_LIBRARY_PATH", str(tmp_path))
    done = dem_bench(*HOPPER)
    assert done.returncode == 4 and "cannot load LIKWID" in done.stderr
