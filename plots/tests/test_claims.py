"""Claims: made-up records decide as they should, and CLAIMS.md lists what is tested."""
import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "plots"))
from claims import CLAIMS, FAIL, HARDWARE, PASS, UNTESTABLE, judge  # noqa: E402

BY_ID = {claim.id: claim for claim in CLAIMS}
FIXED = {"scheme": "plain", "particles": 1000}
AXES = {"grid": ["regular"], "vertices": [10, 20, 40], "threads": [1, 2, 24]}  # the made-up speed-up is the ideal one


def test_an_ideal_speed_up_passes_and_a_poor_one_fails(made_up):
    points = made_up.sweep("figure_8_5", AXES, FIXED)
    verdict = judge(BY_ID["8.5-regular-2"], made_up.folder)
    assert verdict.word == PASS and "2.00 (1.91) at 10" in verdict.seen and "at 40" in verdict.seen
    slow = points["grid=regular vertices=20 threads=2"]["id"]
    samples = made_up.read("figure_8_5", slow)["samples"]
    made_up.change("figure_8_5", slow, samples=[{**sample, "wall_s": 1.2 * sample["wall_s"]} for sample in samples])
    assert judge(BY_ID["8.5-regular-2"], made_up.folder).word == FAIL
    made_up.change("figure_8_5", slow, check={"passed": False, "how": [{"what": "grid", "passed": False, "detail": ""}]})
    assert judge(BY_ID["8.5-regular-2"], made_up.folder).word == PASS, "what failed its check says nothing"


def test_what_the_machine_cannot_do_is_not_testable(made_up):
    made_up.sweep("figure_8_5", AXES, FIXED)
    many = judge(BY_ID["8.5-regular-24"], made_up.folder)
    assert (many.word, many.status) == (UNTESTABLE, HARDWARE) and "24 threads, 2 cores here" in many.seen
    assert judge(BY_ID["8.9-knl"], made_up.folder).status == HARDWARE
    assert judge(BY_ID["8.6-adaptive-2"], made_up.folder).status == "not run"


def test_wall_time_of_a_busy_machine_says_nothing(made_up):
    points = made_up.sweep("figure_8_5", AXES, FIXED)
    for point in points.values():
        samples = made_up.read("figure_8_5", point["id"])["samples"] if point["state"] == "finished" else []
        if samples:
            made_up.change("figure_8_5", point["id"], samples=[{**sample, "load_average_1min": 9.0} for sample in samples])
    verdict = judge(BY_ID["8.5-regular-2"], made_up.folder)
    assert (verdict.word, verdict.status) == (UNTESTABLE, "disturbed") and "load average up to 9.0" in verdict.seen


def test_the_smallest_preset_decides_nothing(made_up):
    made_up.sweep("figure_8_5", AXES, FIXED)
    made_up.change("figure_8_5", "index", preset="smoke")
    assert judge(BY_ID["8.5-regular-2"], made_up.folder).word == UNTESTABLE


def test_ratios_hold_for_every_value_of_the_axis(made_up):
    points = made_up.sweep("published_kernels", {"vertices": [10, 20], "kernel": ["brute", "hybrid-pair"]}, FIXED)
    for name, point in points.items():
        times = 3.0 if "brute" in name else 1.0
        made_up.change("published_kernels", point["id"], samples=[{"cpu_s": times, "wall_s": times, "steps": 1}])
    assert judge(BY_ID["hybrid-1"], made_up.folder).word == PASS
    made_up.change("published_kernels", points["vertices=20 kernel=hybrid-pair"]["id"],
                   samples=[{"cpu_s": 2.0, "wall_s": 1.0, "steps": 1}])
    assert judge(BY_ID["hybrid-1"], made_up.folder).word == FAIL


@pytest.mark.parametrize("seconds,unflagged,word", [(0.5, 0, PASS), (0.8, 0, FAIL), (0.5, 0.01, FAIL)])
def test_the_penalty_method_must_be_faster_and_own_up_to_what_is_wrong(made_up, seconds, unflagged, word):
    settings = {"lanes": 1, "schedule": "constant", "steps": 4, "tolerance": 1e-3, "particles": 1, "vertices": 1}
    assert judge(BY_ID["penalty"], made_up.folder).word == UNTESTABLE
    for name, point in made_up.sweep("figure_kernels", {"kernel": ["brute", "iterative"]}, settings).items():
        made_up.change("figure_kernels", point["id"], samples=[{"cpu_s": 1 if "brute" in name else seconds, "pairs": 10}],
                       kernel={"wrong_unflagged_share": unflagged, "error_p99_S": 0.02})
    verdict = judge(BY_ID["penalty"], made_up.folder)
    assert verdict.word == word and "below 0.02 S" in verdict.seen


@pytest.mark.parametrize("key,values,claim", [
    ("candidate_pairs", [0, 0, 10, 0], None), ("candidate_pairs", [0, 10, 10, 0], "two-bodies-pairs"),
    ("candidate_pairs", [0, 0, 90, 0], "two-bodies-pairs"), ("candidate_pairs", [0, 0, 0, 0], "two-bodies-pairs"),
    ("step_s", [0.001, 0.2, 0.01, 0.1], "two-bodies-step"), ("time_s", [0.1, 1.9, 2.8, 4], "two-bodies-step")])
def test_two_bodies_meet_once(made_up, key, values, claim):
    history = {"every": 10, "time_s": [0.1, 1.9, 2.68, 4], "step_s": [1e-4, 0.2, 1e-3, 0.1], "candidate_pairs": [0, 0, 10, 0]}
    points = made_up.sweep("figure_g_1", {"grid": ["regular", "adaptive", "reluctant"]}, {"particles": 2, "vertices": 1}, unavailable=None)
    for point in points.values():
        made_up.change("figure_g_1", point["id"], history={**history, key: values})
    for id in ("two-bodies-pairs", "two-bodies-step"):
        assert judge(BY_ID[id], made_up.folder).word == (FAIL if id == claim else PASS), id
    made_up.change("figure_g_1", points["grid=adaptive"]["id"], check={"passed": False, "how": []})
    assert judge(BY_ID["two-bodies-step"], made_up.folder).word == UNTESTABLE


@pytest.mark.parametrize("seconds,word", [(31, PASS), (29, FAIL)])
def test_grids_are_compared_by_the_time_of_whole_runs(made_up, seconds, word):
    points = made_up.sweep("figure_g_1", {"grid": ["regular-dense", "adaptive"]}, {"particles": 2, "vertices": 1}, unavailable=None)
    for name, point in points.items():  # the runs take different numbers of steps
        dense = "dense" in name
        made_up.change("figure_g_1", point["id"], samples=[{"cpu_s": seconds if dense else 1, "steps": 100 if dense else 1}])
    assert judge(BY_ID["two-bodies-adaptive"], made_up.folder).word == word
    assert judge(BY_ID["two-bodies-reluctant"], made_up.folder).word == UNTESTABLE


@pytest.mark.parametrize("nanoseconds,shares,words", [(360, [0, 0, 0, .6], (PASS, PASS)), (370, [0, 0, .6, .4], (FAIL, FAIL)),
                                                       (360, [0] * 6 + [.4, .6], (PASS, FAIL))])
def test_rates_and_newton_steps_of_the_penalty_method(made_up, nanoseconds, shares, words):
    settings = {"family": "random_mixed", "lanes": 1, "schedule": "constant", "steps": 4, "particles": 1, "vertices": 1}
    for point in made_up.sweep("figure_kernels", {"kernel": ["iterative"]}, settings).values():
        made_up.change("figure_kernels", point["id"], samples=[{"cpu_s": 1e-9 * nanoseconds, "pairs": 1}],
                       kernel={"proven_after_steps": shares})
    assert tuple(judge(BY_ID[id], made_up.folder).word for id in ("rate-penalty", "newton-steps")) == words
    assert judge(BY_ID["penalty-simd"], made_up.folder).word == UNTESTABLE


@pytest.mark.parametrize("flops,word", [((3e6, 1e6), PASS), ((2e6, 1e6), FAIL), ((None, 1e6), UNTESTABLE), (None, UNTESTABLE)])
def test_counted_flops_decide_where_there_are_counters(made_up, flops, word):
    points = made_up.sweep("figure_counters", {"kernel": ["brute-simd", "brute"]}, {**FIXED, "vertices": 10})
    for point, value in zip(points.values(), flops or ()):
        made_up.write("figure_counters/counters", point["id"], {
            "schema": "trigrain-counters-1", "point_id": point["id"], "steps": 1, "phases": {},
            "whole": {"flops_dp": {"value": value, "reason": None if value else "no PMU"}}})
    assert judge(BY_ID["counters"], made_up.folder).word == word


def test_grains_that_hang_in_the_air_do_not_flow(hopper_frames):
    assert judge(BY_ID["8.4"], hopper_frames.folder).word == FAIL  # none is below the opening


@pytest.mark.parametrize("speed,code", [(1, 0), (9, 1)])
def test_the_tool_prints_every_claim_and_exits_by_them(made_up, speed, code):
    points = made_up.sweep("figure_8_5", AXES, FIXED)
    id = points["grid=regular vertices=10 threads=2"]["id"]
    made_up.change("figure_8_5", id, samples=[{"wall_s": speed * 1e-9, "cpu_s": 1, "steps": 1}] if speed == 1 else [
        {"wall_s": speed * 1e9, "cpu_s": 1, "steps": 1}])
    done = subprocess.run([ROOT / "tools/claims", "--no-run", "--results", made_up.folder], capture_output=True, text=True,
                          check=False)
    assert done.returncode == code, done.stdout + done.stderr
    assert sum(done.stdout.count(word) for word in (PASS, FAIL, UNTESTABLE)) == len(CLAIMS)
    rows = json.loads((made_up.folder / "claims.json").read_text())["claims"]
    assert [row["id"] for row in rows] == list(BY_ID)


def test_claims_have_specs_and_stand_in_the_table():
    table = (ROOT / "CLAIMS.md").read_text()
    for claim in CLAIMS:
        assert claim.spec is None or (ROOT / f"experiments/specs/{claim.spec}.json").exists(), claim
        assert f"| {claim.claim.replace('|', '/')} |" in table, "tools/claims --write brings CLAIMS.md up to date"
