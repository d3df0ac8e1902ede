"""The report: one page with all there is."""
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

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
        for ending in ("svg", "png", "csv"):
            assert f'href="figures/{name}.{ending}"' in page and (full.folder / f"figures/{name}.{ending}").exists()
    assert page.count("<svg ") == page.count("</svg>") == 5
    assert "needs a Xeon Phi" in page and "Imagined &lt;CPU&gt;" in page and "64 pairs agree" in page
    assert "needs a bigger machine: 4 threads, 2 cores here" in page and "grid &#x27;adaptive&#x27;" in page


def test_the_page_loads_nothing_and_is_well_formed(full):
    page = report(full)
    assert not re.findall(r'(?:src|href)="(?:https?:)?//[^"]*"', page)
    assert not re.search(r"<(script|link|iframe|img)\b|@import|url\(['\"]?http", page)
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
    assert "<td>grid</td><td>0</td><td class=bad>1</td><td>lost</td>" in page


def test_figures_without_results_are_listed(made_up):
    made_up.sweep("figure_8_8", AXES, FIXED)
    page = report(made_up)
    assert "tools/reproduce --figures 8.5" in page and page.count("<svg ") == 1
    assert "Known: 8.4, 8.5" in report(type(made_up)(made_up.folder / "none"), "--figures", "8.7", expect=3)
