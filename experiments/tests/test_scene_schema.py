"""The schema of scene files accepts what the engine's own tests read, and knows every key and default of it."""
import copy
import json
from pathlib import Path

import jsonschema
import pytest

ROOT = Path(__file__).resolve().parents[2]
SCHEMA = json.loads((ROOT / "experiments/schema/scene.json").read_text())
GOOD = sorted((ROOT / "dem/tests/data").glob("*.json"))
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)


def every_shape() -> dict:
    return json.loads((ROOT / "dem/tests/data/every_shape.json").read_text())


def test_the_schema_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert len(GOOD) >= 2


@pytest.mark.parametrize("file", GOOD, ids=lambda f: f.name)
def test_scenes_that_the_engine_reads_are_valid(file):
    VALIDATOR.validate(json.loads(file.read_text()))


def test_every_key_of_the_schema_is_in_a_scene_that_the_engine_reads():
    text = "".join(file.read_text() for file in GOOD)

    def keys(node):
        if isinstance(node, dict):
            yield from node.get("properties", {})
            for child in node.values():
                yield from keys(child)
        elif isinstance(node, list):
            for child in node:
                yield from keys(child)

    missing = [key for key in keys(SCHEMA) if f'"{key}":' not in text]
    assert missing == []


def test_defaults_are_those_of_the_engine():
    source = (ROOT / "dem/scene.hpp").read_text()
    contact = SCHEMA["properties"]["contact"]["properties"]
    time = SCHEMA["properties"]["time"]["properties"]
    for field, value in [
        ("double stiffness = 1e3;", contact["stiffness_N_m"]["default"] == 1e3),
        ("double damping_ratio = 0.5;", contact["damping_ratio"]["default"] == 0.5),
        ("double friction = 0.5;", contact["friction"]["default"] == 0.5),
        ("double tangential_ratio = 2. / 7.;", contact["tangential_ratio"]["default"] == 2 / 7),
        ("double step = 1e-5;", time["step_s"]["default"] == 1e-5),
        ("double end = 1;", time["end_s"]["default"] == 1),
        ("double density = 1000;", SCHEMA["$defs"]["body"]["properties"]["density_kg_m3"]["default"] == 1000),
        ("double halo = 0;", SCHEMA["$defs"]["body"]["properties"]["halo_m"]["default"] == 0),
        ("gravity{0, -9.81, 0};", SCHEMA["properties"]["gravity_m_s2"]["default"] == [0, -9.81, 0]),
    ]:
        assert field in source and value, field


@pytest.mark.parametrize(
    "path, value",
    [
        (["gravity"], [0, 0, 0]),
        (["gravity_m_s2"], [0, 0]),
        (["domain_m", "size"], 0),
        (["contact", "law"], "hertz"),
        (["contact", "friction"], -1),
        (["time", "control"], "adaptive"),
        (["time", "step_s"], "short"),
        (["bodies"], []),
        (["bodies", 0, "colour"], "red"),
        (["bodies", 0, "density_kg_m3"], 0),
        (["bodies", 0, "orientation_wxyz"], [1, 0, 0]),
        (["bodies", 0, "fixed"], 1),
        (["bodies", 0, "shape"], {}),
        (["bodies", 0, "shape"], {"sphere_m": -1}),
        (["bodies", 0, "shape"], {"sphere_m": 1, "box_m": [1, 1, 1]}),
        (["bodies", 0, "shape"], {"box_m": [1, 1, 1], "subdivide": 0}),
        (["bodies", 0, "shape"], {"granulate": {"diameter_m": 1, "vertices": 3}}),
        (["bodies", 0, "shape"], {"mesh": {"file": "part.step"}}),
        (["bodies", 0, "shape"], {"hopper": {"width_m": 1}}),
    ],
)
def test_what_the_engine_refuses_is_not_valid(path, value):
    scene = copy.deepcopy(every_shape())
    node = scene
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value
    assert not VALIDATOR.is_valid(scene)
