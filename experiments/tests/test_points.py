"""From a spec to its points: what varies, what makes a point another one, and which of them a command chooses."""
import json
import subprocess

import pytest

from sweep.aliases import import_ini
from sweep.errors import InputError
from sweep.points import expand, short_hash
from sweep.spec import read_spec
from sweep_bench import FIXED, Bench


def names(bench: Bench, **spec) -> list[str]:
    bench.write(**spec)
    return [point.name for point in expand(read_spec(bench.spec))]


def test_every_combination_is_a_point_and_the_last_axis_varies_fastest(bench):
    bench.write(axes={"grid": ["regular", "none"], "threads": [1, 2, 3]})
    names = [point.name for point in expand(read_spec(bench.spec))]
    assert names == [f"grid={g} threads={t}" for g in ("regular", "none") for t in (1, 2, 3)]


@pytest.mark.parametrize("given,values", [
    ({"from": 1, "to": 8, "factor": 2}, [1, 2, 4, 8]), ({"from": 10, "to": 25, "step": 5}, [10, 15, 20, 25]),
    ({"from": 10, "to": 24, "step": 5}, [10, 15, 20]), ({"from": 3, "to": 3, "step": 1}, [3])])
def test_a_range_is_written_out(bench, given, values):
    assert names(bench, axes={"particles": given}) == [f"particles={value}" for value in values]


def test_a_range_of_fractions_has_no_rounding_in_it(bench):
    assert names(bench, axes={"size_ratio": {"from": 1.1, "to": 1.4, "step": 0.1}}) == [
        f"size_ratio={value}" for value in (1.1, 1.2, 1.3, 1.4)]


def test_zipped_axes_advance_together(bench):
    assert names(bench, axes={"threads": [1, 2]}, zip=[{"particles": [250, 500], "vertices": [20, 10]}]) == [
        f"threads={t} particles={p} vertices={v}" for t in (1, 2) for p, v in ((250, 20), (500, 10))]


def test_excluded_combinations_are_no_points(bench):
    assert names(bench, axes={"scheme": ["serial", "plain"], "threads": [1, 2, 4]},
                 exclude=[{"scheme": "serial", "threads": [2, 4]}]) == [
        "scheme=serial threads=1", "scheme=plain threads=1", "scheme=plain threads=2", "scheme=plain threads=4"]


def test_a_preset_turns_an_axis_into_a_fixed_value_and_back(bench):
    bench.write(axes={"threads": [1, 2]}, presets={"quick": {"fixed": {"threads": 1}, "axes": {"steps": [5, 6]}}})
    assert [point.params for point in expand(read_spec(bench.spec, "quick"))] == [
        {"scene": "hopper", "kernel": "brute", "threads": 1, "steps": steps} for steps in (5, 6)]


@pytest.mark.parametrize("changes,message", [
    ({"axes": {"threads": {"from": 1, "to": 4}}}, "either 'step' or 'factor' (tried.json: axes.threads)"),
    ({"axes": {"threads": {"from": 1, "to": 4, "stepp": 1}}}, "Did you mean 'step'?"),
    ({"axes": {"threads": {"from": 1, "to": 4, "factor": 1}}}, "a range grows"),
    ({"axes": {"particles": {"from": 1, "to": 1e9, "step": 1}}}, "more than 10000 values"),
    ({"zip": [{"particles": [1, 2], "vertices": [1]}]}, "zip[0]: particles has 2, vertices has 1"),
    ({"zip": [{"particles": [1, 1], "vertices": [4, 4]}]}, "two points are the same"),
    ({"zip": [{"particles": [1, 2], "steps": [4, 5]}]}, "'steps' is given twice (tried.json: zip[0].steps)"),
    ({"exclude": [{"threds": 2}]}, "Did you mean 'threads'?"), ({"exclude": [{}]}, "leaves out every point"),
    ({"interleave": ["kernl"]}, "unknown parameter 'kernl' (tried.json: interleave[0]). Did you mean 'kernel'?"),
    ({"axes": {"grid": ["none"], "grid-type": ["no-grid"]}}, "are the same parameter (tried.json: axes)"),
    ({"axes": {"layers": ["grid", "grid+partcle"]}}, "(tried.json: axes.layers[1]). Did you mean 'grid+particle'?"),
    ({"program": "dem_bensch"}, "Did you mean 'dem_bench'?"), ({"memory_limit_mb": 0}, "a number above 0 MB")])
def test_a_wrong_spec_is_refused(bench, changes, message):
    bench.write(**changes)
    with pytest.raises(InputError) as error:
        expand(read_spec(bench.spec))
    assert message in str(error.value)


def test_a_points_identity_is_its_parameters_alone(bench):
    bench.write(axes={"threads": [1, 2]})
    plain = expand(read_spec(bench.spec))
    bench.spec.write_text(json.dumps({"title": "renamed", "axes": {"threads": [2, 1]}, "time_limit_s": 9,
                                      "fixed": dict(reversed(FIXED.items())), "presets": {"quick": {}}}))
    assert {point.id for point in plain} == {point.id for point in expand(read_spec(bench.spec))}
    assert short_hash({"b": 1, "a": "x"}) == "cdab067e9f3b"  # sha256sum of {"a":"x","b":1}
    bench.write(axes={"threads": [1, 2]}, presets={"quick": {"fixed": {"steps": 4}}})
    assert not {point.id for point in plain} & {point.id for point in expand(read_spec(bench.spec))}


def test_presets_that_agree_share_records(bench):
    bench.write(axes={"threads": [1, 2, 3]}, presets={"quick": {"axes": {"threads": [1, 2]}}})
    bench.run("run", "--quick")
    bench.run("run", "--full")
    assert len(bench.calls()) == 3


def test_a_changed_scene_file_is_another_point(bench):
    scene = bench.folder / "own.json"
    bench.write(fixed={"scene_file": "own.json", "steps": 1})
    scene.write_text("{}")
    before = expand(read_spec(bench.spec))[0].id
    scene.write_text("{ }")
    assert expand(read_spec(bench.spec))[0].id != before
    scene.unlink()
    assert "own.json" in bench.run("run", expect=3).stderr


def test_the_ancestors_names_make_the_same_points(bench):
    bench.write(axes={"grid": ["regular", "reluctant"], "threads": [1]}, fixed={**FIXED, "vertices": 20})
    ours = [point.id for point in expand(read_spec(bench.spec))]
    bench.write(axes={"grid-type": ["regular-grid", "reluctant-grid"], "tbb-core-count": [1]},
                fixed={"scenario": "hopper", "iterations": 3, "collision-model": "bf", "mesh-density": 20})
    assert [point.id for point in expand(read_spec(bench.spec))] == ours
    bench.run("run", "--only", "grid-type=regular-grid")
    assert len(bench.calls()) == 1


def test_an_option_file_of_the_ancestor_becomes_a_spec(bench):
    ini = bench.folder / "old.ini"
    ini.write_text("[jobs]\ntime = 10\n[parameters]\nscenario = hopperUniform1k\ngrid-type = regular-grid, reluctant-grid\n"
                   "iterations = 100\ngravity = true\n; a comment\n[parameters_grouped]\n"
                   "tbb-core-count = 1, 2\nmesh-density = 10,20\n")
    done = bench.run("run", "--dry-run", expect=3)  # there is no spec yet
    assert "cannot read the spec" in done.stderr
    command = bench.command("import")[:4] + [str(ini), "--out", str(bench.spec)]
    imported = subprocess.run(command, capture_output=True, text=True, env=bench.environment(), check=True)
    assert "[jobs] is left out" in imported.stderr and "gravity = true is left out" in imported.stderr
    assert [point.params for point in expand(read_spec(bench.spec))] == [
        {"scene": "hopper", "particles": 1000, "steps": 100, "grid": grid, "threads": t, "vertices": v}
        for grid in ("regular", "reluctant") for t, v in ((1, 10), (2, 20))]
    ini.write_text("[parameters]\nscenario = hopper\n[parameters_grouped]\ntbb-core-count = 1, 1, 2\nmesh-density = 10, 20, 10\n")
    assert import_ini(ini)[0]["zip"] == [{"threads": [1, 1, 2], "vertices": [10, 20, 10]}], "what advances together keeps its rows"
    ini.write_text("[parameters]\nscenario = hopper\n[parameters_grouped]\ntbb-core-count = 1, 2\n")
    assert import_ini(ini)[0]["axes"] == {"threads": [1, 2]}, "one list alone is an axis"
    for text, message in (("[parameters]\ngrid-typ = x\n", "Did you mean 'grid-type'?"), ("grid = x\n", "no option file"),
                          ("[jobs]\na = b\n", "there is no [parameters]")):
        ini.write_text(text)
        with pytest.raises(InputError) as error:
            import_ini(ini)
        assert message in str(error.value)


def test_shards_are_a_partition(bench):
    bench.write(axes={"threads": [1, 2, 3], "vertices": [10, 20, 40], "seed": [0]})
    for i in (1, 2, 3, 4):
        before = set(bench.records())
        bench.run("run", "--shard", f"{i}/4")
        assert before < set(bench.records())
    assert len(bench.calls()) == len(set(bench.calls())) == 9
    for wrong in ("0/4", "5/4", "4", "a/b"):
        assert "--shard" in bench.run("run", "--shard", wrong, expect=3).stderr


def test_only_lets_through_what_it_names(bench):
    bench.write(axes={"threads": [1, 2, 3], "vertices": [10, 20]})
    bench.run("run", "--only", "threads=1,3", "--only", "vertices=20")
    assert [name for name, state in bench.states().items() if state == "finished"] == [
        "threads=1 vertices=20", "threads=3 vertices=20"]
    assert "Did you mean 'threads'?" in bench.run("run", "--only", "thread=1", expect=3).stderr
    assert "threads = '9'" in bench.run("run", "--only", "threads=9", expect=3).stderr
