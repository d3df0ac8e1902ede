"""Figures of kernel_bench's records: times, rates and errors where they belong, failures in the gutter."""
import csv
import subprocess
from pathlib import Path

import pytest

PLOTS = Path(__file__).resolve().parents[1]
BENCH = {"precision": "double", "lanes": 8, "steps": 4, "tolerance": 1e-3, "schedule": "constant", "batch": 8, "precheck": "box", "cuts": "adaptive"}
FOUND = {"flops_per_pair": 1400, "bytes_per_pair": 200, "peak_flop_s": 1e11, "bandwidth_B_s": 1e11, "roofline_ns_per_pair": 14,
         "error_p50_S": 0, "error_p99_S": 2e-16, "error_max_S": 3e-16, "wrong_share": 0, "wrong_unflagged_share": 0,
         "fall_back_share": 0.25, "believed_share": 1, "believed_wrong_share": 0.125, "proven_after_steps": [0.5, 0.25],
         "recall": 1, "contacts_per_pair": 3, "triangles_per_mesh": 80, "gap_error_radii": 0.1}


@pytest.fixture(name="bench")
def _bench(made_up):
    """Writes a sweep of kernel_bench and draws it; `changes` to points by kernel: ns, found, passed, and parameters."""
    def draw(name: str, points: list[dict]) -> tuple[list[dict], str]:
        index = []
        for number, each in enumerate(points):
            params = {**BENCH, "family": "every", **{k: v for k, v in each.items() if k not in ("ns", "found", "passed")}}
            id = f"{number:012x}"
            record = made_up.record(id, {"particles": 1, "vertices": 1})
            passed = each.get("passed", True)
            samples = [{"wall_s": 1e-9 * f * each["ns"] * 50, "cpu_s": 1e-9 * f * each["ns"] * 50, "pairs": 50} for f in (1.2, 1, 0.9)]
            made_up.write(name, id, {**record, "params": {**params, "lanes": params["lanes"] or 8}, "samples": samples if passed else [],
                                     "kernel": {**FOUND, **each.get("found", {})},
                                     "check": {"passed": passed, "how": [{"what": "answers", "passed": passed, "detail": ""}]}})
            index.append({"id": id, "name": str(number), "params": params, "state": "finished", "why": ""})
        made_up.write(name, "index", {"schema": "trigrain-index-1", "spec": name, "preset": "quick", "title": name, "about": "",
                                      "elsewhere": [], "points": index})
        subprocess.run(["/usr/bin/python3", PLOTS / f"{name}.py", "--results", made_up.folder], check=True, capture_output=True)
        with open(made_up.folder / f"figures/{name}.csv", encoding="utf-8") as file:
            return list(csv.DictReader(file)), (made_up.folder / f"figures/{name}.svg").read_text()

    return draw


def test_rates_stand_beside_the_printed_table(bench):
    rows, svg = bench("figure_kernels", [{"family": "random_mixed", "kernel": "brute", "lanes": 1, "ns": 700},
                                         {"family": "random_mixed", "kernel": "iterative", "lanes": 0, "ns": 50},
                                         {"kernel": "brute-simd", "lanes": 0, "ns": 20}])
    assert float(rows[0]["median_ns"]) == pytest.approx(700) and float(rows[0]["mflop_s"]) == pytest.approx(2000)
    assert float(rows[0]["peak_share"]) == pytest.approx(0.02)
    for text in ("22.49 s", "962", "7.00 s", "2,000", "2.0%", "4.54 s", "0.50 s", "28,000", "28.0%", "2e-16 S"):
        assert f">{text}<" in svg, text
    assert "100 GFLOP/s, 100 GB/s" in svg and svg.count(">-<") == 2 * 4, "two printed rows were not run here"


def test_what_failed_or_answers_no_number_is_in_the_gutter(bench, made_up, monkeypatch):
    rows, svg = bench("figure_w_1", [{"kernel": "brute", "ns": 500}, {"kernel": "bullet", "ns": 900, "found": {"error_p99_S": None}},
                                   {"kernel": "hybrid-pair", "ns": 400, "passed": False}])
    assert [row["state"] for row in rows] == ["finished", "finished", "check failed"]
    assert float(rows[0]["error_p99_S"]) == 2e-16 and rows[1]["error_p99_S"] == "" and rows[2]["median_ns"] == ""
    monkeypatch.chdir(PLOTS)
    import figure_w_1
    from matplotlib.figure import Figure
    from records import load_sweep
    axes = Figure().subplots()
    figure_w_1._panel(axes, "every", load_sweep(made_up.folder, "figure_w_1").points)
    heights = [line.get_ydata()[0] for line in axes.lines if line.get_marker() not in ("None", None, "")]
    assert heights == [2e-16, figure_w_1.GUTTER] and "failed: hybrid-pair" in svg, "what failed its check has no time"


def test_the_fastest_kernel_of_each_reach_is_named(bench):
    near, far = {"family": "near_vf", "reach_m": 0.01}, {"family": "near_vf", "reach_m": 1e9}
    rows, svg = bench("figure_reach", [{**near, "kernel": "brute-simd", "ns": 20}, {**near, "kernel": "hybrid-pair", "ns": 10},
                                       {**far, "kernel": "brute-simd", "ns": 20}, {**far, "kernel": "hybrid-pair", "ns": 30},
                                       {**far, "kernel": "brute", "ns": 1, "passed": False}])
    assert [row["fastest"] for row in rows] == ["", "yes", "yes", "", ""], "what failed its check does not win"
    assert "brute-simd double, 8 lanes" in svg and "hybrid-pair, 4 steps" in svg and ">none<" in svg


def test_mesh_pairs_are_compared_with_fcl(bench):
    rows, svg = bench("figure_w_2", [{"kernel": "brute-simd", "ns": 1000}, {"kernel": "fcl", "ns": 5000, "found": {"recall": 0.125}}])
    assert [float(row["times_fcl"]) for row in rows] == [5, 1] and float(rows[1]["recall"]) == 0.125
    assert float(rows[0]["median_us_per_mesh_pair"]) == pytest.approx(1) and "brute-simd double box" in svg


def test_growth_has_a_row_for_every_size(bench):
    rows, _ = bench("figure_w_5", [
        {"kernel": "brute-simd", "family": f"spheres_{size}", "ns": 10 * size, "found": {"triangles_per_mesh": size}}
        for size in (80, 320)])
    assert [(row["triangles_per_mesh"], float(row["median_us"])) for row in rows] == [("80", 0.8), ("320", 3.2)]
