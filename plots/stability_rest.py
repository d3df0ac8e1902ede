#!/usr/bin/python3
"""A cube at rest, a block on a slope: drift, turn, kinetic energy and creep over up to a million steps."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

from figure import Drawn, command_line
from stability import RULES, Line, Panel, by_rule, draw_panels, worst

NAME = "stability_rest"
PANELS = [
    Panel(by_rule("long-rest", "drift_m"), "steps", "drift (m)", floor=1e-18),
    Panel(by_rule("long-rest", "turn_rad"), "steps", "turn (rad)", floor=1e-18),
    Panel(by_rule("long-rest", "kinetic_of_m_g_overlap"), "steps", "kinetic energy / (m g overlap)", floor=1e-30),
    Panel([*by_rule("slope-rest", "creep_m"),
           Line("friction without springs (theory)", "slope-rest", "creep_without_springs_m", {"contact_rule": "features"})],
          "steps", "creep at 20 degrees, mu = .5 (m)", floor=1e-18),
]


def notes(sweep) -> list[str]:
    def of(study: str, metric: str, rule: str) -> float:
        return worst(sweep, Line("", study, metric, {"contact_rule": rule}))
    return [f"{rule}: a cube drifts by {of('long-rest', 'drift_m', rule):.1e} m, a block on a slope creeps by "
            f"{of('slope-rest', 'creep_m', rule):.1e} m." for rule in RULES]


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/stability_rest, writes OUT/stability_rest.svg, .png and .csv."""
    return draw_panels(NAME, PANELS, notes, results, out, columns=2)


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
