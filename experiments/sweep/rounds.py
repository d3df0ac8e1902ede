"""A point whose repeats are processes of their own, so that the repeats of compared points can take turns."""
from dataclasses import dataclass, field, replace
from typing import Any

from sweep.points import Point


@dataclass
class Rounds:
    """Records of one repeat each; `took_s` sums up how long the processes ran."""
    point: Point
    records: list[dict] = field(default_factory=list)
    took_s: float = 0.0

    @property
    def wanted(self) -> int:
        return self.point.params.get("repeats", 1)

    def next_point(self) -> Point:
        """The point with one repeat. The first checks all that is to be checked; the others must only end in the same
        state, and check a single step."""
        once = {**self.point.params, "repeats": 1}
        if self.records and "check_steps" in once:
            once["check_steps"] = 1
        return replace(self.point, params=once)

    def joined(self) -> dict[str, Any]:
        """One record of all repeats: every sample, checked all through, hardware events averaged."""
        first = self.records[0]
        samples = [sample for record in self.records for sample in record["samples"]]
        states = {record.get("state_hash") for record in self.records}
        passed = len(states) == 1 and all(record["check"]["passed"] for record in self.records)
        how = {"what": "interleaved", "passed": len(states) == 1,
               "detail": f"{len(self.records)} processes in turn with those of compared points, distinct last states: "
                         f"{len(states)}"}
        warnings = dict.fromkeys(text for record in self.records for text in record.get("warnings", []))
        failed = [item for record in self.records[1:] for item in record["check"].get("how", []) if not item["passed"]]
        return {**first, "params": {**first["params"], "repeats": len(self.records)},
                "check": {"passed": passed, "how": [*first["check"].get("how", []), *failed, how]}, "samples": samples,
                "counters": _mean_counters([record.get("counters", {}) for record in self.records]),
                "warnings": list(warnings)}


def _mean_counters(counters: list[dict]) -> dict:
    """Per metric the mean if every repeat measured it, else the first that did not."""
    joined = {}
    for name, first in counters[0].items():
        absent = next((each[name] for each in counters if each[name]["status"] != "measured"), None)
        mean = None if absent else sum(each[name]["value"] for each in counters) / len(counters)
        joined[name] = absent or {**first, "value": mean}
    return joined
