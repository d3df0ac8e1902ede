"""Results in the formats of others, and the adapters to other runners."""
import builtins
import csv
import io
import json
import os
import re
import resource
import runpy
import shlex
import shutil
import signal
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from types import SimpleNamespace

import pytest

from sweep.errors import InputError
from sweep.exchange import read_google_benchmark
from sweep.regression import compare_benchmarks
from sweep_bench import Bench

EXPERIMENTS = Path(__file__).resolve().parents[1]
ROOT = EXPERIMENTS.parent


@pytest.fixture(name="bench")
def _bench(tmp_path) -> Bench:
    """Two points that finished and one whose check failed."""
    bench = Bench(tmp_path)
    bench.write(fixed={"scene": "hopper", "steps": 4, "repeats": 3}, axes={"threads": [1, 2]}, zip=[
        {"seed": [0, 5], "kernel": ["brute", "hybrid-pair"]}], exclude=[{"seed": 5, "threads": 2}])
    bench.run("run", expect=1)
    return bench


def exported(bench: Bench, kind: str) -> str:
    return bench.run("export", "--format", kind).stdout


def test_csv_and_json_lines_have_a_row_per_sample_of_what_passed(bench):
    table = list(csv.DictReader(io.StringIO(exported(bench, "csv"))))
    assert len(table) == 2 * 3 and {row["param.threads"] for row in table} == {"1", "2"}
    assert all(float(row["wall_s"]) == 1.0 and row["steps"] == "4" for row in table)
    lines = [json.loads(line) for line in exported(bench, "jsonl").splitlines()]
    assert [line["point_id"] for line in lines] == [row["point_id"] for row in table]


def test_pandas_reads_the_lines(bench):
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_json(io.StringIO(exported(bench, "jsonl")), lines=True)
    assert len(frame) == 6 and frame.groupby("point_id").wall_s.median().tolist() == [1.0, 1.0]


def test_export_writes_a_file(bench):
    bench.run("export", "--only", "threads=2", "--out", str(bench.folder / "o.csv"))
    assert len((bench.folder / "o.csv").read_text().splitlines()) == 1 + 3


def test_an_export_that_does_not_fit_leaves_no_file(bench):
    def limit() -> None:  # stands for a full disk
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (300, 300))

    out = bench.folder / "mine.csv"
    done = subprocess.run(bench.command("export", "--out", str(out)), capture_output=True, text=True, env=bench.environment(),
                          check=False, preexec_fn=limit)
    assert done.returncode == 4 and str(out) in done.stderr and "Traceback" not in done.stderr
    assert not list(bench.folder.glob("mine*"))


def test_what_goes_out_as_google_benchmark_comes_in_again(bench):
    path = bench.folder / "b.json"
    path.write_text(exported(bench, "google-benchmark"))
    found = read_google_benchmark(path)
    assert found == {f"tried/threads={n}/seed=0/kernel=brute": pytest.approx([1 / 4] * 3) for n in (1, 2)}


BENCHMARK = {"name": "a", "run_name": "a", "run_type": "iteration", "cpu_time": 2.0, "time_unit": "us"}


def test_aggregates_and_errors_are_left_out(tmp_path):
    path = tmp_path / "b.json"
    path.write_text(json.dumps({"benchmarks": [BENCHMARK, {**BENCHMARK, "run_type": "aggregate"}, {
        **BENCHMARK, "error_occurred": True}, {**BENCHMARK, "name": "b", "run_name": "b", "time_unit": "ms"}]}))
    assert read_google_benchmark(path) == {"a": [2e-6], "b": [2e-3]}


@pytest.mark.parametrize("text", ["{", "[]", '{"benchmarks": []}', '{"benchmarks": [{"name": "a"}]}'])
def test_other_files_are_refused(tmp_path, text):
    (tmp_path / "b.json").write_text(text)
    with pytest.raises(InputError, match="b.json"):
        read_google_benchmark(tmp_path / "b.json")


def test_two_files_are_compared_by_name(tmp_path):
    for name, factor in (("old", 1.0), ("new", 1.1)):
        both = [{**BENCHMARK, "run_name": run, "cpu_time": (factor if run == "b" else 1.0) * (1 + 1e-3 * (i % 5))}
                for run in "ab" for i in range(20)]
        (tmp_path / f"{name}.json").write_text(json.dumps({"benchmarks": both}))
    found = compare_benchmarks((tmp_path / "old.json", tmp_path / "new.json"))
    assert [(each.name, each.verdict) for each in found] == [("a", "same"), ("b", "slower")]


def test_kernel_bench_is_read(tmp_path):
    program = Path(os.environ.get("TRIGRAIN_BIN", ROOT / "build/release/bin")) / "kernel_bench"
    if not program.exists():
        pytest.skip("kernel_bench is not built")
    done = subprocess.run([program, "--kernel", "brute-simd", "--family", "near_vf", "--pairs", "256",
                           "--benchmark_min_time=0.01", f"--benchmark_out={tmp_path / 'k.json'}",
                           "--benchmark_out_format=json"], capture_output=True, text=True, check=False, timeout=60)
    if done.returncode != 0:
        pytest.skip(f"kernel_bench takes other options ({done.stderr.strip()[-100:]})")
    assert all(0 < seconds < 1 for times in read_google_benchmark(tmp_path / "k.json").values() for seconds in times)


def test_jube_runs_a_sweep(dem_bench, tmp_path):
    file = EXPERIMENTS / "adapters/jube.xml"
    assert ElementTree.parse(file).getroot().find("benchmark").attrib["name"] == "trigrain"
    if not shutil.which("jube"):
        pytest.skip("jube is not installed (apt-get install jube)")
    if not (ROOT / "build/release/bin/sweep").exists():
        pytest.skip("the release preset is not built")
    environment = {**os.environ, "TRIGRAIN": str(ROOT), "HOME": str(tmp_path)}
    for words in (["run", file, "--outpath", tmp_path / "runs", "--hide-animation"], ["result", tmp_path / "runs", "-a"]):
        done = subprocess.run(["jube", *map(str, words)], capture_output=True, text=True, check=False, timeout=240,
                              env=environment, cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
    assert "figure_8_5,smoke,4,12," in done.stdout, done.stdout


def stand_in_reframe(monkeypatch) -> None:
    """What our file uses of ReFrame, which Debian does not have: names in the bodies of classes, and checks of text files."""
    def mark(*_words):
        return lambda function: function

    for name, value in {"variable": lambda _kind, value: value, "parameter": lambda values: values[0], "run_before": mark,
                        "sanity_function": lambda function: function, "performance_function": mark}.items():
        monkeypatch.setattr(builtins, name, value, raising=False)
    sanity = SimpleNamespace(all=all, assert_found=lambda text, file: re.search(text, Path(file).read_text(), re.MULTILINE),
                             assert_not_found=lambda text, file: not re.search(text, Path(file).read_text(), re.MULTILINE))
    utility = SimpleNamespace(sanity=sanity)
    reframe = SimpleNamespace(simple_test=lambda kind: kind, RunOnlyRegressionTest=object, utility=utility)
    for name, module in {"reframe": reframe, "reframe.utility": utility,
                         "reframe.utility.sanity": sanity}.items():
        monkeypatch.setitem(sys.modules, name, module)


@pytest.mark.parametrize("spec,passes", [("figure_8_5", True), ("failing", False)])
def test_the_reframe_file_runs_and_judges_a_sweep(dem_bench, tmp_path, monkeypatch, spec, passes):
    if not (ROOT / "build/release/bin/sweep").exists():
        pytest.skip("the release preset is not built")
    stand_in_reframe(monkeypatch)
    test = runpy.run_path(str(EXPERIMENTS / "adapters/reframe_trigrain.py"))["TrigrainSweep"]()
    (tmp_path / "failing.json").write_text(json.dumps({"fixed": {"scene": "hopper", "particles": 27}, "time_limit_s": 1e-3}))
    test.spec = spec if passes else str(tmp_path / "failing.json")
    test.stagedir, test.stdout = tmp_path, tmp_path / "rfm_job.out"
    test.commands()
    script = "\n".join([shlex.join([test.executable, *test.executable_opts]), *test.postrun_cmds])
    with open(test.stdout, "w", encoding="utf-8") as out:
        subprocess.run(["bash", "-c", script], cwd=tmp_path, stdout=out, check=passes, timeout=240)
    assert bool(test.every_point_finished()) == passes
    assert not passes or 0 < test.step() < 1e6
