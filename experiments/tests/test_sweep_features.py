"""What a spec can vary, repeats that take turns, and what a sweep survives; with a stand-in for dem_bench."""
import json
import os
import pty
import resource
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

EXPERIMENTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(EXPERIMENTS), str(EXPERIMENTS / "tests")]
from sweep.aliases import import_ini  # noqa: E402
from sweep.errors import InputError  # noqa: E402
from sweep.points import expand  # noqa: E402
from sweep.spec import read_spec  # noqa: E402
from test_sweep import FIXED, Bench, _bench, alive, seeds, wait_until  # noqa: E402, F401


def names(bench: Bench, **spec) -> list[str]:
    bench.write(**spec)
    return [point.name for point in expand(read_spec(bench.spec))]


# --- what varies

@pytest.mark.parametrize("given,values", [
    ({"from": 1, "to": 8, "factor": 2}, [1, 2, 4, 8]), ({"from": 10, "to": 25, "step": 5}, [10, 15, 20, 25]),
    ({"from": 10, "to": 24, "step": 5}, [10, 15, 20]), ({"from": 3, "to": 3, "step": 1}, [3])])
def test_a_range_is_written_out(bench, given, values):
    assert names(bench, axes={"particles": given}) == [f"particles={value}" for value in values]


def test_a_range_of_fractions_has_no_rounding_in_it(bench):
    assert names(bench, axes={"size_ratio": {"from": 1.1, "to": 1.4, "step": 0.1}}) == [
        f"size_ratio={value}" for value in (1.1, 1.2, 1.3, 1.4)]


def test_zipped_axes_advance_together(bench):
    assert names(bench, axes={"threads": [1, 2]}, zip=[{"particles": [250, 500], "vertices": [20, 10]}]) == [
        f"threads={t} particles={p} vertices={v}" for t in (1, 2) for p, v in ((250, 20), (500, 10))]


def test_excluded_combinations_are_no_points(bench):
    assert names(bench, axes={"scheme": ["serial", "plain"], "threads": [1, 2, 4]},
                 exclude=[{"scheme": "serial", "threads": [2, 4]}]) == [
        "scheme=serial threads=1", "scheme=plain threads=1", "scheme=plain threads=2", "scheme=plain threads=4"]


def test_the_ancestors_names_make_the_same_points(bench):
    bench.write(axes={"grid": ["regular", "reluctant"], "threads": [1]}, fixed={**FIXED, "vertices": 20})
    ours = [point.id for point in expand(read_spec(bench.spec))]
    bench.write(axes={"grid-type": ["regular-grid", "reluctant-grid"], "tbb-core-count": [1]},
                fixed={"scenario": "hopper", "iterations": 3, "collision-model": "bf", "mesh-density": 20})
    assert [point.id for point in expand(read_spec(bench.spec))] == ours
    bench.run("run", "--only", "grid-type=regular-grid")
    assert len(bench.calls()) == 1


@pytest.mark.parametrize("changes,message", [
    ({"axes": {"threads": {"from": 1, "to": 4}}}, "either 'step' or 'factor' (tried.json: axes.threads)"),
    ({"axes": {"threads": {"from": 1, "to": 4, "stepp": 1}}}, "Did you mean 'step'?"),
    ({"axes": {"threads": {"from": 1, "to": 4, "factor": 1}}}, "a range grows"),
    ({"axes": {"particles": {"from": 1, "to": 1e9, "step": 1}}}, "more than 10000 values"),
    ({"zip": [{"particles": [1, 2], "vertices": [1]}]}, "zip[0]: particles has 2, vertices has 1"),
    ({"zip": [{"particles": [1, 1], "vertices": [4, 4]}]}, "two points are the same"),
    ({"zip": [{"particles": [1, 2], "steps": [4, 5]}]}, "'steps' is given twice (tried.json: zip[0].steps)"),
    ({"exclude": [{"threds": 2}]}, "Did you mean 'threads'?"), ({"exclude": [{}]}, "leaves out every point"),
    ({"interleave": ["kernl"]}, "unknown parameter 'kernl' (tried.json: interleave[0]). Did you mean 'kernel'?"),
    ({"axes": {"grid": ["none"], "grid-type": ["no-grid"]}}, "are the same parameter (tried.json: axes)"),
    ({"program": "dem_bensch"}, "Did you mean 'dem_bench'?"), ({"memory_limit_mb": 0}, "a number above 0 MB")])
def test_a_wrong_spec_is_refused(bench, changes, message):
    bench.write(**changes)
    with pytest.raises(InputError) as error:
        expand(read_spec(bench.spec))
    assert message in str(error.value)


def test_an_option_file_of_the_ancestor_becomes_a_spec(bench):
    ini = bench.folder / "old.ini"
    ini.write_text("[jobs]\ntime = 10\n[parameters]\nscenario = hopperUniform1k\ngrid-type = regular-grid, reluctant-grid\n"
                   "iterations = 100\ngravity = true\n; a comment\n[parameters_grouped]\n"
                   "tbb-core-count = 1, 2\nmesh-density = 10,20\n")
    done = bench.run("run", "--dry-run", expect=3)  # there is no spec yet
    assert "cannot read the spec" in done.stderr
    command = bench.command("import")[:4] + [str(ini), "--out", str(bench.spec)]
    imported = subprocess.run(command, capture_output=True, text=True, env=bench.environment(), check=True)
    assert "[jobs] is left out" in imported.stderr and "gravity = true is left out" in imported.stderr
    assert [point.params for point in expand(read_spec(bench.spec))] == [
        {"scene": "hopper", "particles": 1000, "steps": 100, "grid": grid, "threads": t, "vertices": v}
        for grid in ("regular", "reluctant") for t, v in ((1, 10), (2, 20))]
    for text, message in (("[parameters]\ngrid-typ = x\n", "Did you mean 'grid-type'?"), ("grid = x\n", "no option file"),
                          ("[jobs]\na = b\n", "there is no [parameters]")):
        ini.write_text(text)
        with pytest.raises(InputError) as error:
            import_ini(ini)
        assert message in str(error.value)


# --- repeats that take turns

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


def test_a_compared_point_that_dies_does_not_stop_the_others(bench):
    bench.write(fixed={**FIXED, "repeats": 2}, axes={"seed": seeds("crash", "fine")}, interleave=["seed"])
    bench.run("run", expect=1)
    assert list(bench.states().values()) == ["failed", "finished"] and len(bench.calls()) == 3


# --- shards, log, live line

def test_merging_shards_is_idempotent(bench):
    bench.write(axes={"threads": [1, 2, 3]})
    other = Bench.__new__(Bench)
    other.__dict__ = {**bench.__dict__, "results": bench.folder / "other/tried"}
    bench.run("run", "--shard", "1/2")
    shutil.copytree(bench.folder / "results", bench.folder / "other")
    for record in bench.records():
        (bench.results / f"{record}.json").unlink()
    bench.run("run", "--shard", "2/2")
    ours = set(bench.records())
    assert "2 taken over" in bench.run("merge", str(bench.folder / "other")).stdout
    assert set(bench.records()) == ours | set(other.records())
    assert set(bench.states().values()) == {"finished"}
    before = bench.records()
    assert "2 already here" in bench.run("merge", str(bench.folder / "other")).stdout
    assert bench.records() == before
    assert "to merge" in bench.run("merge", str(bench.folder / "nowhere"), expect=3).stderr


def test_a_finished_record_from_elsewhere_replaces_a_failed_one_and_not_the_other_way(bench):
    bench.write(axes={"seed": seeds("crash")})
    bench.run("run", expect=1)
    shutil.copytree(bench.folder / "results", bench.folder / "other")
    path, = (bench.folder / "other/tried").glob("[0-9a-f]*.json")
    path.write_text(json.dumps({"schema": "trigrain-record-1", "point_id": path.stem, "status": "finished",
                                "check": {"passed": True, "how": []}, "samples": []}))
    shutil.copytree(bench.folder / "results", bench.folder / "failed")
    assert "1 taken over" in bench.run("merge", str(bench.folder / "other")).stdout
    path.write_text(path.read_text().replace('"samples": []', '"samples": [{}]'))
    for other in ("failed", "other"):
        assert "1 kept as they are here" in bench.run("merge", str(bench.folder / other)).stdout
    assert next(iter(bench.records().values()))["samples"] == []
    assert list(bench.states().values()) == ["finished"]


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


def test_the_estimate_comes_from_finished_points(bench):
    bench.write(axes={"threads": [1, 2, 3]})
    assert "none has run yet" in bench.run("run", "--dry-run").stdout
    bench.run("run", "--only", "threads=1", STAND_IN_SLEEP="1")
    text = bench.run("run", "--dry-run").stdout
    assert float(text.split("Estimated time of the points: ")[1].split(" s")[0]) == pytest.approx(2.1, abs=0.5)


# --- what a sweep survives

def test_the_child_of_a_killed_sweep_dies_and_what_it_left_is_removed(bench):
    bench.write(axes={"seed": seeds("slow")})
    with subprocess.Popen(bench.command("run"), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          env=bench.environment()) as first:
        wait_until(bench.calls)
        first.kill()
    wait_until(lambda: not alive(str(bench.folder / "bin")), 5)
    (bench.results / "0123.77.part").write_text("{")
    (bench.results / ".0123.77.part.78.part").write_text("{")
    bench.write(axes={"seed": seeds("fine")})
    bench.run("run")
    assert sorted(path.suffix for path in bench.results.iterdir()) == [".json", ".json", ".lock", ".log"]


def test_a_point_that_runs_out_of_memory_says_so(bench):
    bench.write(axes={"seed": seeds("memory", "fine")}, memory_limit_mb=2000)
    bench.run("run", expect=1)
    failed, = (record for record in bench.records().values() if record["status"] == "failed")
    assert failed["reason"] == "out of memory of 2000 MB" and failed["output"] == ["stand-in: std::bad_alloc"]
    assert list(bench.states().values()) == ["failed", "finished"]


def test_a_full_disk_ends_the_sweep_and_no_point_is_called_failed(bench):
    bench.write(axes={"seed": seeds("fine", "disk full")})
    assert "the disk is full" in bench.run("run", expect=4).stderr
    assert [record["status"] for record in bench.records().values()] == ["finished"]


def test_a_record_that_cannot_be_written_leaves_none(bench):
    bench.write(axes={"seed": seeds("crash")})

    def limit() -> None:  # stands for a full disk: no file may grow beyond this
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (300, 300))

    done = subprocess.run(bench.command("run"), capture_output=True, text=True, env=bench.environment(), check=False,
                          preexec_fn=limit, timeout=60)
    assert done.returncode == 4 and "the same command" in done.stderr and "Traceback" not in done.stderr
    assert not bench.records() and not list(bench.results.glob("*.part"))


def test_an_edited_record_is_noticed_and_made_again(bench):
    bench.write(axes={"threads": [1]})
    bench.run("run")
    path = bench.results / f"{next(iter(bench.records()))}.json"
    path.write_text(path.read_text().replace('"wall_s": 1.0', '"wall_s": 0.5'))
    assert "its checksum differs" in bench.run("status").stderr
    bench.run("run")
    assert '"wall_s": 0.5' in path.with_suffix(".json.broken").read_text()
    assert len(bench.calls()) == 2 and '"wall_s": 1.0' in path.read_text()


def test_a_record_that_was_only_laid_out_anew_is_the_same(bench):
    bench.write(axes={"threads": [1]})
    bench.run("run")
    path = bench.results / f"{next(iter(bench.records()))}.json"
    path.write_text(json.dumps(json.loads(path.read_text()), sort_keys=True, indent=4))
    assert "1 finished" in bench.run("status").stdout


def test_it_needs_no_python_package(bench):
    bench.write(axes={"threads": [1]})
    command = bench.command("run")
    done = subprocess.run([command[0], "-S", *command[1:]], capture_output=True, text=True, env=bench.environment(),
                          check=False)  # -S: without Debian's packages
    assert done.returncode == 0, done.stderr


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
