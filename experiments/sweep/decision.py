"""Whether one build is slower than another, from CPU times of fixed work that were taken in turn."""
import itertools
import math
import random
import statistics
from dataclasses import dataclass

SAME, FASTER, SLOWER, UNSTABLE = "same", "faster", "slower", "unstable"
LEAST_CHANGE = 0.03  # of CPU time
LEAST_COUNT_CHANGE = 0.005  # of exact counts; of instructions if the CPU time went the same way
INSTRUCTIONS_ALONE = 0.02  # of instructions where the CPU time does not tell: neighbouring commits differed by .11 % at most
SIGNIFICANCE = 0.01
LEAST_PAIRS = 15
NOISE_TO_STOP = 0.01  # so that a change of 5 % is hardly ever measured as one below LEAST_CHANGE
EXACT_UP_TO = 14  # pairs: 2^14 sign patterns are all tried, of more pairs so many at random
SEED = 20180115


@dataclass(frozen=True)
class Decision:
    """`change`: relative change of CPU time; `p`: probability of such a change if both were the same; `noise`: how large
    a change the scatter alone makes in 19 of 20 cases."""
    verdict: str
    change: float
    p: float
    noise: float

    @property
    def direction(self) -> int:
        """1 if the CPU time rose for certain, by however little, -1 if it fell, 0 if it does not tell."""
        return 0 if self.p >= SIGNIFICANCE else 1 if self.change > 0 else -1


def decide(before: list[float], after: list[float]) -> Decision:
    """From pairs of CPU times (s). A change needs significance and size; where the noise hides a change of the size
    that counts, and none larger was found, the answer is "unstable"."""
    ratios = [math.log(b / a) for a, b in zip(before, after, strict=True)]
    if len(ratios) < LEAST_PAIRS:
        return Decision(UNSTABLE, math.expm1(_middle(ratios)) if ratios else 0.0, 1.0, math.inf)
    found = _middle(ratios)
    p = _share_as_large(ratios, abs(found))
    noise = _quantile95([r - found for r in ratios])
    change = math.expm1(found)
    if p < SIGNIFICANCE and abs(change) >= LEAST_CHANGE:
        verdict = SLOWER if change > 0 else FASTER
    else:
        verdict = UNSTABLE if noise > LEAST_CHANGE else SAME
    return Decision(verdict, change, p, math.expm1(noise))


def with_counts(decision: Decision, instructions: float, work: float) -> str:
    """The verdict of CPU time and exact counts: `instructions` and `work`, the algorithmic count that rose most, are relative
    changes. Time decides where it can. Instructions tell if time went their way, or from a bar on that the same work in other
    machine code does not reach; more work of one kind tells unless it paid off. Neither tells against the time."""
    if decision.verdict in (SLOWER, FASTER):
        return decision.verdict
    for verdict, sign in ((SLOWER, 1), (FASTER, -1)):
        bar = LEAST_COUNT_CHANGE if decision.direction == sign else INSTRUCTIONS_ALONE
        if sign * instructions >= bar and decision.direction != -sign:
            return verdict
    paid_off = decision.direction < 0 or instructions <= -LEAST_COUNT_CHANGE
    return SLOWER if work >= LEAST_COUNT_CHANGE and not paid_off else decision.verdict


def exact_change(before: float | None, after: float | None) -> float | None:
    """Relative change of a count; None if one is unknown or both are 0."""
    if before is None or after is None or before == after == 0:
        return None
    return math.inf if before == 0 else after / before - 1


def _middle(ratios: list[float]) -> float:
    """Mean without the fifth at each end: other work on the machine disturbs single runs by much."""
    cut = len(ratios) // 5
    return statistics.fmean(sorted(ratios)[cut:len(ratios) - cut])


def _middles_by_chance(ratios: list[float]) -> list[float]:
    """If both builds are the same, each pair could as well have come out the other way round."""
    if len(ratios) <= EXACT_UP_TO:
        patterns = itertools.product((1, -1), repeat=len(ratios))
    else:
        chance = random.Random(SEED)
        patterns = ([chance.choice((1, -1)) for _ in ratios] for _ in range(4000))
    return [abs(_middle([sign * r for sign, r in zip(signs, ratios)])) for signs in patterns]


def _share_as_large(ratios: list[float], found: float) -> float:
    by_chance = _middles_by_chance(ratios)
    return (1 + sum(middle >= found * (1 - 1e-12) for middle in by_chance)) / (1 + len(by_chance))


def _quantile95(centred: list[float]) -> float:
    by_chance = sorted(_middles_by_chance(centred))
    return by_chance[int(0.95 * (len(by_chance) - 1))]
