"""The record of a peer's point (experiments/schema/peer_record.json), and whether its times may be used."""
import argparse
import math
import os

import numpy as np

from peers.bodies import Bodies, ball_radius
from peers.outcome import Outcome

OTHER_CONTACTS = .2  # share of ours by which the number of touching pairs may differ
OTHER_PLACES = .1    # radii by which half of the bodies may be elsewhere
OTHER_FALL = .05     # radii that a body falls to be as much faster than ours as allowed


def record_of(options: argparse.Namespace, ours: dict, start: Bodies, end: Bodies, outcome: Outcome) -> dict:
    """`ours`: what dem_bench recorded of the same steps, from `start` to `end`; its contacts are pairs of bodies."""
    how = _checks(ours, start, end, outcome)
    params = {**ours["params"], "engine": options.engine, "steps": options.steps, "warmup_steps": options.warmup,
              "repeats": options.repeats, "start_state": str(options.start_state) if options.start_state else None}
    load = os.getloadavg()[0]
    kept = ("schema", "status", "started_utc", "scene", "build", "machine", "placement")
    return {**{key: ours[key] for key in kept}, "point_id": options.point_id, "params": params,
            "check": {"passed": all(item["passed"] for item in how), "how": how},
            "samples": [{"wall_s": wall_s, "steps": options.steps, "load_average_1min": load} for wall_s in outcome.wall_s],
            "peer": {"name": options.engine, "version": outcome.version, "differs": outcome.differs,
                     "touching_pairs": outcome.contacts},
            "warnings": []}


def _checks(ours: dict, start: Bodies, end: Bodies, outcome: Outcome) -> list[dict]:
    """The peer's bodies must end where ours do, hardly faster, and as many of them touch."""
    mass, contacts = start.mass, ours["counts"]["contacts"] / ours["counts"]["steps"]
    radius = ball_radius(mass)
    there = int(np.isfinite(outcome.position).all(axis=1).sum())
    away = np.median(np.linalg.norm(outcome.position - end.position, axis=1) / radius)
    speed, our_speed = (math.sqrt(mass @ np.sum(v ** 2, axis=1) / mass.sum()) for v in (outcome.velocity, end.velocity))
    allowed = our_speed + math.sqrt(2 * np.linalg.norm(start.gravity) * OTHER_FALL * radius.mean())
    return [
        {"what": "reference", "passed": ours["check"]["passed"], "detail": "dem_bench's own check of the same steps"},
        {"what": "bodies", "passed": there == len(mass), "detail": f"{there} of {len(mass)} bodies are somewhere"},
        {"what": "contacts", "passed": abs(outcome.contacts - contacts) <= OTHER_CONTACTS * contacts,
         "detail": f"{outcome.contacts} touching pairs at the end, {contacts:.0f} of ours in the mean"},
        {"what": "places", "passed": bool(away <= OTHER_PLACES),
         "detail": f"half of the bodies are within {away:.3g} radii of ours"},
        {"what": "speed", "passed": bool(speed <= allowed),
         "detail": f"{speed:.3g} m/s, root of the mean square; ours {our_speed:.3g} m/s, allowed {allowed:.3g} m/s"}]
