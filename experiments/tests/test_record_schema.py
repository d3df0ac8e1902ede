"""dem_bench as a program: its records and states keep to their schemas, its exit codes say what happened."""
import copy
import json
from pathlib import Path

import jsonschema
import pytest

SCHEMA = Path(__file__).resolve().parents[1] / "schema"
TINY = ("--scene", "two-particles", "--steps", 5)


def validator(name: str) -> jsonschema.Draft202012Validator:
    schema = json.loads((SCHEMA / f"{name}.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.fixture(scope="module")
def run(dem_bench, tmp_path_factory):
    """One tiny run with everything written: (process, folder)."""
    folder = tmp_path_factory.mktemp("run")
    done = dem_bench(*TINY, "--repeats", 2, "--warmup", 1, "--record", folder / "r.json", "--final-state", folder / "s.json",
                     "--vtk", folder / "vtk", "--point-id", "p1", "--param", "axis=0.5")
    assert done.returncode == 0, done.stdout + done.stderr
    return done, folder


def test_record_keeps_to_its_schema(run):
    record = json.loads((run[1] / "r.json").read_text())
    validator("record").validate(record)
    assert record["point_id"] == "p1"
    assert record["params"]["axis"] == 0.5
    assert record["check"]["passed"] is True
    assert len(record["samples"]) == 2
    assert record["energy_J"]["final"]["kinetic"] > 0


@pytest.mark.parametrize("path, value", [
    (("samples", 0, "wall_s"), None), (("samples", 0, "wall"), 1.0), (("check", "passed"), "yes"), (("counts", "contacts"), -1),
    (("counters", "cycles"), {"value": 0, "source": "perf_event", "status": "measured", "reason": None}),
    (("placement", "cpus"), []), (("build", "commit"), "latest"), (("surprise",), 1), (("state_hash",), "12")])
def test_record_schema_refuses_a_wrong_record(run, path, value):
    record = json.loads((run[1] / "r.json").read_text())
    assert validator("record").is_valid(record)
    broken = copy.deepcopy(record)
    inner = broken
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    assert not validator("record").is_valid(broken)


def test_record_schema_needs_every_key(run):
    record = json.loads((run[1] / "r.json").read_text())
    for key in record:
        assert not validator("record").is_valid({k: v for k, v in record.items() if k != key}), key


def test_final_state_keeps_to_its_schema_and_can_be_gone_on_from(run, dem_bench, tmp_path):
    state = json.loads((run[1] / "s.json").read_text())
    validator("final_state").validate(state)
    assert len(state["bodies"]) == json.loads((run[1] / "r.json").read_text())["scene"]["bodies"]
    done = dem_bench(*TINY, "--start-state", run[1] / "s.json", "--final-state", tmp_path / "s2.json")
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "s2.json").read_text())["time_s"] > state["time_s"]


def test_frames_are_listed_with_their_times(run):
    pvd = (run[1] / "vtk" / "frames.pvd").read_text()
    assert pvd.count("<DataSet") == 2
    assert {f.name for f in (run[1] / "vtk").iterdir()} == {
        "frames.pvd", "frame_00000.vtp", "frame_00001.vtp", "grid.pvd", "grid_00000.vtu", "grid_00001.vtu"}


def test_summary_says_what_was_checked_and_written(run):
    out = run[0].stdout
    for words in ("check scheme", "check kernel", "passed", "s per step", "integrate", "us per particle and step",
                  "contacts per particle", "r.json", "s.json", "frames.pvd"):
        assert words in out, out
    assert run[0].stderr == "", "silent where nobody watches"


@pytest.mark.parametrize("kind, known", [
    ("kernel", "brute"), ("precheck", "sphere"), ("grid", "regular"), ("contact-rule", "nearest"), ("scheme", "serial"),
    ("runtime", "openmp"), ("scene", "hopper")])
def test_an_unknown_name_lists_the_known_ones(dem_bench, tmp_path, kind, known):
    done = dem_bench(*TINY, f"--{kind}", "nonsense", "--record", tmp_path / "r.json") if kind != "scene" else \
        dem_bench("--scene", "nonsense", "--record", tmp_path / "r.json")
    assert done.returncode == 3
    assert "nonsense" in done.stderr and known in done.stderr
    assert done.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("words", [
    (), ("--scene", "two-particles", "--scene-file", "s.json"), ("--scene", "two-particles", "--particles", "-3"),
    ("--scene", "two-particles", "--steps", "many"), ("--scene-file", "missing.json"),
    (*TINY, "--start-state", "missing.json"), (*TINY, "--record", "missing/r.json"), (*TINY, "--final-state", "missing/s.json"),
    (*TINY, "--vtk", "missing/vtk"), (*TINY, "--param", "no-equals"), (*TINY, "--no-check")])
def test_bad_input_is_refused_in_one_line_and_leaves_nothing(dem_bench, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    outputs = () if "--record" in words else ("--record", "r.json")
    done = dem_bench(*words, *outputs)
    assert done.returncode == 3, done.stdout + done.stderr
    assert done.stderr.startswith("dem_bench: ") and done.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_state_of_another_scene_is_refused(run, dem_bench, tmp_path):
    state = json.loads((run[1] / "s.json").read_text())
    state["bodies"].pop()
    (tmp_path / "s.json").write_text(json.dumps(state))
    done = dem_bench(*TINY, "--start-state", tmp_path / "s.json", "--record", tmp_path / "r.json")
    assert done.returncode == 3
    assert "bodies" in done.stderr and "two-particles" in done.stderr
    assert not (tmp_path / "r.json").exists()


def test_list_has_every_table(dem_bench):
    lines = dem_bench("--list").stdout.splitlines()
    assert [line for line in lines if not line.startswith(" ")] == [
        "scenes", "kernels", "prechecks", "grids", "contact rules", "schemes", "runtimes", "step controls"]
    rows = [line.split(": ", 1) for line in lines if line.startswith("  ")]
    assert all(len(row) == 2 and row[1] for row in rows), rows


def test_bodies_handed_over_keep_to_their_schema_and_have_the_mass_of_the_scene(dem_bench, tmp_path):
    done = dem_bench("--scene", "hopper", "--particles", 5, "--vertices", 10, "--steps", 1, "--hand-over", tmp_path / "h.json",
                     "--record", tmp_path / "r.json")
    assert done.returncode == 0 and "h.json" in done.stdout, done.stdout + done.stderr
    handed = json.loads((tmp_path / "h.json").read_text())
    validator("hand_over").validate(handed)
    assert not validator("hand_over").is_valid({**handed, "bodies": [{}]})
    moving = [body for body in handed["bodies"] if not body["fixed"]]
    record = json.loads((tmp_path / "r.json").read_text())
    assert sum(body["mass_kg"] for body in moving) == pytest.approx(record["scene"]["total_mass_kg"])
    for body in moving:  # the world's frame: the centre of mass lies amid the points
        points = body["shape"]["points_m"]
        for axis in range(3):
            assert min(p[axis] for p in points) < body["centre_m"][axis] < max(p[axis] for p in points)
