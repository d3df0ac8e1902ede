"""Every header compiles alone."""
import os
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LAYERS = ("kernels", "dem", "experiments")


def include_flags() -> list[str]:
    eigen = subprocess.run(["pkg-config", "--cflags-only-I", "eigen3"], capture_output=True, text=True)
    folder = eigen.stdout.strip().removeprefix("-I") or "/usr/include/eigen3"
    return ["-I", str(ROOT), "-isystem", folder]


def headers() -> list[Path]:
    return [h for layer in LAYERS for h in sorted((ROOT / layer).rglob("*.hpp")) if "installed_package" not in h.parts]


def complaint(header: Path) -> str:
    """What the compiler says to a file that includes nothing but `header`, twice."""
    source = f'#include "{header.relative_to(ROOT)}"\n' * 2
    command = [os.environ.get("CXX", "g++"), "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror",
               "-march=x86-64-v3", *include_flags(), "-x", "c++", "-"]
    done = subprocess.run(command, input=source, capture_output=True, text=True)
    return "" if done.returncode == 0 else f"{header.relative_to(ROOT)}:\n{done.stderr[:1000]}"


def test_every_header_compiles_alone():
    assert len(headers()) > 20
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        complaints = [c for c in pool.map(complaint, headers()) if c]
    assert not complaints, "\n".join(complaints)


def test_a_header_that_leans_on_another_is_noticed(tmp_path, monkeypatch):
    monkeypatch.setattr(f"{__name__}.ROOT", tmp_path)
    (tmp_path / "leaning.hpp").write_text("#pragma once\nstd::vector<int> lent();\n")
    assert "leaning.hpp" in complaint(tmp_path / "leaning.hpp")
