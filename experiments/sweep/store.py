"""The results folder of one spec: records, start states, index and lock."""
import fcntl
import json
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from sweep.errors import SweepError

RECORD_SCHEMA = "trigrain-record-1"
INDEX_SCHEMA = "trigrain-index-1"


class Store:
    """Where a sweep keeps what it found:
    RESULTS/SPEC/ID.json a record, RESULTS/SPEC/index.json the state of every point, RESULTS/SPEC/frames/ID/ pictures,
    RESULTS/states/ID.json start states, shared by all specs."""

    def __init__(self, results: Path, spec_name: str):
        self.folder = results / spec_name
        self.states = results / "states"

    def record_path(self, id: str) -> Path:
        return self.folder / f"{id}.json"

    def state_path(self, id: str) -> Path:
        return self.states / f"{id}.json"

    def frames(self, id: str) -> Path:
        return self.folder / "frames" / id

    def load(self, id: str) -> tuple[dict | None, str | None]:
        """The record of a point, or None and, if there is a file that is no record, what is wrong with it."""
        return load_record(self.record_path(id), id)

    def set_aside_broken(self, id: str) -> Path:
        """Renames a file that is no record, so that its point counts as missing and nothing is lost."""
        path = self.record_path(id)
        aside = path.with_suffix(".json.broken")
        path.rename(aside)
        return aside

    def write_failure(self, id: str, params: dict[str, Any], failure: dict[str, Any]) -> dict:
        """Records a point that did not finish: `failure` says exit code, reason and last output lines."""
        record = {"schema": RECORD_SCHEMA, "point_id": id, "status": "failed", "params": params, **failure}
        write_json(self.record_path(id), record)
        return record

    def load_index(self) -> dict:
        try:
            index = json.loads((self.folder / "index.json").read_text(encoding="utf-8"))
            return index if index["schema"] == INDEX_SCHEMA else {}
        except (OSError, ValueError, KeyError, TypeError):
            return {}

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
            try:
                yield
            finally:
                file.truncate(0)


def load_record(path: Path, id: str) -> tuple[dict | None, str | None]:
    """Record and None; None and None if there is no file; None and the trouble if it is no record of point `id`."""
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None, None
    except (OSError, ValueError) as error:
        return None, f"not readable as JSON: {error}"
    if not isinstance(record, dict) or record.get("schema") != RECORD_SCHEMA:
        return None, f"its schema is not {RECORD_SCHEMA}"
    if record.get("point_id") != id:
        return None, f"its point_id is {record.get('point_id')!r}"
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
    """Writes the whole file or nothing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}.part")
    part.write_text(json.dumps(value, indent=1) + "\n", encoding="utf-8")
    os.replace(part, path)


def now() -> str:
    return datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
