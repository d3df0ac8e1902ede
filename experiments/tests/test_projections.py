"""`sweep project` on the real program: what is stored of a small series over threads, and what is withheld."""
import json
import os
import subprocess
from pathlib import Path

import jsonschema
import pytest

EXPERIMENTS = Path(__file__).resolve().parents[1]
BIN = Path(os.environ.get("TRIGRAIN_BIN", EXPERIMENTS.parent / "build/release/bin"))
SPEC = {"fixed": {"scene": "hopper-dense", "particles": 64, "vertices": 10, "halo": "published", "scheme": "task", "steps": 20,
                  "repeats": 1}, "axes": {"threads": [1, 2]}}
SCHEMAS = {path.stem: json.loads(path.read_text()) for path in (EXPERIMENTS / "schema").glob("*.json")}


@pytest.fixture(name="swept")
def _swept(dem_bench, tmp_path):
    """A finished sweep; sweep(command) runs another command on it."""
    (tmp_path / "tried.json").write_text(json.dumps(SPEC))

    def sweep(command: str) -> str:
        done = subprocess.run(["/usr/bin/python3", "-m", "sweep", command, str(tmp_path / "tried.json"), "--results",
                               str(tmp_path / "results"), "--bin", str(BIN), "--cores", "2"], capture_output=True, text=True,
                              check=False, timeout=120, env={**os.environ, "PYTHONPATH": str(EXPERIMENTS)})
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    sweep("run")
    return tmp_path / "results/tried", sweep


def set_speed_up(folder: Path, value: float) -> None:
    """Makes the two records show this speed-up on two threads."""
    records = {}
    for path in folder.glob("*.json"):
        record = json.loads(path.read_text())
        if path.name != "index.json":
            records[record["params"]["threads"]] = path, record
    for threads, (path, record) in records.items():
        record.pop("sweep", None)
        record["samples"] = [{**record["samples"][0], "wall_s": 1 if threads == 1 else 1 / value, "steps": 20}]
        path.write_text(json.dumps(record))


def test_a_projection_is_stored_with_its_residual_and_withheld_where_it_misses_two_threads(swept):
    folder, sweep = swept
    set_speed_up(folder, 0.5)
    assert "WITHHELD" in sweep("project") and "1 projections withheld" in sweep("project")
    (path,) = (folder / "projections").glob("*.json")
    found = json.loads(path.read_text())
    resolver = jsonschema.RefResolver("projection.json", SCHEMAS["projection"], {f"{stem}.json": s for stem, s in SCHEMAS.items()})
    jsonschema.Draft202012Validator(SCHEMAS["projection"], resolver=resolver).validate(found)
    assert found["machine_costs"] == json.loads((folder.parent / "machine_costs.json").read_text())
    assert found["validation"]["measured"] == pytest.approx(0.5) and not found["validation"]["trusted"]
    assert found["validation"]["residual"] == pytest.approx(found["validation"]["predicted"] / 0.5 - 1)
    assert found["rows"][-1]["threads"] == 64 and found["tasks_per_step"] > 0 and 0 < found["serial_share"] < 1
    for _ in range(6):  # each traces anew, and what the machine does meanwhile is in the trace
        set_speed_up(folder, found["validation"]["predicted"])
        path.unlink()
        said = sweep("project")
        found = json.loads(path.read_text())
        trusted = abs(found["validation"]["residual"]) <= 0.05
        assert found["validation"]["trusted"] == trusted and f"{0 if trusted else 1} projections withheld" in said
        if trusted:
            return
    pytest.fail("no prediction agreed with the one before")
