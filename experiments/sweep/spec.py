"""Reads a spec: fixed parameters, axes, presets and preparation; schema in experiments/schema/spec.json."""
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sweep.errors import InputError, nearest
from sweep.parameters import PARAMETERS, check_key, typed

KEYS = ("title", "about", "fixed", "axes", "prepare", "time_limit_s", "elsewhere")
OVERRIDABLE = ("fixed", "axes", "prepare", "time_limit_s")
PREPARE_KEYS = ("by", "params", "end_s")
# How long or how often a point is timed says nothing about the state it starts from.
NOT_PREPARED = ("steps", "end_s", "repeats", "warmup", "check_steps", "threads", "vtk_every_s")


@dataclass(frozen=True)
class Prepare:
    """Start states: one for each distinct combination of the parameters `by`, run with `params` until `end_s` (s)."""
    by: tuple[str, ...]
    params: dict[str, Any]
    end_s: float


@dataclass(frozen=True)
class Spec:
    """One spec with one of its presets applied; `folder` is where its scene files are looked for."""
    name: str
    preset: str
    title: str
    about: str
    fixed: dict[str, Any]
    axes: dict[str, list]
    prepare: Prepare | None
    time_limit_s: float
    elsewhere: list[dict[str, str]]
    folder: Path


def read_spec(path: Path, preset: str | None = None) -> Spec:
    """The spec in `path` with `preset` applied. None: "quick" where the spec has it. "full" is the spec itself
    unless it says otherwise. InputError names the file, the key's path and the nearest known name."""
    raw = _load(path)
    name = path.name
    _known_keys(raw, (*KEYS, "presets"), name, "")
    presets = _object(raw.get("presets", {}), f"{name}: presets")
    chosen = preset or ("quick" if "quick" in presets else "full")
    if chosen not in presets and chosen != "full" and (preset and (presets or preset != "quick")):
        raise InputError(f"unknown preset '{chosen}' ({name}: presets). {nearest(chosen, ['full', *presets])}")
    for each, change in presets.items():
        _known_keys(_object(change, f"{name}: presets.{each}"), OVERRIDABLE, name, f"presets.{each}.")
        _build({**raw, "presets": presets}, each, path)  # a wrong preset is told even if another one was asked for
    return _build(raw, chosen, path)


def _build(raw: dict, preset: str, path: Path) -> Spec:
    name = path.name
    fixed, axes = _parameters(raw, f"{name}: ")
    change = raw.get("presets", {}).get(preset, {})
    new_fixed, new_axes = _parameters(change, f"{name}: presets.{preset}.")
    fixed = {k: v for k, v in fixed.items() if k not in new_axes} | new_fixed
    axes = {k: v for k, v in axes.items() if k not in new_fixed} | new_axes
    prepare = _changed(raw.get("prepare"), change, f"{name}: presets.{preset}.prepare")
    limit = change.get("time_limit_s", raw.get("time_limit_s", 3600))
    if isinstance(limit, bool) or not isinstance(limit, (int, float)) or not limit > 0:
        raise InputError(f"a time above 0 s is expected, not {limit!r} ({name}: time_limit_s). Give seconds.")
    spec = Spec(path.stem, preset, _text(raw, "title", name), _text(raw, "about", name), fixed, axes,
                None if prepare is None else _prepare(prepare, name), float(limit), _elsewhere(raw, name), path.parent)
    _complete(spec, name)
    return spec


def _changed(prepare: Any, change: dict, where: str) -> Any:
    """A preset may change single keys of `prepare`, or remove all of it by null."""
    if change.get("prepare") is None:
        return prepare if "prepare" not in change else None
    return {**_object(prepare or {}, where), **_object(change["prepare"], where)}


def _parameters(part: dict, where: str) -> tuple[dict, dict]:
    fixed = {key: typed(key, value, f"{where}fixed.{key}")
             for key, value in _object(part.get("fixed", {}), f"{where}fixed").items()}
    axes = {}
    for key, values in _object(part.get("axes", {}), f"{where}axes").items():
        here = f"{where}axes.{key}"
        check_key(key, here)
        if key in fixed:
            raise InputError(f"'{key}' is both fixed and an axis ({here}). Keep one of the two.")
        if not isinstance(values, list) or not values:
            raise InputError(f"a list of values is expected, not {values!r} ({here}). Write [a, b, ...].")
        axes[key] = [typed(key, value, f"{here}[{i}]") for i, value in enumerate(values)]
        for i, value in enumerate(axes[key]):
            if value in axes[key][:i]:
                raise InputError(f"{value!r} is listed twice ({here}[{i}]). Remove one.")
    return fixed, axes


def _prepare(raw: Any, name: str) -> Prepare:
    where = f"{name}: prepare"
    _known_keys(_object(raw, where), PREPARE_KEYS, name, "prepare.")
    by = raw.get("by")
    if not isinstance(by, list) or not by:
        raise InputError(f"a list of parameters is expected, not {by!r} ({where}.by). Write [\"scene\", ...].")
    for i, key in enumerate(by):
        check_key(str(key), f"{where}.by[{i}]")
    params = {key: typed(key, value, f"{where}.params.{key}")
              for key, value in _object(raw.get("params", {}), f"{where}.params").items()}
    for key in [*by, *params]:
        if key in NOT_PREPARED:
            raise InputError(f"'{key}' does not belong to a start state ({where}). Remove it.")
    if "end_s" not in raw:
        raise InputError(f"end_s is missing ({where}). Give the time (s) until which the start state is computed.")
    return Prepare(tuple(by), params, typed("end_s", raw["end_s"], f"{where}.end_s"))


def _elsewhere(raw: dict, name: str) -> list[dict[str, str]]:
    """Panels that this project cannot measure on an ordinary machine: {"what", "needs"}."""
    panels = raw.get("elsewhere", [])
    for i, panel in enumerate(panels if isinstance(panels, list) else [panels]):
        if not isinstance(panel, dict) or set(panel) != {"what", "needs"}:
            raise InputError(f"an object with 'what' and 'needs' is expected ({name}: elsewhere[{i}]). Write both.")
    return panels


def _complete(spec: Spec, name: str) -> None:
    given = {**spec.fixed, **spec.axes}
    for one, other in (("scene", "scene_file"), ("steps", "end_s")):
        if (one in given) == (other in given):
            raise InputError(f"exactly one of '{one}' and '{other}' is needed ({name}: fixed). "
                             f"{'Keep one of the two.' if one in given else f'Add {one}.'}")
    for i, key in enumerate(spec.prepare.by if spec.prepare else ()):
        if key not in given:
            raise InputError(f"'{key}' is neither fixed nor an axis ({name}: prepare.by[{i}]). Add it to one of them.")


def _load(path: Path) -> dict:
    def once(pairs: list) -> dict:
        seen = {}
        for key, value in pairs:
            if key in seen:
                raise InputError(f"'{key}' is written twice ({path.name}). Remove one.")
            seen[key] = value
        return seen

    try:
        raw = json.loads(path.read_text(encoding="utf-8"), object_pairs_hook=once)
    except OSError as error:
        raise InputError(f"cannot read the spec '{path}' ({error.strerror}). `sweep list` shows those there are.") from None
    except UnicodeDecodeError:
        raise InputError(f"'{path.name}' is not UTF-8 text. Is it a spec?") from None
    except json.JSONDecodeError as error:
        raise InputError(f"not JSON ({path.name}: line {error.lineno}, column {error.colno}: {error.msg}). "
                         "Mend that line.") from None
    return _object(raw, path.name)


def _object(value: Any, where: str) -> dict:
    if not isinstance(value, dict):
        raise InputError(f"an object is expected, not {value!r} ({where}). Write {{...}}.")
    return value


def _known_keys(raw: dict, keys: tuple[str, ...], name: str, path: str) -> None:
    for key in raw:
        if key not in keys:
            hint = f"It is a parameter: put it into {path}fixed." if key in PARAMETERS else nearest(key, keys)
            raise InputError(f"unknown key '{key}' ({name}: {path}{key}). {hint}")


def _text(raw: dict, key: str, name: str) -> str:
    value = raw.get(key, "")
    if not isinstance(value, str):
        raise InputError(f"a text is expected, not {value!r} ({name}: {key}). Write it in quotes.")
    return value
