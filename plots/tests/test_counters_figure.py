"""Figure of the counters: measured values per phase, and "unavailable" with its reason where nobody counted."""
import csv
import json
import subprocess
from pathlib import Path

import pytest

PLOTS = Path(__file__).resolve().parents[1]
PHASES = {"grid": 1e-3, "detect": 6e-3, "merge": 1e-3, "forces": 1e-3, "integrate": 1e-3}
UNAVAILABLE = {"value": None, "source": None, "status": "unavailable", "reason": "likwid: Unsupported Processor"}


def measured(value: float) -> dict:
    return {"value": value, "source": "likwid", "status": "measured", "reason": None}


@pytest.fixture(name="drawn")
def _drawn(made_up):
    """Draws two kernels, the first with these counters, `wrong` with a failed check; returns the table of the CSV, the SVG's text and what was said."""
    def draw(counters: dict | None, wrong: str = "") -> tuple[list[dict], str, str]:
        points = made_up.sweep("figure_counters", {"kernel": ["brute", "hybrid-pair"]}, {"particles": 10, "vertices": 10})
        for point in points.values():
            made_up.change("figure_counters", point["id"], counters={}, counts=dict.fromkeys(
                ("steps", "candidate_pairs", "triangle_pairs", "newton_steps", "fall_backs", "contacts"), 4), samples=[
                    {"wall_s": 10e-3, "cpu_s": 10e-3, "steps": 4, "phases_s": PHASES, "load_average_1min": 0}])
        for point in points.values():
            if point["params"]["kernel"] == wrong:
                made_up.change("figure_counters", point["id"], samples=[], counts=None, check={"passed": False, "how": [
                    {"what": "kernel", "passed": False, "detail": ""}]})
                index = made_up.read("figure_counters", "index")
                for each in index["points"]:
                    each["expected_failure"] = {"where": {}, "check": "kernel", "why": "known"}
                made_up.write("figure_counters", "index", index)
        if counters:
            id = next(iter(points.values()))["id"]
            made_up.write("figure_counters/counters", id, {"schema": "trigrain-counters-1", "point_id": id, "steps": 4, **counters})
        done = subprocess.run(["/usr/bin/python3", PLOTS / "figure_counters.py", "--results", made_up.folder], capture_output=True,
                              text=True, check=True)
        folder = made_up.folder / "figures"
        with open(folder / "figure_counters.csv", encoding="utf-8") as file:
            return list(csv.DictReader(file)), (folder / "figure_counters.svg").read_text(), done.stdout

    return draw


def test_measured_values_are_shown_per_phase_and_as_the_published_table_has_them(drawn):
    whole = {"instructions": measured(8e6), "cycles": measured(4e6), "flops_dp": measured(2e7), "dram_bytes": measured(1e7)}
    table, svg, _ = drawn({"whole": whole, "phases": {"detect": {"instructions": measured(8e6)}}})
    of = {(row["kernel"], row["phase"], row["quantity"]): row for row in table}
    assert of["brute", "detect", "instructions"]["per step"] == "2000000"
    assert of["brute", "detect", "instructions"]["source"] == "likwid"
    assert float(of["brute", "detect", "wall time"]["per step"]) == pytest.approx(1500)
    for text in ("2.5 ms per step", "2,000", "0.5", "1,000", "P17: BF"):  # runtime, MFLOP/s, CPI, MB/s
        assert f">{text}<" in svg, text


def test_a_baseline_whose_answers_are_wrong_has_a_place_and_no_time(drawn):
    table, svg, said = drawn(None, wrong="hybrid-pair")
    row, = (row for row in table if row["kernel"] == "hybrid-pair")
    assert row["per step"] == "" and row["reason"] == "check failed as expected: kernel: known"
    assert svg.count(">answers wrong<") == 1 and svg.count(">answers wrong:<") == 2
    assert "hybrid-pair: check failed as expected (kernel: known)." in said


def test_what_nobody_counted_is_unavailable_with_its_reason_and_never_0(drawn):
    table, svg, said = drawn({"whole": {"instructions": UNAVAILABLE, "cycles": UNAVAILABLE}, "phases": {}})
    row = next(row for row in table if row["quantity"] == "cycles")
    assert row["per step"] == "" and row["reason"] == "likwid: Unsupported Processor"
    assert svg.count(">unavailable<") == 2 + 2 * 3 and "Unavailable here: likwid: Unsupported Processor." in said
    assert "run sweep counters figure_counters" in said, "the second kernel has not been counted"
    assert json.dumps(table).count('"algorithm"') == 2 * 5
