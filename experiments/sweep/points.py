"""From a spec to its points: stable order, stable identity."""
import hashlib
import itertools
import json
from dataclasses import dataclass, field
from typing import Any

from sweep.aliases import key_here, value_here
from sweep.axes import excluded
from sweep.errors import InputError, nearest
from sweep.parameters import DEM_BENCH
from sweep.spec import ExpectedFailure, Spec


@dataclass(frozen=True)
class StartState:
    """A state that points start from: the scene run with `params` until params["end_s"]."""
    id: str
    params: dict[str, Any] = field(compare=False)


@dataclass(frozen=True)
class Point:
    """One process of the spec's program. `id` depends on the parameters alone, so that presets share records;
    `name` tells it from its neighbours in the sweep."""
    id: str
    name: str
    params: dict[str, Any]
    start: StartState | None = None
    expected_failure: ExpectedFailure | None = None


def expand(spec: Spec) -> list[Point]:
    """All points, in the order of axes and zipped groups, the last fastest; InputError if two are the same."""
    points: dict[str, Point] = {}
    axes = [[{key: value} for value in values] for key, values in spec.axes.items()]
    groups = [[dict(zip(group, row)) for row in zip(*group.values())] for group in spec.zips]
    for combination in itertools.product(*axes, *groups):
        varied = {key: value for part in combination for key, value in part.items()}
        params = {**spec.fixed, **varied}
        if excluded(params, spec.exclude):
            continue
        digest = _scene_digest(spec, params)
        start = _start_state(spec, params, digest)
        program = {} if spec.program == DEM_BENCH else {"program": spec.program.name}
        identity = {**program, **params, **({"start_state": start.id} if start else {}),
                    **({"digest": digest} if digest else {})}
        name = " ".join(f"{key}={value}" for key, value in varied.items()) or spec.name
        baseline = next((each for each in spec.expected_failures if excluded(params, [each.where])), None)
        point = Point(short_hash(identity), name, params, start, baseline)
        if point.id in points:
            raise InputError(f"two points are the same ({spec.name}.json: {name}). Remove one row of zip.")
        points[point.id] = point
    return list(points.values())


def comparable(points: list[Point], interleave: tuple[str, ...]) -> list[list[Point]]:
    """Points in groups whose members differ in the parameters `interleave` alone, in order of first appearance."""
    groups: dict[str, list[Point]] = {}
    for point in points:
        rest = {key: value for key, value in point.params.items() if key not in interleave}
        groups.setdefault(short_hash(rest) if interleave else point.id, []).append(point)
    return list(groups.values())


def short_hash(params: dict[str, Any]) -> str:
    """12 hexadecimal digits that depend on keys and values, not on their order."""
    text = json.dumps(params, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def select(points: list[Point], only: list[str], shard: str | None) -> list[Point]:
    """Points that every "key=value[,value]" of `only` lets through, of those that shard "i/n" (i from 1) owns.
    Shards divide all points of the spec, so that they stay a partition whatever `only` says."""
    chosen = points[_shard_slice(shard)] if shard else points
    for condition in only:
        key, _, values = condition.partition("=")
        key = key_here(key)
        known = {key for point in points for key in point.params}
        if key not in known:
            raise InputError(f"no point has a parameter '{key}' (--only {condition}). {nearest(key, sorted(known))}")
        there = {str(point.params.get(key)) for point in points}
        wanted = [value_here(key, value) for value in values.split(",")]
        for value in wanted:
            if value not in there:
                raise InputError(f"no point has {key} = '{value}' (--only {condition}). {nearest(value, sorted(there))}")
        chosen = [point for point in chosen if str(point.params.get(key)) in wanted]
    return chosen


def _shard_slice(shard: str) -> slice:
    index, slash, count = shard.partition("/")
    if not (slash and index.isdigit() and count.isdigit() and 1 <= int(index) <= int(count)):
        raise InputError(f"'{shard}' is no shard (--shard). Write i/n with i from 1 to n, for example 2/4.")
    return slice(int(index) - 1, None, int(count))


def _start_state(spec: Spec, params: dict, digest: str | None) -> StartState | None:
    if spec.prepare is None:
        return None
    state = {**{key: params[key] for key in spec.prepare.by}, **spec.prepare.params, "end_s": spec.prepare.end_s}
    return StartState(short_hash({**state, **({"digest": digest} if digest else {})}), state)


def _scene_digest(spec: Spec, params: dict) -> str | None:
    """A changed scene file makes another point."""
    if "scene_file" not in params:
        return None
    path = spec.folder / params["scene_file"]
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()[:12]
    except OSError as error:
        raise InputError(f"cannot read the scene file '{path}' ({spec.name}.json: fixed.scene_file: {error.strerror}). "
                         "The path counts from the spec's folder.") from None
