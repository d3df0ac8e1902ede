"""Figure 8.7: bars, shares and missing traces from made-up steps."""
import csv
import json
import subprocess
from pathlib import Path

import pytest

PLOTS = Path(__file__).resolve().parents[1]


def event(name: str, begin: float, length: float, tid: int, step: int, phase: str = "detect") -> dict:
    return {"name": name, "ph": "X", "ts": begin, "dur": length, "tid": tid, "args": {"step": step, "phase": phase}}


def trace() -> dict:
    """Three steps of 100, 200 and 400 us on threads 7 and 9: traversal, comparisons, a loop and a serial piece."""
    events = []
    for step, unit in enumerate((1.0, 2.0, 4.0)):
        at = 1000.0 * step
        events += [event("traverse", at, 10 * unit, 7, step), event("compare", at + 5 * unit, 65 * unit, 9, step),
                   event("spawn", at + 10 * unit, 0, 7, step), event("part", at + 10 * unit, 60 * unit, 7, step),
                   event("serial", at + 70 * unit, 10 * unit, 7, step, "merge"),
                   event("loop", at + 80 * unit, 20 * unit, 7, step, "forces"), event("loop", at + 80 * unit, 20 * unit, 9, step, "forces")]
    return {"traceEvents": events, "otherData": {}}


@pytest.fixture(name="draw")
def _draw(made_up):
    """Draws one point of two threads with this text as its trace."""
    def draw(text: str) -> subprocess.CompletedProcess:
        points = made_up.sweep("figure_8_7", {"threads": [2]}, {"particles": 10, "vertices": 10})
        folder = made_up.folder / "figure_8_7/traces"
        folder.mkdir()
        (folder / f"{next(iter(points.values()))['id']}.json").write_text(text)
        return subprocess.run(["/usr/bin/python3", PLOTS / "figure_8_7.py", "--results", made_up.folder], capture_output=True, text=True)
    return draw


def test_the_step_of_median_time_is_drawn_and_its_shares_add_up(draw, made_up):
    done = draw(json.dumps(trace()))
    assert done.returncode == 0, done.stderr
    assert "62.5 % of the threads' time compares bodies, 5.0 % traverses" in done.stdout
    assert "works for 10.00 % of the step, 7.5 % is idle" in done.stdout
    with open(made_up.folder / "figures/figure_8_7.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {row["step"] for row in rows} == {"1"} and {row["thread"] for row in rows} == {"0", "1"}
    assert sum(float(row["length_us"]) for row in rows if row["what"] == "compare") == 250
    drawn = {path.name: path.read_bytes() for path in (made_up.folder / "figures").iterdir()}
    subprocess.run(["/usr/bin/python3", PLOTS / "figure_8_7.py", "--results", made_up.folder], check=True, capture_output=True)
    assert drawn == {path.name: path.read_bytes() for path in (made_up.folder / "figures").iterdir()}, "the same records, the same bytes"


@pytest.mark.parametrize("text", ["", "{}", '{"traceEvents": []}'])
def test_a_broken_trace_is_told(draw, text):
    done = draw(text)
    assert done.returncode == 3 and "cannot read the trace" in done.stderr
