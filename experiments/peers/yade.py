"""YADE: spheres by ScGeom and ViscElMat, our spring-dashpot; grains of triangles by Polyhedra, the volume of overlap."""
import json
import math
import shutil
import subprocess
from pathlib import Path

import numpy as np

from peers.bodies import DENSITY, SHARE_OF_HALO, Bodies, ball_radius, convex, parts
from peers.outcome import OF_SPHERES, Outcome, Run, Unable

PROGRAM = "yade"
GLOBAL_DAMPING, WHILE_SETTLING = 0.3, 0.8  # of polyhedra, as YADE's own examples have it; and in the warm-up
OF_GRAINS = (f"convex hulls grown by {SHARE_OF_HALO:g} of the halo, with corners where our halos are round; the force is proportional to "
             "the volume of overlap and acts at its centre, one contact for each pair; no dashpot, instead global damping of "
             f"{GLOBAL_DAMPING:g}; ")


def run(bodies: Bodies, wanted: Run, folder: Path) -> Outcome:
    """Unable if YADE does not end well."""
    task = {"step_s": bodies.step_s, "gravity": bodies.gravity, "friction_angle": math.atan(bodies.friction), "density": DENSITY,
            "skin_m": wanted.skin * 2 * _smallest(bodies), "steps": wanted.steps, "warmup": wanted.warmup,
            "repeats": wanted.repeats, "mass": bodies.mass.tolist(), "position": bodies.position.tolist(),
            "velocity": bodies.velocity.tolist(), "angular_velocity": bodies.angular_velocity.tolist(),
            **_walls(bodies), **_shapes(bodies)}
    (folder / "task.json").write_text(json.dumps(task), encoding="ascii")
    script = shutil.copy(Path(__file__).with_name("yade_script.py"), folder)
    with open(folder / "log.txt", "w", encoding="utf-8") as log:
        done = subprocess.run([PROGRAM, "-n", "-x", "-j1", script, "task.json", "answer.json"], cwd=folder, stdout=log,
                              stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
    if not (folder / "answer.json").exists():
        said = (folder / "log.txt").read_text(encoding="utf-8", errors="replace").splitlines()
        raise Unable(f"exit code {done.returncode}: {(said or ['it said nothing'])[-1]}")
    answer = json.loads((folder / "answer.json").read_text(encoding="ascii"))
    differs = (OF_SPHERES if bodies.spheres else OF_GRAINS) + "tangential springs start from 0"
    return Outcome(answer["version"], differs, answer["wall_s"], answer["contacts"], np.array(answer["position"]), np.array(answer["velocity"]))


def _smallest(bodies: Bodies) -> float:
    """Radius (m) of the smallest body's bounding sphere."""
    if bodies.spheres:
        return min(bodies.shapes)
    return min(np.linalg.norm(mesh.points - at, axis=1).max() for mesh, at in zip(bodies.shapes, bodies.position))


def _walls(bodies: Bodies) -> dict:
    """Triangles; for grains of triangles blocks where a piece of wall is convex, which YADE compares once and not per triangle."""
    pieces = [piece for wall in bodies.walls for piece in parts(wall)]
    blocks = [] if bodies.spheres else [piece for piece in pieces if convex(piece)]
    return {"blocks": [piece.points[np.unique(piece.faces)].tolist() for piece in blocks],
            "walls": [piece.points[piece.faces].tolist() for piece in pieces if not any(piece is each for each in blocks)]}


def _shapes(bodies: Bodies) -> dict:
    if bodies.spheres:  # YADE joins two springs or dashpots in series
        k, zeta, m = bodies.stiffness, bodies.damping_ratio, bodies.mass[0]
        normal = 2 * zeta * math.sqrt(k * m / 2)
        ratio = bodies.tangential_ratio
        return {"radius": list(bodies.shapes), "damping": 0, "damping_of_warmup": 0,
                "material": {"kn": 2 * k, "ks": 2 * k * ratio, "cn": 2 * normal, "cs": 2 * normal * math.sqrt(ratio)}}
    # as stiff as our springs where a face of the square of the mean radius is in contact; its modulus is half of young
    radius = ball_radius(np.mean(bodies.mass))
    return {"points": [mesh.points.tolist() for mesh in bodies.shapes], "damping": GLOBAL_DAMPING, "damping_of_warmup": WHILE_SETTLING,
            "material": {"young": 2 * bodies.stiffness / radius ** 2}}
