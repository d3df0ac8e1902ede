"""The README's example scene and spec work as printed."""
import json
import re
from pathlib import Path

import pytest

from sweep.points import expand
from sweep.spec import read_spec

ROOT = Path(__file__).resolve().parents[2]
BLOCKS = [json.loads(text) for text in re.findall(r"```json\n(.*?)```", (ROOT / "README.md").read_text(), re.S)]
SPEC, = (block for block in BLOCKS if "fixed" in block)
SCENE, = (block for block in BLOCKS if "bodies" in block)


def test_the_spec_is_valid(tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(json.dumps(SPEC))
    assert len(expand(read_spec(path))) == 4


def test_the_cube_comes_to_lie_on_the_plane(dem_bench, tmp_path):
    (tmp_path / "cube.json").write_text(json.dumps(SCENE))
    words = ("--scene-file", tmp_path / "cube.json", "--record", tmp_path / "r.json", "--final-state", tmp_path / "s.json",
             "--vtk", tmp_path / "frames", "--vtk-every", 0.02)
    done = dem_bench(*words)
    assert done.returncode == 0, done.stderr
    state = json.loads((tmp_path / "s.json").read_text())
    plane, cube = state["bodies"]
    assert plane["position_m"] == [0.5, 0.3, 0.5]
    halos = 2 * 5e-4
    edge, overlap = 0.02, 0.02 ** 3 * 1000 * 9.81 / 5e4
    assert cube["position_m"][1] == pytest.approx(0.3 + edge / 2 + halos - overlap, abs=1e-4)
    assert max(map(abs, cube["velocity_m_s"])) < 0.05
    assert len(list((tmp_path / "frames").glob("*.vtp"))) == 26
