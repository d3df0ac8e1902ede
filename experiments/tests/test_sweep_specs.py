"""What a spec may say, and what is said about one that is wrong."""
import json
from pathlib import Path

import jsonschema
import pytest

from sweep.cli import main
from sweep.errors import InputError
from sweep.points import expand
from sweep.spec import read_spec

EXPERIMENTS = Path(__file__).resolve().parents[1]
SCHEMA = json.loads((EXPERIMENTS / "schema/spec.json").read_text())
SPECS = sorted((EXPERIMENTS / "specs").glob("*.json"))
GOOD = {"title": "t", "fixed": {"scene": "hopper", "steps": 3}, "axes": {"threads": [1, 2]}, "time_limit_s": 5,
        "prepare": {"by": ["scene"], "params": {"grid": "none"}, "end_s": 0.1},
        "elsewhere": [{"what": "a", "needs": "b"}], "presets": {"quick": {"axes": {"threads": [1]}}, "tiny": {}}}

# change to GOOD: path of keys -> value; what the message must say; whether the JSON Schema sees it too
WRONG = [
    ({"axis": {}}, "unknown key 'axis' (s.json: axis). Did you mean 'axes'?", True),
    ({"threads": 2}, "unknown key 'threads' (s.json: threads). It is a parameter: put it into fixed.", True),
    ({"fixed.thread": 1}, "unknown parameter 'thread' (s.json: fixed.thread). Did you mean 'threads'?", True),
    ({"axes.vertexes": [1]}, "unknown parameter 'vertexes' (s.json: axes.vertexes). Did you mean 'vertices'?", True),
    ({"fixed.grid": "adaptiv"}, "unknown grid 'adaptiv' (s.json: fixed.grid). Did you mean 'adaptive'?", True),
    ({"axes.grid": ["none", "regulr"]}, "unknown grid 'regulr' (s.json: axes.grid[1]). Did you mean 'regular'?", True),
    ({"axes.threads": [1, "2"]}, "whole number is expected, not '2' (s.json: axes.threads[1])", True),
    ({"axes.threads": [1, 1.5]}, "whole number is expected, not 1.5 (s.json: axes.threads[1])", True),
    ({"axes.threads": [True]}, "whole number is expected, not True (s.json: axes.threads[0])", True),
    ({"axes.threads": [0]}, "0 is too small (s.json: axes.threads[0]). The least is 1.", True),
    ({"axes.threads": []}, "a list of values is empty (s.json: axes.threads)", True),
    ({"axes.threads": 2}, "a list of values is expected, not 2 (s.json: axes.threads)", True),
    ({"axes.threads": [1, 2, 1]}, "1 is listed twice (s.json: axes.threads[2])", True),
    ({"fixed.threads": 1}, "'threads' is both fixed and an axis (s.json: axes.threads)", False),
    ({"fixed.size_ratio": float("nan")}, "a number is expected, not nan (s.json: fixed.size_ratio)", False),
    ({"fixed.end_s": 1.0}, "exactly one of 'steps' and 'end_s' is needed (s.json: fixed)", False),
    ({"fixed": {"steps": 3}}, "exactly one of 'scene' and 'scene_file' is needed (s.json: fixed). Add scene.", False),
    ({"fixed": []}, "an object is expected, not [] (s.json: fixed)", True),
    ({"time_limit_s": 0}, "a number above 0 s is expected, not 0 (s.json: time_limit_s)", True),
    ({"title": 3}, "a text is expected, not 3 (s.json: title)", True),
    ({"prepare.bye": []}, "unknown key 'bye' (s.json: prepare.bye). Did you mean 'by'?", True),
    ({"prepare.by": ["scena"]}, "unknown parameter 'scena' (s.json: prepare.by[0]). Did you mean 'scene'?", True),
    ({"prepare.by": ["vertices"]}, "'vertices' is neither fixed nor an axis (s.json: prepare.by[0])", False),
    ({"prepare.by": ["threads"]}, "'threads' does not belong to a start state (s.json: prepare)", False),
    ({"prepare": {"by": ["scene"]}}, "end_s is missing (s.json: prepare)", True),
    ({"prepare.params.kernel": "brut"}, "unknown kernel 'brut' (s.json: prepare.params.kernel). Did you mean", True),
    ({"elsewhere": [{"what": "a"}]}, "'what' and 'needs' is expected (s.json: elsewhere[0])", True),
    ({"expected_failures": [{"where": {"kernel": "brute"}, "check": "kernel"}]},
     "'where', 'check' and 'why' is expected (s.json: expected_failures[0])", True),
    ({"expected_failures": [{"where": {"kernel": "brut"}, "check": "kernel", "why": "w"}]},
     "unknown kernel 'brut' (s.json: expected_failures[0].where", True),
    ({"presets.tiny.fixd": {}}, "unknown key 'fixd' (s.json: presets.tiny.fixd). Did you mean 'fixed'?", True),
    ({"presets.tiny.fixed": {"kernel": 3}}, "a name is expected, not 3 (s.json: presets.tiny.fixed.kernel)", True),
]


def changed(changes: dict) -> dict:
    spec = json.loads(json.dumps(GOOD))
    for path, value in changes.items():
        *parents, last = path.split(".")
        part = spec
        for key in parents:
            part = part[key]
        part[last] = value
    return spec


def write(folder: Path, spec: dict) -> Path:
    path = folder / "s.json"
    path.write_text(json.dumps(spec))
    return path


@pytest.mark.parametrize("changes,message,by_schema", WRONG, ids=[str(*row[0]) + "-" + str(i) for i, row in enumerate(WRONG)])
def test_a_wrong_spec_is_refused_with_the_path_of_the_key(tmp_path, capsys, changes, message, by_schema):
    path = write(tmp_path, changed(changes))
    with pytest.raises(InputError) as error:
        read_spec(path)
    assert message in str(error.value)
    assert "\n" not in str(error.value)
    assert main(["run", str(path), "--dry-run"]) == 3
    assert message in capsys.readouterr().err
    validator = jsonschema.Draft202012Validator(SCHEMA)
    assert validator.is_valid(json.loads(json.dumps(changed(changes)))) != by_schema


@pytest.mark.parametrize("text,message", [
    ("{\"fixed\": {},\n}", "not JSON (s.json: line 2"), ("[]", "an object is expected"), (" \n", "the spec is empty (s.json)"),
    ('{"fixed": {}, "fixed": {}}', "'fixed' is written twice"), ('{"fixed": {"steps": 1, "steps": 2}}', "'steps' is")])
def test_a_file_that_is_no_spec_is_refused(tmp_path, text, message):
    path = tmp_path / "s.json"
    path.write_text(text)
    with pytest.raises(InputError, match=".*") as error:
        read_spec(path)
    assert message in str(error.value)


def test_unknown_specs_and_presets_name_the_nearest(tmp_path, capsys):
    assert main(["run", "figure_8_55"]) == 3
    assert "Did you mean 'figure_8_5'?" in capsys.readouterr().err
    with pytest.raises(InputError, match="unknown preset 'tinny'.*Did you mean 'tiny'"):
        read_spec(write(tmp_path, GOOD), "tinny")
    with pytest.raises(SystemExit) as wrong_usage:
        main(["run", "figure_8_5", "--slow"])
    assert wrong_usage.value.code == 3


def test_a_preset_changes_single_keys_of_prepare_or_removes_it(tmp_path):
    spec = changed({"presets.tiny.prepare": {"end_s": 0.01}, "presets.quick.prepare": None})
    path = write(tmp_path, spec)
    assert read_spec(path, "tiny").prepare.end_s == 0.01
    assert read_spec(path, "tiny").prepare.params == {"grid": "none"}
    assert read_spec(path).prepare is None
    assert read_spec(path, "full").prepare.end_s == 0.1


def test_the_schema_is_up_to_date(capsys):
    assert main(["schema"]) == 0
    assert capsys.readouterr().out == (EXPERIMENTS / "schema/spec.json").read_text(), "sweep schema > .../spec.json"
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.validate(GOOD, SCHEMA)


def test_each_program_has_parameters_of_its_own(tmp_path):
    spec = {"program": "kernel_bench", "axes": {"kernel": ["brute", "hybrid-pair"], "family": ["near_vf"]}}
    jsonschema.validate(spec, SCHEMA)
    assert [point.params["kernel"] for point in expand(read_spec(write(tmp_path, spec)))] == ["brute", "hybrid-pair"]
    for wrong, message in (({"threads": 1}, "unknown parameter 'threads'"), ({"family": "near_vx"}, "Did you mean 'near_v")):
        with pytest.raises(InputError, match=".*") as error:
            read_spec(write(tmp_path, {**spec, "axes": {"kernel": ["brute"]}, "fixed": wrong}))
        assert message in str(error.value).replace("  ", " ")
        assert not jsonschema.Draft202012Validator(SCHEMA).is_valid({**spec, "fixed": wrong})


@pytest.mark.parametrize("path", SPECS, ids=[path.stem for path in SPECS])
def test_every_spec_of_the_project_is_valid_in_every_preset(path):
    raw = json.loads(path.read_text())
    jsonschema.validate(raw, SCHEMA)
    sizes = {preset: len(expand(read_spec(path, preset))) for preset in ("full", "quick", "smoke")}
    assert 0 < sizes["smoke"] <= sizes["quick"] <= sizes["full"]


def test_full_has_the_published_sizes():
    threads = [1, 2, 3, 4, 6, 8, 12, 16, 24]
    for name, particles in (("8_5", 1000), ("8_6", 10000), ("8_8", 1000), ("8_9", 10000)):
        spec = read_spec(EXPERIMENTS / f"specs/figure_{name}.json", "full")
        assert spec.fixed["particles"] == particles
        assert spec.axes["threads"] == threads and spec.axes["vertices"] == [10, 20, 40]


def test_list_shows_every_spec(capsys):
    assert main(["list"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == len(SPECS) >= 7
