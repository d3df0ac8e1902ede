"""The command line of peer_bench: that of dem_bench and --engine."""
import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from peers import liggghts, yade
from peers.bodies import read_bodies
from peers.outcome import Run, Unable
from peers.record import record_of
from sweep.store import write_json

OURS = "trigrain"
PEERS = {"liggghts": liggghts, "yade": yade}
FINE, CHECK_FAILED, BAD_INPUT, BAD_ENVIRONMENT = 0, 1, 3, 4


def main() -> int:
    """Runs one point; exit codes as all programs here."""
    choice = _Parser(
        prog="peer_bench", allow_abbrev=False,
        description="Runs one point with another engine on bodies that dem_bench hands over, on one thread: checks what came out "
                    "against ours, and tells its times. All options of dem_bench are taken; with --engine trigrain it is dem_bench.")
    choice.add_argument("--engine", default=OURS, help=f"{OURS} (default), {', '.join(PEERS)}")
    choice.add_argument("--list", action="store_true", help="engines that are installed, and all names of dem_bench")
    chosen, words = choice.parse_known_args()
    dem_bench = Path(sys.argv[0]).resolve().parent / "dem_bench"
    if not os.access(dem_bench, os.X_OK):
        return _refuse(f"there is no dem_bench beside it ({dem_bench}). Build first: tools/build.", BAD_ENVIRONMENT)
    if chosen.list:
        return _list(dem_bench)
    if chosen.engine == OURS:
        os.execv(dem_bench, [str(dem_bench), *words, "--param", f"engine={OURS}"])
    if chosen.engine not in PEERS:
        return _refuse(f"unknown engine '{chosen.engine}' (--engine). Known: {OURS}, {', '.join(PEERS)}.", BAD_INPUT)
    if why := absent(chosen.engine):
        return _refuse(f"{why}.", BAD_ENVIRONMENT)
    options, others = _options(words, chosen.engine)
    if options.threads != 1 or min(options.steps, options.repeats) < 1 or options.warmup < 0:
        return _refuse("peers run on one thread, with at least one step and one repeat (command line). Give such numbers.", BAD_INPUT)
    return _compare(dem_bench, options, others)


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> None:
        self.exit(BAD_INPUT, f"{self.prog}: {message} (command line). See {self.prog} --help and dem_bench --help.\n")


def _options(words: list[str], engine: str) -> tuple[argparse.Namespace, list[str]]:
    """Those that are the peer's too, with dem_bench's defaults, and the words that only dem_bench needs."""
    parser = _Parser(prog="peer_bench", allow_abbrev=False, add_help=False)
    for option, default in (("steps", 20), ("warmup", 0), ("repeats", 1), ("threads", 1), ("check-steps", 5)):
        parser.add_argument(f"--{option}", type=int, default=default)
    parser.add_argument("--skin", type=float, default=0.0)
    parser.add_argument("--start-state", type=Path)
    parser.add_argument("--record", type=Path)
    parser.add_argument("--point-id", default="unnamed")
    parser.add_argument("--contact-rule")  # touching pairs are counted by "nearest", whatever times ours
    options, others = parser.parse_known_args(words)
    options.engine = engine
    return options, others


def absent(engine: str) -> str | None:
    """Why the engine cannot be asked here."""
    program = PEERS[engine].PROGRAM
    return None if shutil.which(program) else f"there is no program '{program}' (PATH). On Debian: apt-get install {program}"


def _list(dem_bench: Path) -> int:
    done = subprocess.run([dem_bench, "--list"], stdout=subprocess.PIPE, text=True)
    missing = {engine: why for engine in PEERS if (why := absent(engine))}
    print(done.stdout.rstrip("\n"), "engines", f"  {OURS}: dem_bench of this build",
          *(f"  {engine}: {PEERS[engine].__doc__}" for engine in PEERS if engine not in missing),
          "missing engines", *(f"  {engine}: {why}" for engine, why in missing.items()), sep="\n")
    return done.returncode


def _compare(dem_bench: Path, options: argparse.Namespace, others: list[str]) -> int:
    """Ours goes one step, hands over its bodies, and goes on as far as the peer does, for the peer to be compared with."""
    wanted = Run(options.steps, options.warmup, options.repeats, options.skin)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        state = options.start_state

        def ours(steps: int, name: str, *more: object) -> int:
            begin = ["--start-state", state] if state else []
            return subprocess.run([dem_bench, *others, *begin, "--contact-rule", "nearest", "--skin", str(options.skin),
                                   "--steps", str(steps), "--hand-over", folder / name, *more], stdout=subprocess.DEVNULL).returncode

        if code := ours(1, "start.json", "--check-steps", "1", "--final-state", folder / "state.json"):
            return _refuse("dem_bench did not hand over its bodies (see above).", code)
        bodies, state = read_bodies(folder / "start.json"), folder / "state.json"
        code = ours(wanted.all_steps, "end.json", "--check-steps", str(options.check_steps), "--record", folder / "ours.json")
        if code not in (FINE, CHECK_FAILED):
            return _refuse("dem_bench did not go on from its own state (see above).", code)
        record = json.loads((folder / "ours.json").read_text(encoding="utf-8"))
        try:
            outcome = PEERS[options.engine].run(bodies, wanted, folder)
        except Unable as why:
            return _refuse(f"{options.engine} did not run: {why}.", BAD_ENVIRONMENT)
        record = record_of(options, record, bodies, read_bodies(folder / "end.json"), outcome)
    for item in record["check"]["how"]:
        print(f"check {item['what']:10} {'passed' if item['passed'] else 'FAILED'}: {item['detail']}")
    samples = sorted(outcome.wall_s)
    print(f"{1e6 * samples[(len(samples) - 1) // 2] / options.steps / len(bodies.mass):.3g} us per particle and step")
    if options.record:
        write_json(options.record, record)
    return FINE if record["check"]["passed"] else CHECK_FAILED


def _refuse(words: str, code: int) -> int:
    print(f"peer_bench: {words}", file=sys.stderr)
    return code
