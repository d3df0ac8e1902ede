"""What the figures show, read back from the files they write."""
import csv
import hashlib
import importlib
import json
import os
import re
import statistics
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import frames
import records
import scaling
from figure import Drawn

PLOTS = Path(__file__).resolve().parents[1]
AXES = {"grid": ["regular", "adaptive"], "vertices": [10, 20, 40], "threads": [1, 2, 4]}
FIXED = {"particles": 1000, "scheme": "plain"}
SCALING = ["figure_8_5", "figure_8_6", "figure_8_8", "figure_8_9"]


def draw(name: str, made_up, out: str = "figures") -> Drawn:
    return importlib.import_module(name).draw(made_up.folder, made_up.folder / out)


def rows(drawn: Drawn) -> list[dict[str, str]]:
    with open(drawn.path("csv"), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def texts(drawn: Drawn) -> str:
    return " ".join(re.findall(r"<text[^>]*>([^<]*)</text>", drawn.path("svg").read_text()))


def test_whatever_names_its_interpreter_can_be_run():
    scripts = [path for path in PLOTS.glob("*.py") if path.read_text(encoding="utf-8").startswith("#!")]
    assert len(scripts) > 20
    assert [path.name for path in scripts if not os.access(path, os.X_OK)] == []


@pytest.mark.parametrize("name", SCALING)
def test_the_same_records_give_the_same_bytes(made_up, name):
    made_up.sweep(name, AXES, FIXED)
    draw(name, made_up, "once")
    command = ["/usr/bin/python3", PLOTS / f"{name}.py", "--results", made_up.folder, "--out", made_up.folder / "twice"]
    subprocess.run(command, check=True, capture_output=True)  # another process: no state of this one may matter
    for ending in ("svg", "png", "csv"):
        once, twice = (made_up.folder / folder / f"{name}.{ending}" for folder in ("once", "twice"))
        assert once.read_bytes() == twice.read_bytes() and len(once.read_bytes()) > 100


def test_the_csv_holds_what_the_records_hold(made_up):
    made_up.sweep("figure_8_5", AXES, FIXED)
    found = [row for row in rows(draw("figure_8_5", made_up)) if row["state"] == "finished"]
    assert len(found) == 6
    for row in found:
        record = made_up.read("figure_8_5", row["record"])
        assert int(row["threads"]) == record["params"]["threads"]
        assert int(row["vertices"]) == record["params"]["vertices"]
        times = [1e6 * sample["wall_s"] / sample["steps"] / 1000 for sample in record["samples"]]
        for column, value in (("median", statistics.median(times)), ("min", min(times)), ("max", max(times))):
            assert float(row[f"{column}_us_per_particle_step"]) == pytest.approx(value, rel=1e-5)
        assert int(row["samples"]) == 3


def test_missing_points_are_shown_missing(made_up):
    made_up.sweep("figure_8_5", AXES, FIXED)
    drawn = draw("figure_8_5", made_up)
    shown = texts(drawn)
    assert "threads 4: needs a bigger machine" in shown
    assert "adaptive: not available in this build" in shown
    assert len(rows(drawn)) == 18
    assert "6 of 18 points are drawn." in drawn.notes


@pytest.mark.parametrize("changes,state", [
    ({"check": {"passed": False, "how": [{"what": "grid", "passed": False, "detail": "lost"}]}}, "check failed"),
    ({"placement": {"oversubscribed": True, "asked_threads": 2}}, "oversubscribed"),
    ({"status": "failed", "reason": "killed by signal 11"}, "failed"),
    ({"samples": []}, "failed"), ({"schema": "other"}, "missing"), ({"point_id": "other"}, "missing")])
def test_a_record_that_is_no_measurement_is_not_drawn(made_up, changes, state):
    points = made_up.sweep("figure_8_5", AXES, FIXED)
    id = points["grid=regular vertices=20 threads=2"]["id"]
    made_up.change("figure_8_5", id, **changes)
    drawn = draw("figure_8_5", made_up)
    row, = (row for row in rows(drawn) if row["record"] == id)
    assert row["state"] == state and row["median_us_per_particle_step"] == ""
    assert f"threads 2: {state}" in texts(drawn)
    assert sum(row["state"] == "finished" for row in rows(drawn)) == 5
    assert id not in [point.id for point in drawn.sweep.drawn()]


def test_a_vanished_record_is_missing_whatever_the_index_says(made_up):
    points = made_up.sweep("figure_8_5", AXES, FIXED)
    (made_up.folder / "figure_8_5" / f"{points['grid=regular vertices=10 threads=1']['id']}.json").unlink()
    states = [point.state for point in records.load_sweep(made_up.folder, "figure_8_5").points]
    assert states[:3] == ["missing", "finished", "needs a bigger machine"]


def test_a_record_changed_after_it_was_written_is_not_drawn(made_up):
    points = made_up.sweep("figure_8_5", AXES, FIXED)
    id = points["grid=regular vertices=20 threads=2"]["id"]
    bare = made_up.read("figure_8_5", id)
    text = json.dumps(bare, sort_keys=True, separators=(",", ":"))
    seal = {"took_s": 1.0, "sha256": hashlib.sha256(text.encode()).hexdigest()}
    for change, state in (({}, "finished"), ({"warnings": ["none"]}, "missing")):
        made_up.write("figure_8_5", id, {**bare, **change, "sweep": seal})
        row, = (row for row in rows(draw("figure_8_5", made_up)) if row["record"] == id)
        assert row["state"] == state


def test_published_curves_keep_their_shape(made_up):
    curves = scaling.published_curves()
    assert curves["C18.F5a"][10][1] == 118.672 and curves["C18.F7a"][40][24] == 141.931
    for name, published, anchor in (("figure_8_5", "C18.F5a", "C18.F5a"), ("figure_8_8", "C18.F7a", "C18.F5a")):
        made_up.sweep(name, AXES, FIXED)
        for row in rows(draw(name, made_up)):
            if row["grid"] != "regular":
                continue
            vertices, threads = int(row["vertices"]), int(row["threads"])
            ours = 10 * vertices  # us per particle and step on one thread, as made up
            expected = curves[published][vertices][threads] / curves[anchor][vertices][1] * ours
            assert float(row["published_scaled_us"]) == pytest.approx(expected, rel=1e-5)


def test_without_our_one_thread_value_nothing_published_is_drawn(made_up):
    points = made_up.sweep("figure_8_5", AXES, FIXED)
    (made_up.folder / "figure_8_5" / f"{points['grid=regular vertices=10 threads=1']['id']}.json").unlink()
    scaled = {row["vertices"]: row["published_scaled_us"] for row in rows(draw("figure_8_5", made_up))
              if row["grid"] == "regular"}
    assert scaled["10"] == "" and scaled["20"] != ""


def test_a_panel_of_another_machine_says_so(made_up):
    made_up.sweep("figure_8_9", AXES, FIXED, [{"what": "Knights Landing", "needs": "an Intel Xeon Phi"}])
    assert "needs an Intel Xeon Phi" in texts(draw("figure_8_9", made_up))


def test_two_builds_in_one_figure_are_pointed_out(made_up):
    points = made_up.sweep("figure_8_5", AXES, FIXED)
    assert "CAUTION" not in texts(draw("figure_8_5", made_up))
    id = points["grid=regular vertices=20 threads=2"]["id"]
    made_up.change("figure_8_5", id, build={**made_up.read("figure_8_5", id)["build"], "commit": "1" * 40})
    assert "CAUTION" in texts(draw("figure_8_5", made_up))


def test_work_beside_the_measurement_is_pointed_out(made_up):
    points = made_up.sweep("figure_8_5", AXES, FIXED)
    id = points["grid=regular vertices=20 threads=2"]["id"]
    samples = made_up.read("figure_8_5", id)["samples"]
    made_up.change("figure_8_5", id, samples=[{**sample, "load_average_1min": 2.4} for sample in samples])
    assert "CAUTION" not in texts(draw("figure_8_5", made_up))
    made_up.change("figure_8_5", id, samples=[*samples[:2], {**samples[2], "load_average_1min": 7.13}])
    assert "other work ran on the machine during 1 of 18 samples (load average up to 7.1)" in texts(
        draw("figure_8_5", made_up))


def test_the_foot_names_machine_compiler_and_commit(made_up):
    made_up.sweep("figure_8_5", AXES, FIXED)
    shown = texts(draw("figure_8_5", made_up))
    for part in ("Imagined &lt;CPU&gt;", "GNU 12.2.0", "c0ffeec0ff", "µs"):
        assert part in shown


def test_the_hopper_is_drawn_at_four_times(hopper_frames):
    drawn = draw("figure_8_4", hopper_frames)
    assert [title in texts(drawn) for title in ("t = 0 s", "t = 0.1 s", "t = 0.2 s", "t = 0.3 s")] == [True] * 4
    table = rows(drawn)
    assert [row["body"] for row in table] == ["1"] * 4  # the wall is no grain
    assert [float(row["speed_m_s"]) for row in table] == [0, 0.5, 1, 1.5]
    assert float(table[3]["y_m"]) == pytest.approx(0.6 - 0.15 + 0.02 / 3, abs=1e-6)
    again = draw("figure_8_4", hopper_frames, "again")
    assert all(drawn.path(e).read_bytes() == again.path(e).read_bytes() for e in ("svg", "png", "csv"))


def test_a_frame_is_read_as_written(hopper_frames):
    folder = next((hopper_frames.folder / "figure_8_4/frames").iterdir())
    times = frames.read_frames(folder)
    frame = frames.read_frame(*times[2])
    assert frame.time == pytest.approx(0.2) and frame.corners.shape == (2, 3, 3)
    np.testing.assert_array_equal(frame.corners[0], [[0.4, 0.4, 0.4], [0.6, 0.4, 0.4], [0.5, 0.4, 0.6]])
    assert list(frames.standing(frame, frames.read_frame(*times[3]))) == [True, False]
    with pytest.raises(ValueError, match="position_m"):
        (folder / "x.vtp").write_text("<VTKFile/>")
        frames.read_frame(0, folder / "x.vtp")


def test_lost_frames_are_told(hopper_frames):
    next((hopper_frames.folder / "figure_8_4/frames").iterdir()).joinpath("f3.vtp").unlink()
    with pytest.raises(records.NothingToDraw, match="cannot read the frames"):
        draw("figure_8_4", hopper_frames)


def test_a_sweep_that_never_ran_is_told(tmp_path):
    done = subprocess.run([sys.executable, PLOTS / "figure_8_5.py", "--results", tmp_path], capture_output=True,
                          text=True, check=False)
    assert done.returncode == 3 and "sweep run figure_8_5" in done.stderr and not list(tmp_path.iterdir())
