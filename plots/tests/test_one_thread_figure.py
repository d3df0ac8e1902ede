"""Ours beside other engines, read back from the table that the figure leaves."""
import csv

import figure_one_thread


def test_peers_stand_beside_ours_with_the_ratio_or_the_reason_why_not(made_up):
    points = made_up.sweep("figure_one_thread", {"engine": ["trigrain", "liggghts", "yade"]}, {"particles": 10, "vertices": 1})
    ours, peer, missing = points.values()
    made_up.change("figure_one_thread", ours["id"], counts={"contacts": 60, "steps": 2})
    samples = made_up.read("figure_one_thread", ours["id"])["samples"]
    made_up.change("figure_one_thread", peer["id"], samples=[{**each, "wall_s": 3 * each["wall_s"]} for each in samples],
                   peer={"name": "liggghts", "version": "3.8", "differs": "another law", "touching_pairs": 20})
    (made_up.folder / "figure_one_thread" / f"{missing['id']}.json").unlink()
    index = made_up.read("figure_one_thread", "index")
    index["points"][2] |= {"state": "not available in this build", "why": "engine 'yade': there is no program 'yade'"}
    made_up.write("figure_one_thread", "index", index)
    drawn = figure_one_thread.draw(made_up.folder, made_up.folder / "figures")
    with open(drawn.path("csv"), newline="", encoding="utf-8") as file:
        rows = {row["engine"]: row for row in csv.DictReader(file)}
    assert rows["trigrain"]["times_ours"] == "1" and rows["trigrain"]["contacts_per_body"] == "3"
    assert rows["liggghts"]["times_ours"] == "3" and rows["liggghts"]["contacts_per_body"] == "2"
    assert rows["yade"]["us_per_body"] == "" and "there is no program" in rows["yade"]["differs"]
    assert any("liggghts 3.8, grains: another law." in note for note in drawn.notes)
    assert any("engine=yade: not available in this build" in note for note in drawn.notes)
    assert "30 us, 3 x" in drawn.path("svg").read_text() and "not available in this build" in drawn.path("svg").read_text()
