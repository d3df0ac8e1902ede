"""The printed series that figures show beside ours."""
import json

from figure import ROOT

PUBLISHED = ROOT / "results/reference/published_series.json"


def figures() -> list[dict]:
    """Every digitised figure and table; results/reference/published_series.md says how they were read."""
    return json.loads(PUBLISHED.read_text(encoding="utf-8"))["figures"]


def table_1() -> dict[str, dict[str, float]]:
    """Runtime (s), MFLOP/s, CPI and bandwidth (MB/s) by method: table 1 of Krestenitis, Weinzierl and Koziara (2017)."""
    return {each["label"]: dict(each["points"]) for each in next(f for f in figures() if f["id"] == "P17.T1")["series"]}
