"""A comparison of two builds as Markdown for people and as JUnit XML for machines."""
import xml.etree.ElementTree as ElementTree

from sweep.decision import SLOWER, UNSTABLE
from sweep.regression import Comparison

OK, REGRESSION, NOT_SURE = 0, 1, 2


def exit_code(found: list[Comparison]) -> int:
    """1 if a point is slower, else 2 if one is unstable, else 0."""
    verdicts = {each.verdict for each in found}
    return REGRESSION if SLOWER in verdicts else NOT_SURE if UNSTABLE in verdicts else OK


def markdown(found: list[Comparison], names: tuple[str, str]) -> str:
    """A table: a row per point."""
    lines = [f"### {names[0]} against {names[1]}", "", "| point | verdict | CPU time | why |", "|---|---|---|---|"]
    for each in found:
        change = f"{100 * each.decision.change:+.1f} %" if each.decision else "-"
        mark = f"**{each.verdict}**" if each.verdict in (SLOWER, UNSTABLE) else each.verdict
        lines.append(f"| {each.name} | {mark} | {change} | {each.why.replace('|', '/')} |")
    return "\n".join(lines) + "\n"


def junit(found: list[Comparison]) -> str:
    """A test case per point: slower fails, unstable is skipped."""
    suite = ElementTree.Element("testsuite", name="regress", tests=str(len(found)),
                                failures=str(sum(each.verdict == SLOWER for each in found)),
                                skipped=str(sum(each.verdict == UNSTABLE for each in found)))
    for each in found:
        case = ElementTree.SubElement(suite, "testcase", classname="regress", name=each.name)
        if each.verdict in (SLOWER, UNSTABLE):
            kind = "failure" if each.verdict == SLOWER else "skipped"
            ElementTree.SubElement(case, kind, message=f"{each.verdict}: {each.why}")
    ElementTree.indent(suite)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(suite, encoding="unicode") + "\n"
