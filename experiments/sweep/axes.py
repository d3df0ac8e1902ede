"""What varies in a spec: lists, ranges, axes that advance together, and combinations that are left out."""
import math
from typing import Any

from sweep.aliases import key_here, value_here
from sweep.errors import InputError, an_object, nearest
from sweep.parameters import Program

RANGE_KEYS = ("from", "to", "step", "factor")
MOST_VALUES = 10_000


def read_fixed(program: Program, raw: Any, where: str) -> dict[str, Any]:
    """Typed values of an object of single values, under our own names."""
    return {key: program.typed(key, value_here(key, value), place) for key, value, place in _renamed(raw, where)}


def read_axes(program: Program, raw: Any, where: str) -> dict[str, list]:
    """Typed lists of values; {"from", "to", "step" or "factor"} is written out."""
    axes = {}
    for key, values, here in _renamed(raw, where):
        program.check_key(key, here)
        if isinstance(values, dict):
            values = _range(values, here)
        if not isinstance(values, list) or not values:
            what = "is empty" if values == [] else f"is expected, not {values!r}"
            raise InputError(f"a list of values {what} ({here}). Write [a, b, ...].")
        axes[key] = [program.typed(key, value_here(key, value), f"{here}[{i}]") for i, value in enumerate(values)]
    return axes


def refuse_repeated(axes: dict[str, list], where: str) -> None:
    """A value that is listed twice would be a point twice."""
    for key, values in axes.items():
        for i, value in enumerate(values):
            if value in values[:i]:
                raise InputError(f"{value!r} is listed twice ({where}.{key}[{i}]). Remove one.")


def read_zip(program: Program, raw: Any, where: str) -> list[dict[str, list]]:
    """Groups of axes of equal length that advance together."""
    if not isinstance(raw, list):
        raise InputError(f"a list of groups is expected, not {raw!r} ({where}). Write [{{\"particles\": [...], ...}}].")
    groups = []
    for i, group in enumerate(raw):
        here = f"{where}[{i}]"
        axes = read_axes(program, group, here)
        lengths = {key: len(values) for key, values in axes.items()}
        if len(axes) < 2 or len(set(lengths.values())) > 1:
            found = ", ".join(f"{key} has {length}" for key, length in lengths.items()) or "it has none"
            raise InputError(f"two or more lists of one length are expected ({here}: {found}). Make them equally long.")
        groups.append(axes)
    return groups


def read_exclude(program: Program, raw: Any, where: str) -> list[dict[str, list]]:
    """Conditions; a point that meets all of one (a value, or one of a list) is left out."""
    if not isinstance(raw, list):
        raise InputError(f"a list of conditions is expected, not {raw!r} ({where}). Write [{{\"grid\": \"none\"}}].")
    conditions = []
    for i, condition in enumerate(raw):
        here = f"{where}[{i}]"
        lists = {key: values if isinstance(values, (list, dict)) else [values]
                 for key, values in an_object(condition, here).items()}
        if not lists:
            raise InputError(f"an empty condition leaves out every point ({here}). Name a parameter.")
        conditions.append(read_axes(program, lists, here))
    return conditions


def excluded(params: dict[str, Any], conditions: list[dict[str, list]]) -> bool:
    """Whether a point meets all of one of the conditions."""
    return any(all(params.get(key) in values for key, values in condition.items()) for condition in conditions)


def _renamed(raw: Any, where: str) -> list[tuple[str, Any, str]]:
    """Our key, value and place of each entry; the ancestor's names are accepted."""
    seen: dict[str, str] = {}
    entries = []
    for key, value in an_object(raw, where).items():
        ours = key_here(key)
        if ours in seen:
            raise InputError(f"'{key}' and '{seen[ours]}' are the same parameter ({where}). Keep one.")
        seen[ours] = key
        entries.append((ours, value, f"{where}.{key}"))
    return entries


def _range(raw: dict, where: str) -> list:
    """Values from `from` to `to`, both included: each adds `step` to the one before or multiplies it by `factor`."""
    for key in raw:
        if key not in RANGE_KEYS:
            raise InputError(f"unknown key '{key}' ({where}.{key}). {nearest(key, RANGE_KEYS)}")
    for key, value in raw.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise InputError(f"a number is expected, not {value!r} ({where}.{key}). Give one number.")
    if not {"from", "to"} <= set(raw) or ("step" in raw) == ("factor" in raw):
        raise InputError(f"a range has 'from', 'to' and either 'step' or 'factor' ({where}). Write "
                         '{"from": 1, "to": 8, "factor": 2}.')
    first, last = raw["from"], raw["to"]
    if ("step" in raw and not raw["step"] > 0) or ("factor" in raw and not (raw["factor"] > 1 and first > 0)):
        raise InputError(f"a range grows: step > 0, or factor > 1 and from > 0 ({where}). Change it.")
    values, value = [], first
    while value <= last * (1 + 1e-12) if last > 0 else value <= last:
        values.append(value)
        if len(values) > MOST_VALUES:
            raise InputError(f"more than {MOST_VALUES} values ({where}). Take a larger step.")
        value = first + len(values) * raw["step"] if "step" in raw else first * raw["factor"] ** len(values)
        value = float(f"{value:.12g}") if isinstance(value, float) else value  # 0.3, not 0.30000000000000004
    return values
