"""Results in the formats of others: CSV, JSON lines for pandas, and Google Benchmark's JSON, which is also read."""
import csv
import io
import json
import math
from pathlib import Path
from typing import Any

from sweep.errors import InputError
from sweep.points import Point
from sweep.store import Store

NS = 1e9
UNITS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


def rows(store: Store, points: list[Point]) -> list[dict[str, Any]]:
    """A flat row per sample of every point that finished and passed its check; keys carry their unit."""
    table = []
    for point in points:
        record, _ = store.load(point.id)
        if record is None or record["status"] != "finished" or not record["check"]["passed"]:
            continue
        for number, sample in enumerate(record["samples"]):
            flat = {"spec": store.folder.name, "point_id": point.id, "point": point.name, "sample": number,
                    **{f"param.{key}": value for key, value in record["params"].items()},
                    **{key: value for key, value in sample.items() if not isinstance(value, dict)},
                    **{f"phase.{key}_s": value for key, value in sample.get("phases_s", {}).items()},
                    **{f"count.{key}": value for key, value in (record.get("counts") or {}).items()},
                    "cpu": record.get("machine", {}).get("cpu"), "cores": record.get("machine", {}).get("cores"),
                    "commit": record.get("build", {}).get("commit"), "compiler": record.get("build", {}).get("compiler"),
                    "started_utc": record.get("started_utc")}
            table.append(flat)
    return table


def as_csv(table: list[dict[str, Any]]) -> str:
    """With a head; null is an empty cell."""
    columns = list(dict.fromkeys(key for row in table for key in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(table)
    return text.getvalue()


def as_json_lines(table: list[dict[str, Any]]) -> str:
    """pandas.read_json(FILE, lines=True) reads it."""
    return "".join(json.dumps(row) + "\n" for row in table)


def as_google_benchmark(table: list[dict[str, Any]]) -> str:
    """A benchmark per point, a repetition per sample, an iteration per step of the engine (or pair of a kernel)."""
    repetitions = {id: sum(row["point_id"] == id for row in table) for id in {row["point_id"] for row in table}}
    families = list(dict.fromkeys(row["point_id"] for row in table))
    benchmarks = []
    for row in table:
        work = row.get("steps") or row.get("pairs") or 1
        name = f"{row['spec']}/{row['point'].replace(' ', '/')}"
        benchmarks.append({
            "name": name, "run_name": name, "run_type": "iteration", "family_index": families.index(row["point_id"]),
            "per_family_instance_index": 0, "repetitions": repetitions[row["point_id"]], "repetition_index": row["sample"],
            "threads": row.get("param.threads", 1), "iterations": work, "real_time": NS * row["wall_s"] / work,
            "cpu_time": NS * row["cpu_s"] / work, "time_unit": "ns",
            **{key.removeprefix("count."): value / work for key, value in row.items()
               if key.startswith("count.") and isinstance(value, (int, float)) and key != "count.steps"}})
    first = table[0] if table else {}
    context = {"date": first.get("started_utc"), "host_name": first.get("cpu"), "executable": "dem_bench",
               "num_cpus": first.get("cores"), "library_build_type": "release", "commit": first.get("commit")}
    return json.dumps({"context": context, "benchmarks": benchmarks}, indent=1) + "\n"


def read_google_benchmark(path: Path) -> dict[str, list[float]]:
    """CPU time (s) of an iteration, per benchmark and repetition; aggregates are left out, as are benchmarks with an error.
    InputError if it is no such file."""
    try:
        benchmarks = json.loads(path.read_text(encoding="utf-8"))["benchmarks"]
        found: dict[str, list[float]] = {}
        for each in benchmarks:
            if each.get("run_type", "iteration") != "iteration" or each.get("error_occurred"):
                continue
            seconds = float(each["cpu_time"]) * UNITS[each.get("time_unit", "ns")]
            if math.isfinite(seconds) and seconds > 0:
                found.setdefault(each.get("run_name", each["name"]), []).append(seconds)
    except OSError as error:
        raise InputError(f"cannot read '{path}' ({error.strerror}). Name a JSON file of Google Benchmark.") from None
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"'{path}' is no JSON of Google Benchmark ({type(error).__name__}: {error}). Make it with "
                         "--benchmark_out=FILE --benchmark_out_format=json.") from None
    if not found:
        raise InputError(f"'{path}' has no benchmark that ran (benchmarks). Run it again.")
    return found


FORMATS = {"csv": as_csv, "jsonl": as_json_lines, "google-benchmark": as_google_benchmark}
