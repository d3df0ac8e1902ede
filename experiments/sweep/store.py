"""The results folder of one spec: records, start states, index and lock."""
import errno
import fcntl
import hashlib
import json
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from sweep.errors import SweepError

RECORD_SCHEMA = "trigrain-record-1"
INDEX_SCHEMA = "trigrain-index-1"
DAY_S = 86400
DISK_FULL = (errno.ENOSPC, errno.EDQUOT)


class Store:
    """Where a sweep keeps what it found:
    RESULTS/SPEC/ID.json               a record
    RESULTS/SPEC/index.json            the state of every point
    RESULTS/SPEC/sweep.log             a line per point that ran
    RESULTS/SPEC/frames/ID/            pictures
    RESULTS/SPEC/traces/ID.json        traces
    RESULTS/SPEC/counters/ID.json      hardware counters
    RESULTS/SPEC/projections/ID.json   what a point on one thread would take on more
    RESULTS/states/ID.json             start states, shared by all specs"""

    def __init__(self, results: Path, spec_name: str):
        self.folder = results / spec_name
        self.states = results / "states"
        self.log = self.folder / "sweep.log"

    def record_path(self, id: str) -> Path:
        return self.folder / f"{id}.json"

    def state_path(self, id: str) -> Path:
        return self.states / f"{id}.json"

    def frames(self, id: str) -> Path:
        return self.folder / "frames" / id

    def trace_path(self, id: str) -> Path:
        return self.folder / "traces" / f"{id}.json"

    def projection_path(self, id: str) -> Path:
        return self.folder / "projections" / f"{id}.json"

    def counters_path(self, id: str) -> Path:
        return self.folder / "counters" / f"{id}.json"

    def load(self, id: str) -> tuple[dict | None, str | None]:
        """The record of a point, or None and, if there is a file that is no record, what is wrong with it."""
        return load_record(self.record_path(id), id)

    def set_aside_broken(self, id: str) -> Path:
        """Renames a file that is no record, so that its point counts as missing and nothing is lost."""
        path = self.record_path(id)
        aside = path.with_suffix(".json.broken")
        path.rename(aside)
        return aside

    def write_record(self, id: str, record: dict, took_s: float) -> None:
        """Keeps a record; `took_s` is how long its processes ran."""
        write_json(self.record_path(id), sealed(record, took_s))

    def write_failure(self, id: str, params: dict[str, Any], failure: dict[str, Any], took_s: float) -> None:
        """Records a point that did not finish: `failure` says exit code, reason and last output lines."""
        record = {"schema": RECORD_SCHEMA, "point_id": id, "status": "failed", "params": params, **failure}
        self.write_record(id, record, took_s)

    def write_index(self, index: dict[str, Any]) -> None:
        write_json(self.folder / "index.json", {"schema": INDEX_SCHEMA, **index})

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Holds the folder for this process. SweepError naming the holder if another sweep works in it. The lock of a
        dead process is free: the kernel drops it with the process."""
        self.folder.mkdir(parents=True, exist_ok=True)
        with open(self.folder / "sweep.lock", "a+", encoding="utf-8") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                file.seek(0)
                holder = file.read().strip() or "another process"
                raise SweepError(f"a sweep is already running there ({self.folder}: {holder}). "
                                 "Wait until it ends or give another --results.") from None
            file.truncate(0)
            file.write(f"process {os.getpid()} on {socket.gethostname()} since {now()}\n")
            file.flush()
            self._remove_leftovers()
            try:
                yield
            finally:
                file.truncate(0)

    def _remove_leftovers(self) -> None:
        """Half written files of sweeps that were killed. Another sweep may be writing a start state just now: only old
        ones go."""
        for part in [*self.folder.glob("*.part"), *self.folder.glob(".*.part")]:
            part.unlink(missing_ok=True)
        for part in [*self.states.glob("*.part"), *self.states.glob(".*.part")]:
            if time.time() - part.stat().st_mtime > DAY_S:
                part.unlink(missing_ok=True)


def sealed(record: dict, took_s: float) -> dict:
    """The record with what the sweep adds: how long its processes ran, and a checksum by which an edit is noticed."""
    bare = {key: value for key, value in record.items() if key != "sweep"}
    return {**bare, "sweep": {"took_s": round(took_s, 3), "sha256": checksum(bare)}}


def checksum(record: dict) -> str:
    """SHA-256 of the record without what the sweep added, as compact JSON with sorted keys."""
    bare = {key: value for key, value in record.items() if key != "sweep"}
    return hashlib.sha256(json.dumps(bare, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def load_record(path: Path, id: str) -> tuple[dict | None, str | None]:
    """Record and None; None and None if there is no file; None and the trouble if it is no record of point `id`."""
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None, None
    except (OSError, ValueError) as error:
        return None, f"not readable as JSON: {error}"
    schema = record.get("schema") if isinstance(record, dict) else None
    if schema != RECORD_SCHEMA:
        return None, f"its schema is {schema!r}, and {RECORD_SCHEMA!r} is what this version reads"
    if record.get("point_id") != id:
        return None, f"its point_id is {record.get('point_id')!r}"
    added = record.get("sweep")
    if added is not None and (not isinstance(added, dict) or added.get("sha256") != checksum(record)):
        return None, "it was changed after it was written: its checksum differs"
    if record.get("status") == "finished":
        check, samples = record.get("check"), record.get("samples")
        if not isinstance(check, dict) or not isinstance(check.get("passed"), bool):
            return None, "check.passed is missing"
        if not isinstance(samples, list) or not all(isinstance(sample, dict) for sample in samples):
            return None, "samples is no list of samples"
    elif record.get("status") != "failed":
        return None, f"its status is {record.get('status')!r}"
    return record, None


def write_json(path: Path, value: dict) -> None:
    write_whole(path, json.dumps(value, indent=1) + "\n")


def write_whole(path: Path, text: str) -> None:
    """Writes the whole file or nothing. OSError that names the file, if the disk is full."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}.part")
    try:
        with open(part, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException as error:
        part.unlink(missing_ok=True)
        if isinstance(error, OSError):
            error.filename = str(path)
        raise


def now() -> str:
    return datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
