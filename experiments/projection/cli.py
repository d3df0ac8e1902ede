"""Command line of the projection."""
import argparse
import csv
import json
import os
import statistics
import sys
from pathlib import Path
from typing import Any

from projection.machine import load_costs, machine_of
from projection.project import limit_of, summary
from projection.trace import Trace, TraceError, load_trace

ROOT = Path(__file__).resolve().parents[2]


def main() -> int:
    """Exit codes: 0 fine, 1 the projection is withheld, 3 wrong input."""
    parser = argparse.ArgumentParser(prog="project", description="Replays a trace of one thread on more threads.")
    parser.add_argument("trace", type=Path, help="of dem_bench --threads 1 --trace FILE")
    parser.add_argument("--two", type=Path, metavar="RECORD", help="record of the same point on two threads, made without "
                        "--trace: the projection must predict it, or is withheld")
    parser.add_argument("--one", type=Path, metavar="RECORD", help="record on one thread, made without --trace")
    parser.add_argument("--costs", type=Path, default=ROOT / "results/machine_costs.json", metavar="FILE",
                        help="of machine_costs, which is run if the file is missing (default: %(default)s)")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="where machine_costs is (default: %(default)s)")
    parser.add_argument("--bytes-per-step", type=float, default=0.0,
                        help="to and from memory, as counted; 0: bandwidth is not looked at (default: %(default)s)")
    parser.add_argument("--socket-GB-s", type=float, help="bandwidth of a socket (default: the triad that was measured here)")
    parser.add_argument("--cores-per-socket", type=int, default=64)
    parser.add_argument("--json", type=Path, help="all that is known, as a file")
    parser.add_argument("--csv", type=Path, help="the table as a file")
    options = parser.parse_args()
    try:
        return _report(options)
    except BrokenPipeError:  # whoever read it has seen enough
        os._exit(0)
    except TraceError as error:
        print(f"project: {error}", file=sys.stderr)
        return 3


def traced_run(path: Path) -> Trace:
    """The trace, of one thread. TraceError if it is not."""
    trace = load_trace(path)
    if trace.threads != 1 or not trace.steps:
        raise TraceError(f"the trace is of {trace.threads} threads ({path}). Trace a run of one.")
    return trace


def _report(options: argparse.Namespace) -> int:
    trace = traced_run(options.trace)
    costs = load_costs(options.costs, options.bin / "machine_costs")
    if options.socket_GB_s:
        costs["triad_GB_s"][str(costs["threads"])] = options.socket_GB_s
    traffic = options.bytes_per_step / statistics.median(trace.walls)
    machine = machine_of(costs, trace.runtime, traffic, options.cores_per_socket)
    measured = wall_us(options.one) / wall_us(options.two) if options.one and options.two else None
    found = summary(trace, machine, measured) | {"machine_costs": costs}
    _print(found)
    if options.json:
        options.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    if measured and not found["validation"]["trusted"]:
        print(f"WITHHELD: {found['validation']['why']}.")
        return 1
    _print_rows(found["rows"])
    if options.csv:
        _write_rows(found["rows"], options.csv)
    return 0


def _print(found: dict[str, Any]) -> None:
    print(f"a step: work {found['work_us']:.0f} us, span {found['span_us']:.0f} us, burdened by what sharing costs "
          f"{found['burdened_span_us']:.0f} us; one thread alone does {100 * found['serial_share']:.2f} % of the work")
    if found["median_task_us"]:
        print(f"tasks per step: {found['tasks_per_step']:.0f}, median length {found['median_task_us']:.1f} us, "
              f"handing them over {100 * found['spawn_share']:.2f} % of the time")
    print(f"recording the trace took {100 * found['trace_share']:.2f} % of the time")
    check = found["validation"]
    if check["measured"]:
        print(f"speed-up on two threads: predicted {check['predicted']:.3f}, measured {check['measured']:.3f}, "
              f"residual {100 * check['residual']:+.1f} %")
    else:
        print("NOT VALIDATED: give --one and --two, records of the same point.")


def _print_rows(rows: list[dict[str, Any]]) -> None:
    print("threads  us per step (projected)  speed-up  band           limited by")
    for row in rows:
        why = limit_of(row) if row["threads"] > 1 else ""
        print(f"{row['threads']:7d}  {row['us_per_step']:23.1f}  {row['speed_up']:8.2f}  "
              f"{row['lower']:5.2f} - {row['upper']:5.2f}  {why}")
    print("band: every greedy schedule takes at least max(work / threads, span), at most work / threads + burdened span")


def _write_rows(rows: list[dict[str, Any]], path: Path) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["threads", "projected_us_per_step", "speed_up", "lower", "upper", "limit"])
        writer.writerows([row["threads"], row["us_per_step"], row["speed_up"], row["lower"], row["upper"], limit_of(row)]
                         for row in rows)


def wall_us(path: Path) -> float:
    """Median wall time per step of a record."""
    try:
        return record_wall_us(json.loads(path.read_text(encoding="utf-8")), str(path))
    except (OSError, ValueError, KeyError) as error:
        raise TraceError(f"cannot read the record ({path}: {error}).") from None


def record_wall_us(record: dict[str, Any], where: str) -> float:
    """The same of a record that is at hand."""
    if not record["check"]["passed"]:
        raise TraceError(f"the check of the record failed ({where}). Its times must not be used.")
    return statistics.median(1e6 * sample["wall_s"] / sample["steps"] for sample in record["samples"])
