"""Runs inside YADE: builds what the task file says, warms up, times, and writes the answer."""
import json
import sys
import time

from yade import log, polyhedra_utils, utils  # noqa: F401: YADE's names, as O, are there without an import

log.setLevel("Default", log.FATAL)
task = json.load(open(sys.argv[1], encoding="ascii"))
spheres = "radius" in task
if spheres:
    material = ViscElMat(density=task["density"], frictionAngle=task["friction_angle"], **task["material"])
    bounds, shapes = [Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()], [Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()]
    physics, law = Ip2_ViscElMat_ViscElMat_ViscElPhys(), Law2_ScGeom_ViscElPhys_Basic()
    grains = [utils.sphere(x, r, material=material) for x, r in zip(task["position"], task["radius"])]
else:
    material = PolyhedraMat(density=task["density"], frictionAngle=task["friction_angle"], **task["material"])
    bounds = [Bo1_Polyhedra_Aabb(), Bo1_Facet_Aabb()]
    shapes = [Ig2_Polyhedra_Polyhedra_PolyhedraGeom(), Ig2_Facet_Polyhedra_PolyhedraGeom()]
    physics, law = Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys(), Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()
    grains = [polyhedra_utils.polyhedra(material, v=points) for points in task["points"]]
O.materials.append(material)
O.bodies.append(grains)
for grain, mass, velocity, spin in zip(grains, task["mass"], task["velocity"], task["angular_velocity"]):
    grain.state.inertia *= mass / grain.state.mass  # the grown body's shape with the mass of the body itself
    grain.state.mass = mass
    grain.state.vel, grain.state.angVel = velocity, spin
O.bodies.append([polyhedra_utils.polyhedra(material, v=points, fixed=True) for points in task["blocks"]])
O.bodies.append([utils.facet(corners, material=material, fixed=True) for wall in task["walls"] for corners in wall])
start = [grain.state.pos for grain in grains]
O.engines = [ForceResetter(), InsertionSortCollider(bounds, verletDist=task["skin_m"]), InteractionLoop(shapes, [physics], [law]),
             NewtonIntegrator(damping=task["damping_of_warmup"], gravity=task["gravity"], label="newton")]
O.dt = task["step_s"]
if task["warmup"]:  # 0 would mean without end
    O.run(task["warmup"], True)
newton.damping = task["damping"]
wall_s = []
for _ in range(task["repeats"]):
    begin = time.perf_counter()
    O.run(task["steps"], True)
    wall_s.append(time.perf_counter() - begin)
touching = [each for each in O.interactions if each.isReal and (spheres or each.geom.penetrationVolume > 0)]
moved = [grain.state.pos - at for grain, at in zip(grains, start)]
json.dump({"version": yade.config.version, "wall_s": wall_s, "contacts": len(touching),
           "position": [list(x + d) for x, d in zip(map(Vector3, task["position"]), moved)],
           "velocity": [list(grain.state.vel) for grain in grains]}, open(sys.argv[2], "w", encoding="ascii"))
