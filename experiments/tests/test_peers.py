"""peer_bench: what other engines are given, whether their answers may be timed, and what happens where there are none."""
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from test_written_files import errors

EXPERIMENTS = Path(__file__).resolve().parents[1]
BIN = Path(os.environ.get("TRIGRAIN_BIN", EXPERIMENTS.parent / "build/release/bin"))
sys.path.insert(0, str(EXPERIMENTS))
from peers.bodies import Mesh, convex, grown, parts  # noqa: E402

BOX = Mesh(np.array([[x, y, z] for x in (0., 1) for y in (0., 2) for z in (0., 3)]),
           np.array([[0, 1, 3], [0, 3, 2], [4, 7, 5], [4, 6, 7], [0, 5, 1], [0, 4, 5], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
                     [1, 7, 3], [1, 5, 7]]))
# four balls of 2 cm that lie on a plane, none near another
BALLS = {"gravity_m_s2": [0, -9.81, 0], "domain_m": {"min": [0, 0, 0], "size": 1},
         "contact": {"law": "spring-dashpot", "stiffness_N_m": 1e4, "damping_ratio": 0.5, "friction": 0.5}, "time": {"step_s": 2e-5, "end_s": 1},
         "bodies": [{"shape": {"plane": {"size_m": 0.4}}, "position_m": [0.5, 0.3, 0.5], "halo_m": 5e-4, "fixed": True}, *(
             {"shape": {"sphere_m": 0.01}, "position_m": [0.42 + 0.05 * i, 0.311 - 4e-6, 0.5], "density_kg_m3": 1000,
              "halo_m": 5e-4} for i in range(4))]}


def test_a_grown_box_has_every_face_further_out():
    bigger = grown(BOX, 0.25)
    assert np.allclose(bigger.points.min(axis=0), -0.25) and np.allclose(bigger.points.max(axis=0), [1.25, 2.25, 3.25])
    assert np.allclose(bigger.points[0], -0.25)


def test_pieces_are_told_apart_and_a_dent_is_not_convex():
    both = Mesh(np.vstack([BOX.points, BOX.points + 5]), np.vstack([BOX.faces, BOX.faces + 8]))
    assert [len(piece.faces) for piece in parts(both)] == [12, 12]
    assert convex(BOX) and all(convex(piece) for piece in parts(both)) and not convex(both)


@pytest.fixture
def bench(tmp_path):
    """Runs peer_bench with the words; `path` is where programs are looked for, by default with a stand-in for LIGGGHTS."""
    if not (BIN / "dem_bench").exists():
        pytest.skip(f"{BIN / 'dem_bench'} is not built")
    (tmp_path / "balls.json").write_text(json.dumps(BALLS))
    (tmp_path / "path").mkdir()
    shutil.copy(EXPERIMENTS / "tests/stand_in_liggghts.py", tmp_path / "path/liggghts")

    def run(*words: object, path: Path = tmp_path / "path", **environment: str) -> subprocess.CompletedProcess:
        return subprocess.run([BIN / "peer_bench", *map(str, words)], capture_output=True, text=True, timeout=300,
                              env={**os.environ, "PATH": str(path), **environment})

    return run


def test_a_peer_that_agrees_leaves_a_record(bench, tmp_path):
    done = bench("--engine", "liggghts", "--scene-file", tmp_path / "balls.json", "--steps", 10, "--warmup", 5, "--repeats", 3,
                 "--point-id", "p1", "--record", tmp_path / "p1.json", STAND_IN_PAIRS="4")
    assert done.returncode == 0, done.stdout + done.stderr
    record = json.loads((tmp_path / "p1.json").read_text())
    assert errors("peer_record", record) == []
    assert errors("peer_record", {**record, "peer": {}})
    assert record["check"]["passed"] and record["point_id"] == "p1" and record["params"]["engine"] == "liggghts"
    assert [(s["wall_s"], s["steps"]) for s in record["samples"]] == [(0.5, 10)] * 3
    assert record["scene"]["moving_bodies"] == 4 and "0.0125 us" not in done.stdout


@pytest.mark.parametrize("failing, environment", [
    ("contacts", {"STAND_IN_PAIRS": "3"}), ("places", {"STAND_IN_PAIRS": "4", "STAND_IN_AWAY": "0.002"})])
def test_a_peer_with_another_answer_is_not_timed(bench, tmp_path, failing, environment):
    done = bench("--engine", "liggghts", "--scene-file", tmp_path / "balls.json", "--record", tmp_path / "p1.json", **environment)
    assert done.returncode == 1, done.stdout + done.stderr
    how = json.loads((tmp_path / "p1.json").read_text())["check"]["how"]
    assert [each["what"] for each in how if not each["passed"]] == [failing]


def test_a_missing_peer_is_told_with_the_way_to_get_it(bench, tmp_path):
    done = bench("--engine", "yade", "--scene-file", tmp_path / "balls.json")
    assert (done.returncode, done.stderr) == (
        4, "peer_bench: there is no program 'yade' (PATH). On Debian: apt-get install yade.\n")
    listed = bench("--list").stdout
    assert "\n  liggghts: LIGGGHTS" in listed and listed.endswith("missing engines\n  yade: there is no program 'yade' (PATH). "
                                                                  "On Debian: apt-get install yade\n")


def test_the_sweep_lists_points_of_a_missing_peer(bench, tmp_path):
    (tmp_path / "s.json").write_text(json.dumps({
        "program": "peer_bench", "fixed": {"scene_file": "balls.json", "steps": 5, "repeats": 1},
        "axes": {"engine": ["trigrain", "liggghts", "yade"]}}))
    done = subprocess.run([BIN / "sweep", "run", tmp_path / "s.json", "--results", tmp_path / "results"], capture_output=True, text=True,
                          env={**os.environ, "PATH": str(tmp_path / "path"), "STAND_IN_PAIRS": "4"}, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    index = json.loads((tmp_path / "results/s/index.json").read_text())
    assert [(point["state"], point["why"]) for point in index["points"]] == [("finished", ""), ("finished", ""), (
        "not available in this build", "engine 'yade': there is no program 'yade' (PATH). On Debian: apt-get install yade")]


@pytest.mark.parametrize("engine", ["liggghts", "yade"])
def test_an_installed_peer_ends_where_we_do(bench, tmp_path, engine):
    if not shutil.which(engine):
        pytest.skip(f"{engine} is not installed")
    done = bench("--engine", engine, "--scene-file", tmp_path / "balls.json", "--steps", 100, "--record", tmp_path / "p1.json",
                 path=Path(os.environ["PATH"]))
    assert done.returncode == 0, done.stdout + done.stderr
    assert errors("peer_record", json.loads((tmp_path / "p1.json").read_text())) == []


def test_wrong_words_are_refused(bench):
    assert bench("--engine", "bullet").returncode == 3
    assert bench("--engine", "liggghts", "--steps", "many").returncode == 3
    assert bench("--engine", "liggghts", "--threads", 2, "--scene", "hopper").returncode == 3
