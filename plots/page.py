"""Parts of the report: sections, tables and provenance as HTML."""
import base64
import csv
import re
import statistics
from collections import Counter
from html import escape
from pathlib import Path

from figure import Drawn
from records import BIGGER_MACHINE, DRAWN, EXPECTED, Point

TABLE_LIMIT = 200  # rows of a table in the page; the CSV has all
MARKS = {"PASS": "good", "FAIL": "bad"}


def section(number: str, drawn: Drawn, results: Path) -> str:
    """A figure with caption, data links and table. The CSV travels inside the page, the other files lie beside it."""
    sweep = drawn.sweep
    raw = base64.b64encode(drawn.path("csv").read_bytes()).decode()
    links = [f'<a download="{drawn.name}.csv" href="data:text/csv;base64,{raw}">CSV</a>']
    links += [f'<a href="{drawn.path(ending).relative_to(results)}">{ending.upper()}</a>' for ending in ("svg", "png")]
    notes = " ".join(escape(note) for note in drawn.notes)
    return (f'<h2 id="{drawn.name}">Figure {number}: {escape(sweep.title)}</h2>\n<figure><div class="scroll">'
            f"{inline_svg(drawn)}</div>\n<figcaption>{escape(sweep.about)} Preset: {escape(sweep.preset)}. {notes}"
            f'</figcaption></figure>\n<p>Data: {", ".join(links)}, <a href="{sweep.name}/">records</a></p>\n'
            f"{numbers(drawn)}")


def inline_svg(drawn: Drawn) -> str:
    """The figure's SVG as an element; names inside get the figure's own, as all share one page."""
    text = drawn.path("svg").read_text(encoding="utf-8")
    text = text[text.index("<svg"):]
    text = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{drawn.name}-", text)
    return text.replace("<svg ", f'<svg role="img" aria-label="{escape(drawn.sweep.title)}" ', 1)


def table(header: list[str], rows: list[list[str]]) -> str:
    """Cells are HTML. Each column can be sorted by."""
    heads = "".join(f'<th scope="col"><button type="button">{cell}</button></th>' for cell in header)
    body = "".join(f"<tr>{''.join(cell if cell.startswith('<td') else f'<td>{cell}</td>' for cell in row)}</tr>\n"
                   for row in rows)
    return (f'<div class="scroll"><table class="sortable"><thead><tr>{heads}</tr></thead>\n<tbody>{body}</tbody></table>'
            "</div>")


def numbers(drawn: Drawn) -> str:
    """The figure's CSV as a folded table."""
    with open(drawn.path("csv"), newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    if not rows:
        return ""
    more = f"<p>The first {TABLE_LIMIT} of {len(rows)} rows; the CSV has all.</p>" if len(rows) > TABLE_LIMIT else ""
    shown = table([escape(cell) for cell in header], [[_cell(text) for text in row] for row in rows[:TABLE_LIMIT]])
    return f"<details{' open' if drawn.open_table else ''}><summary>The {len(rows)} rows of numbers</summary>{shown}{more}</details>"


def _cell(text: str) -> str:
    """Numbers are not broken over lines: 1.0e-04."""
    return f"<td class=number>{text}</td>" if re.fullmatch(r"[-+.0-9e]+", text) else escape(text)


def claims(rows: list[dict]) -> str:
    """What tools/claims found: a row per published figure or number."""
    if not rows:
        return ('<h2 id="claims">Claims</h2><p>Not tested yet: <code>tools/claims</code> tests what was published, and '
                "writes it here.</p>")
    cells = [[escape(row["claim"]), escape(row["expected"]), _marked(row["verdict"]), escape(row["status"]),
              escape(row["seen"]), f"<code>{escape(row['command'])}</code>"] for row in rows]
    return ('<h2 id="claims">Claims</h2><p>Each published figure and number, and what this machine says about it.</p>'
            + table(["claim", "expected", "verdict", "status", "seen here", "command"], cells))


TRIED = {"same": "the same build twice", "kernel": "one kernel 5 % slower", "phase": "one phase 5 % slower"}


def gate(trial: dict | None) -> str:
    """What experiments/regression_trial.py found out about tools/regress."""
    head = '<h2 id="gate">How small a slow-down is found</h2>'
    if not trial:
        return f"{head}<p>Not tried yet: <code>experiments/regression_trial.py</code> does, in about half an hour.</p>"
    rows = []
    for build, what in TRIED.items():
        tries = [each for each in trial["tries"] if each["build"] == build]
        if tries:
            verdicts = Counter(each["verdict"] for each in tries)
            changes = sorted(100 * each["change"] for each in tries)
            rows.append([what, str(len(tries)), *(str(verdicts[word]) for word in ("slower", "same", "unstable", "faster")),
                         f"{statistics.median(changes):+.2f} ({changes[0]:+.2f} to {changes[-1]:+.2f})",
                         f"{100 * max(each['noise'] for each in tries):.2f}"])
    return (f"{head}<p>tools/regress on builds with a known slow-down, {trial['pairs']} pairs of runs a try, while another process "
            f"loads a core; {escape((trial['machine'] or {}).get('cpu', 'unknown machine'))}, commit {escape(trial['commit'][:10])}.</p>"
            + table(["build", "tries", "slower", "same", "unstable", "faster", "CPU time, median and range (%)",
                     "largest noise (%)"], rows))


def verified(points: list[Point]) -> str:
    """What the programs checked before they timed, over all records."""
    checks: dict[str, Counter] = {}
    example: dict[str, str] = {}
    for point in points:
        for how in (point.record or {}).get("check", {}).get("how", []):
            failed = "failed as expected" if point.state == EXPECTED else "failed"
            checks.setdefault(how["what"], Counter())["passed" if how["passed"] else failed] += 1
            example.setdefault(how["what"], how["detail"])
    if not checks:
        return '<h2 id="verified">What was verified</h2><p>No point has run.</p>'
    rows = [[escape(what), str(count["passed"]), f"<td{' class=bad' if count['failed'] else ''}>{count['failed']}</td>",
             str(count["failed as expected"]), escape(example[what])] for what, count in checks.items()]
    return ('<h2 id="verified">What was verified</h2><p>Every point is checked before it is timed; a point that fails is '
            "not drawn. Baselines whose answers are known to be wrong fail as expected.</p>"
            + table(["check", "points passed", "failed", "failed as expected", "for example"], rows))


def not_drawn(drawn: dict[str, Drawn]) -> str:
    """Every point that a figure does not show, and why."""
    rows = []
    for number, each in drawn.items():
        rows += [[number, escape(panel["what"]), f"needs {escape(panel['needs'])}"] for panel in each.sweep.elsewhere]
        larger = [point for point in each.sweep.points if point.state == BIGGER_MACHINE]
        if larger:
            threads = ", ".join(map(str, sorted({point.params["threads"] for point in larger})))
            rows.append([number, f"{len(larger)} point{'s' * (len(larger) > 1)} on {threads} threads", BIGGER_MACHINE])
        for point in each.sweep.points:
            if point.state not in (DRAWN, BIGGER_MACHINE):
                bad = " class=bad" if point.state in ("failed", "check failed") else ""
                why = f": {escape(point.why)}" if point.why else ""
                rows.append([number, escape(point.name), f"<td{bad}>{point.state}{why}</td>"])
    if not rows:
        return '<h2 id="not-drawn">Not drawn</h2><p>Nothing is missing.</p>'
    return (f'<h2 id="not-drawn">Not drawn</h2><details open><summary>{len(rows)} rows</summary>'
            + table(["figure", "point", "why"], rows) + "</details>")


def origin(points: list[Point]) -> str:
    """Machine and build of the drawn points; each combination once."""
    combinations: dict[str, int] = {}
    for point in points:
        if point.state == DRAWN:
            text = _pairs({**_flat("machine", point.record["machine"]), **_flat("build", point.record["build"])})
            combinations[text] = combinations.get(text, 0) + 1
    times = sorted(point.record["started_utc"] for point in points if point.state == DRAWN)
    when = f"<p>Measured from {times[0]} to {times[-1]}.</p>" if times else "<p>Nothing was measured.</p>"
    warnings = Counter(text for point in points if point.record for text in point.record.get("warnings", []))
    said = "".join(f"<li>{escape(text)} ({count} points)</li>" for text, count in warnings.items())
    return ('<h2 id="origin">Where the numbers come from</h2>' + when
            + "".join(f"<p>{count} points:</p>{text}" for text, count in combinations.items())
            + (f"<p>Warnings of the program:</p><ul>{said}</ul>" if said else ""))


def _marked(verdict: str) -> str:
    return f'<td class="{MARKS.get(verdict, "")}">{escape(verdict)}</td>'


def _flat(prefix: str, value: dict) -> dict[str, str]:
    """Nested keys as "machine.caches_bytes.L1"."""
    found = {}
    for key, item in value.items():
        found.update(_flat(f"{prefix}.{key}", item) if isinstance(item, dict) else {f"{prefix}.{key}": str(item)})
    return found


def _pairs(rows: dict[str, str]) -> str:
    cells = "".join(f"<tr><th>{escape(key)}</th><td>{escape(value)}</td></tr>" for key, value in rows.items())
    return f'<div class="scroll"><table>{cells}</table></div>'
