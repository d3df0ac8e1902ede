"""Reads a spec: what is fixed, what varies, presets and preparation; schema in experiments/schema/spec.json."""
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sweep import axes as varied
from sweep.errors import InputError, an_object, nearest
from sweep.parameters import PROGRAMS, Program

KEYS = ("title", "about", "program", "fixed", "axes", "zip", "exclude", "interleave", "prepare", "time_limit_s",
        "memory_limit_mb", "trace", "expected_failures", "elsewhere")
OVERRIDABLE = ("fixed", "axes", "zip", "exclude", "prepare", "time_limit_s", "memory_limit_mb")
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
class ExpectedFailure:
    """Points that meet all of `where` fail this one check, and `why`: a baseline whose answers are known to be wrong."""
    where: dict[str, list]
    check: str
    why: str


@dataclass(frozen=True)
class Spec:
    """One spec with one of its `presets` applied; `folder` is where its scene files are looked for. Points that differ
    in the parameters `interleave` alone are compared: their repeats take turns."""
    name: str
    preset: str
    presets: tuple[str, ...]
    title: str
    about: str
    program: Program
    fixed: dict[str, Any]
    axes: dict[str, list]
    zips: list[dict[str, list]]
    exclude: list[dict[str, list]]
    interleave: tuple[str, ...]
    prepare: Prepare | None
    time_limit_s: float
    memory_limit_mb: float | None
    trace: bool
    expected_failures: list[ExpectedFailure]
    elsewhere: list[dict[str, str]]
    folder: Path


def read_spec(path: Path, preset: str | None = None) -> Spec:
    """The spec in `path` with `preset` applied. None: "quick" where the spec has it. "full" is the spec itself
    unless it says otherwise. InputError names the file, the key's path and the nearest known name."""
    raw = _load(path)
    name = path.name
    _known_keys(raw, (*KEYS, "presets"), name, "")
    presets = an_object(raw.get("presets", {}), f"{name}: presets")
    chosen = preset or ("quick" if "quick" in presets else "full")
    if chosen not in presets and chosen != "full" and (preset and (presets or preset != "quick")):
        raise InputError(f"unknown preset '{chosen}' ({name}: presets). {nearest(chosen, ['full', *presets])}")
    for each, change in presets.items():
        _known_keys(an_object(change, f"{name}: presets.{each}"), OVERRIDABLE, name, f"presets.{each}.")
        _build({**raw, "presets": presets}, each, path)  # a wrong preset is told even if another one was asked for
    return _build(raw, chosen, path)


def _build(raw: dict, preset: str, path: Path) -> Spec:
    name = path.name
    program = _program(raw, name)
    change = raw.get("presets", {}).get(preset, {})
    old, new = f"{name}: ", f"{name}: presets.{preset}."
    fixed, axes = _parameters(program, raw, old)
    new_fixed, new_axes = _parameters(program, change, new)
    fixed = {k: v for k, v in fixed.items() if k not in new_axes} | new_fixed
    axes = {k: v for k, v in axes.items() if k not in new_fixed} | new_axes

    def latest(key: str, read):
        """The preset's value of `key` if it has one, else the spec's; None if neither has."""
        part, where = (change, new) if key in change else (raw, old)
        return read(part[key], f"{where}{key}") if key in part else None

    prepare = _changed(raw.get("prepare"), change, f"{new}prepare")
    spec = Spec(path.stem, preset, tuple(raw.get("presets", {})), _text(raw, "title", name), _text(raw, "about", name), program,
                fixed, axes,
                latest("zip", lambda value, where: varied.read_zip(program, value, where)) or [],
                latest("exclude", lambda value, where: varied.read_exclude(program, value, where)) or [],
                _interleave(program, raw.get("interleave", []), f"{name}: interleave"),
                None if prepare is None else _prepare(program, prepare, name),
                latest("time_limit_s", _above_zero) or 3600.0, latest("memory_limit_mb", _above_zero),
                _trace(program, raw.get("trace", False), f"{name}: trace"),
                _expected_failures(program, raw.get("expected_failures", []), f"{name}: expected_failures"), _elsewhere(raw, name), path.parent)
    _complete(spec, name)
    return spec


def _program(raw: dict, name: str) -> Program:
    chosen = raw.get("program", "dem_bench")
    if not isinstance(chosen, str) or chosen not in PROGRAMS:
        raise InputError(f"unknown program {chosen!r} ({name}: program). {nearest(str(chosen), PROGRAMS)}")
    return PROGRAMS[chosen]


def _above_zero(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not value > 0:
        unit, words = ("s", "Give seconds") if where.endswith("_s") else ("MB", "Give megabytes")
        raise InputError(f"a number above 0 {unit} is expected, not {value!r} ({where}). {words}.")
    return float(value)


def _trace(program: Program, raw: Any, where: str) -> bool:
    if not isinstance(raw, bool):
        raise InputError(f"true or false is expected, not {raw!r} ({where}). Write true to keep a trace of every point.")
    if raw and program.name != "dem_bench":
        raise InputError(f"{program.name} writes no traces ({where}). Remove it.")
    return raw


def _interleave(program: Program, raw: Any, where: str) -> tuple[str, ...]:
    if not isinstance(raw, list):
        raise InputError(f"a list of parameters is expected, not {raw!r} ({where}). Write [\"kernel\", ...].")
    for i, key in enumerate(raw):
        program.check_key(str(key), f"{where}[{i}]")
    return tuple(raw)


def _changed(prepare: Any, change: dict, where: str) -> Any:
    """A preset may change single keys of `prepare`, or remove all of it by null."""
    if change.get("prepare") is None:
        return prepare if "prepare" not in change else None
    return {**an_object(prepare or {}, where), **an_object(change["prepare"], where)}


def _parameters(program: Program, part: dict, where: str) -> tuple[dict, dict]:
    fixed = varied.read_fixed(program, part.get("fixed", {}), f"{where}fixed")
    axes = varied.read_axes(program, part.get("axes", {}), f"{where}axes")
    varied.refuse_repeated(axes, f"{where}axes")
    for key in axes:
        if key in fixed:
            raise InputError(f"'{key}' is both fixed and an axis ({where}axes.{key}). Keep one of the two.")
    return fixed, axes


def _prepare(program: Program, raw: Any, name: str) -> Prepare:
    where = f"{name}: prepare"
    _known_keys(an_object(raw, where), PREPARE_KEYS, name, "prepare.")
    by = raw.get("by")
    if not isinstance(by, list) or not by:
        raise InputError(f"a list of parameters is expected, not {by!r} ({where}.by). Write [\"scene\", ...].")
    for i, key in enumerate(by):
        program.check_key(str(key), f"{where}.by[{i}]")
    params = varied.read_fixed(program, raw.get("params", {}), f"{where}.params")
    for key in [*by, *params]:
        if key in NOT_PREPARED:
            raise InputError(f"'{key}' does not belong to a start state ({where}). Remove it.")
    if "end_s" not in raw:
        raise InputError(f"end_s is missing ({where}). Give the time (s) until which the start state is computed.")
    return Prepare(tuple(by), params, program.typed("end_s", raw["end_s"], f"{where}.end_s"))


def _expected_failures(program: Program, raw: Any, where: str) -> list[ExpectedFailure]:
    found = []
    for i, each in enumerate(raw if isinstance(raw, list) else [raw]):
        texts = isinstance(each, dict) and [each.get(key) for key in ("check", "why")]
        if not texts or set(each) != {"where", "check", "why"} or not all(text and isinstance(text, str) for text in texts):
            raise InputError(f"an object with 'where', 'check' and 'why' is expected ({where}[{i}]). Write all three.")
        found.append(ExpectedFailure(varied.read_exclude(program, [each["where"]], f"{where}[{i}].where")[0], *texts))
    return found


def _elsewhere(raw: dict, name: str) -> list[dict[str, str]]:
    """Panels that this project cannot measure on an ordinary machine: {"what", "needs"}."""
    panels = raw.get("elsewhere", [])
    for i, panel in enumerate(panels if isinstance(panels, list) else [panels]):
        if not isinstance(panel, dict) or set(panel) != {"what", "needs"}:
            raise InputError(f"an object with 'what' and 'needs' is expected ({name}: elsewhere[{i}]). Write both.")
    return panels


def _complete(spec: Spec, name: str) -> None:
    given = {**spec.fixed, **spec.axes}
    for i, group in enumerate(spec.zips):
        for key in group:
            if key in given:
                raise InputError(f"'{key}' is given twice ({name}: zip[{i}].{key}). Keep it in one place.")
        given |= group
    for one, other in spec.program.exactly_one:
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
        text = path.read_text(encoding="utf-8")
        if not text.strip():
            raise InputError(f"the spec is empty ({path.name}). The README has one to begin with, under \"A sweep\".")
        raw = json.loads(text, object_pairs_hook=once)
    except OSError as error:
        raise InputError(f"cannot read the spec '{path}' ({error.strerror}). `sweep list` shows those there are.") from None
    except UnicodeDecodeError:
        raise InputError(f"'{path.name}' is not UTF-8 text. Is it a spec?") from None
    except json.JSONDecodeError as error:
        raise InputError(f"not JSON ({path.name}: line {error.lineno}, column {error.colno}: {error.msg}). "
                         "Mend that line.") from None
    return an_object(raw, path.name)


def _known_keys(raw: dict, keys: tuple[str, ...], name: str, path: str) -> None:
    for key in raw:
        if key not in keys:
            is_parameter = any(key in program.parameters for program in PROGRAMS.values())
            hint = f"It is a parameter: put it into {path}fixed." if is_parameter else nearest(key, keys)
            raise InputError(f"unknown key '{key}' ({name}: {path}{key}). {hint}")


def _text(raw: dict, key: str, name: str) -> str:
    value = raw.get(key, "")
    if not isinstance(value, str):
        raise InputError(f"a text is expected, not {value!r} ({name}: {key}). Write it in quotes.")
    return value
