"""Runs fixed work with two builds in turn and compares point by point."""
import shutil
import statistics
import subprocess
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

from sweep import callgrind
from sweep.bench import Bench, complaint, point_command, state_command
from sweep.decision import FASTER, NOISE_TO_STOP, SLOWER, UNSTABLE, Decision, decide, exact_change, with_counts
from sweep.errors import InputError, SweepError
from sweep.exchange import read_google_benchmark
from sweep.points import Point, expand
from sweep.spec import Spec
from sweep.store import Store, load_record

WORK_COUNTS = ("candidate_pairs", "body_pairs", "triangle_pairs", "newton_steps", "fall_backs")
INSTRUCTIONS = "instructions"
MOST = 4  # times the pairs that were asked for
LOOK = 5  # pairs between two looks at the noise
CALM = 0.01  # of a sample's CPU time: so much longer it took at most if nothing held it up
LEAST_CALM = 3  # samples
LEAST_TOLD = 5e-5  # of a count: less would read as 0.00 %


@dataclass
class Side:
    """One of the two: CPU times (s) of a step, wall times (s) of a step's phases in samples that other work did not hold
    up, exact counts per step."""
    cpu_s: list[float] = field(default_factory=list)
    phases_s: list[dict[str, float]] = field(default_factory=list)
    held_up: int = 0  # samples
    counts: dict[str, float] = field(default_factory=dict)
    machine: dict = field(default_factory=dict)
    trouble: str = ""
    not_counted: str = ""  # why there are no instructions

    def add(self, record: dict) -> None:
        """The samples of one process: of each the least time, which other work disturbs least."""
        samples = [sample for sample in record["samples"]]
        self.cpu_s.append(min(sample["cpu_s"] / sample["steps"] for sample in samples))
        self.look_at(record)

    def look_at(self, record: dict) -> None:
        """Phases, counts and machine of a record."""
        self.machine = record.get("machine") or {}
        for sample in record["samples"]:
            phases = {phase: seconds / sample["steps"] for phase, seconds in sample.get("phases_s", {}).items()}
            if phases and sample["wall_s"] <= (1 + CALM) * sample["cpu_s"]:
                self.phases_s.append(phases)
            elif phases:
                self.held_up += 1
        counts = record.get("counts") or {}
        self.counts |= {name: counts[name] / counts["steps"] for name in WORK_COUNTS if name in counts}


@dataclass(frozen=True)
class Counted:
    """What callgrind runs: builds that valgrind can run, and a spec with a shorter point for each that is timed."""
    programs: tuple[Path, Path]
    spec: Spec


@dataclass(frozen=True)
class Comparison:
    """What became of one point."""
    name: str
    verdict: str
    decision: Decision | None
    before: Side
    after: Side
    why: str

    def counts(self) -> dict[str, float]:
        """Relative change of every exact count that changed."""
        changes = {name: exact_change(self.before.counts.get(name), self.after.counts.get(name))
                   for name in (INSTRUCTIONS, *WORK_COUNTS)}
        return {name: change for name, change in changes.items() if change}


def compare_builds(spec: Spec, benches: tuple[Bench, Bench], counted: Counted | None, pairs: int,
                   tell: Callable[[str], None]) -> list[Comparison]:
    """Runs every point `pairs` times with each build, A B B A A B..., up to MOST times as often while the noise is too large
    (whatever the change: a rule that looked at it would find one too often), and then, if there is something for it, callgrind.
    Each run is of a copy of the program that is made for it: where a file happens to lie in memory may change how fast it
    runs, for as long as it stays there; so that is part of the noise and not of the difference. The
    copies of a point stay until it is done, else the next ones would take their places."""
    points = expand(spec)
    short = expand(counted.spec) if counted else points
    if len(short) != len(points):
        raise InputError(f"{len(short)} points for callgrind and {len(points)} to be timed ({spec.name}.json: presets."
                         f"{counted.spec.preset}). Give each of them one.")
    tell(f"{len(points)} points, {pairs} runs of each version in turn{', and callgrind' if counted else ''}")
    found = []
    with tempfile.TemporaryDirectory() as place:
        for point, once in zip(points, short):
            sides = (Side(), Side())
            start = _start_state(spec, benches[0], point, Path(place))
            with tempfile.TemporaryDirectory() as copies:
                for number in range(MOST * pairs):
                    if number >= pairs and number % LOOK == 0 and _settled(*sides):
                        break
                    for which in ((0, 1), (1, 0))[number % 2]:
                        if not any(side.trouble for side in sides):
                            copy = _copy(benches[which], Path(copies) / f"{number}-{which}")
                            _run(spec, copy, point, start, sides[which])
            if counted and not any(side.trouble for side in sides):
                _count(counted, benches, once, _start_state(counted.spec, benches[0], once, Path(place)), sides)
            found.append(judge(point.name, *sides))
            tell(f"{found[-1].name}: {found[-1].verdict} ({found[-1].why})")
    return found


def compare_records(spec: Spec, folders: tuple[Path, Path]) -> list[Comparison]:
    """Compares two results folders, sample by sample. SweepError if they share no finished point."""
    found = []
    for point in expand(spec):
        records = [load_record(Store(folder, spec.name).record_path(point.id), point.id)[0] for folder in folders]
        if any(record is None for record in records):
            continue
        sides = (Side(), Side())
        for record, side in zip(records, sides):
            if record["status"] != "finished" or not record["check"]["passed"]:
                side.trouble = record.get("reason", "its check failed")
                continue
            side.cpu_s = [sample["cpu_s"] / sample["steps"] for sample in record["samples"]]
            side.look_at(record)
        shorter = min(len(side.cpu_s) for side in sides)
        for side in sides:
            side.cpu_s = side.cpu_s[:shorter]
        found.append(judge(point.name, *sides))
    if not found:
        raise SweepError(f"the two share no point of {spec.name} ({folders[0]}, {folders[1]}). Run `sweep run {spec.name}` in both.")
    return found


def compare_benchmarks(files: tuple[Path, Path]) -> list[Comparison]:
    """Compares two JSON files of Google Benchmark by name, repetition by repetition."""
    before, after = (read_google_benchmark(file) for file in files)
    common = [name for name in before if name in after]
    if not common:
        raise InputError(f"the two have no benchmark in common ({files[0]}, {files[1]}). Run the same program.")
    shorter = {name: min(len(before[name]), len(after[name])) for name in common}
    return [judge(name, Side(before[name][:shorter[name]]), Side(after[name][:shorter[name]])) for name in common]


def judge(name: str, before: Side, after: Side) -> Comparison:
    """The verdict and what explains it."""
    if after.trouble or before.trouble:
        # What does not run any more is the worst slow-down; what did not run before cannot be compared.
        verdict = UNSTABLE if before.trouble else SLOWER
        return Comparison(name, verdict, None, before, after, f"{'before' if before.trouble else 'now'}: "
                          f"{before.trouble or after.trouble}")
    decision = decide(before.cpu_s, after.cpu_s)
    comparison = Comparison(name, decision.verdict, decision, before, after, "")
    counts = comparison.counts()
    verdict = with_counts(decision, counts.get(INSTRUCTIONS, 0), max((counts.get(each, 0) for each in WORK_COUNTS)))
    comparison = replace(comparison, verdict=verdict)
    return replace(comparison, why=_why(comparison, decision))


def _why(comparison: Comparison, decision: Decision) -> str:
    words = [f"CPU time {100 * decision.change:+.1f} %, p = {decision.p:.2g}, noise {100 * decision.noise:.1f} %"]
    words += [f"{name.replace('_', ' ')} {100 * change:+.2f} %" for name, change in comparison.counts().items()
              if abs(change) >= LEAST_TOLD]
    words += [f"instructions not counted: {why}" for why in [comparison.before.not_counted or comparison.after.not_counted] if why]
    words.append(_phase(comparison) if comparison.verdict in (SLOWER, FASTER) else "")
    return "; ".join(filter(None, words))


def _phase(comparison: Comparison) -> str:
    """The phase that changed most in the direction of the verdict. Phases have wall times: samples that waited tell nothing."""
    both = comparison.before.phases_s, comparison.after.phases_s
    if min(map(len, both)) < LEAST_CALM:
        held_up = comparison.before.held_up + comparison.after.held_up
        return "other work held the runs up too often to name the phase" if held_up else ""
    before, after = ({phase: statistics.median(each.get(phase, 0) for each in samples) for phase in samples[0]} for samples in both)
    gains = {phase: (after[phase] - before[phase]) / sum(before.values()) for phase in before if phase in after}
    phase = (max if comparison.verdict == SLOWER else min)(gains, key=gains.get)
    return f"mostly in phase {phase}: {100 * gains[phase]:+.1f} % of the step"


def _start_state(spec: Spec, bench: Bench, point: Point, place: Path) -> Path | None:
    """Where the point starts, for both builds alike: computed once, by the older one. SweepError if that fails."""
    if point.start is None:
        return None
    path = place / f"{point.start.id}.json"
    if not path.exists():
        trouble = _trouble(state_command(bench, point.start, spec.folder, 1, ["--final-state", str(path)]), spec)
        if trouble:
            raise SweepError(f"the start state cannot be computed ({bench.path}: {trouble}). Compare with a version that can.")
    return path


def _settled(before: Side, after: Side) -> bool:
    return bool(before.trouble or after.trouble) or decide(before.cpu_s, after.cpu_s).noise <= NOISE_TO_STOP


def _copy(bench: Bench, folder: Path) -> Bench:
    """The program once more, in a new folder."""
    folder.mkdir()
    try:
        return replace(bench, path=Path(shutil.copy(bench.path, folder)))
    except OSError as error:
        raise SweepError(f"cannot copy {bench.path} ({folder}: {error.strerror}). Name a folder with room in TMPDIR.") from None


def _run(spec: Spec, bench: Bench, point: Point, start: Path | None, side: Side) -> None:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "record.json"
        side.trouble = _trouble(point_command(bench, point, spec.folder, ["--record", str(file)], start), spec)
        if not side.trouble:
            record, broken = load_record(file, point.id)
            if record is None:
                side.trouble = f"no record: {broken}"
            else:
                side.add(record)


def _count(counted: Counted, benches: tuple[Bench, Bench], point: Point, start: Path | None, sides: tuple[Side, Side]) -> None:
    """Instructions of both, at the same time: they are not disturbed by each other."""
    commands = [point_command(replace(bench, path=path), point, counted.spec.folder, [], start)
                for bench, path in zip(benches, counted.programs)]
    with ThreadPoolExecutor(2) as pool:
        found = pool.map(lambda command: callgrind.instructions(command, counted.spec.time_limit_s), commands)
    for side, (count, side.not_counted) in zip(sides, found):
        if count is not None:
            side.counts[INSTRUCTIONS] = count


def _trouble(command: list[str], spec: Spec) -> str:
    """Runs it; why it did not end well, or nothing. A machine that slept meanwhile makes a run too long once and not twice."""
    for _ in range(2):
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=spec.time_limit_s, check=False)
        except subprocess.TimeoutExpired:
            continue
        except OSError as error:
            raise SweepError(f"{command[0]} does not start ({error.strerror}). Name a folder where programs may run in TMPDIR.") from None
        return "" if done.returncode == 0 else complaint(done)
    return f"needed more than {spec.time_limit_s:g} s, twice"
