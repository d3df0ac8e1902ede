"""A sweep that goes well: what is run, in which order, and what is said about it."""
import json
import os
import pty
import subprocess
import time
from pathlib import Path

import pytest

from sweep_bench import FIXED, seeds


def test_a_second_run_repeats_nothing(bench):
    bench.write(axes={"threads": [1, 2]})
    assert "[2/2] threads=2" in bench.run("run").stdout
    before = {path: path.read_bytes() for path in bench.results.glob("*.json") if path.stem != "index"}
    assert "running 0" in bench.run("run").stdout
    assert len(bench.calls()) == 2
    assert before == {path: path.read_bytes() for path in before}
    assert not list(bench.results.glob("*.part"))


def test_a_dry_run_writes_nothing(bench):
    bench.write(axes={"threads": [1, 2]})
    assert bench.run("run", "--dry-run").stdout.count("would run") == 3  # two points and the sum
    assert not (bench.folder / "results").exists() and not bench.calls()


def test_the_estimate_comes_from_finished_points(bench):
    bench.write(axes={"threads": [1, 2, 3]})
    assert "none has run yet" in bench.run("run", "--dry-run").stdout
    start = time.monotonic()
    bench.run("run", "--only", "threads=1", STAND_IN_SLEEP="1")
    took = time.monotonic() - start  # with the start of the sweep itself
    text = bench.run("run", "--dry-run").stdout
    assert 2 < float(text.split("Estimated time of the points: ")[1].split(" s")[0]) <= 2 * took + .1


def test_status_says_how_long_a_step_took(bench):
    bench.write(axes={"seed": seeds("fine", "crash")})
    bench.run("run", expect=1)
    said = bench.run("status").stdout
    assert "seed=0: finished (333 ms per step)" in said and said.count("per step") == 1, "1 s for 3 steps"


def test_points_beyond_the_machine_are_listed_and_not_run(bench):
    bench.write(axes={"threads": [1, 4, 5]})
    assert "threads=5: needs a bigger machine (5 threads, 4 cores here)" in bench.run("run", "--dry-run").stdout
    bench.run("run")
    assert bench.states() == {"threads=1": "finished", "threads=4": "finished", "threads=5": "needs a bigger machine"}
    assert "1 needs a bigger machine" in bench.run("status").stdout
    assert len(bench.calls()) == 2


def test_variants_that_the_build_lacks_are_listed_and_not_run(bench):
    bench.write(axes={"grid": ["regular", "adaptive"], "runtime": ["tbb", "default"]})
    assert "not available in this build (grid 'adaptive')" in bench.run("run", "--dry-run").stdout
    bench.run("run")
    assert list(bench.states().values()) == ["finished"] * 2 + ["not available in this build"] * 2


def test_a_record_from_a_bigger_machine_counts_here(bench):
    bench.write(axes={"threads": [5]})
    bench.run("run", "--cores", "8")
    bench.run("run")
    assert bench.states() == {"threads=5": "finished"}


def test_start_states_are_computed_once_per_combination(bench):
    prepare = {"by": ["scene", "vertices"], "params": {"kernel": "brute"}, "end_s": 0.25}
    bench.write(axes={"vertices": [10, 20], "threads": [1, 2]}, prepare=prepare)
    assert "2 start states" in bench.run("run", "--dry-run").stdout
    bench.run("run")
    assert [call.split()[1] for call in bench.calls()] == ["state", "point", "point"] * 2
    for record in bench.records().values():
        assert json.loads(Path(record["params"]["start_state"]).read_text())["time_s"] == 0.25
    ids = set(bench.records())
    bench.write(axes={"vertices": [10, 20], "threads": [1, 2]}, prepare={**prepare, "end_s": 0.5})
    bench.run("run", "--only", "threads=1")
    assert len(bench.calls()) == 10 and len(set(bench.records()) - ids) == 2


@pytest.mark.parametrize("scheme,threads", [("serial", 1), ("plain", 4)])
def test_a_start_state_is_computed_on_the_cores_its_scheme_can_use(bench, scheme, threads):
    bench.write(prepare={"by": ["scene"], "params": {"scheme": scheme}, "end_s": 0.25})
    bench.run("run")
    state, = (bench.folder / "results/states").glob("*.json")
    assert json.loads(state.read_text())["threads"] == threads


def test_repeats_of_compared_points_take_turns(bench):
    bench.write(fixed={**FIXED, "repeats": 3, "check_steps": 7}, axes={"threads": [1, 2], "grid": ["none", "regular"]},
                interleave=["grid"])
    bench.run("run")
    order = [point["id"] for point in bench.index()["points"]]
    first, second = order[:2], order[2:]
    assert bench.calls() == [f"{id} point {steps}" for pair in (first, second) for steps in (7, 1, 1) for id in pair]
    for record in bench.records().values():
        assert len(record["samples"]) == 3 and record["params"]["repeats"] == 3
        assert record["check"]["passed"] and record["check"]["how"][-1]["what"] == "interleaved"
        assert record["counters"]["cycles"]["value"] == 1


def test_turns_that_end_in_different_states_fail_the_check(bench):
    bench.write(fixed={**FIXED, "repeats": 2}, axes={"seed": seeds("unsteady", "fine")}, interleave=["seed"])
    bench.run("run", expect=1)
    assert list(bench.states().values()) == ["check failed", "finished"]


@pytest.mark.parametrize("check,code,state", [("kernel", 0, "check failed as expected"), ("grid", 1, "check failed")])
def test_a_baseline_that_fails_the_check_it_is_known_to_fail_is_no_defect(bench, check, code, state):
    seed, = seeds("check fails")
    baseline = {"where": {"seed": seed}, "check": check, "why": "known to be wrong"}
    bench.write(axes={"seed": [0, seed], "kernel": ["brute"]}, fixed={"scene": "hopper", "steps": 3, "repeats": 2},
                interleave=["seed"], expected_failures=[baseline])
    done = bench.run("run", expect=code)
    assert bench.states()[f"seed={seed} kernel=brute"] == state and f"1 {state}" in done.stdout
    assert ("kernel: known to be wrong" in done.stdout) == (code == 0) == ("CHECK FAILED (kernel)" not in done.stdout)
    assert ("--rerun-failed" in done.stderr) == (code == 1)
    assert state in bench.run("status").stdout
    assert len(bench.calls()) == 4
    bench.run("run", "--rerun-failed", expect=code)
    assert len(bench.calls()) == 4 + code, "what is as expected is not tried again"


def test_the_log_has_one_line_per_point(bench):
    bench.write(axes={"seed": seeds("crash", "fine")})
    bench.run("run", expect=1)
    lines = [line.split("\t") for line in (bench.results / "sweep.log").read_text().splitlines()]
    assert [(line[1] in bench.records(), line[3]) for line in lines] == [(True, "seed=2"), (True, "seed=0")]
    assert "killed by signal 11" in lines[0][4]


def test_a_terminal_gets_one_live_line_and_troubles_stay(bench):
    bench.write(axes={"seed": seeds("fine", "crash"), "threads": [1, 2]})
    leader, follower = pty.openpty()
    with subprocess.Popen(bench.command("run"), stdout=follower, stderr=subprocess.DEVNULL,
                          env=bench.environment(STAND_IN_SLEEP="0.7")) as sweep:
        os.close(follower)
        seen = b""
        try:
            while chunk := os.read(leader, 4096):
                seen += chunk
        except OSError:  # the other end is closed
            pass
    assert sweep.returncode == 1
    shown = [line.split("\r\x1b[K")[-1] for line in seen.decode().split("\r\n")]  # what stays of each line
    assert [line.split("] ")[1].split(":")[0] for line in shown if "FAILED" in line] == ["seed=2 threads=1", "seed=2 threads=2"]
    assert not [line for line in shown if line.startswith("[1/4]")]
    assert "about" in seen.decode() and "left" in seen.decode()


def test_it_needs_no_python_package(bench):
    bench.write(axes={"threads": [1]})
    command = bench.command("run")
    done = subprocess.run([command[0], "-S", *command[1:]], capture_output=True, text=True, env=bench.environment(),
                          check=False)  # -S: without Debian's packages
    assert done.returncode == 0, done.stderr


def test_without_dem_bench_it_says_how_to_get_one(bench):
    bench.write()
    (bench.folder / "bin/dem_bench").unlink()
    assert "Build first" in bench.run("run", expect=4).stderr


def test_a_dem_bench_that_cannot_list_is_told(bench):
    bench.write()
    for text, message in (("echo nonsense", "names no scene"), ("echo no >&2; exit 4", "exit code 4: no")):
        (bench.folder / "bin/dem_bench").write_text(f"#!/bin/bash\n{text}\n")
        assert message in bench.run("run", expect=4).stderr


KERNEL_BENCH = """#!/usr/bin/python3
import json, sys
if "--list" in sys.argv:
    print("kernels\\n  brute: all features\\nfamilies\\n  near_vf: in contact\\n  cross_deep: all cross")
    sys.exit(0)
call = dict(zip(sys.argv[1::2], sys.argv[2::2]))
with open(call["--record"], "w") as file:
    json.dump({"schema": "trigrain-record-1", "point_id": call["--point-id"], "status": "finished", "params": call,
               "check": {"passed": True, "how": []}, "samples": [{"wall_s": 1, "cpu_s": 1, "pairs": 5}]}, file)
"""


def test_kernel_bench_is_swept_as_dem_bench_is(bench):
    (bench.folder / "bin/kernel_bench").write_text(KERNEL_BENCH)
    (bench.folder / "bin/kernel_bench").chmod(0o755)
    bench.spec.write_text(json.dumps({"program": "kernel_bench", "fixed": {"repeats": 2}, "axes": {
        "kernel": ["brute", "hybrid-pair"], "family": ["near_vf", "cross_deep", "lattice"]}}))
    assert "2 finished, 4 not available in this build" in bench.run("run").stdout
    assert {record["params"]["--family"] for record in bench.records().values()} == {"near_vf", "cross_deep"}
    assert "kernel 'hybrid-pair'" in bench.run("status").stdout and "family 'lattice'" in bench.run("status").stdout
