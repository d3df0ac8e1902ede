"""Who may include whom: kernels <- dem <- experiments, inside dem phase by phase, and no cycle anywhere."""
import ast
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LAYERS = {"kernels": {"kernels"}, "dem": {"kernels", "dem"}, "experiments": {"kernels", "dem", "experiments"}}

# Parts of dem, each of one or more files, and the parts they may see beside themselves.
PARTS = {"mesh": {"mesh", "shapes", "load_mesh", "mesh_defects", "shape_file", "shape_features", "surface"}, "scene": {"scene", "scenes", "load_scene", "critical_step", "hertz"},
         "particles": {"particles"}, "grid": {"grid", "grid_kind", "grid_pairs", "grid_projection", "spacetree", "dense_grid", "pair_source", "sphere_array",
                  "verlet_list"}, "contact": {"contact"},
         "contact_rule": {"contact_rule"}, "features": {"feature_pairs", "feature_contacts", "edge_array"},
         "narrow_phase": {"narrow_phase", "kept_pairs"}, "runtime": {"runtime"}, "contact_list": {"contact_list"},
         "scheme": {"scheme"}, "forces": {"forces"}, "motion": {"motion"}, "step_stats": {"step_stats"},
         "simulation": {"simulation"}, "random": {"random"}, "step_size": {"step_size"}, "loads": {"loads"},
         "phase_observer": {"phase_observer"}, "contact_step_limit": {"contact_step_limit"}, "contact_law": {"contact_law"},
         "budget": {"budget"}, "json_reader": {"json_reader"}, "block_sum": {"block_sum"}, "fast_bodies": {"fast_bodies"},
         "watch": {"watch"}, "vectors": {"vectors"}, "contact_pack": {"contact_pack"}}
BASE = {"vectors": set(), "mesh": {"random", "vectors"}, "scene": {"mesh", "random", "json_reader"}, "particles": {"scene", "mesh"}, "random": set(),
        "json_reader": set(), "loads": set(), "step_stats": set(), "phase_observer": {"step_stats"}, "runtime": {"phase_observer", "step_stats"}}
MAY_SEE = BASE | {"grid": {"particles", "scene", "runtime", "step_stats", "vectors"}, "contact": set(), "contact_rule": {"contact", "particles", "mesh"},
                  "features": {"contact", "contact_rule", "grid", "particles", "mesh", "vectors"},
                  "narrow_phase": {"contact_rule", "contact", "features", "grid", "particles", "mesh", "runtime", "vectors"},
                  "scheme": {"narrow_phase", "grid", "particles", "runtime"},
                  "contact_list": {"contact", "narrow_phase", "particles", "runtime"},
                  "forces": {"particles", "contact", "contact_pack", "scene", "loads", "contact_law", "vectors"},
                  "contact_pack": {"contact", "vectors"}, "contact_law": {"particles", "contact", "contact_pack", "scene", "mesh"},
                  "budget": {"particles", "contact", "contact_pack", "loads"}, "block_sum": {"runtime"},
                  "contact_step_limit": {"particles", "contact", "scene", "contact_law", "contact_list", "runtime", "block_sum"},
                  "motion": {"particles", "contact", "scene", "loads", "vectors"},
                  "fast_bodies": {"particles"},
                  "step_size": {"grid", "particles", "loads", "fast_bodies", "vectors"},
                  "watch": {"budget", "contact_list", "contact_step_limit", "fast_bodies", "forces", "particles", "runtime", "step_stats"},
                  "simulation": set(PARTS) - {"simulation"}}


def part_of(stem: str) -> str:
    """The part of dem that a file belongs to; a name in no part is its own, and sees nothing until it is listed here."""
    return next((part for part, stems in PARTS.items() if stem in stems), stem)


def include_graph(root: Path) -> dict[str, set[str]]:
    """Per source file of the layers (path from root): the project's headers it includes."""
    graph = {}
    for layer in LAYERS:
        for file in sorted((root / layer).rglob("*")):
            if file.suffix in {".hpp", ".cpp"} and "tests" not in file.relative_to(root).parts:
                includes = re.findall(r'^\s*#\s*include\s*"([^"]+)"', file.read_text(), re.MULTILINE)
                graph[str(file.relative_to(root))] = set(includes)
    return graph


def forbidden(graph: dict[str, set[str]]) -> list[str]:
    """Includes that cross the layers, or the parts of dem, the wrong way."""
    wrong = []
    for file, includes in graph.items():
        layer, stem = file.split("/")[0], Path(file).stem
        for include in includes:
            other_layer, other = include.split("/")[0], part_of(Path(include).stem)
            allowed = other_layer in LAYERS[layer]
            if allowed and layer == other_layer == "dem":
                allowed = other == part_of(stem) or other in MAY_SEE.get(part_of(stem), set())
            if not allowed:
                wrong.append(f"{file} includes {include}")
    return wrong


def cycle(graph: dict[str, set[str]]) -> list[str]:
    """Some chain of files that ends where it began; empty if there is none."""
    done, path = set(), []

    def visit(file: str) -> list[str]:
        if file in path:
            return path[path.index(file):] + [file]
        if file in done:
            return []
        path.append(file)
        found = next((c for c in map(visit, sorted(graph.get(file, ()))) if c), [])
        path.pop()
        done.add(file)
        return found

    return next((c for c in map(visit, sorted(graph)) if c), [])


def dem_parts(graph: dict[str, set[str]]) -> dict[str, set[str]]:
    """The graph of dem by part, a header and its source counted together."""
    parts: dict[str, set[str]] = {}
    for file, includes in graph.items():
        if file.startswith("dem/"):
            part = part_of(Path(file).stem)
            parts.setdefault(part, set()).update(
                other for i in includes if i.startswith("dem/") and (other := part_of(Path(i).stem)) != part)
    return parts


def test_includes_follow_the_layers():
    graph = include_graph(ROOT)
    assert len(graph) > 30
    assert not forbidden(graph)


def test_includes_are_written_from_the_root():
    missing = [f"{f}: {i}" for f, includes in include_graph(ROOT).items() for i in includes if not (ROOT / i).exists()]
    assert not missing


def test_no_cycles():
    graph = include_graph(ROOT)
    assert not cycle(graph)
    assert not cycle(dem_parts(graph))


def test_the_allowed_edges_have_no_cycle():
    assert not cycle(MAY_SEE)


@pytest.mark.parametrize("file, include", [
    ("kernels/brute.cpp", "dem/mesh.hpp"), ("dem/grid.cpp", "experiments/record.hpp"), ("dem/grid.hpp", "dem/contact.hpp"),
    ("dem/forces.cpp", "dem/grid.hpp"), ("dem/motion.cpp", "dem/simulation.hpp"), ("dem/mesh.hpp", "dem/particles.hpp"),
    ("dem/unlisted.cpp", "dem/particles.hpp"), ("kernels/brute.cpp", "brute.hpp")])
def test_a_wrong_include_is_noticed(file, include):
    assert forbidden({file: {include}})


def test_a_cycle_is_noticed():
    assert cycle({"a": {"b"}, "b": {"c"}, "c": {"a"}})
    assert not cycle({"a": {"b", "c"}, "b": {"c"}})


def imports(file: Path) -> set[str]:
    """Top-level names of all modules that a Python file imports."""
    names = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names.add(node.module.split(".")[0])
    return names


def test_plots_import_nothing_of_the_project():
    files = [f for f in sorted((ROOT / "plots").rglob("*.py")) if "tests" not in f.parts]
    own = {f.stem for f in files} | {"plots"}
    allowed = set(sys.stdlib_module_names) | {"numpy", "matplotlib", "mpl_toolkits"} | own
    wrong = {str(f.relative_to(ROOT)): sorted(imports(f) - allowed) for f in files if imports(f) - allowed}
    assert not wrong


def test_nobody_imports_tools():
    files = [f for layer in ("experiments", "plots") for f in (ROOT / layer).rglob("*.py")]
    assert not [f for f in files if "tools" in imports(f)]
