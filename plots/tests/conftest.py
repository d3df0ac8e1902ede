"""Made-up results of sweeps, as sweep and dem_bench leave them."""
import base64
import itertools
import json
import struct
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))


class MadeUp:
    """A results folder. Times are functions of the parameters, so that figures can be compared with them."""

    def __init__(self, folder: Path):
        self.folder = folder

    def record(self, id: str, params: dict, **changes) -> dict:
        particles = params["particles"]
        times = [1e-6 * particles * 10 * f * params["vertices"] / params.get("threads", 1) for f in (1.1, 0.9, 1.0)]
        return {"schema": "trigrain-record-1", "point_id": id, "status": "finished", "params": params,
                "started_utc": "2024-01-01T00:00:00Z", "scene": {"moving_bodies": particles, "step_s": 1e-5},
                "build": {"version": "0.1.0", "commit": "c0ffee" * 6 + "abcd", "dirty": False, "compiler": "GNU 12.2.0",
                          "build_type": "Release", "arch": "native", "arch_resolved": "znver3", "flags": "-O3",
                          "libraries": {"tbb": "2021.8"}},
                "machine": {"cpu": "Imagined <CPU>", "sockets": 1, "cores": 2, "os_kernel": "Linux 6"},
                "placement": {"asked_threads": params.get("threads", 1), "observed_threads": params.get("threads", 1),
                              "oversubscribed": False},
                "check": {"passed": True, "how": [{"what": "kernel", "passed": True, "detail": "64 pairs agree"}]},
                "samples": [{"wall_s": 7 * t, "cpu_s": 7 * t, "steps": 7} for t in times], "warnings": [], **changes}

    def sweep(self, name: str, axes: dict, fixed: dict, elsewhere=(), unavailable="adaptive") -> dict[str, dict]:
        """Writes records for points of up to 2 threads on any grid but the unavailable one; returns points of the index by name."""
        points = {}
        for number, values in enumerate(itertools.product(*axes.values())):
            params = {**fixed, **dict(zip(axes, values))}
            id = f"{number:012x}"
            state, why = "finished", ""
            if params.get("threads", 1) > 2:
                state, why = "needs a bigger machine", f"{params['threads']} threads, 2 cores here"
            if unavailable and params.get("grid") == unavailable:
                state, why = "not available in this build", f"grid '{unavailable}'"
            point_name = " ".join(f"{key}={value}" for key, value in zip(axes, values))
            points[point_name] = {"id": id, "name": point_name, "params": params, "state": state, "why": why}
            if state == "finished":
                self.write(name, id, self.record(id, params))
        self.write(name, "index", {"schema": "trigrain-index-1", "spec": name, "preset": "quick", "title": f"About {name}",
                                   "about": "Made up.", "elsewhere": list(elsewhere), "points": list(points.values())})
        return points

    def write(self, name: str, id: str, value: dict) -> None:
        (self.folder / name).mkdir(parents=True, exist_ok=True)
        (self.folder / name / f"{id}.json").write_text(json.dumps(value))

    def read(self, name: str, id: str) -> dict:
        return json.loads((self.folder / name / f"{id}.json").read_text())

    def change(self, name: str, id: str, **changes) -> None:
        self.write(name, id, {**self.read(name, id), **changes})


def vtp(triangles: list, bodies: list[int], speeds: list[float]) -> str:
    """A frame as dem_bench writes it: arrays behind the text, each with its length, in base64."""
    appended, tags = "", []

    def array(kind: str, code: str, name: str, values: list) -> None:
        nonlocal appended
        raw = struct.pack(f"<{len(values)}{code}", *values)
        tags.append(f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="1" format="appended" '
                    f'offset="{len(appended)}"/>')
        appended += base64.b64encode(struct.pack("<Q", len(raw)) + raw).decode()

    count = len(triangles)
    array("Float64", "d", "position_m", [x for triangle in triangles for corner in triangle for x in corner])
    array("Int64", "q", "connectivity", list(range(3 * count)))
    array("Int64", "q", "offsets", [3 * i + 3 for i in range(count)])
    array("Int32", "i", "body", bodies)
    array("Float64", "d", "speed_m_s", speeds)
    return ("<VTKFile><PolyData>" + "\n".join(tags) + '</PolyData><AppendedData encoding="base64">\n_' + appended
            + "\n</AppendedData></VTKFile>\n")


@pytest.fixture(name="made_up")
def _made_up(tmp_path) -> MadeUp:
    return MadeUp(tmp_path / "results")


@pytest.fixture(name="hopper_frames")
def _hopper_frames(made_up) -> MadeUp:
    """Results of figure 8.4: a wall that stands and a grain that falls, at four times."""
    points = made_up.sweep("figure_8_4", {"vertices": [10]}, {"particles": 1})
    folder = made_up.folder / "figure_8_4/frames" / next(iter(points.values()))["id"]
    folder.mkdir(parents=True)
    names = []
    for number in range(4):
        wall = [[0.4, 0.4, 0.4], [0.6, 0.4, 0.4], [0.5, 0.4, 0.6]]
        grain = [[x, y + 0.6 - 0.05 * number, z] for x, y, z in ([0.5, 0, 0.5], [0.52, 0, 0.5], [0.5, 0.02, 0.5])]
        (folder / f"f{number}.vtp").write_text(vtp([wall, grain], [0, 1], [0.0, 0.5 * number]))
        names.append(f'<DataSet timestep="{0.1 * number}" file="f{number}.vtp"/>')
    (folder / "frames.pvd").write_text(f"<VTKFile><Collection>{''.join(names)}</Collection></VTKFile>")
    return made_up
