"""Counter runs of the real program under a stand-in for LIKWID: what is kept of healthy and of sick outputs."""
import json
import os
import shutil
import subprocess
from pathlib import Path

import jsonschema
import pytest

from stand_in_likwid_perfctr import BEHAVIOUR
from sweep import metrics
from sweep.counters import PHASES, cpus_for

EXPERIMENTS = Path(__file__).resolve().parents[1]
BIN = Path(os.environ.get("TRIGRAIN_BIN", EXPERIMENTS.parent / "build/release/bin"))
SPEC = {"fixed": {"scene": "hopper-dense", "particles": 27, "vertices": 10, "scheme": "plain", "steps": 5, "repeats": 1,
                  "halo": "published"}, "axes": {"threads": [1]}}
SCHEMAS = {path.stem: json.loads(path.read_text()) for path in (EXPERIMENTS / "schema").glob("*.json")}


@pytest.fixture(name="sweep")
def _sweep(dem_bench, tmp_path):
    """Runs sweep commands with the stand-in on PATH; returns the process and the counters of the first point."""
    if not (BIN.parent / "stand_in/liblikwid.so.5").exists():
        pytest.skip("the stand-in for LIKWID's library is not built")
    shutil.copy(EXPERIMENTS / "tests/stand_in_likwid_perfctr.py", tmp_path / "likwid-perfctr")
    (tmp_path / "likwid-perfctr").chmod(0o755)

    def run(how: str, threads: int = 1, **more: str):
        (tmp_path / "tried.json").write_text(json.dumps({**SPEC, "axes": {"threads": [threads]}}))
        environment = {**os.environ, "PATH": f"{tmp_path}:/usr/bin:/bin", "PYTHONPATH": str(EXPERIMENTS), "STAND_IN_LIKWID": how,
                       "STAND_IN_LIBRARY": str(BIN.parent / "stand_in"), **more}
        for command in ("run", "counters"):
            done = subprocess.run(["/usr/bin/python3", "-m", "sweep", command, str(tmp_path / "tried.json"), "--results",
                                   str(tmp_path / "results"), "--bin", str(BIN)], capture_output=True, text=True, check=False,
                                  timeout=120, env=environment)
            assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout, json.loads(next((tmp_path / "results/tried/counters").glob("*.json")).read_text())

    return run


def check_schema(value: dict) -> None:
    resolver = jsonschema.RefResolver("counters.json", SCHEMAS["counters"], {f"{stem}.json": s for stem, s in SCHEMAS.items()})
    jsonschema.Draft202012Validator(SCHEMAS["counters"], resolver=resolver).validate(value)


def test_a_healthy_xeon_measures_everything_per_phase(sweep):
    said, found = sweep("xeon")
    check_schema(found)
    assert "counters by likwid on broadwellEP" in said and found["arch"] == "broadwellEP"
    for name in metrics.NAMES:
        assert found["whole"][name]["status"] == "measured", (name, found["whole"][name])
        parts = [found["phases"][phase][name]["value"] for phase in PHASES]
        assert found["whole"][name]["value"] == pytest.approx(sum(parts)) and min(parts) > 0
    entries = found["phases"]["merge"]["instructions"]["value"] / 1000
    assert entries > 0 and entries % 5 == 0, "as often in each of five steps, the check and the warm-up left out"
    # 1 MFLOP/s per entry over 1 ms per entry, 1 GB and 1 J per entry
    assert found["phases"]["merge"]["flops_dp"]["value"] == pytest.approx(entries * 1e6 * entries * 1e-3)
    assert found["phases"]["merge"]["dram_bytes"]["value"] == entries * 1e9
    assert found["phases"]["merge"]["energy_J"]["value"] == entries


def test_a_healthy_knl_says_what_it_cannot_tell(sweep):
    _, found = sweep("knl")
    check_schema(found)
    assert found["arch"] == "knl"
    for name in ("flops_dp", "flops_sp", "l3_bytes"):
        assert found["whole"][name]["value"] is None and "Knights Landing" in found["whole"][name]["reason"]
    entries = found["phases"]["merge"]["instructions"]["value"] / 1000
    assert found["phases"]["merge"]["dram_bytes"]["value"] == 2 * entries * 1e9, "MEM and HBM"
    assert found["whole"]["instructions"]["source"] == "likwid"


@pytest.mark.parametrize("how,reason", [
    ("zeros", "counted no instructions"), ("dashes", "counted no instructions"), ("refusal", "Unsupported Processor"),
    ("truncated", "breaks off"), ("regions", "4 regions, 5 expected: no merge"), ("silent", "0 regions, 5 expected"),
    ("dead", "nothing was counted"), ("infinite", "no finite number on every CPU")])
def test_sick_output_is_null_with_its_reason_and_never_0(sweep, how, reason):
    assert how in BEHAVIOUR
    _, found = sweep(how)
    check_schema(found)
    for name in set(metrics.NAMES) - {"instructions"}:
        each = found["whole"][name]
        if each["source"] != "perf_event":
            assert each["value"] is None and each["status"] == "unavailable" and reason in each["reason"], (name, each)
    assert found["algorithm"]["candidate_pairs"] > 0
    instructions = found["whole"]["instructions"]
    assert instructions["source"] in ("perf_event", "callgrind") or reason in instructions["reason"]


def test_a_thread_that_never_entered_a_region_has_no_part_in_it(sweep):
    if len(os.sched_getaffinity(0)) < 2:
        pytest.skip("needs two CPUs")
    _, found = sweep("alone", threads=2)
    entries = found["phases"]["merge"]["instructions"]["value"] / 1000
    assert found["phases"]["merge"]["flops_dp"]["value"] == pytest.approx(entries * 1e6 * entries * 1e-3) and entries > 0


def test_a_point_is_counted_once(sweep):
    assert "instructions" in sweep("xeon")[0]
    assert "instructions" not in sweep("xeon")[0]


def test_what_nobody_could_count_is_counted_once_somebody_can(sweep):
    sweep("refusal")
    said, found = sweep("xeon")
    assert "instructions" in said and found["whole"]["dram_bytes"]["source"] == "likwid"


@pytest.mark.parametrize("synthetic,threads,cpus", [
    ("package:2 l3:1 core:12 pu:2", 14, [*range(0, 24, 2), 24, 26]), ("package:1 core:64 pu:4", 3, [0, 4, 8])])
def test_threads_fill_cores_of_synthetic_machines(dem_bench, tmp_path, monkeypatch, synthetic, threads, cpus):
    """A Xeon of two sockets, and Knights Landing."""
    monkeypatch.setenv("HWLOC_SYNTHETIC", synthetic)
    dem_bench("--scene", "two-particles", "--steps", 2, "--record", tmp_path / "r.json")
    record = json.loads((tmp_path / "r.json").read_text())
    record["params"]["threads"] = threads
    assert cpus_for(record) == cpus


@pytest.mark.parametrize("arch", ["broadwellEP", "knl", "zen2", "zen3", "haswellEP", "z80"])
def test_every_metric_has_rows_or_a_reason_on_every_architecture(arch):
    for metric in metrics.metrics_of(arch):
        assert bool(metric.rows) != bool(metric.why_not), metric
