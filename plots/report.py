#!/usr/bin/python3
"""Draws all figures there are results for and writes them into one self-contained page, results/report.html."""
import argparse
import csv
import importlib
import os
import re
import sys
from collections import Counter
from html import escape
from pathlib import Path

from figure import ROOT, Drawn
from records import DRAWN, NothingToDraw, Point

FIGURES = {"8.4": "figure_8_4", "8.5": "figure_8_5", "8.6": "figure_8_6", "8.8": "figure_8_8", "8.9": "figure_8_9"}
TABLE_LIMIT = 200  # rows of a table in the page; the CSV has all
CSS = """body{font:16px/1.5 system-ui,sans-serif;color:#222;margin:0 auto;max-width:70rem;padding:0 1rem 3rem}
h1{font-size:1.6rem}h2{font-size:1.25rem;margin-top:2.5rem;border-top:1px solid #ddd;padding-top:1rem}
.scroll{overflow-x:auto}.scroll svg{min-width:40rem;width:100%;height:auto}figure{margin:0}figcaption{color:#444}
table{border-collapse:collapse;font-size:.85rem}td,th{padding:.15rem .6rem;text-align:left;border-bottom:1px solid #e4e4e4}
summary{cursor:pointer;margin:.4rem 0}.bad{color:#a40000;font-weight:600}code{overflow-wrap:anywhere}
"""


def main() -> int:
    """Draws and writes; returns the exit code: 1 if a point failed or its check did, 3 for a wrong command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--results", type=Path, default=ROOT / "results", help="default: %(default)s")
    parser.add_argument("--figures", default=",".join(FIGURES), help="some of %(default)s")
    options = parser.parse_args()
    wanted = options.figures.split(",")
    for number in wanted:
        if number not in FIGURES:
            print(f"unknown figure '{number}' (--figures). Known: {', '.join(FIGURES)}.", file=sys.stderr)
            return 3
    drawn, absent = draw_all(options.results, wanted)
    page = write_page(options.results, drawn, absent)
    for number, why in absent.items():
        print(f"figure {number} is not drawn: {why}", file=sys.stderr)
    print(page)
    troubles = [point for each in drawn.values() for point in each.sweep.points
                if point.state in ("failed", "check failed")]
    return 1 if troubles or not drawn else 0


def draw_all(results: Path, wanted: list[str]) -> tuple[dict[str, Drawn], dict[str, str]]:
    """Figures by number, and those there is nothing to draw for with the reason."""
    drawn, absent = {}, {}
    for number in wanted:
        try:
            drawn[number] = importlib.import_module(FIGURES[number]).draw(results, results / "figures")
        except NothingToDraw as reason:
            absent[number] = str(reason)
    return drawn, absent


def write_page(results: Path, drawn: dict[str, Drawn], absent: dict[str, str]) -> Path:
    """Writes results/report.html whole or not at all."""
    parts = [section(number, each, results) for number, each in drawn.items()]
    points = [point for each in drawn.values() for point in each.sweep.points]
    if absent:
        parts.append("<h2>Not run</h2><ul>" + "".join(
            f"<li>Figure {number}: <code>tools/reproduce --figures {number}</code></li>" for number in absent) + "</ul>")
    parts += [verified(points), not_drawn(drawn), origin(points)]
    page = results / "report.html"
    part = page.with_suffix(f".{os.getpid()}.part")
    part.write_text("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Trigrain: figures</title>"
                    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
                    f"<style>{CSS}</style></head><body>\n<h1>Trigrain: reproduced figures</h1>\n"
                    + "\n".join(parts) + "\n</body></html>\n", encoding="utf-8")
    os.replace(part, page)
    return page


def section(number: str, drawn: Drawn, results: Path) -> str:
    """A figure with caption, data links and table."""
    sweep = drawn.sweep
    links = ", ".join(f'<a href="{drawn.path(ending).relative_to(results)}">{ending.upper()}</a>'
                      for ending in ("svg", "png", "csv"))
    notes = " ".join(escape(note) for note in drawn.notes)
    return (f'<h2 id="{drawn.name}">Figure {number}: {escape(sweep.title)}</h2>\n<figure><div class="scroll">'
            f"{inline_svg(drawn)}</div>\n<figcaption>{escape(sweep.about)} Preset: {escape(sweep.preset)}. {notes}"
            f'</figcaption></figure>\n<p>Data: {links}, <a href="{sweep.name}/">records</a></p>\n{table(drawn)}')


def inline_svg(drawn: Drawn) -> str:
    """The figure's SVG as an element; names inside get the figure's own, as all share one page."""
    text = drawn.path("svg").read_text(encoding="utf-8")
    text = text[text.index("<svg"):]
    text = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{drawn.name}-", text)
    return text.replace("<svg ", f'<svg role="img" aria-label="{escape(drawn.sweep.title)}" ', 1)


def table(drawn: Drawn) -> str:
    """The figure's CSV as a folded table."""
    with open(drawn.path("csv"), newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    if not rows:
        return ""
    shown = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows[:TABLE_LIMIT])
    more = f"<p>The first {TABLE_LIMIT} of {len(rows)} rows; the CSV has all.</p>" if len(rows) > TABLE_LIMIT else ""
    heads = "".join(f"<th>{escape(cell)}</th>" for cell in header)
    return (f"<details><summary>The {len(rows)} rows of numbers</summary><div class=\"scroll\"><table><tr>{heads}</tr>"
            f"{shown}</table></div>{more}</details>")


def verified(points: list[Point]) -> str:
    """What dem_bench checked before it timed, over all records."""
    checks: dict[str, Counter] = {}
    example: dict[str, str] = {}
    for point in points:
        for how in (point.record or {}).get("check", {}).get("how", []):
            checks.setdefault(how["what"], Counter())["passed" if how["passed"] else "failed"] += 1
            example.setdefault(how["what"], how["detail"])
    if not checks:
        return "<h2>What was verified</h2><p>No point has run.</p>"
    rows = "".join(f"<tr><td>{escape(what)}</td><td>{count['passed']}</td><td{' class=bad' if count['failed'] else ''}>"
                   f"{count['failed']}</td><td>{escape(example[what])}</td></tr>" for what, count in checks.items())
    return ("<h2>What was verified</h2><p>Every point is checked before it is timed; a point that fails is not drawn.</p>"
            f'<div class="scroll"><table><tr><th>check</th><th>points passed</th><th>failed</th><th>for example</th></tr>'
            f"{rows}</table></div>")


def not_drawn(drawn: dict[str, Drawn]) -> str:
    """Every point that a figure does not show, and why."""
    rows = ""
    for number, each in drawn.items():
        for panel in each.sweep.elsewhere:
            rows += f"<tr><td>{number}</td><td>{escape(panel['what'])}</td><td>needs {escape(panel['needs'])}</td></tr>"
        for point in each.sweep.points:
            if point.state != DRAWN:
                what = ", ".join(f"{key} {point.params[key]}" for key in ("grid", "scheme", "vertices", "threads")
                                 if key in point.params)
                bad = " class=bad" if "failed" in point.state else ""
                why = f": {escape(point.why)}" if point.why else ""
                rows += f"<tr><td>{number}</td><td>{what}</td><td{bad}>{point.state}{why}</td></tr>"
    if not rows:
        return "<h2>Not drawn</h2><p>Nothing is missing.</p>"
    return (f"<h2>Not drawn</h2><details open><summary>{rows.count('<tr>')} points and panels</summary><div class=\"scroll\">"
            f"<table><tr><th>figure</th><th>point</th><th>why</th></tr>{rows}</table></div></details>")


def origin(points: list[Point]) -> str:
    """Machine and build of the drawn points; each combination once."""
    combinations: dict[str, int] = {}
    for point in points:
        if point.state == DRAWN:
            text = table_of({**flat("machine", point.record["machine"]), **flat("build", point.record["build"])})
            combinations[text] = combinations.get(text, 0) + 1
    times = sorted(point.record["started_utc"] for point in points if point.state == DRAWN)
    when = f"<p>Measured from {times[0]} to {times[-1]}.</p>" if times else "<p>Nothing was measured.</p>"
    warnings = Counter(text for point in points if point.record for text in point.record.get("warnings", []))
    said = "".join(f"<li>{escape(text)} ({count} points)</li>" for text, count in warnings.items())
    return ("<h2>Where the numbers come from</h2>" + when
            + "".join(f"<p>{count} points:</p>{text}" for text, count in combinations.items())
            + (f"<p>Warnings of the program:</p><ul>{said}</ul>" if said else ""))


def flat(prefix: str, value: dict) -> dict[str, str]:
    """Nested keys as "machine.caches_bytes.L1"."""
    found = {}
    for key, item in value.items():
        found.update(flat(f"{prefix}.{key}", item) if isinstance(item, dict) else {f"{prefix}.{key}": str(item)})
    return found


def table_of(rows: dict[str, str]) -> str:
    """Two columns."""
    cells = "".join(f"<tr><th>{escape(key)}</th><td>{escape(value)}</td></tr>" for key, value in rows.items())
    return f'<div class="scroll"><table>{cells}</table></div>'


if __name__ == "__main__":
    sys.exit(main())
