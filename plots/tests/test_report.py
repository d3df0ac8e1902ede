"""The report: one page with all there is."""
import base64
import json
import re
import shutil
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import jsonschema
import pytest

from test_figures import AXES, FIXED

PLOTS = Path(__file__).resolve().parents[1]


def report(made_up, *arguments: str, expect: int = 0) -> str:
    done = subprocess.run(["/usr/bin/python3", PLOTS / "report.py", "--results", made_up.folder, *arguments],
                          capture_output=True, text=True, check=False)
    assert done.returncode == expect, done.stderr
    page = made_up.folder / "report.html"
    return page.read_text(encoding="utf-8") if page.exists() else done.stderr


@pytest.fixture(name="full")
def _full(hopper_frames):
    for name in ("figure_8_5", "figure_8_6", "figure_8_8", "figure_8_9"):
        hopper_frames.sweep(name, AXES, FIXED, [{"what": "KNL", "needs": "a Xeon Phi"}] if name.endswith("9") else ())
    return hopper_frames


def test_every_figure_is_in_the_page_with_its_data(full):
    page = report(full)
    for number in ("8.4", "8.5", "8.6", "8.8", "8.9"):
        name = f"figure_{number.replace('.', '_')}"
        assert f'<h2 id="{name}">Figure {number}: About {name}</h2>' in page
        for ending in ("svg", "png"):
            assert f'href="figures/{name}.{ending}"' in page and (full.folder / f"figures/{name}.{ending}").exists()
        raw = re.search(rf'download="{name}.csv" href="data:text/csv;base64,([^"]*)"', page)[1]
        assert base64.b64decode(raw) == (full.folder / f"figures/{name}.csv").read_bytes()
    assert page.count("<svg ") == page.count("</svg>") == 5
    assert "needs a Xeon Phi" in page and "Imagined &lt;CPU&gt;" in page and "64 pairs agree" in page
    assert "on 4 threads</td><td>needs a bigger machine" in page and "grid &#x27;adaptive&#x27;" in page


def test_the_page_loads_nothing_and_is_well_formed(full):
    page = report(full)
    assert not re.findall(r'(?:src|href)="(?:https?:)?//[^"]*"', page)
    assert not re.search(r"<(link|iframe|img)\b|<script [^>]*src|@import|url\(['\"]?http|fetch\(|XMLHttp", page)
    for svg in re.findall(r"<svg .*?</svg>", page, re.S):
        ids = [element.attrib["id"] for element in ElementTree.fromstring(svg).iter() if "id" in element.attrib]
        assert len(ids) == len(set(ids)) and all(id.startswith("figure_8_") for id in ids)
    used = set(re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', page))
    known = set(re.findall(r'id="([^"]+)"', page))
    assert {a or b for a, b in used} <= known


def test_a_failed_check_makes_the_report_fail_and_say_so(full):
    id = full.sweep("figure_8_5", AXES, FIXED)["grid=regular vertices=20 threads=2"]["id"]
    full.change("figure_8_5", id, check={"passed": False, "how": [{"what": "grid", "passed": False, "detail": "lost"}]})
    page = report(full, "--figures", "8.5", expect=1)
    assert "<td class=bad>check failed: grid</td>" in page
    assert "<td>grid</td><td>0</td><td class=bad>1</td><td>0</td><td>lost</td>" in page


def test_a_baseline_that_fails_as_expected_is_listed_and_no_failure(full):
    id = full.sweep("figure_8_5", AXES, FIXED)["grid=regular vertices=20 threads=2"]["id"]
    full.change("figure_8_5", id, check={"passed": False, "how": [{"what": "kernel", "passed": False, "detail": "wrong"}]})
    index = full.read("figure_8_5", "index")
    for point in index["points"]:
        point["expected_failure"] = {"where": {}, "check": "kernel", "why": "known to be wrong"} if point["id"] == id else None
    full.write("figure_8_5", "index", index)
    page = report(full, "--figures", "8.5")
    assert "<td>check failed as expected: kernel: known to be wrong</td>" in page
    assert "<td>0</td><td>1</td><td>64 pairs agree</td>" in page
    assert "checks of the answers passed (1 baseline known to be wrong left out)" in page
    full.change("figure_8_5", id, check={"passed": False, "how": [{"what": "grid", "passed": False, "detail": "lost"}]})
    assert "<td class=bad>check failed: grid</td>" in report(full, "--figures", "8.5", expect=1), "not what is expected"


def test_figures_without_results_are_listed(made_up):
    made_up.sweep("figure_8_8", AXES, FIXED)
    page = report(made_up)
    assert "tools/reproduce --figures 8.5" in page and page.count("<svg ") == 1
    assert "Known: 8.4, 8.5" in report(type(made_up)(made_up.folder / "none"), "--figures", "8.3", expect=3)


CLAIM = {"claim": "Figure 8.5: <two> threads", "expected": "faster", "verdict": "FAIL", "status": "measured", "seen": "1.01",
         "command": "sweep run figure_8_5"}


def test_claims_and_five_sentences_head_the_page(full):
    (full.folder / "claims.json").write_text(json.dumps({"claims": [CLAIM, {**CLAIM, "verdict": "PASS"}]}))
    page = report(full)
    assert '<td class="bad">FAIL</td>' in page and "Figure 8.5: &lt;two&gt; threads" in page
    summary = re.search(r"<h1>.*?<p>(.*?)</p>", page, re.S)[1]
    assert len(re.findall(r"\.(?= |$)", summary)) == 5
    for words in ("5 figures from", "Imagined &lt;CPU&gt; (2 cores) at commit c0ffeec0ff", "checks of the answers passed",
                  "needs a bigger machine", "Of 2 published claims 1 hold here, 1 fail and 0 cannot be tested"):
        assert words in summary, words


def test_the_trial_of_the_regression_gate_is_shown(full):
    assert "Not tried yet: <code>experiments/regression_trial.py" in report(full, "--figures", "8.5")
    tries = [{"build": build, "verdict": verdict, "change": change, "p": 0.001, "noise": 0.004, "why": "", "took_s": 1}
             for build, verdict, change in (("kernel", "slower", 0.05), ("kernel", "slower", 0.04), ("same", "same", -0.001))]
    trial = {"schema": "trigrain-regression-trial-1", "started_utc": "2024-01-01T00:00:00Z", "commit": "c0ffee" * 7,
             "pairs": 30, "machine": {"cpu": "Imagined <CPU>"}, "tries": tries}
    jsonschema.validate(trial, json.loads((PLOTS.parent / "experiments/schema/regression_trial.json").read_text()))
    (full.folder / "regression_trial.json").write_text(json.dumps(trial))
    page = report(full, "--figures", "8.5")
    assert ("<td>one kernel 5 % slower</td><td>2</td><td>2</td><td>0</td><td>0</td><td>0</td><td>+4.50 (+4.00 to +5.00)</td>"
            "<td>0.40</td>") in page
    assert "<td>the same build twice</td><td>1</td><td>0</td><td>1</td>" in page and "one phase" not in page


def test_the_same_records_give_the_same_bytes(full):
    def files() -> dict[str, bytes]:
        return {path.name: path.read_bytes() for path in [*(full.folder / "figures").iterdir(), full.folder / "report.html"]}

    report(full)
    first = files()
    shutil.rmtree(full.folder / "figures")
    report(full)
    assert len(first) == 16 and files() == first


# Presses the head of the column "threads" of the first table of numbers twice, and notes down what is then to be seen.
PROBE = """<script>addEventListener("load", () => {
  const table = document.querySelector("details table.sortable");
  const column = [...table.tHead.rows[0].cells].findIndex(cell => cell.textContent === "threads");
  const seen = () => [...table.tBodies[0].rows].map(row => row.cells[column].textContent);
  const press = () => { table.tHead.rows[0].cells[column].firstElementChild.click(); return seen(); };
  const sizes = [...document.querySelectorAll("figure svg")].map(svg => svg.getBoundingClientRect().height > 100);
  const found = {up: press(), down: press(), sizes, errors, overflow: document.body.scrollWidth > innerWidth};
  document.documentElement.setAttribute("data-found", JSON.stringify(found));
});</script>"""
WATCH = '<script>const errors = []; addEventListener("error", event => errors.push(event.message));</script>'


@pytest.mark.parametrize("width", [1200, 500])  # the least that a headless window takes
def test_a_browser_shows_every_figure_and_sorts_tables(full, tmp_path, width):
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if not browser:
        pytest.skip("no chromium on PATH (apt-get install chromium)")
    report(full, "--figures", "8.5,8.9")
    page = (full.folder / "report.html").read_text().replace("<head>", f"<head>{WATCH}", 1).replace("</body>", f"{PROBE}</body>")
    (full.folder / "probed.html").write_text(page)
    done = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", f"--window-size={width},900",
                           f"--user-data-dir={tmp_path / 'profile'}", "--dump-dom", f"file://{full.folder}/probed.html"],
                          capture_output=True, text=True, timeout=120, check=False)
    found = re.search(r'data-found="([^"]*)"', done.stdout)
    assert found, done.stderr[-2000:]
    found = json.loads(found[1].replace("&quot;", '"'))
    assert found["errors"] == [] and found["sizes"] == [True, True] and not found["overflow"]
    numbers = [int(cell) for cell in found["up"]]
    assert numbers == sorted(numbers) and len(set(numbers)) > 1
    assert [int(cell) for cell in found["down"]] == sorted(numbers, reverse=True)


SCRIPTS = sorted(path.relative_to(PLOTS.parent) for path in PLOTS.glob("figure_*.py"))


@pytest.mark.parametrize("script", ["plots/report.py", "tools/claims", *SCRIPTS], ids=str)
def test_without_python_packages_one_sentence_says_what_to_do(script):
    done = subprocess.run(["/usr/bin/python3", "-S", PLOTS.parent / script], capture_output=True, text=True, check=False)
    assert done.returncode == 4 and done.stderr.count("\n") == 1, done.stderr
    assert "no Python package matplotlib and numpy" in done.stderr and "tools/install" in done.stderr
