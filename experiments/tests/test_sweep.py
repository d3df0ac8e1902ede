"""The sweep, run as a program with a stand-in for dem_bench."""
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

EXPERIMENTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(EXPERIMENTS), str(EXPERIMENTS / "tests")]
from stand_in_dem_bench import BEHAVIOUR  # noqa: E402
from sweep.points import expand, short_hash  # noqa: E402
from sweep.spec import read_spec  # noqa: E402

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


@pytest.fixture(name="bench")
def _bench(tmp_path) -> Bench:
    return Bench(tmp_path)


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


# --- points

def test_every_combination_is_a_point_and_the_last_axis_varies_fastest(bench):
    bench.write(axes={"grid": ["regular", "none"], "threads": [1, 2, 3]})
    names = [point.name for point in expand(read_spec(bench.spec))]
    assert names == [f"grid={g} threads={t}" for g in ("regular", "none") for t in (1, 2, 3)]


def test_a_points_identity_is_its_parameters_alone(bench):
    bench.write(axes={"threads": [1, 2]})
    plain = expand(read_spec(bench.spec))
    bench.spec.write_text(json.dumps({"title": "renamed", "axes": {"threads": [2, 1]}, "time_limit_s": 9,
                                      "fixed": dict(reversed(FIXED.items())), "presets": {"quick": {}}}))
    assert {point.id for point in plain} == {point.id for point in expand(read_spec(bench.spec))}
    assert short_hash({"b": 1, "a": "x"}) == "cdab067e9f3b"  # sha256sum of {"a":"x","b":1}
    bench.write(axes={"threads": [1, 2]}, presets={"quick": {"fixed": {"steps": 4}}})
    assert not {point.id for point in plain} & {point.id for point in expand(read_spec(bench.spec))}


def test_presets_that_agree_share_records(bench):
    bench.write(axes={"threads": [1, 2, 3]}, presets={"quick": {"axes": {"threads": [1, 2]}}})
    bench.run("run", "--quick")
    bench.run("run", "--full")
    assert len(bench.calls()) == 3


def test_a_preset_turns_an_axis_into_a_fixed_value_and_back(bench):
    bench.write(axes={"threads": [1, 2]}, presets={"quick": {"fixed": {"threads": 1}, "axes": {"steps": [5, 6]}}})
    assert [point.params for point in expand(read_spec(bench.spec, "quick"))] == [
        {"scene": "hopper", "kernel": "brute", "threads": 1, "steps": steps} for steps in (5, 6)]


def test_a_changed_scene_file_is_another_point(bench):
    scene = bench.folder / "own.json"
    bench.write(fixed={"scene_file": "own.json", "steps": 1})
    scene.write_text("{}")
    before = expand(read_spec(bench.spec))[0].id
    scene.write_text("{ }")
    assert expand(read_spec(bench.spec))[0].id != before
    scene.unlink()
    assert "own.json" in bench.run("run", expect=3).stderr


def test_shards_are_a_partition(bench):
    bench.write(axes={"threads": [1, 2, 3], "vertices": [10, 20, 40], "seed": [0]})
    for i in (1, 2, 3, 4):
        before = set(bench.records())
        bench.run("run", "--shard", f"{i}/4")
        assert before < set(bench.records())
    assert len(bench.calls()) == len(set(bench.calls())) == 9
    for wrong in ("0/4", "5/4", "4", "a/b"):
        assert "--shard" in bench.run("run", "--shard", wrong, expect=3).stderr


def test_only_lets_through_what_it_names(bench):
    bench.write(axes={"threads": [1, 2, 3], "vertices": [10, 20]})
    bench.run("run", "--only", "threads=1,3", "--only", "vertices=20")
    assert [name for name, state in bench.states().items() if state == "finished"] == [
        "threads=1 vertices=20", "threads=3 vertices=20"]
    assert "Did you mean 'threads'?" in bench.run("run", "--only", "thread=1", expect=3).stderr
    assert "threads = '9'" in bench.run("run", "--only", "threads=9", expect=3).stderr


# --- running

def test_a_second_run_repeats_nothing(bench):
    bench.write(axes={"threads": [1, 2]})
    assert "[2/2] threads=2" in bench.run("run").stdout
    before = {path: path.read_bytes() for path in bench.results.glob("*.json") if path.stem != "index"}
    assert "running 0" in bench.run("run").stdout
    assert len(bench.calls()) == 2
    assert before == {path: path.read_bytes() for path in before}
    assert not list(bench.results.glob("*.part"))


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


def test_status_says_how_long_a_step_took(bench):
    bench.write(axes={"seed": seeds("fine", "crash")})
    bench.run("run", expect=1)
    said = bench.run("status").stdout
    assert "seed=0: finished (333 ms per step)" in said and said.count("per step") == 1, "1 s for 3 steps"


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


def test_a_dry_run_writes_nothing(bench):
    bench.write(axes={"threads": [1, 2]})
    assert bench.run("run", "--dry-run").stdout.count("would run") == 3  # two points and the sum
    assert not (bench.folder / "results").exists() and not bench.calls()


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


def test_a_start_state_that_fails_fails_its_points_only(bench):
    bench.write(axes={"seed": seeds("refuse", "fine"), "threads": [1, 2]},
                prepare={"by": ["scene", "seed"], "end_s": 0.25})
    bench.run("run", expect=1)
    assert list(bench.states().values()) == ["failed"] * 2 + ["finished"] * 2
    reasons = [record["reason"] for record in bench.records().values() if record["status"] == "failed"]
    assert all("its start state failed: exit code 3: stand-in: no such thing" in reason for reason in reasons)
    assert [call.split()[1] for call in bench.calls()] == ["state", "state", "point", "point"]


# --- the results folder

def test_two_sweeps_do_not_share_a_folder(bench):
    bench.write(axes={"seed": seeds("slow")})
    with subprocess.Popen(bench.command("run"), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          env=bench.environment()) as first:
        wait_until(bench.calls)
        refused = bench.run("run", expect=4).stderr
        assert f"process {first.pid} on" in refused
        first.send_signal(signal.SIGINT)
    assert len(bench.calls()) == 1


def test_the_lock_of_a_dead_sweep_is_taken_over(bench):
    bench.write(axes={"seed": seeds("slow")})
    with subprocess.Popen(bench.command("run"), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          env=bench.environment()) as first:
        wait_until(bench.calls)
        first.kill()
    assert (bench.results / "sweep.lock").read_text()
    try:
        bench.write(axes={"seed": seeds("fine")})
        bench.run("run")
    finally:
        for entry in Path("/proc").glob("[0-9]*"):  # a killed sweep cannot stop its child
            try:
                if str(bench.folder / "bin") in (entry / "cmdline").read_text().replace("\0", " "):
                    os.kill(int(entry.name), signal.SIGKILL)
            except (OSError, UnicodeDecodeError):
                continue


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


def test_without_dem_bench_it_says_how_to_get_one(bench):
    bench.write()
    (bench.folder / "bin/dem_bench").unlink()
    assert "Build first" in bench.run("run", expect=4).stderr


def test_a_dem_bench_that_cannot_list_is_told(bench):
    bench.write()
    for text, message in (("echo nonsense", "names no scene"), ("echo no >&2; exit 4", "exit code 4: no")):
        (bench.folder / "bin/dem_bench").write_text(f"#!/bin/bash\n{text}\n")
        assert message in bench.run("run", expect=4).stderr
