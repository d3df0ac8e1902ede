"""The names that the ancestor of this project (Peano's DEM, Krestenitis 2018) gave to parameters and values."""
import configparser
from pathlib import Path
from typing import Any

from sweep.errors import InputError, nearest

KEYS = {"scenario": "scene", "grid-type": "grid", "collision-model": "kernel", "mesh-density": "vertices",
        "mesh-density-per-particle": "vertices", "tbb-core-count": "threads", "core-count": "threads",
        "iterations": "steps", "time-steps": "steps"}
VALUES = {
    "scene": {"hopperUniform": "hopper", "hopperUniform1k": "hopper", "hopperUniform10k": "hopper",
              "two-particles-crash": "two-particles", "freefallWithGranulates": "gas"},
    "grid": {"no-grid": "none", "regular-grid": "regular", "adaptive-grid": "adaptive", "reluctant-grid": "reluctant"},
    "kernel": {"bf": "brute", "penalty": "iterative", "hybrid-on-triangle-pairs": "hybrid-pair",
               "hybrid-on-batches": "hybrid-batch"}}
# The ancestor packed the number of bodies into the scenario's name.
PARTICLES = {"hopperUniform1k": 1000, "hopperUniform10k": 10000}
# Options of the ancestor that a point here does not have, and what takes their place.
NO_COUNTERPART = {"grid-h-max": "the grid's cells follow from the particles' sizes", "gravity": "the scene has it",
                  "step-size": "the scene has it", "plot": "give vtk_every_s", "snapshot-frequency": "give vtk_every_s",
                  "max-step-size": "the scene has it", "run-grid-parallel": "give scheme",
                  "run-particles-parallel": "give scheme", "run-comparisons-in-background": "give scheme 'task'"}
PLAIN, GROUPED = "parameters", "parameters_grouped"


def key_here(key: str) -> str:
    """Our name of a parameter, whichever of the two was given."""
    return KEYS.get(key, key)


def value_here(key: str, value: Any) -> Any:
    """Our name of a value of our parameter `key`."""
    return VALUES.get(key, {}).get(value, value) if isinstance(value, str) else value


def import_ini(path: Path) -> tuple[dict[str, Any], list[str]]:
    """A spec from the ancestor's option file, and sentences about what was left out. Sections: [parameters] with
    comma-separated values, every combination of which is a point, and [parameters_grouped], whose lists advance
    together; other sections (jobs, environments) are left out. InputError names file, section and key."""
    parser = configparser.ConfigParser(interpolation=None, delimiters=("=",), comment_prefixes=("#", ";"))
    parser.optionxform = str
    try:
        parser.read_string(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"cannot read '{path}' ({error.strerror}). Name an option file.") from None
    except (configparser.Error, UnicodeDecodeError) as error:
        raise InputError(f"no option file ({path.name}: {' '.join(str(error).split())}). Write key = value.") from None
    if not any(parser.has_section(section) for section in (PLAIN, GROUPED)):
        raise InputError(f"there is no [{PLAIN}] ({path.name}). Is it an option file of a sweep?")
    notes = [f"section [{name}] is left out" for name in parser.sections() if name not in (PLAIN, GROUPED)]
    spec: dict[str, Any] = {"title": path.stem, "about": f"Imported from {path.name}.", "fixed": {}, "axes": {}}
    alone = {key: list(dict.fromkeys(values)) for key, values in _entries(parser, PLAIN, path, notes).items()}
    grouped = _entries(parser, GROUPED, path, notes)
    if len(grouped) > 1:
        spec["zip"] = [grouped]
    for key, values in (alone if len(grouped) > 1 else {**alone, **grouped}).items():
        spec["fixed" if len(values) == 1 else "axes"][key] = values[0] if len(values) == 1 else values
    return spec, notes


def _entries(parser: configparser.ConfigParser, section: str, path: Path, notes: list[str]) -> dict[str, list]:
    found: dict[str, list] = {}
    for key, text in parser.items(section) if parser.has_section(section) else ():
        where = f"{path.name}: [{section}] {key}"
        words = [word.strip() for word in text.split(",") if word.strip()]
        if key.replace("_", "-") in NO_COUNTERPART:
            notes.append(f"{key} = {text} is left out: {NO_COUNTERPART[key.replace('_', '-')]}")
            continue
        if key not in KEYS and key not in KEYS.values() and key != "particles":
            raise InputError(f"unknown option '{key}' ({where}). {nearest(key, [*KEYS, *NO_COUNTERPART])}")
        ours = key_here(key)
        found[ours] = [value_here(ours, _number(word)) for word in words]
        particles = [PARTICLES[word] for word in words if word in PARTICLES]
        if particles and len(words) == 1:
            found["particles"] = particles
        elif particles:
            notes.append(f"the numbers of particles in {key} = {text} are left out: write one spec per size")
    return found


def _number(word: str) -> Any:
    for kind in (int, float):
        try:
            return kind(word)
        except ValueError:
            continue
    return word
