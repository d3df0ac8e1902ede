"""The bodies that dem_bench hands over (experiments/schema/hand_over.json), as other engines want them."""
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

DENSITY = 1000  # kg/m3, of all built-in scenes
# Of its halo, that a moving mesh grows by: sharp corners come out further than round halos, and so as many bodies touch.
SHARE_OF_HALO = .98


@dataclass(frozen=True)
class Mesh:
    """points (n, 3) in m, world frame, and faces (m, 3)."""
    points: np.ndarray
    faces: np.ndarray


@dataclass(frozen=True)
class Bodies:
    """Moving bodies as arrays, of which shapes holds a radius (m) or a Mesh each, and walls; all grown by their halos, so that what
    touches overlaps. `stiffness` (N/m), `damping_ratio`, `friction`, `tangential_ratio`: of our contact law."""
    mass: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    angular_velocity: np.ndarray
    shapes: list
    walls: list[Mesh]
    gravity: tuple[float, float, float]
    step_s: float
    stiffness: float
    damping_ratio: float
    friction: float
    tangential_ratio: float

    @property
    def spheres(self) -> bool:
        return not isinstance(self.shapes[0], Mesh)


def read_bodies(path: Path) -> Bodies:
    """OSError or ValueError if it is no hand-over file."""
    data = json.loads(path.read_text(encoding="utf-8"))
    moving = [body for body in data["bodies"] if not body["fixed"]]
    walls = [_shape(body) for body in data["bodies"] if body["fixed"]]
    law = data["contact"]
    return Bodies(*(np.array([body[key] for body in moving])
                    for key in ("mass_kg", "centre_m", "velocity_m_s", "angular_velocity_rad_s")),
                  [_shape(body) for body in moving], walls, tuple(data["gravity_m_s2"]), data["step_s"],
                  law["stiffness_N_m"], law["damping_ratio"], law["friction"], law["tangential_ratio"])


def ball_radius(mass: np.ndarray) -> np.ndarray:
    """Of balls of these masses (m)."""
    return np.cbrt(3 * mass / (4 * math.pi * DENSITY))


def _shape(body: dict) -> float | Mesh:
    shape, halo = body["shape"], body["halo_m"]
    if "radius_m" in shape:
        return shape["radius_m"] + halo
    return grown(Mesh(np.array(shape["points_m"]), np.array(shape["faces"])), halo if body["fixed"] else SHARE_OF_HALO * halo)


def _normals(mesh: Mesh) -> np.ndarray:
    """Unit normals of the faces."""
    corners = mesh.points[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def grown(mesh: Mesh, halo: float) -> Mesh:
    """Every face moved outwards by `halo` (m); a vertex of more than three planes moves to the least squares of them."""
    normals = _normals(mesh)
    moved = mesh.points.copy()
    for i in range(len(moved)):
        planes = normals[np.any(mesh.faces == i, axis=1)]
        moved[i] += np.linalg.lstsq(planes, np.full(len(planes), halo), rcond=1e-6)[0]
    return Mesh(moved, mesh.faces)


def parts(mesh: Mesh) -> list[Mesh]:
    """The pieces that share no vertex."""
    piece = np.arange(len(mesh.points))
    while True:
        least = piece[mesh.faces].min(axis=1)
        before = piece.copy()
        np.minimum.at(piece, mesh.faces, least[:, None])
        if np.array_equal(piece, before):
            break
    return [Mesh(mesh.points, mesh.faces[piece[mesh.faces[:, 0]] == each]) for each in np.unique(piece[mesh.faces[:, 0]])]


def convex(mesh: Mesh) -> bool:
    """Whether no point lies outside of a face, but for 1e-9 of the mesh's size."""
    used = mesh.points[np.unique(mesh.faces)]
    normals = _normals(mesh)
    out = normals @ used.T - np.sum(normals * mesh.points[mesh.faces[:, 0]], axis=1, keepdims=True)
    return bool(out.max() <= 1e-9 * np.ptp(used, axis=0).max())
