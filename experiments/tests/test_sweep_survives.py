"""What a sweep survives: points that die, its own end at any moment, a full disk, and hands in its results folder."""
import json
import resource
import shutil
import signal
import subprocess
import time

import pytest

from sweep_bench import EXPERIMENTS, FIXED, Bench, alive, seeds, wait_until


def test_a_point_that_dies_costs_only_itself(bench):
    bench.write(axes={"seed": seeds("crash", "refuse", "silent", "half record", "check fails", "fine")})
    done = bench.run("run", expect=1)
    assert "[6/6]" in done.stdout and "--rerun-failed" in done.stderr
    by_seed = {point["params"]["seed"]: (bench.records()[point["id"]], point["state"])
               for point in bench.index()["points"]}
    assert {seed: state for seed, (_, state) in by_seed.items()} == {
        2: "failed", 3: "failed", 4: "failed", 6: "failed", 5: "check failed", 0: "finished"}
    crash, refused = by_seed[2][0], by_seed[3][0]
    assert crash["exit_code"] == -signal.SIGSEGV and crash["output"] == ["before the end"]
    assert crash["params"]["seed"] == 2 and crash["schema"] == "trigrain-record-1"
    assert refused["exit_code"] == 3 and "no such thing" in refused["output"][-1]
    assert "no record" in by_seed[4][0]["reason"] and "check.passed" in by_seed[6][0]["reason"]


def test_failed_points_wait_for_rerun_failed(bench):
    bench.write(axes={"seed": seeds("crash", "fine")})
    bench.run("run", expect=1)
    bench.run("run", expect=1)
    assert len(bench.calls()) == 2
    bench.run("run", "--rerun-failed", expect=1)
    assert len(bench.calls()) == 3


@pytest.mark.parametrize("behaviour", ["slow", "grandchild"])
def test_the_time_limit_ends_a_point_and_all_its_children(bench, behaviour):
    bench.write(axes={"seed": seeds(behaviour, "fine")}, time_limit_s=0.8)
    began = time.monotonic()
    bench.run("run", expect=1)
    assert time.monotonic() - began < 20
    failed, = (record for record in bench.records().values() if record["status"] == "failed")
    assert "time limit of 800 ms" in failed["reason"] and failed["sweep"]["took_s"] >= 0.8
    assert list(bench.states().values()) == ["failed", "finished"]
    assert not alive(str(bench.folder / "bin"))


def test_a_point_that_runs_out_of_memory_says_so(bench):
    bench.write(axes={"seed": seeds("memory", "fine")}, memory_limit_mb=2000)
    bench.run("run", expect=1)
    failed, = (record for record in bench.records().values() if record["status"] == "failed")
    assert failed["reason"] == "out of memory of 2000 MB" and failed["output"] == ["stand-in: std::bad_alloc"]
    assert list(bench.states().values()) == ["failed", "finished"]


def test_a_start_state_that_fails_fails_its_points_only(bench):
    bench.write(axes={"seed": seeds("refuse", "fine"), "threads": [1, 2]},
                prepare={"by": ["scene", "seed"], "end_s": 0.25})
    bench.run("run", expect=1)
    assert list(bench.states().values()) == ["failed"] * 2 + ["finished"] * 2
    reasons = [record["reason"] for record in bench.records().values() if record["status"] == "failed"]
    assert all("its start state failed: exit code 3: stand-in: no such thing" in reason for reason in reasons)
    assert [call.split()[1] for call in bench.calls()] == ["state", "state", "point", "point"]


def test_a_compared_point_that_dies_does_not_stop_the_others(bench):
    bench.write(fixed={**FIXED, "repeats": 2}, axes={"seed": seeds("crash", "fine")}, interleave=["seed"])
    bench.run("run", expect=1)
    assert list(bench.states().values()) == ["failed", "finished"] and len(bench.calls()) == 3


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_sweep_resumes(bench, number):
    bench.write(axes={"vertices": [10, 20], "seed": seeds("fine", "slow")}, time_limit_s=50)
    sweep = subprocess.Popen(bench.command("run"), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                             env=bench.environment())
    wait_until(lambda: len(bench.calls()) == 2)  # the first is done, the second sleeps
    sweep.send_signal(number)
    _, errors = sweep.communicate(timeout=20)
    assert sweep.returncode == 128 + number
    assert "the same command resumes" in errors
    assert not alive(str(bench.folder / "bin"))
    assert [record["status"] for record in bench.records().values()] == ["finished"]
    assert not list(bench.results.glob("*.part"))
    assert list(bench.states().values()) == ["finished", "missing", "missing", "missing"]
    bench.run("run", "--only", "seed=0")
    assert len(bench.calls()) == 3 and len(set(bench.calls())) == 3


def test_the_child_of_a_killed_sweep_dies_and_what_it_left_is_removed(bench):
    bench.write(axes={"seed": seeds("slow")})
    with subprocess.Popen(bench.command("run"), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          env=bench.environment()) as first:
        wait_until(bench.calls)
        first.kill()
    wait_until(lambda: not alive(str(bench.folder / "bin")), 5)
    assert str(first.pid) in (bench.results / "sweep.lock").read_text(), "a lock that nobody holds is taken over"
    (bench.results / "0123.77.part").write_text("{")
    (bench.results / ".0123.77.part.78.part").write_text("{")
    bench.write(axes={"seed": seeds("fine")})
    bench.run("run")
    assert sorted(path.suffix for path in bench.results.iterdir()) == [".json", ".json", ".lock", ".log"]


def test_two_sweeps_do_not_share_a_folder(bench):
    bench.write(axes={"seed": seeds("slow")})
    with subprocess.Popen(bench.command("run"), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          env=bench.environment()) as first:
        wait_until(bench.calls)
        refused = bench.run("run", expect=4).stderr
        assert f"process {first.pid} on" in refused
        first.send_signal(signal.SIGINT)
    assert len(bench.calls()) == 1


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


@pytest.mark.parametrize("text", ["{\"schema\": \"trigr", "[]", "{}", '{"schema": "trigrain-record-1"}'])
def test_a_broken_record_is_set_aside_and_counts_as_missing(bench, text):
    bench.write(axes={"threads": [1, 2]})
    bench.run("run")
    path = bench.results / f"{sorted(bench.records())[0]}.json"
    path.write_text(text)
    assert "1 finished, 1 missing" in bench.run("status").stdout
    assert path.read_text() == text
    assert "is no record" in bench.run("run").stderr
    assert path.with_suffix(".json.broken").read_text() == text
    assert json.loads(path.read_text())["status"] == "finished"
    assert len(bench.calls()) == 3


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


def test_records_of_another_commit_are_kept_until_fresh(bench):
    here = subprocess.run(["git", "-C", EXPERIMENTS, "rev-parse", "HEAD"], capture_output=True, text=True, check=False)
    if here.returncode:
        pytest.skip("not a git checkout")
    bench.write(axes={"threads": [1, 2]})
    bench.run("run", STAND_IN_COMMIT="0" * 40)
    bench.run("run", STAND_IN_COMMIT=here.stdout.strip())
    assert "2 records come from another commit" in bench.run("status").stdout
    bench.run("run", "--fresh", STAND_IN_COMMIT=here.stdout.strip())
    assert len(bench.calls()) == 4
    assert "another commit" not in bench.run("status").stdout


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
