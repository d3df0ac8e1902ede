"""The report in five sentences."""
from collections import Counter

from figure import Drawn
from records import DRAWN, EXPECTED, Point


def sentences(drawn: dict[str, Drawn], absent: dict[str, str], claims: list[dict]) -> list[str]:
    """What was measured and where, what was verified, what is missing, what became of the claims, and the counters."""
    points = [point for each in drawn.values() for point in each.sweep.points]
    return [_measured(drawn, points), _verified(points), _missing(points, absent), _claims(claims), _counters(points)]


def _measured(drawn: dict[str, Drawn], points: list[Point]) -> str:
    records = [point.record for point in points if point.state == DRAWN]
    if not records:
        return "Nothing has been measured yet."
    machines = dict.fromkeys(f"{record['machine']['cpu']} ({record['machine']['cores']} cores)" for record in records)
    commits = dict.fromkeys((record["build"]["commit"] or "unknown")[:10] for record in records)
    presets = dict.fromkeys(each.sweep.preset for each in drawn.values())
    return (f"{_count(len(drawn), 'figure')} from {_count(len(records), 'measured point')} (preset {', '.join(presets)}), "
            f"run on {' and '.join(machines)} at commit {', '.join(commits)}.")


def _verified(points: list[Point]) -> str:
    checks = [how["passed"] for point in points if point.state != EXPECTED
              for how in (point.record or {}).get("check", {}).get("how", [])]
    if not checks:
        return "No answer has been verified."
    if all(checks):
        baselines = sum(point.state == EXPECTED for point in points)
        known = f" ({_count(baselines, 'baseline')} known to be wrong left out)" if baselines else ""
        return f"All {len(checks)} checks of the answers passed{known}; a point that fails one is not drawn."
    return f"{checks.count(False)} of {len(checks)} checks of the answers FAILED; those points are not drawn."


def _missing(points: list[Point], absent: dict[str, str]) -> str:
    states = Counter(point.state for point in points if point.state != DRAWN)
    missing = [f"{_count(number, 'point')} ({state})" for state, number in states.items()]
    if absent:
        missing.append(f"{_count(len(absent), 'figure')} (not run)")
    return f"Not drawn: {', '.join(missing)}." if missing else "No point is missing."


def _claims(claims: list[dict]) -> str:
    if not claims:
        return "The published claims have not been tested here (tools/claims does)."
    verdicts = Counter(row["verdict"] for row in claims)
    return (f"Of {len(claims)} published claims {verdicts['PASS']} hold here, {verdicts['FAIL']} fail and "
            f"{verdicts['NOT-TESTABLE-HERE']} cannot be tested on this machine.")


def _counters(points: list[Point]) -> str:
    counters = [each for point in points if point.state == DRAWN for each in point.record.get("counters", {}).values()]
    sources = dict.fromkeys(each["source"] for each in counters if each["status"] == "measured")
    if sources:
        return f"Hardware counters were read by {' and '.join(sources)}."
    reasons = dict.fromkeys(each["reason"] for each in counters)
    return f"Hardware counters are unavailable here{f' ({next(iter(reasons))})' if reasons else ''}."


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
