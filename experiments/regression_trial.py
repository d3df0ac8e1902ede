#!/usr/bin/python3
"""Puts the decision of tools/regress to the test: builds this commit as it is, with one kernel 5 % slower, and with one phase 5 %
slower, and counts how often each is found, and how often two identical builds are called slower, while another process loads
a core. What came out is kept after every try in RESULTS/regression_trial.json for the report; after --minutes, or where it was
ended, the same command goes on with the next try. It may be stopped and continued at any time, as CPU time does not run on
meanwhile. 40 tries take ten minutes, and half an hour on two cores that others use too.
exit codes: 0 found in every try and at most 1 false alarm in 20, 1 otherwise, 2 not all tries are done, 3 usage, 4 environment"""
import argparse
import json
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "experiments"))
from sweep.bench import find_bench  # noqa: E402
from sweep.decision import SLOWER  # noqa: E402
from sweep.regression import compare_builds  # noqa: E402
from sweep.spec import read_spec  # noqa: E402
from sweep.store import now, write_json  # noqa: E402

SOURCE = ROOT / "build/regress/trial"
SCHEMA = "trigrain-regression-trial-1"
SPEC = {"title": "Trial", "fixed": {
    "scene": "hopper-dense", "halo": "published", "particles": 64, "vertices": 10, "kernel": "hybrid-pair", "precheck": "none",
    "grid": "regular", "contact_rule": "all-pairs", "scheme": "serial", "threads": 1, "steps": 10, "repeats": 3,
    "check_steps": 1, "triangle_search": "every-step"}}
# name -> file, text, what takes its place
SOLVE = """  narrow.kernel->closest({particles.mesh[pair.a]->triangles.view(), b, triangles}, {.reach = reach}, hits,
                         buffer.kernel);
"""
MERGE = "    s.merge(stats);\n"
INJECTED = {
    "kernel": ("dem/narrow_phase.cpp", SOLVE, SOLVE + """
  if (static int calls = 0; narrow.kernel->name == "hybrid-pair" && ++calls % 20 == 0) {
    static Hits thrown_away;
    thrown_away.clear();
    KernelCounts not_counted;
    narrow.kernel->closest({particles.mesh[pair.a]->triangles.view(), b, triangles}, {.reach = reach}, thrown_away,
                           not_counted);
  }
"""),
    "phase": ("dem/simulation.cpp", MERGE, MERGE + """
    const auto cpu_s = [] {  // wall time would count what this thread waited for the load
      timespec now{};
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
      return now.tv_sec + 1e-9 * now.tv_nsec;
    };
    static double last_s = cpu_s();
    double spent_s = 0;
    for (const double seconds : stats.seconds) spent_s += seconds;
    const double now_s = cpu_s();
    const double end_s = now_s + 0.05 * std::min(spent_s, now_s - last_s);
    while (cpu_s() < end_s) {
    }
    last_s = cpu_s();
""")}
SAME = "same"
LOAD = """
import os
parent = os.getppid()
while os.getppid() == parent:  # not longer than the trial, however that ends
    for _ in range(1_000_000):
        pass
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tries", type=int, default=10, help="of each slow-down; identical pairs: twice as many")
    parser.add_argument("--pairs", type=int, default=30, help="runs of each build in a try: %(default)s, as in tools/regress")
    parser.add_argument("--minutes", type=float, default=1e9, help="begin no try after so many; 0 only builds")
    parser.add_argument("--fresh", action="store_true", help="build anew and forget the tries there are")
    parser.add_argument("--results", type=Path, default=ROOT / "results", help="default: %(default)s")
    parser.error = lambda message: parser.exit(3, f"{message} (regression_trial). See --help.\n")
    options = parser.parse_args()
    end = time.monotonic() + 60 * options.minutes
    kept = options.results / "regression_trial.json"
    trial = None if options.fresh else read_trial(kept, options.pairs)
    if trial is None:
        trial = {"schema": SCHEMA, "started_utc": now(), "commit": build_all(), "pairs": options.pairs, "machine": None, "tries": []}
        write_json(kept, trial)
    load = subprocess.Popen([sys.executable, "-c", LOAD], start_new_session=True)  # Linux shares cores out by session
    try:
        with tempfile.TemporaryDirectory() as place:
            for name in missing(trial, options.tries):
                if time.monotonic() > end:
                    break
                trial["tries"].append(one_try(name, Path(place), trial))
                write_json(kept, trial)
    finally:
        load.kill()
    return verdict(trial, options.tries)


def read_trial(path: Path, pairs: int) -> dict | None:
    """What an earlier call left unfinished; None if there is nothing to go on with."""
    try:
        trial = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    built = all((SOURCE / "bin" / name / "dem_bench").exists() for name in (SAME, *INJECTED))
    return trial if built and trial.get("schema") == SCHEMA and trial["pairs"] == pairs else None


def missing(trial: dict, tries: int) -> list[str]:
    """The tries that are not done, the kinds in turn: what the machine does meanwhile hits all alike."""
    done = Counter(each["build"] for each in trial["tries"])
    turns = [name for number in range(tries) for name in (SAME, "kernel", SAME, "phase")]
    for name, number in done.items():
        for _ in range(min(number, turns.count(name))):
            turns.remove(name)
    return turns


def one_try(name: str, place: Path, trial: dict) -> dict:
    """The programs as they are against those named so, as tools/regress compares them."""
    path = place / "trial.json"
    path.write_text(json.dumps(SPEC), encoding="utf-8")
    spec = read_spec(path)
    benches = tuple(find_bench(spec.program, SOURCE / "bin" / each, ROOT) for each in (SAME, name))
    began = time.monotonic()
    found, = compare_builds(spec, benches, None, trial["pairs"], lambda text: print(f"{name}: {text}", flush=True))
    if found.decision is None:
        sys.exit(f"a build does not run: {found.why}")
    trial["machine"] = found.before.machine
    return {"build": name, "verdict": found.verdict, "change": found.decision.change, "p": found.decision.p,
            "noise": found.decision.noise, "why": found.why, "took_s": round(time.monotonic() - began, 1)}


def verdict(trial: dict, tries: int) -> int:
    """Prints the counts; returns the exit code."""
    for name in (SAME, *INJECTED):
        print(f"{name}: {dict(Counter(each['verdict'] for each in trial['tries'] if each['build'] == name))}")
    slower = Counter(each["build"] for each in trial["tries"] if each["verdict"] == SLOWER)
    left = missing(trial, tries)
    if left:
        print(f"{len(left)} tries are left; the same command goes on")
        return 2
    return 0 if all(slower[name] >= tries for name in INJECTED) and slower[SAME] <= 1 else 1


def build_all() -> str:
    """Makes folders with dem_bench, as committed and with each slow-down; returns the commit."""
    commit = run("git", "-C", ROOT, "rev-parse", "HEAD").strip()
    run("git", "-C", ROOT, "worktree", "prune")
    if not SOURCE.exists():
        run("git", "-C", ROOT, "worktree", "add", "--detach", SOURCE, "HEAD")
    run("git", "-C", SOURCE, "checkout", "--quiet", "--force", "--detach", commit)
    run("cmake", "-S", SOURCE, "--preset", "release", "-DTRIGRAIN_TESTS=OFF")
    for name in (SAME, *INJECTED):
        print(f"building {name}", flush=True)
        if name in INJECTED:
            file, text, slower = INJECTED[name]
            before = (SOURCE / file).read_text()
            if before.count(text) != 1:
                print(f"the place of the slow-down is not there ({file}: {text.strip()}). Bring this program up to date.",
                      file=sys.stderr)
                sys.exit(4)
            (SOURCE / file).write_text(before.replace(text, slower))
        run("cmake", "--build", SOURCE / "build/release", "--target", "dem_bench")
        folder = SOURCE / "bin" / name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "dem_bench").unlink(missing_ok=True)
        run("cp", SOURCE / "build/release/bin/dem_bench", folder)
        if name in INJECTED:
            (SOURCE / file).write_text(before)
    return commit


def run(*words: object) -> str:
    """What the command prints; ends the program where it fails."""
    done = subprocess.run(list(map(str, words)), cwd=SOURCE if words[0] == "cmake" else None, capture_output=True, text=True,
                          check=False)
    if done.returncode != 0:
        print(done.stdout[-2000:] + done.stderr[-2000:], file=sys.stderr)
        sys.exit(4)
    return done.stdout


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that nothing is left behind
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
