"""What the figures of the grids show, read back from the files they write."""
import base64
import csv
import importlib
import struct

import pytest

from conftest import vtp
from figure import Drawn

COLUMNS = ("time_s", "step_s", "wall_s", "candidate_pairs", "body_pairs", "contacts", "visited_vertices", "cells",
           "refinements", "coarsenings")


def draw(name: str, made_up) -> Drawn:
    return importlib.import_module(name).draw(made_up.folder, made_up.folder / "figures")


def rows(drawn: Drawn) -> list[dict[str, str]]:
    with open(drawn.path("csv"), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def history(pairs: int, every: int = 2) -> dict:
    return {"every": every, **{key: [pairs if key == "candidate_pairs" else 0.5 * i for i in range(1, 4)] for key in COLUMNS}}


def counts(**values: int) -> dict:
    return {"steps": 7, "candidate_pairs": 0, "crossings": 0, "searches": 7, **values}


def sweep(made_up, name: str, axes: dict, fixed: dict, change) -> None:
    """Made-up records, each with what `change(params)` adds."""
    for point in made_up.sweep(name, axes, {"particles": 10, "vertices": 1, **fixed}).values():
        made_up.change(name, point["id"], **change(point["params"]))


def test_two_bodies_ratios_are_of_median_wall_times(made_up):
    factor = {"regular-dense": 60, "regular": 1, "reluctant": 2}
    sweep(made_up, "figure_g_1", {"grid": list(factor)}, {}, lambda params: {
        "history": history(1), "samples": [{"wall_s": s * factor[params["grid"]], "steps": 6} for s in (1, 5 + factor[params["grid"]], 2)]})
    drawn = draw("figure_g_1", made_up)
    assert any("regular-dense : reluctant = 30 : 1" in note for note in drawn.notes)
    assert [row["wall_so_far_s"] for row in rows(drawn) if row["grid"] == "regular"] == ["0.5", "1.5", "3"]


def test_comparisons_are_per_body_and_step(made_up):
    pairs = {"regular": 2000, "reluctant": 20}
    sweep(made_up, "figure_g_2", {"grid": list(pairs)}, {"size_ratio": 20, "gravity": 0},
          lambda params: {"history": history(pairs[params["grid"]])})
    drawn = draw("figure_g_2", made_up)
    assert {row["compared_per_body"] for row in rows(drawn) if row["grid"] == "regular"} == {"100"}  # 2000 / 2 / 10
    assert any("regular 100, reluctant 1 " in note and "+2.00 orders" in note for note in drawn.notes)


def test_steps_saved_are_against_the_fixed_step(made_up):
    sweep(made_up, "figure_g_4", {"scene": ["hopper", "gas"]}, {"fill": 0.5, "end_s": 1}, lambda _: {
        "history": history(1), "counts": counts(steps=25000)})  # of 1 s / 1e-5 s
    assert [row["share_saved"] for row in rows(draw("figure_g_4", made_up))] == ["0.75", "0.75"]


def test_cost_has_slope_memory_and_comparisons_saved(made_up):
    sweep(made_up, "figure_g_5", {"grid": ["regular"], "skin": [0], "particles": [1000, 10000]}, {}, lambda params: {
        "counts": counts(candidate_pairs=7 * 999 * 50), "heap_bytes": 300 * params["particles"],
        "samples": [{"wall_s": 7e-3 * params["particles"], "steps": 7, "phases_s": {"grid": 7, "detect": 7}}]})
    drawn = draw("figure_g_5", made_up)
    assert any("bodies^1.00" in note for note in drawn.notes)
    assert any("90.0 % of the comparisons" in note for note in drawn.notes)
    assert [row["heap_bytes_per_body"] for row in rows(drawn)] == ["300.0", "300.0"]


def test_share_is_of_grid_and_search_and_old_records_have_none(made_up):
    phases = {"grid": 0.07, "detect": 3.5, "merge": 1.0, "forces": 1.03, "integrate": 1.4}
    sample = {"wall_s": 7.0, "steps": 7, "phases_s": phases, "search_s": 0.04}  # of one step: .01 + .04 of 1 s
    old = {key: value for key, value in sample.items() if key != "search_s"}
    sweep(made_up, "figure_g_6", {"skin": [0, 0.1], "grid": ["regular"]}, {"scene": "hopper"}, lambda params: {
        "counts": counts(candidate_pairs=70, contacts=7), "samples": [sample if params["skin"] == 0 else old]})
    drawn = draw("figure_g_6", made_up)
    assert [row["share_of_grid_and_search"] for row in rows(drawn)] == ["0.05"]
    assert float(rows(drawn)[0]["comparison_us_per_body"]) == pytest.approx(1e6 * (0.5 - 0.04) / 10)
    assert "5.0 % of the step, within the bar" in drawn.notes[0]


def test_subdivisions_are_means_over_steps(made_up):
    sweep(made_up, "figure_g_7", {"subdivision": [2, 3]}, {"size_ratio": 20, "grid": "reluctant"}, lambda params: {
        "counts": counts(candidate_pairs=70 * params["subdivision"], levels=7 * 5, cells=700, virtual_copies=7, refinements=14,
                         coarsenings=21, settled_bodies=28),
        "samples": [{"wall_s": 7e-5 * params["subdivision"], "steps": 7}]})
    drawn = draw("figure_g_7", made_up)
    assert [(row["k"], row["levels"], row["cells"], row["refinements_per_step"]) for row in rows(drawn)] == [
        ("2", "5.0", "100.0", "2.0"), ("3", "5.0", "100.0", "2.0")]
    assert "compared per body and step 2 and 3; time k = 2 : k = 3 = 0.67." in drawn.notes[0]


def vtu(cells: list[tuple[list[float], list[float], int]]) -> str:
    """Cells as dem_bench writes them: (lower corner, upper corner, level)."""
    appended, tags = "", []
    corners = [[(low, high)[i >> axis & 1][axis] for axis in range(3)] for low, high, _ in cells for i in range(8)]
    for kind, code, name, values in (("Float64", "d", "position_m", [x for corner in corners for x in corner]),
                                     ("Int64", "q", "connectivity", list(range(len(corners)))),
                                     ("Int32", "i", "level", [level for *_, level in cells])):
        raw = struct.pack(f"<{len(values)}{code}", *values)
        tags.append(f'<DataArray type="{kind}" Name="{name}" format="appended" offset="{len(appended)}"/>')
        appended += base64.b64encode(struct.pack("<Q", len(raw)) + raw).decode()
    return f'<VTKFile>{"".join(tags)}<AppendedData encoding="base64">\n_{appended}\n</AppendedData></VTKFile>'


@pytest.mark.parametrize("there", [True, False])
def test_slices_count_the_cells_that_the_plane_cuts(made_up, there):
    points = made_up.sweep("figure_g_3", {"grid": ["regular"]}, {"particles": 1, "vertices": 0})
    folder = made_up.folder / "figure_g_3/frames" / next(iter(points.values()))["id"]
    folder.mkdir(parents=True)
    triangle = [[0.4, 0.4, 0.5], [0.6, 0.4, 0.5], [0.5, 0.6, 0.5]]
    for listing, file, text in (("frames", "f.vtp", vtp([triangle] * 3, [0, 1, 2], [0.0, 0.0, 1.0])),
                                ("grid", "g.vtu", vtu([([0, 0, 0], [1, 1, 0.6], 1), ([0, 0, 0.6], [1, 1, 1], 1)]))):
        (folder / file).write_text(text)
        if there:
            (folder / f"{listing}.pvd").write_text("<VTKFile><Collection>" + "".join(
                f'<DataSet timestep="{t}" file="{file}"/>' for t in (0, 0.1, 0.2, 0.3)) + "</Collection></VTKFile>")
    if there:
        assert [(row["cells"], row["cells_in_slice"]) for row in rows(draw("figure_g_3", made_up))] == [("2", "1")] * 3
    else:
        with pytest.raises(Exception, match="cannot read the frames"):
            draw("figure_g_3", made_up)
