"""Every file that a sweep of the real program leaves keeps to its schema."""
import json
import os
import subprocess
from pathlib import Path

import jsonschema
import pytest

EXPERIMENTS = Path(__file__).resolve().parents[1]
SCHEMAS = {path.stem: json.loads(path.read_text()) for path in (EXPERIMENTS / "schema").glob("*.json")}


def errors(name: str, value: dict) -> list[str]:
    """What the schema `name` has against `value`; references go from schema to schema by file name."""
    resolver = jsonschema.RefResolver(f"{name}.json", SCHEMAS[name], {f"{stem}.json": s for stem, s in SCHEMAS.items()})
    return [error.message for error in jsonschema.Draft202012Validator(SCHEMAS[name], resolver=resolver).iter_errors(value)]


@pytest.fixture(name="results", scope="module")
def _results(dem_bench, tmp_path_factory) -> Path:
    """Two points that run in turn, one that the program refuses."""
    folder = tmp_path_factory.mktemp("written")
    spec = {"fixed": {"scene": "two-particles", "steps": 5, "repeats": 2, "vertices": 10}, "interleave": ["grid"],
            "axes": {"grid": ["regular", "none"], "scheme": ["serial", "plain"]}, "exclude": [{"grid": "none", "scheme": "plain"}],
            "prepare": {"by": ["scene", "vertices"], "params": {"grid": "none"}, "end_s": 0.001}}
    spec["fixed"]["threads"] = 2  # which `serial` refuses
    (folder / "tried.json").write_text(json.dumps(spec))
    spec["fixed"]["threads"] = 1
    (folder / "fine.json").write_text(json.dumps(spec))
    for name, code in (("tried", 1), ("fine", 0)):
        command = ["/usr/bin/python3", "-m", "sweep", "run", str(folder / f"{name}.json"), "--results", str(folder / "results"),
                   "--bin", os.environ.get("TRIGRAIN_BIN", str(EXPERIMENTS.parent / "build/release/bin")), "--cores", "2"]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120,
                              env={**os.environ, "PYTHONPATH": str(EXPERIMENTS)})
        assert done.returncode == code, done.stdout + done.stderr
    return folder / "results"


def test_records_failures_and_indices_keep_to_their_schemas(results):
    seen = {"index": 0, "record": 0, "failed_record": 0}
    for path in sorted(results.glob("[tf]*/*.json")):
        value = json.loads(path.read_text())
        schema = "index" if path.stem == "index" else "failed_record" if value["status"] == "failed" else "record"
        assert errors(schema, value) == [], path
        seen[schema] += 1
    assert seen == {"index": 2, "record": 4, "failed_record": 2}


def test_start_states_keep_to_their_schemas(results):
    for path in (results / "states").iterdir():
        schema = "final_state" if path.suffix == ".json" else "record"
        assert errors(schema, json.loads(path.read_text())) == [], path
    assert len(list((results / "states").iterdir())) == 2


@pytest.mark.parametrize("schema,change", [
    ("failed_record", {"reason": ""}), ("failed_record", {"surprise": 1}), ("index", {"points": [{}]}),
    ("index", {"elsewhere": [{"what": "a"}]}), ("record", {"sweep": {"took_s": 1}})])
def test_the_schemas_refuse_what_is_wrong(results, schema, change):
    values = [json.loads(path.read_text()) for path in sorted(results.glob("[tf]*/*.json"))]
    kind = {"index": lambda v: "points" in v, "record": lambda v: v.get("status") == "finished",
            "failed_record": lambda v: v.get("status") == "failed"}[schema]
    good = next(value for value in values if kind(value))
    assert errors(schema, good) == [] and errors(schema, {**good, **change})


def test_every_schema_is_one():
    for schema in SCHEMAS.values():
        jsonschema.Draft202012Validator.check_schema(schema)


def test_a_record_of_a_study_keeps_to_its_schema(tmp_path):
    bin_folder = os.environ.get("TRIGRAIN_BIN", str(EXPERIMENTS.parent / "build/release/bin"))
    record = tmp_path / "r.json"
    subprocess.run([f"{bin_folder}/stability", "--study", "rigid-impact", "--value", "13", "--record", str(record)], check=True,
                   capture_output=True, timeout=60)
    value = json.loads(record.read_text())
    assert errors("stability_record", value) == []
    assert all(metric["within"] for metric in value["metrics"].values())
    assert errors("stability_record", {**value, "metrics": {"a": 1}})
