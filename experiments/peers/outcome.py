"""What a peer is asked for and what it answers."""
from dataclasses import dataclass

import numpy as np

# How spheres of other engines differ from ours, up to where they start from.
OF_SPHERES = ("the same linear spring, dashpot and Coulomb friction; radii include the halo, so that the levers of friction and the "
              "moments of inertia are larger; ")


class Unable(Exception):
    """The peer cannot run this point here; says why."""


@dataclass(frozen=True)
class Run:
    """`repeats` samples of `steps` after `warmup` steps; `skin`: of the neighbour list, in diameters of the smallest body."""
    steps: int
    warmup: int
    repeats: int
    skin: float

    @property
    def all_steps(self) -> int:
        return self.warmup + self.steps * self.repeats


@dataclass(frozen=True)
class Outcome:
    """Wall time (s) of each sample; `contacts`: touching pairs after the last step, when bodies are at `position` (m) with
    `velocity` (m/s), in the order they were handed over. `differs`: how its model is not ours."""
    version: str
    differs: str
    wall_s: list[float]
    contacts: int
    position: np.ndarray
    velocity: np.ndarray
