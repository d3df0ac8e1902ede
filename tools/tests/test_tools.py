"""What the tools say and return where nothing need be built."""
import os
import runpy
import subprocess
from pathlib import Path

import pytest

TOOLS = Path(__file__).resolve().parents[1]


def call(tool: str, *arguments: str, path: str | None = None) -> subprocess.CompletedProcess:
    environment = {**os.environ, "PATH": path or os.environ["PATH"]}
    return subprocess.run(["/bin/bash", TOOLS / tool, *arguments], capture_output=True, text=True, timeout=60,
                          env=environment, check=False)


def program(folder: Path, name: str, text: str) -> None:
    (folder / name).write_text(f"#!/bin/bash\n{text}\n")
    (folder / name).chmod(0o755)


@pytest.mark.parametrize("tool", ["install", "reproduce", "test"])
def test_help_is_given_and_unknown_arguments_are_refused(tool):
    helped = call(tool, "--help")
    assert helped.returncode == 0 and "usage" in helped.stdout
    refused = call(tool, "--fast")
    assert refused.returncode == 3 and "'--fast'" in refused.stderr


@pytest.mark.parametrize("arguments", [["--figures", "8.5,8.3"], ["--figures=8.3"]])
def test_an_unknown_figure_lists_the_known_ones(arguments):
    refused = call("reproduce", *arguments)
    assert refused.returncode == 3
    assert "unknown figure '8.3'" in refused.stderr and "8.4 8.5 8.6 8.7 8.8 8.9" in refused.stderr


def test_figures_needs_a_value():
    assert call("reproduce", "--figures").returncode == 3


def test_without_root_the_command_to_run_is_printed(tmp_path):
    program(tmp_path, "dpkg-query", "printf 'cmake:installed git:installed '; exit 1")
    program(tmp_path, "id", "echo 1000")
    program(tmp_path, "sudo", "exit 1")
    refused = call("install", path=f"{tmp_path}:/usr/bin:/bin")
    assert refused.returncode == 4
    assert "sudo apt-get install --no-install-recommends g++ ninja-build pkg-config" in refused.stderr


def test_as_root_only_what_is_missing_is_installed(tmp_path):
    all_but_one = subprocess.run(["/bin/bash", TOOLS / "install", "--help"], capture_output=True, text=True, check=True)
    packages = all_but_one.stdout.split(" of: ")[1].split()
    there = " ".join(f"{package}:installed" for package in packages if package != "libqhull-dev")
    program(tmp_path, "dpkg-query", f"printf '{there} '; exit 1")
    program(tmp_path, "id", "echo 0")
    program(tmp_path, "apt-get", f'echo "$@" >> {tmp_path}/asked')
    assert call("install", path=f"{tmp_path}:/usr/bin:/bin").returncode == 0
    assert (tmp_path / "asked").read_text().splitlines()[-1].split()[-2:] == ["--no-install-recommends", "libqhull-dev"]
    program(tmp_path, "dpkg-query", f"printf '{there} libqhull-dev:installed '")
    (tmp_path / "asked").unlink()
    assert call("install", path=f"{tmp_path}:/usr/bin:/bin").returncode == 0
    assert not (tmp_path / "asked").exists()


def test_every_line_that_mutate_breaks_is_in_the_sources_once():
    faults = runpy.run_path(str(TOOLS / "mutate"))["MUTANTS"]
    assert [fault.name for fault in faults if (TOOLS.parent / fault.file).read_text().count(fault.old) != 1] == []
