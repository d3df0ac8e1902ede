#!/usr/bin/python3
"""Draws all figures there are results for and writes them into one self-contained page, results/report.html."""
import argparse
import importlib
import json
import os
import re
import sys
from html import escape
from pathlib import Path

import packages  # noqa: F401
import page
from figure import ROOT, Drawn
from records import NothingToDraw
from summary import sentences

HERE = Path(__file__).resolve().parent


def figures() -> dict[str, str]:
    """The figures that there are scripts for: "8.4": "figure_8_4", "stability-rest": "stability_rest"."""
    def number(name: str) -> str:
        return re.sub(r"(?<=\d)_(?=\d)", ".", name.removeprefix("figure_")).replace("_", "-")

    def in_order(name: str) -> list:
        return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", name)]

    names = sorted((path.stem for path in HERE.glob("*_*.py") if path.stem.startswith(("figure_", "stability_"))),
                   key=in_order)
    return {number(name): name for name in names}


def main() -> int:
    """Draws and writes; returns the exit code: 1 if a point failed or its check did, 3 for a wrong command line."""
    known = figures()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--results", type=Path, default=ROOT / "results", help="default: %(default)s")
    parser.add_argument("--figures", default=",".join(known), help="some of %(default)s")
    parser.add_argument("--list", action="store_true", help="print the figures there are, and stop")
    options = parser.parse_args()
    if options.list:
        print(*known)
        return 0
    wanted = options.figures.split(",")
    for number in wanted:
        if number not in known:
            print(f"unknown figure '{number}' (--figures). Known: {', '.join(known)}.", file=sys.stderr)
            return 3
    drawn, absent = draw_all(options.results, {number: known[number] for number in wanted})
    path = write_page(options.results, drawn, absent)
    for number, why in absent.items():
        print(f"figure {number} is not drawn: {why}", file=sys.stderr)
    print(path)
    troubles = [point for each in drawn.values() for point in each.sweep.points
                if point.state in ("failed", "check failed")]
    return 1 if troubles or not drawn else 0


def draw_all(results: Path, wanted: dict[str, str]) -> tuple[dict[str, Drawn], dict[str, str]]:
    """Figures by number, and those there is nothing to draw for with the reason."""
    drawn, absent = {}, {}
    for number, name in wanted.items():
        try:
            drawn[number] = importlib.import_module(name).draw(results, results / "figures")
        except NothingToDraw as reason:
            absent[number] = str(reason)
    return drawn, absent


def write_page(results: Path, drawn: dict[str, Drawn], absent: dict[str, str]) -> Path:
    """Writes results/report.html whole or not at all."""
    points = [point for each in drawn.values() for point in each.sweep.points]
    claims = (read_json(results / "claims.json") or {"claims": []})["claims"]  # tools/claims leaves them
    links = [(each.name, f"Figure {number}") for number, each in drawn.items()]
    links += [("claims", "Claims"), ("gate", "Regression gate"), ("verified", "Verified"), ("not-drawn", "Not drawn"), ("origin", "Provenance")]
    parts = [f"<p>{escape(' '.join(sentences(drawn, absent, claims)))}</p>",
             f"<nav>{''.join(f'<a href=#{name}>{title}</a>' for name, title in links)}</nav>",
             *(page.section(number, each, results) for number, each in drawn.items())]
    if absent:
        parts.append("<h2>Not run</h2><ul>" + "".join(
            f"<li>Figure {number}: <code>tools/reproduce --figures {number}</code></li>" for number in absent) + "</ul>")
    parts += [page.claims(claims), page.gate(read_json(results / "regression_trial.json")), page.verified(points), page.not_drawn(drawn), page.origin(points)]
    body = "\n".join(parts)
    text = (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>Trigrain: figures</title>\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<style>\n{(HERE / 'page.css').read_text()}</style></head><body>\n<h1>Trigrain: reproduced figures</h1>\n"
            f"{body}\n<script>\n{(HERE / 'page.js').read_text()}</script>\n</body></html>\n")
    path = results / "report.html"
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}.part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)
    return path


def read_json(path: Path) -> dict | None:
    """What another program left there, if it has run."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


if __name__ == "__main__":
    sys.exit(main())
