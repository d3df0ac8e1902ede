"""Motions with known outcome as a user would run them: a scene file in, a final state out. All values differ from those of the
studies in experiments/stability."""
import json
from math import cos, exp, log, pi, radians, sin, sqrt, tan

import numpy as np
import pytest

G = 9.81


@pytest.fixture
def end_of(dem_bench, tmp_path):
    """Runs a scene and returns the bodies of its final state."""
    def run(contact: dict, time: dict, bodies: list[dict], gravity=(0, 0, 0), size: float = 40) -> list[dict]:
        scene, state = tmp_path / "scene.json", tmp_path / "end.json"
        scene.write_text(json.dumps({"gravity_m_s2": list(gravity), "domain_m": {"min": [-size / 2] * 3, "size": size},
                                     "contact": contact, "time": time, "bodies": bodies}))
        done = dem_bench("--scene-file", scene, "--final-state", state)
        assert done.returncode == 0, done.stderr + done.stdout
        return [{key: np.array(value) for key, value in body.items()} for body in json.loads(state.read_text())["bodies"]]
    return run


def turned(angle: float, axis=(0, 0, 1)) -> list[float]:
    """Quaternion w, x, y, z."""
    axis = np.array(axis) / np.linalg.norm(axis)
    return [cos(angle / 2), *(sin(angle / 2) * axis)]


def matrix(q) -> np.ndarray:
    w, x, y, z = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def floor(halo: float, top: float = 0., width: float = 8.) -> dict:
    return {"shape": {"box_m": [width, 1, width]}, "position_m": [0, top - .5, 0], "halo_m": halo, "fixed": True}


# --- C2: frictionless impact of a rigid cuboid

@pytest.mark.parametrize("size, angle, axis, e, speed", [
    ((.2, .2, .2), 33, (0, 0, 1), 1, .7), ((1, 1, 1), 8, (1, 0, 0), .6, 2), ((.5, .2, .3), 62, (0, 0, 1), .8, 1),
    ((1, 2, 3), 40, (1, .3, .7), .9, 1), ((.4, .4, .4), 54.7356, (1, 0, 1), 1, 1), ((1, .5, .7), 25, (.2, .1, 1), .3, 1.5)])
def test_a_cuboid_rebounds_and_spins(end_of, size, angle, axis, e, speed):
    size, density = np.array(size, float), 1700
    mass = density * size.prod()
    q = turned(radians(angle), axis)
    r = matrix(q)
    inertia = r @ np.diag(mass / 12 * np.array([size[1]**2 + size[2]**2, size[0]**2 + size[2]**2, size[0]**2 + size[1]**2])) @ r.T
    corners = np.array([[x, y, z] for x in (-.5, .5) for y in (-.5, .5) for z in (-.5, .5)]) * size @ r.T
    lowest = corners[corners[:, 1] < corners[:, 1].min() + 1e-9].mean(axis=0)  # a corner, or the middle of an edge
    normal = np.array([0, 1, 0])
    arm = np.cross(lowest, normal)
    impulse = (1 + e) * speed / (1 / mass + arm @ np.linalg.solve(inertia, arm))
    spin = np.linalg.solve(inertia, impulse * arm)
    contact_time = 5e-5 * size.min() / speed  # a dashpot sets in with a jump: where in a step it does is an error of order 1 / N
    stiffness = mass * (pi / contact_time)**2
    halo = 10 * speed * contact_time
    bodies = [floor(halo, -halo),
              {"shape": {"box_m": list(size)}, "position_m": [0, -lowest[1] + .1 * halo, 0], "orientation_wxyz": q,
               "velocity_m_s": [0, -speed, 0], "density_kg_m3": density}]
    after = end_of({"stiffness_N_m": stiffness, "restitution": e, "friction": 0},
                   {"step_s": contact_time / (150 if e == 1 else 4000), "end_s": 8 * contact_time}, bodies)[1]
    scale = np.linalg.norm(spin) + speed / size.max()
    assert after["velocity_m_s"] == pytest.approx([0, impulse / mass - speed, 0], abs=1e-3 * speed)
    assert after["angular_velocity_rad_s"] == pytest.approx(spin, abs=1e-3 * scale)


# --- C1: the free top, against an integration of Euler's equations

@pytest.mark.parametrize("size, spin, q", [
    ((.3, .1, .2), (2, -3, 1), turned(.4, (1, 1, 0))), ((1, 2, 3), (.1, 4, .05), turned(2, (0, 1, 1))),
    ((.1, .1, .4), (5, 5, 20), turned(0))])
def test_a_free_top_follows_eulers_equations(end_of, size, spin, q):
    a, b, c = size
    inertia = np.array([b * b + c * c, a * a + c * c, a * a + b * b]) / 12
    end = 6 / np.linalg.norm(spin) * 2 * pi
    w = matrix(q).T @ np.array(spin)
    state = np.concatenate([w, q])

    def rate(s):
        w, (q0, *v) = s[:3], s[3:]
        v = np.array(v)
        return np.concatenate([np.cross(inertia * w, w) / inertia, [-v @ w / 2], (q0 * w + np.cross(v, w)) / 2])

    steps = 6000
    h = end / steps
    for _ in range(steps):
        k1 = rate(state)
        k2 = rate(state + h / 2 * k1)
        k3 = rate(state + h / 2 * k2)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(state + h * k3))
    after = end_of({}, {"step_s": end / 40000, "end_s": end},
                   [{"shape": {"box_m": list(size)}, "orientation_wxyz": q, "angular_velocity_rad_s": list(spin)}])[0]
    assert matrix(after["orientation_wxyz"]) == pytest.approx(matrix(state[3:]), abs=1e-5)
    assert after["angular_velocity_rad_s"] == pytest.approx(matrix(state[3:]) @ state[:3], rel=1e-5, abs=1e-5 * max(map(abs, spin)))


# --- C5, C6: blocks on slopes

def block_on_slope(end_of, size, angle, mu, end, stiffness=1e6, halo=5e-4) -> dict:
    """The block after `end` (s); it begins where its springs carry it."""
    mass = 1200 * np.prod(size)
    sag = mass * G * cos(angle) / (4 * stiffness)
    after = end_of({"stiffness_N_m": stiffness, "damping_ratio": .5, "friction": mu}, {"step_s": 2e-5, "end_s": end},
                   [floor(halo), {"shape": {"box_m": list(size)}, "position_m": [0, size[1] / 2 + 2 * halo - sag, 0],
                                  "density_kg_m3": 1200, "halo_m": halo}],
                   gravity=(G * sin(angle), -G * cos(angle), 0))[1]
    return after


@pytest.mark.parametrize("degrees, mu", [(25, .2), (40, .55), (12, .1)])
def test_a_block_slides_down(end_of, degrees, mu):
    """From the time on when the springs of friction are stretched."""
    angle = radians(degrees)
    one, two = (block_on_slope(end_of, (.3, .1, .2), angle, mu, end) for end in (.1, .5))
    found = (two["velocity_m_s"][0] - one["velocity_m_s"][0]) / .4
    assert found == pytest.approx(G * (sin(angle) - mu * cos(angle)), rel=1e-3)
    way = two["position_m"][0] - one["position_m"][0]
    assert way == pytest.approx(.4 * (one["velocity_m_s"][0] + two["velocity_m_s"][0]) / 2, rel=1e-3)


@pytest.mark.parametrize("degrees, mu", [(15, .4), (30, .6), (5, .09)])
def test_a_block_rests(end_of, degrees, mu):
    one, two = (block_on_slope(end_of, (.2, .12, .15), radians(degrees), mu, end) for end in (.3, .5))
    assert np.linalg.norm(two["position_m"] - one["position_m"]) < 1e-9


@pytest.mark.parametrize("degrees, mu, shape, falls", [(35, .9, .5, True), (35, .9, .72, False), (20, .6, .35, True),
                                                       (20, .6, .38, False), (50, 1.4, 1.15, True)])
def test_a_block_topples_if_it_is_slender(end_of, degrees, mu, shape, falls):
    after = block_on_slope(end_of, (.1 * shape, .1, .08), radians(degrees), mu, .4)
    turn = 2 * np.arccos(min(1, abs(after["orientation_wxyz"][0])))
    assert (turn > .05) == falls, turn


# --- balls: sliding, rolling, bouncing

@pytest.mark.parametrize("radius, mu, speed, halo", [(.08, .15, 2.5, 1e-3), (.01, .4, .5, 2e-4), (.3, .25, 4, 0)])
def test_a_ball_slides_until_it_rolls(end_of, radius, mu, speed, halo):
    mass = 1000 * 4 / 3 * pi * radius**3
    wall, stiffness = 1e-3, mass * 1e6
    rolls = 2 * speed / (7 * mu * G)
    bodies = [floor(wall, width=40), {"shape": {"sphere_m": radius}, "halo_m": halo, "velocity_m_s": [speed, 0, 0],
                                      "position_m": [0, radius + wall + halo - mass * G / stiffness, 0]}]
    contact, step = {"stiffness_N_m": stiffness, "damping_ratio": .3, "friction": mu}, 4e-5
    sliding = end_of(contact, {"step_s": step, "end_s": .6 * rolls}, bodies, (0, -G, 0), 80)[1]
    rolling = end_of(contact, {"step_s": step, "end_s": 1.5 * rolls}, bodies, (0, -G, 0), 80)[1]
    assert sliding["velocity_m_s"][0] == pytest.approx(speed * (1 - .6 * 2 / 7), rel=1e-3)
    assert rolling["velocity_m_s"][0] == pytest.approx(5 / 7 * speed, rel=1e-3)
    assert -radius * rolling["angular_velocity_rad_s"][2] == pytest.approx(5 / 7 * speed, rel=1e-3)


@pytest.mark.parametrize("degrees, mu", [(12, .5), (40, .3), (55, .2)])
def test_a_ball_rolls_down_or_slips(end_of, degrees, mu):
    angle, radius, end = radians(degrees), .05, .4
    mass = 1000 * 4 / 3 * pi * radius**3
    stiffness = mass * 1e6
    after = end_of({"stiffness_N_m": stiffness, "damping_ratio": .3, "friction": mu}, {"step_s": 4e-5, "end_s": end},
                   [floor(5e-4), {"shape": {"sphere_m": radius}, "halo_m": 5e-4,
                                  "position_m": [0, radius + 1e-3 - mass * G * cos(angle) / stiffness, 0]}],
                   (G * sin(angle), -G * cos(angle), 0))[1]
    rolls = mu >= 2 / 7 * tan(angle)
    acceleration = 5 / 7 * G * sin(angle) if rolls else G * (sin(angle) - mu * cos(angle))
    spin = acceleration / radius if rolls else 2.5 * mu * G * cos(angle) / radius
    assert after["velocity_m_s"][0] == pytest.approx(acceleration * end, rel=1e-3)
    assert -after["angular_velocity_rad_s"][2] == pytest.approx(spin * end, rel=1e-3)


@pytest.mark.parametrize("modulus, nu, density, degrees, e, mu", [(210e9, .3, 7800, 40, .8, .1), (3e9, .35, 1200, 60, .95, .25),
                                                                  (70e9, .22, 2500, 25, .5, .05)])
def test_an_oblique_impact_that_slides_throughout(end_of, modulus, nu, density, degrees, e, mu):
    radius, speed, theta = .02, 2.5, radians(degrees)
    mass = density * 4 / 3 * pi * radius**3
    k, normal = 4 / 3 * modulus / (1 - nu**2) * sqrt(radius), speed * cos(theta)
    depth = (5 * mass * normal**2 / (4 * k))**.4
    contact_time = 2.943275 * depth / normal
    after = end_of({"law": "hertz-mindlin", "youngs_modulus_Pa": modulus, "poisson_ratio": nu, "restitution": e, "friction": mu},
                   {"step_s": contact_time / 100, "end_s": 3 * contact_time},
                   [floor(1.05 * depth, -1.05 * depth),
                    {"shape": {"sphere_m": radius}, "position_m": [0, radius * (1 + 1e-9), 0], "density_kg_m3": density,
                     "velocity_m_s": [speed * sin(theta), -normal, 0]}])[1]
    assert tan(theta) > 3.5 * mu * (1 + e) * .999
    assert after["velocity_m_s"][1] == pytest.approx(e * normal, abs=1e-3 * normal)
    assert after["velocity_m_s"][0] / (speed * sin(theta)) == pytest.approx(1 - mu * (1 + e) / tan(theta), abs=1e-3)
    assert after["angular_velocity_rad_s"][2] == pytest.approx(-2.5 * mu * (1 + e) * normal / radius, rel=1e-3)


@pytest.mark.parametrize("law", ["spring-dashpot", "hertz-mindlin"])
def test_two_unequal_balls_meet(end_of, law):
    """Momentum is kept, the restitution is the one asked for."""
    radii, density, e, speed = (.03, .05), 3000, .4, (1.5, -.5)
    masses = [density * 4 / 3 * pi * r**3 for r in radii]
    after = end_of({"law": law, "stiffness_N_m": 1e7, "youngs_modulus_Pa": 1e9, "restitution": e, "friction": .5},
                   {"step_s": 1e-7, "end_s": .004},
                   [{"shape": {"sphere_m": r}, "position_m": [x, 0, 0], "velocity_m_s": [v, 0, 0], "density_kg_m3": density,
                     "halo_m": 1e-3} for r, x, v in zip(radii, (-.0331, .0511), speed)])
    v = [body["velocity_m_s"][0] for body in after]
    assert np.dot(masses, v) == pytest.approx(np.dot(masses, speed), rel=1e-12)
    assert v[1] - v[0] == pytest.approx(e * (speed[0] - speed[1]), abs=1e-3 * 2)


@pytest.mark.parametrize("e, height", [(.7, .2), (.4, .05)])
def test_a_bouncing_ball_comes_to_rest(end_of, e, height):
    """It still bounces at 90 % of sqrt(2 H / g) (1 + e) / (1 - e), and rests at 110 %."""
    radius, halo, end = .05, 1e-3, sqrt(2 * height / G) * (1 + e) / (1 - e)
    mass = 1000 * 4 / 3 * pi * radius**3
    stiffness = mass * 4e8
    bodies = [floor(halo), {"shape": {"sphere_m": radius}, "position_m": [0, radius + halo + height, 0]}]
    before, after = (end_of({"stiffness_N_m": stiffness, "restitution": e, "friction": 0}, {"step_s": 4e-6, "end_s": t * end},
                            bodies, (0, -G, 0))[1] for t in (.9, 1.1))
    bounces = log(.1) / log(e)  # after that many 10 % of the time is left
    assert abs(before["velocity_m_s"][1]) > .02 * exp(log(e) * (bounces + 1)) * sqrt(2 * G * height)
    assert abs(after["velocity_m_s"][1]) < 1e-6
    assert after["position_m"][1] == pytest.approx(radius + halo - mass * G / stiffness, abs=1e-9)


# --- C13: a stack

def test_a_stack_of_unequal_boxes_stands(end_of):
    stiffness, halo, density = 5e6, 1e-3, 900
    edges = [(.3, .1, .3), (.24, .15, .24), (.2, .08, .2), (.16, .12, .16), (.1, .1, .1)]
    bodies, y = [floor(halo)], 0.
    for edge in edges:
        bodies.append({"shape": {"box_m": list(edge)}, "position_m": [0, y + 2 * halo + edge[1] / 2, 0], "density_kg_m3": density,
                       "halo_m": halo})
        y += 2 * halo + edge[1]
    after = end_of({"stiffness_N_m": stiffness, "damping_ratio": .5, "friction": .4}, {"step_s": 3e-5, "end_s": 1.2}, bodies,
                   (0, -G, 0))
    masses, y = [density * np.prod(edge) for edge in edges], 0.
    for i, edge in enumerate(edges):  # each upper box stands on its four corners, being narrower
        y += 2 * halo - sum(masses[i:]) * G / (4 * stiffness)
        assert after[i + 1]["position_m"][1] == pytest.approx(y + edge[1] / 2, rel=1e-6)
        assert np.hypot(*after[i + 1]["position_m"][[0, 2]]) < 1e-6 * edge[0]
        y += edge[1]
