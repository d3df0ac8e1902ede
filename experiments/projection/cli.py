"""Command line of the projection."""
import argparse
import csv
import json
import os
import statistics
import sys
from pathlib import Path

from projection.project import TRUSTED, project, serial_share, task_lengths
from projection.replay import Machine
from projection.trace import Trace, TraceError, load_trace


def main() -> int:
    """Exit codes: 0 fine, 1 the projection is withheld, 3 wrong input."""
    parser = argparse.ArgumentParser(prog="project", description="Replays a trace of one thread on more threads.")
    parser.add_argument("trace", type=Path, help="of dem_bench --threads 1 --trace FILE")
    parser.add_argument("--two", type=Path, metavar="RECORD",
                        help="record of the same point on two threads: the projection must predict it")
    parser.add_argument("--one", type=Path, metavar="RECORD", help="record on one thread, made without --trace")
    parser.add_argument("--triad-share", type=float, default=0.0,
                        help="share of a socket's STREAM triad bandwidth that one thread needs (default: %(default)s)")
    parser.add_argument("--cores-per-socket", type=int, default=64)
    parser.add_argument("--csv", type=Path, help="the table as a file")
    options = parser.parse_args()
    try:
        trace = load_trace(options.trace)
        if trace.threads != 1 or not trace.steps:
            raise TraceError(f"the trace is of {trace.threads} threads ({options.trace}). Trace a run of one.")
        machine = Machine(one_thread_share=options.triad_share, cores_per_socket=options.cores_per_socket)
        return _report(trace, machine, options)
    except BrokenPipeError:  # whoever read it has seen enough
        os._exit(0)
    except TraceError as error:
        print(f"project: {error}", file=sys.stderr)
        return 3


def _report(trace: Trace, machine: Machine, options: argparse.Namespace) -> int:
    rows = project(trace, machine)
    one = rows[0].projected
    lengths = task_lengths(trace)
    print(f"serial share of a step: {100 * serial_share(trace):.2f} %")
    if lengths:
        print(f"tasks per step: {len(lengths) / min(9, len(trace.steps)):.0f}, median length {statistics.median(lengths):.1f} us")
    if options.two and options.one:
        measured = _wall_us(options.one) / _wall_us(options.two)
        predicted = one / next(row.projected for row in rows if row.threads == 2)
        residual = predicted / measured - 1
        print(f"speed-up on two threads: predicted {predicted:.3f}, measured {measured:.3f}, residual {100 * residual:+.1f} %")
        if abs(residual) > TRUSTED:
            print(f"WITHHELD: the residual exceeds {100 * TRUSTED:.0f} %.")
            return 1
    print("threads  us per step (projected)  speed-up  band           limited by")
    table = []
    for row in rows:
        limit, share = max(row.limits.items(), key=lambda item: item[1])
        why = f"{limit} ({100 * share:.1f} % of the time)" if row.threads > 1 else ""
        print(f"{row.threads:7d}  {row.projected:23.1f}  {one / row.projected:8.2f}  "
              f"{one / row.most:5.2f} - {one / row.least:5.2f}  {why}")
        table.append([row.threads, row.projected, one / row.projected, one / row.most, one / row.least, limit, share])
    if options.csv:
        with open(options.csv, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["threads", "projected_us_per_step", "speed_up", "lower", "upper", "limit", "limit_share"])
            writer.writerows(table)
    return 0


def _wall_us(path: Path) -> float:
    """Median wall time per step of a record."""
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        if not record["check"]["passed"]:
            raise TraceError(f"the check of the record failed ({path}). Its times must not be used.")
        return statistics.median(1e6 * sample["wall_s"] / sample["steps"] for sample in record["samples"])
    except (OSError, ValueError, KeyError) as error:
        raise TraceError(f"cannot read the record ({path}: {error}).") from None
