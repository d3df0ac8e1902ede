"""Takes over records that were made elsewhere. Doing it twice changes nothing."""
import shutil
from collections import Counter
from pathlib import Path

from sweep.errors import InputError
from sweep.store import Store, load_record, write_json


def merge(ours: Store, theirs: Store) -> str:
    """Copies their records that we lack or have as failed, with their frames; returns a sentence. Where both finished a
    point, ours stays. InputError if they have no such folder."""
    if not theirs.folder.is_dir():
        raise InputError(f"there is no '{theirs.folder}' to merge. Name the results folder that holds {ours.folder.name}/.")
    done: Counter = Counter()
    for path in sorted(theirs.folder.glob("*.json")):
        if path.stem != "index":
            done[_take(ours, theirs, path)] += 1
    what = ", ".join(f"{number} {how}" for how, number in sorted(done.items())) or "no records"
    return f"{theirs.folder}: {what}"


def _take(ours: Store, theirs: Store, path: Path) -> str:
    record, broken = load_record(path, path.stem)
    if record is None:
        return f"left out as no record ({broken})"
    mine, _ = ours.load(path.stem)
    if mine == record:
        return "already here"
    if mine is not None and (mine["status"] == "finished" or record["status"] == "failed"):
        return "kept as they are here"
    frames = theirs.frames(path.stem)
    if frames.is_dir():
        shutil.copytree(frames, ours.frames(path.stem), dirs_exist_ok=True)
    write_json(ours.record_path(path.stem), record)
    return "taken over"
