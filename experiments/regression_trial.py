#!/usr/bin/python3
"""Puts tools/regress to the test: builds this commit as it is, with one kernel 5 % slower, and with one phase 5 % slower, and
counts how often each is found, and how often two identical builds are called slower, while another process loads a core.
exit codes: 0 found in every try and at most 1 false alarm in 20, 1 otherwise, 4 environment"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SPEC = {"title": "Trial", "fixed": {
    "scene": "hopper-dense", "halo": "published", "particles": 64, "vertices": 10, "kernel": "hybrid-pair", "precheck": "none",
    "grid": "regular", "contact_rule": "all-pairs", "scheme": "serial", "threads": 1, "steps": 20, "repeats": 3,
    "check_steps": 1}}
# name -> file, text, what takes its place
INJECTED = {
    "kernel": ("dem/narrow_phase.cpp", "  if (buffer.hits.empty()) return;\n", """
  if (static int calls = 0; narrow.kernel->name == "hybrid-pair" && ++calls % 20 == 0) {
    Hits thrown_away;
    KernelCounts not_counted;
    narrow.kernel->closest({a.triangles.view(), candidates.b.view(), candidates.pairs}, {.reach = buffer.reach}, thrown_away,
                           not_counted);
  }
  if (buffer.hits.empty()) return;
"""),
    "phase": ("dem/simulation.cpp", "    s.merge(stats);\n", """
    s.merge(stats);
    double spent = 0;
    for (const double seconds : stats.seconds) spent += seconds;
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(0.05 * spent)) {
    }
""")}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tries", type=int, default=10, help="of each slow-down; identical pairs: twice as many")
    parser.add_argument("--pairs", type=int, default=30, help="runs of each build in a try: %(default)s")
    options = parser.parse_args()
    folders = build_all()
    load = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    try:
        with tempfile.TemporaryDirectory() as place:
            spec = Path(place) / "trial.json"
            spec.write_text(json.dumps(SPEC))
            found = {name: tally(folders["same"], folders[name], spec, options.pairs, tries) for name, tries in (
                ("kernel", options.tries), ("phase", options.tries), ("same", 2 * options.tries))}
    finally:
        load.kill()
    good = all(found[name]["slower"] == options.tries for name in INJECTED) and found["same"].get("slower", 0) <= 1
    return 0 if good else 1


def tally(base: Path, head: Path, spec: Path, pairs: int, tries: int) -> dict[str, int]:
    """Verdicts of so many calls of tools/regress."""
    verdicts: dict[str, int] = {"slower": 0}
    for number in range(tries):
        done = subprocess.run([ROOT / "tools/regress", base, head, "--spec", spec, "--pairs", str(pairs)], capture_output=True,
                              text=True, check=False)
        verdict = {0: "not slower", 1: "slower", 2: "unstable"}.get(done.returncode)
        if verdict is None:
            sys.exit(f"tools/regress failed: {done.stderr}")
        verdicts[verdict] = verdicts.get(verdict, 0) + 1
        print(f"{head.name} {number + 1}/{tries}: {done.stdout.splitlines()[0]}", flush=True)
    print(f"{head.name}: {verdicts}", flush=True)
    return verdicts


def build_all() -> dict[str, Path]:
    """Folders with dem_bench: as committed, and with each slow-down."""
    source = ROOT / "build/regress/trial"
    run("git", "-C", ROOT, "worktree", "prune")
    if not source.exists():
        run("git", "-C", ROOT, "worktree", "add", "--detach", source, "HEAD")
    run("git", "-C", source, "checkout", "--quiet", "--force", "--detach", subprocess.run(
        ["git", "-C", ROOT, "rev-parse", "HEAD"], capture_output=True, text=True, check=True).stdout.strip())
    run("cmake", "-S", source, "--preset", "release", "-DTRIGRAIN_TESTS=OFF")
    folders = {}
    for name in ("same", *INJECTED):
        if name in INJECTED:
            file, text, slower = INJECTED[name]
            before = (source / file).read_text()
            if before.count(text) != 1:
                sys.exit(f"the place of the slow-down is not there ({file}: {text.strip()}). Bring this program up to date.")
            (source / file).write_text(before.replace(text, slower))
        run("cmake", "--build", source / "build/release", "--target", "dem_bench")
        folders[name] = source / "bin" / name
        folders[name].mkdir(parents=True, exist_ok=True)
        (folders[name] / "dem_bench").unlink(missing_ok=True)
        run("cp", source / "build/release/bin/dem_bench", folders[name])
        if name in INJECTED:
            (source / file).write_text(before)
    return folders


def run(*words: object) -> None:
    done = subprocess.run(list(map(str, words)), cwd=ROOT / "build/regress/trial" if words[0] == "cmake" else None,
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        print(done.stdout[-2000:] + done.stderr[-2000:], file=sys.stderr)
        sys.exit(4)


if __name__ == "__main__":
    sys.exit(main())
