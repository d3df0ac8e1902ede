"""LIGGGHTS: spheres by its model hooke/stiffness with history, our spring-dashpot."""
import math
import re
import subprocess
from pathlib import Path

import numpy as np

from peers.bodies import Bodies, Mesh
from peers.outcome import OF_SPHERES, Outcome, Run, Unable

PROGRAM = "liggghts"
DIFFERS = OF_SPHERES + "spins start from ours, tangential springs from 0"


def run(bodies: Bodies, wanted: Run, folder: Path) -> Outcome:
    """Unable if the bodies are no spheres of one size, or LIGGGHTS does not end well."""
    if not bodies.spheres or np.ptp(bodies.shapes) > 0:
        raise Unable("LIGGGHTS is compared with spheres of one size only")
    _write_data(bodies, folder / "bodies.data")
    for number, wall in enumerate(bodies.walls):
        _write_stl(wall, folder / f"wall_{number}.stl")
    (folder / "in.txt").write_text(_script(bodies, wanted), encoding="ascii")
    done = subprocess.run([PROGRAM, "-in", "in.txt", "-log", "log.txt"], cwd=folder, capture_output=True, text=True)
    log = (folder / "log.txt").read_text(encoding="ascii", errors="replace") if (folder / "log.txt").exists() else ""
    loops = [float(each) for each in re.findall(r"^Loop time of (\S+) on 1 procs for ", log, re.MULTILINE)]
    if done.returncode or len(loops) != wanted.repeats + 2:  # the warm-up, the samples, and no step for the last look
        raise Unable(f"exit code {done.returncode}: {([*log.splitlines(), *done.stderr.splitlines()] or ['it said nothing'])[-1]}")
    last = np.loadtxt(folder / "end.txt", skiprows=9, ndmin=2)
    last = last[np.argsort(last[:, 0])]
    version = re.search(r"LIGGGHTS-PUBLIC (\S+),", done.stdout)
    return Outcome(version[1] if version else "unknown", DIFFERS, loops[1:-1], _entries(folder / "pairs.txt") + _entries(folder / "walls.txt"),
                   last[:, 1:4], last[:, 4:7])


def _script(bodies: Bodies, wanted: Run) -> str:
    """Grains are of type 1, walls of type 2. Its damping per effective mass; a wall's is the grain's own."""
    mass, diameter, k = bodies.mass[0], 2 * bodies.shapes[0], bodies.stiffness
    of_grains, of_walls = (2 * bodies.damping_ratio * math.sqrt(k / m) for m in (mass / 2, mass))
    tangential = math.sqrt(bodies.tangential_ratio)
    g = math.dist(bodies.gravity, (0, 0, 0))

    def pairs(grains: float, walls: float) -> str:
        return f"peratomtypepair 2 {grains:.17g} {walls:.17g} {walls:.17g} {walls:.17g}"

    meshes = [f"fix wall_{i} all mesh/surface file wall_{i}.stl type 2 curvature_tolerant yes" for i in range(len(bodies.walls))]
    return "\n".join([
        "atom_style granular", "atom_modify map array", "boundary f f f", "newton off", "communicate single vel yes", "units si",
        "processors 1 1 1", "read_data bodies.data",
        f"neighbor {2 * wanted.skin * diameter:.17g} bin", "neigh_modify delay 0 every 1 check yes",
        f"fix kn all property/global kn {pairs(k, k)}",
        f"fix kt all property/global kt {pairs(k * bodies.tangential_ratio, k * bodies.tangential_ratio)}",
        f"fix cn all property/global gamman {pairs(of_grains, of_walls)}",
        f"fix ct all property/global gammat {pairs(of_grains * tangential, of_walls * tangential)}",
        f"fix mu all property/global coefficientFriction {pairs(bodies.friction, bodies.friction)}",
        "pair_style gran model hooke/stiffness tangential history limitForce on", "pair_coeff * *",
        f"timestep {bodies.step_s:.17g}",
        f"fix fall all gravity {g:.17g} vector " + " ".join(f"{each:.17g}" for each in bodies.gravity),
        *meshes,
        f"fix walls all wall/gran model hooke/stiffness tangential history mesh n_meshes {len(meshes)} meshes "
        + " ".join(f"wall_{i}" for i in range(len(meshes))) + " limitForce on",
        "fix move all nve/sphere", "compute pairs all pair/gran/local id", "compute walls all wall/gran/local id",
        "thermo_style custom step atoms ke", f"thermo {10 ** 9}", f"run {wanted.warmup}",
        *[f"run {wanted.steps} pre no post no"] * wanted.repeats,
        "dump pairs all local 1 pairs.txt c_pairs[1] c_pairs[2]", "dump walls all local 1 walls.txt c_walls[1] c_walls[2]",
        "dump end all custom 1 end.txt id x y z vx vy vz", "dump_modify end format \"%d %.17g %.17g %.17g %.17g %.17g %.17g\"", "run 0", ""])


def _write_data(bodies: Bodies, path: Path) -> None:
    points = np.vstack([bodies.position, *(wall.points for wall in bodies.walls)])
    room = 4 * bodies.shapes[0]
    low, high = points.min(axis=0) - room, points.max(axis=0) + room
    density = bodies.mass / (4 / 3 * math.pi * np.array(bodies.shapes) ** 3)
    lines = ["grains handed over", "", f"{len(bodies.mass)} atoms", "2 atom types", "",
             *(f"{low[i]:.17g} {high[i]:.17g} {axis}lo {axis}hi" for i, axis in enumerate("xyz")), "", "Atoms", "",
             *(f"{i + 1} 1 {2 * bodies.shapes[i]:.17g} {density[i]:.17g} " + " ".join(f"{x:.17g}" for x in bodies.position[i])
               for i in range(len(density))), "", "Velocities", "",
             *(f"{i + 1} " + " ".join(f"{v:.17g}" for v in (*bodies.velocity[i], *bodies.angular_velocity[i]))
               for i in range(len(density))), ""]
    path.write_text("\n".join(lines), encoding="ascii")


def _write_stl(wall: Mesh, path: Path) -> None:
    lines = ["solid wall"]
    for face in wall.points[wall.faces]:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex " + " ".join(f"{x:.17g}" for x in corner) for corner in face),
                  "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid wall", ""]), encoding="ascii")


def _entries(path: Path) -> int:
    """Rows of a local dump of one step."""
    lines = path.read_text(encoding="ascii").splitlines()
    return int(lines[lines.index("ITEM: NUMBER OF ENTRIES") + 1])
