"""The regression gate: its statistics on made-up noise, and the tool with stand-ins for two builds."""
import json
import os
import random
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "experiments"))
from regression_trial import INJECTED  # noqa: E402
from sweep.bench import find_bench  # noqa: E402
from sweep.decision import FASTER, LEAST_PAIRS, SAME, SLOWER, UNSTABLE, Decision, decide, with_counts  # noqa: E402
from sweep.regression import Counted, Side, compare_builds, judge  # noqa: E402
from sweep.spec import read_spec  # noqa: E402

STAND_IN = """#!/usr/bin/python3
import json, os, random, sys
if "--list" in sys.argv:
    print("kernels\\n  brute: all")
    sys.exit(0)
call = dict(zip(sys.argv[1::2], sys.argv[2::2]))
factor, counts, built = FACTOR, COUNTS, BUILT
if "--final-state" in call:
    open(call["--final-state"], "w").write(built)
    sys.exit(0)
if "--start-state" in call:
    open(built + ".starts", "a").write(open(call["--start-state"]).read() + "\\n")
open(built + ".calls", "a").write(f"{sys.argv[0]} {os.stat(sys.argv[0]).st_ino}\\n")
chance = random.Random(built[-12:] + str(len(open(built + ".calls").readlines())))  # the same in every test run
noise = lambda: 1 + abs(chance.gauss(0, NOISE))
samples = [{"cpu_s": s, "wall_s": s, "steps": 10, "phases_s": {"grid": 0.2, "detect": 0.8 * factor}}
           for s in [factor * noise() for _ in range(3)]]
json.dump({"schema": "trigrain-record-1", "point_id": call["--point-id"], "status": "finished", "params": call,
           "check": {"passed": PASSED, "how": []}, "samples": samples, "counts": {"steps": 10, **counts}}, open(call["--record"], "w"))
print("check step FAILED: too long" * (not PASSED))
sys.exit(0 if PASSED else 1)
"""
VALGRIND = """#!/usr/bin/python3
import sys
steps = int(sys.argv[sys.argv.index("--steps") + 1])
print(f"Collected : {steps * (1030 if '/b/' in ' '.join(sys.argv) else 1000)}", file=sys.stderr)
"""
SPEC = {"fixed": {"scene": "hopper", "steps": 10, "repeats": 3}, "axes": {"kernel": ["brute"]}}


def times(chance: random.Random, factor: float, pairs: int = 30) -> list[float]:
    """CPU times as a loaded machine gives them: never below the true time, now and then far above it."""
    return [factor * (1 + abs(chance.gauss(0, 0.015)) + (0.3 * chance.random() if chance.random() < 0.1 else 0))
            for _ in range(pairs)]


@pytest.mark.parametrize("factor,verdict", [(1.05, SLOWER), (1 / 1.05, FASTER)])
def test_five_percent_are_found_in_ten_of_ten(factor, verdict):
    for seed in range(10):
        chance = random.Random(seed)
        assert decide(times(chance, 1), times(chance, factor)).verdict == verdict, seed


def test_identical_builds_are_hardly_ever_called_slower():
    verdicts = []
    for seed in range(100, 140):
        chance = random.Random(seed)
        verdicts.append(decide(times(chance, 1), times(chance, 1)).verdict)
    assert verdicts.count(SLOWER) <= 1 and verdicts.count(SAME) >= 36, verdicts


def test_noise_that_hides_a_change_is_unstable_and_few_pairs_say_nothing():
    chance = random.Random(1)
    wild = [[1 + chance.random() for _ in range(30)] for _ in range(2)]
    assert decide(*wild).verdict == UNSTABLE
    assert decide([1.0] * (LEAST_PAIRS - 1), [2.0] * (LEAST_PAIRS - 1)).verdict == UNSTABLE


def test_a_significant_change_that_is_too_small_to_matter_is_none():
    chance = random.Random(2)
    found = decide([1 + 1e-4 * chance.random() for _ in range(30)], [1.01 + 1e-4 * chance.random() for _ in range(30)])
    assert found.verdict == SAME and found.p < 0.01 and found.change == pytest.approx(0.01, abs=1e-3)


@pytest.mark.parametrize("time,p,instructions,work,verdict", [
    (-0.005, 0.4, 0.0053, 0, SAME),  # the compiler laid the same work out anew
    (0.01, 0.001, 0.0053, 0, SLOWER),  # little, but both rose
    (0.01, 0.2, 0.025, 0, SLOWER), (-0.01, 0.001, 0.025, 0, SAME),  # much, unless the time fell
    (0.05, 0.001, -0.05, 0, SLOWER), (-0.05, 0.001, 0.05, 0.05, FASTER),  # time decides where it can
    (-0.01, 0.001, -0.01, 0, FASTER), (0, 0.5, -0.01, 0, SAME), (0, 0.5, -0.03, 0, FASTER),
    (-0.005, 0.4, 0, 0.01, SLOWER), (-0.005, 0.4, -0.01, 0.01, SAME), (-0.01, 0.001, 0, 0.01, SAME)])  # work may pay off
def test_counts_tell_where_they_are_sure_and_never_against_the_time(time, p, instructions, work, verdict):
    large = verdict if abs(time) >= 0.03 else SAME
    assert with_counts(Decision(large, time, p, 0.01), instructions, work) == verdict


def test_instructions_that_decide_nothing_are_shown_all_the_same():
    before = Side([1 + i * 1e-5 for i in range(30)], counts={"instructions": 10_000})
    found = judge("point", before, Side(before.cpu_s, counts={"instructions": 10_053}))
    assert found.verdict == SAME and "instructions +0.53 %" in found.why


def build(folder: Path, factor: float = 1, noise: float = 0.01, passed: bool = True, **counts: int) -> Path:
    folder.mkdir()
    text = STAND_IN.replace("FACTOR", str(factor)).replace("NOISE", str(noise)).replace("PASSED", str(passed))
    text = text.replace("BUILT", repr(str(folder / "dem_bench"))).replace("COUNTS", repr(counts or {"triangle_pairs": 1000}))
    (folder / "dem_bench").write_text(text)
    (folder / "dem_bench").chmod(0o755)
    return folder


def regress(folder: Path, *words: object, spec: dict = SPEC) -> subprocess.CompletedProcess:
    (folder / "tried.json").write_text(json.dumps(spec))
    return subprocess.run([ROOT / "tools/regress", *map(str, words), "--spec", folder / "tried.json", "--junit", folder / "j.xml"],
                          capture_output=True, text=True, check=False, timeout=120)


@pytest.mark.parametrize("head,code,words", [
    ({}, 0, ["| same |"]), ({"factor": 1.06}, 1, ["**slower**", "mostly in phase detect: +4."]),
    ({"factor": 0.9}, 0, ["| faster |"]), ({"noise": 1.0}, 2, ["**unstable**"]),
    ({"triangle_pairs": 1010}, 1, ["**slower**", "triangle pairs +1.00 %"]),
    ({"passed": False}, 1, ["**slower**", "now: exit code 1: check step FAILED: too long"])])
def test_the_tool_exits_by_its_verdict(tmp_path, head, code, words):
    done = regress(tmp_path, build(tmp_path / "a", noise=head.get("noise", 0.01)), build(tmp_path / "b", **head))
    assert done.returncode == code, done.stdout + done.stderr
    for word in words:
        assert word in done.stdout, done.stdout
    suite = ElementTree.parse(tmp_path / "j.xml").getroot()
    assert suite.attrib["failures"] == str(int(code == 1)) and suite.attrib["skipped"] == str(int(code == 2))


def test_a_table_that_cannot_be_written_is_told_after_it_was_printed(tmp_path):
    done = regress(tmp_path, build(tmp_path / "a"), build(tmp_path / "b"), "--markdown", "/proc/none/r.md")
    assert done.returncode == 4 and "| same |" in done.stdout and "(/proc/none" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize("factor,told", [(1.05, "slower in phase merge: +5.0 %"), (0.95, "faster in phase detect: -8.0 %")])
def test_the_phase_that_is_named_went_the_way_of_the_whole(factor, told):
    before = Side([1 + i * 1e-5 for i in range(30)], 3 * [{"detect": 0.9, "merge": 0.1}])
    after = Side([factor * s for s in before.cpu_s], 3 * [{"detect": 0.82, "merge": 0.15}])
    found = judge("point", before, after)
    assert found.verdict == told.split()[0] and "mostly in phase " + told.split("phase ")[1] in found.why


def test_samples_that_other_work_held_up_name_no_phase():
    sides = Side(), Side()
    for side, factor in zip(sides, (1, 1.05)):
        for number in range(30):
            cpu_s = factor * (1 + number * 1e-5)
            waited = {"wall_s": 3 * cpu_s, "phases_s": {"detect": 0.9 + 2 * cpu_s, "merge": 0.1 * factor}}
            side.add({"samples": [{"cpu_s": cpu_s, "steps": 1, **waited}]})
    found = judge("point", *sides)
    assert found.verdict == SLOWER and "held the runs up" in found.why and "mostly" not in found.why
    for side, merge_s in zip(sides, (0.1, 0.15)):
        side.look_at({"samples": 3 * [{"cpu_s": 1, "wall_s": 1.005, "steps": 1, "phases_s": {"detect": 0.9, "merge": merge_s}}]})
    assert "mostly in phase merge: +5.0 % of the step" in judge("point", *sides).why


def test_both_start_from_the_state_that_the_first_computed(tmp_path):
    spec = {**SPEC, "prepare": {"by": ["scene"], "end_s": 0.1}}
    done = regress(tmp_path, build(tmp_path / "a"), build(tmp_path / "b"), "--pairs", 15, spec=spec)
    assert done.returncode == 0, done.stdout + done.stderr
    for name in "ab":
        assert (tmp_path / name / "dem_bench.starts").read_text() == f"{tmp_path}/a/dem_bench\n" * 15


def test_every_run_has_a_copy_of_its_own_that_stays_until_the_point_is_done(tmp_path):
    done = regress(tmp_path, build(tmp_path / "a"), build(tmp_path / "b"), "--pairs", 15)
    assert done.returncode == 0, done.stdout + done.stderr
    paths, inodes = zip(*(line.split() for name in "ab" for line in (tmp_path / name / "dem_bench.calls").read_text().splitlines()))
    assert len(set(paths)) == len(set(inodes)) == 30
    assert not any(Path(path).exists() or str(tmp_path) in path for path in paths)


@pytest.mark.parametrize("times,verdict", [(1, SAME), (2, SLOWER)])
def test_a_run_that_is_too_long_once_is_run_again(tmp_path, times, verdict):
    folders = [build(tmp_path / name, noise=0.001) for name in "ab"]
    slow = folders[1] / "dem_bench"
    slow.write_text(slow.read_text().replace("chance = random", f"""if len(open(built + ".calls").readlines()) <= {times}:
    import time
    time.sleep(60)
chance = random"""))
    (tmp_path / "tried.json").write_text(json.dumps({**SPEC, "time_limit_s": 2}))
    spec = read_spec(tmp_path / "tried.json")
    found, = compare_builds(spec, tuple(find_bench(spec.program, folder, ROOT) for folder in folders), None, LEAST_PAIRS, print)
    assert found.verdict == verdict and ("needed more than 2 s, twice" in found.why) == (verdict == SLOWER)


def test_ended_by_a_signal_it_leaves_nothing_behind(tmp_path):
    (tmp_path / "tmp").mkdir()
    (tmp_path / "tried.json").write_text(json.dumps(SPEC))
    tool = subprocess.Popen([ROOT / "tools/regress", build(tmp_path / "a"), build(tmp_path / "b"), "--spec", tmp_path / "tried.json"],
                            env={**os.environ, "TMPDIR": str(tmp_path / "tmp")}, stdout=subprocess.DEVNULL)
    calls, until = tmp_path / "b/dem_bench.calls", time.monotonic() + 60
    while not calls.exists() and time.monotonic() < until:
        time.sleep(0.05)
    assert list((tmp_path / "tmp").iterdir())
    tool.terminate()
    assert tool.wait(60) == 143 and not list((tmp_path / "tmp").iterdir())


@pytest.mark.parametrize("noise,runs", [(0.01, 20), (0.06, 21), (10.0, 80)])
def test_noise_is_met_with_more_runs(tmp_path, noise, runs):
    (tmp_path / "tried.json").write_text(json.dumps(SPEC))
    spec = read_spec(tmp_path / "tried.json")
    benches = tuple(find_bench(spec.program, build(tmp_path / name, noise=noise), tmp_path) for name in "ab")
    found, = compare_builds(spec, benches, None, 20, lambda _: None)
    assert len(found.before.cpu_s) == len(found.after.cpu_s)
    assert len(found.before.cpu_s) == runs if runs != 21 else 20 < len(found.before.cpu_s) < 80 and found.decision.noise <= 0.01


def test_instructions_come_from_the_shorter_runs(tmp_path, monkeypatch):
    (tmp_path / "valgrind").write_text(VALGRIND)
    (tmp_path / "valgrind").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    (tmp_path / "tried.json").write_text(json.dumps({**SPEC, "presets": {"instructions": {"fixed": {"steps": 3}}}}))
    spec, short = (read_spec(tmp_path / "tried.json", preset) for preset in (None, "instructions"))
    benches = tuple(find_bench(spec.program, build(tmp_path / name), tmp_path) for name in "ab")
    found, = compare_builds(spec, benches, Counted(tuple(bench.path for bench in benches), short), LEAST_PAIRS, lambda _: None)
    assert (found.before.counts["instructions"], found.after.counts["instructions"]) == (3000, 3090)
    assert found.verdict == SLOWER and "instructions +3.00 %" in found.why
    (tmp_path / "valgrind").write_text("#!/bin/sh\necho '==1== bad' >&2; exit 1\n")
    found, = compare_builds(spec, benches, Counted(tuple(bench.path for bench in benches), short), LEAST_PAIRS, lambda _: None)
    assert found.verdict == SAME and "instructions not counted: callgrind: exit code 1: ==1== bad" in found.why


@pytest.mark.parametrize("change,code", [(1.0, 0), (1.05, 1)])
def test_two_record_sets_are_compared(tmp_path, change, code):
    sys.path.insert(0, str(ROOT / "experiments"))
    from sweep.points import expand
    (tmp_path / "tried.json").write_text(json.dumps(SPEC))
    point = expand(read_spec(tmp_path / "tried.json"))[0]
    for name, factor in (("a", 1.0), ("b", change)):
        (tmp_path / name / "tried").mkdir(parents=True)
        (tmp_path / name / "tried/index.json").write_text("{}")
        record = {"schema": "trigrain-record-1", "point_id": point.id, "status": "finished", "check": {"passed": True},
                  "samples": [{"cpu_s": factor * (1 + 0.001 * (i % 7)), "wall_s": 2, "steps": 1} for i in range(20)], "counts": None}
        (tmp_path / name / f"tried/{point.id}.json").write_text(json.dumps(record))
    done = regress(tmp_path, tmp_path / "a", tmp_path / "b")
    assert done.returncode == code, done.stdout + done.stderr


@pytest.mark.parametrize("name", INJECTED)
def test_the_slow_downs_of_the_trial_have_their_places_in_the_sources(name):
    file, text, _ = INJECTED[name]
    assert (ROOT / file).read_text().count(text) == 1


def test_wrong_usage_is_told(tmp_path):
    done = regress(tmp_path, "no-such-commit", build(tmp_path / "b"))
    assert done.returncode == 3 and "'no-such-commit' is no commit" in done.stderr
    assert regress(tmp_path, build(tmp_path / "c"), tmp_path / "b", "--pairs", 3).returncode == 3
