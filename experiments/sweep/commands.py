"""What each command of `sweep` does with its options; the exit code is returned."""
import argparse
import json
import signal
import sys
from pathlib import Path

from sweep import status
from sweep.aliases import import_ini
from sweep.bench import Bench, find_bench
from sweep.counters import Counting, load_counters
from sweep.errors import InputError, SweepError, nearest
from sweep.exchange import FORMATS, rows
from sweep.merge import merge
from sweep.points import Point, comparable, expand, select
from sweep.process import Stop
from sweep.progress import duration
from sweep.projections import Projecting, sentence
from sweep.runner import Interrupted, Runner, missing_states, set_aside_broken
from sweep.spec import Spec, read_spec
from sweep.spec_schema import spec_schema
from sweep.status import BIGGER_MACHINE, CHECK_FAILED, FAILED, FINISHED, MISSING, NOT_AVAILABLE, PointStatus, status_of
from sweep.store import Store, write_whole

ROOT = Path(__file__).resolve().parents[2]
SPECS = ROOT / "experiments" / "specs"


def run(options: argparse.Namespace) -> int:
    spec = _read(options)
    bench = find_bench(spec.program, options.bin, ROOT)
    store = Store(options.results, spec.name)
    points = expand(spec)
    chosen = select(points, options.only, options.shard)
    if options.dry_run:
        return _dry_run(spec, options, bench, store, chosen)
    with store.lock():
        set_aside_broken([status_of(point, store, bench, options.cores) for point in points], store)
        statuses = [status_of(point, store, bench, options.cores) for point in chosen]
        to_run = _to_run(statuses, options)
        print(f"{spec.name} ({spec.preset}): {status.counts(statuses)}; running {len(to_run)}")
        stop = Stop()
        runner = Runner(spec, store, bench, options.cores, stop)
        interrupted = False
        with stop.listening():
            try:
                runner.run(to_run)
            except Interrupted:
                interrupted = True
            everything = [status_of(point, store, bench, options.cores) for point in points]
            status.write_index(store, spec, everything, options.cores)
    after = [status_of(point, store, bench, options.cores) for point in chosen]
    if interrupted:
        print(f"interrupted: {status.counts(after)}. Nothing is lost; the same command resumes.", file=sys.stderr)
        return 128 + (stop.signal or signal.SIGINT)
    print(f"{spec.name} ({spec.preset}): {status.counts(after)}")
    _tell_troubles(after)
    return 1 if any(each.state in (FAILED, CHECK_FAILED, MISSING) for each in after) else 0


def _to_run(statuses: list[PointStatus], options: argparse.Namespace) -> list[Point]:
    def wanted(each: PointStatus) -> bool:
        if each.state in (BIGGER_MACHINE, NOT_AVAILABLE):
            return False
        again = options.rerun_failed and each.state in (FAILED, CHECK_FAILED)
        # A record made elsewhere that cannot be made here is kept.
        fresh = options.fresh and each.other_commit and each.point.params.get("threads", 1) <= options.cores
        return each.state == MISSING or again or fresh

    return [each.point for each in statuses if wanted(each)]


def _dry_run(spec: Spec, options: argparse.Namespace, bench: Bench, store: Store, points: list[Point]) -> int:
    statuses = [status_of(point, store, bench, options.cores) for point in points]
    to_run = _to_run(statuses, options)
    running = {point.id for point in to_run}
    for each in statuses:
        state = "would run" if each.point.id in running else each.state
        print(f"{each.point.id}  {each.point.name}: {state}{f' ({each.why})' if each.why else ''}")
    states = missing_states(to_run, store)
    for state in states:
        users = sum(point.start == state for point in to_run)
        print(f"{state.id}  start state at {state.params['end_s']:g} s for {users} points: would be computed first")
    guess = _estimate(statuses, to_run)
    print(f"{spec.name} ({spec.preset}): {len(points)} points, {len(to_run)} would run and {len(states)} start states "
          f"be computed first; {status.counts(statuses)}. Estimated time of the points: {guess}")
    return 0


def _estimate(statuses: list[PointStatus], to_run: list[Point]) -> str:
    """Of each point what it took before, else the mean of those that have run."""
    known = {each.point.id: each.took_s for each in statuses if each.took_s is not None}
    if not to_run:
        return "nothing to run"
    if not known:
        return "unknown: none has run yet"
    mean = sum(known.values()) / len(known)
    return duration(sum(known.get(point.id, mean) for point in to_run))


def take_over(options: argparse.Namespace) -> int:
    spec = _read(options)
    store = Store(options.results, spec.name)
    with store.lock():
        told = [merge(store, Store(other, spec.name)) for other in options.others]
        statuses = [status_of(point, store, None, options.cores) for point in expand(spec)]
        status.write_index(store, spec, statuses, options.cores)
    print("\n".join(told))
    print(f"{spec.name} ({spec.preset}): {status.counts(statuses)}")
    return 0


def count(options: argparse.Namespace) -> int:
    spec = _read(options)
    bench = find_bench(spec.program, options.bin, ROOT)
    store = Store(options.results, spec.name)
    if spec.program.name != "dem_bench":
        raise InputError(f"{spec.program.name} has no regions to count ({spec.name}.json: program). Name a spec of dem_bench.")
    with store.lock():
        counting = Counting(spec, store, bench, ROOT)
        print(f"{spec.name} ({spec.preset}): {counting.sources()}")
        done = 0
        for point in select(expand(spec), options.only, None):
            if status_of(point, store, bench, options.cores).state != FINISHED or \
                    point.params.get("threads", 1) > options.cores:
                continue
            done += 1
            before = load_counters(store.counters_path(point.id), point.id)
            if options.fresh or before is None or counting.counts_more_than(before):
                whole = counting.count(point, store.load(point.id)[0])["whole"]
                found = [f"{name} {each['value']:.4g}" for name, each in whole.items() if each["status"] == "measured"]
                print(f"{point.name}: {', '.join(found) or 'nothing, ' + whole['instructions']['reason']}", flush=True)
    print(f"{spec.name} ({spec.preset}): {done} points counted" if done else
          f"{spec.name} ({spec.preset}): no finished point; sweep run comes first")
    return 0


def project(options: argparse.Namespace) -> int:
    spec = _read(options)
    bench = find_bench(spec.program, options.bin, ROOT)
    store = Store(options.results, spec.name)
    withheld = 0
    with store.lock():
        projecting = Projecting(spec, store, bench, ROOT)
        finished = [point for point in select(expand(spec), options.only, None)
                    if status_of(point, store, bench, options.cores).state == FINISHED]
        for series in comparable(finished, ("threads",)):
            by_threads = {point.params.get("threads", 1): point for point in series}
            if 1 not in by_threads or by_threads[1].params.get("scheme", "serial") == "serial":
                continue
            path = store.projection_path(by_threads[1].id)
            if options.fresh or not path.exists():
                projecting.project(by_threads[1], by_threads.get(2))
            found = json.loads(path.read_text(encoding="utf-8"))
            withheld += not found["validation"]["trusted"]
            print(sentence(by_threads[1].name, found), flush=True)
    print(f"{spec.name} ({spec.preset}): {withheld} projections withheld")
    return 0


def export(options: argparse.Namespace) -> int:
    spec = _read(options)
    text = FORMATS[options.format](rows(Store(options.results, spec.name), select(expand(spec), options.only, None)))
    if not options.out:
        sys.stdout.write(text)
        return 0
    write_whole(options.out, text)
    print(options.out)
    return 0


def import_spec(options: argparse.Namespace) -> int:
    spec, notes = import_ini(options.file)
    for note in notes:
        print(f"note: {note}", file=sys.stderr)
    text = json.dumps(spec, indent=2)
    if not options.out:
        print(text)
        return 0
    if options.out.exists():
        raise InputError(f"'{options.out}' is there already (--out). Name another file.")
    write_whole(options.out, text + "\n")
    print(options.out)
    return 0


def show_status(options: argparse.Namespace) -> int:
    spec = _read(options)
    try:
        bench = find_bench(spec.program, options.bin, ROOT)
    except SweepError as error:
        bench = None
        print(f"warning: {error} Availability of variants is unknown.", file=sys.stderr)
    store = Store(options.results, spec.name)
    statuses = [status_of(point, store, bench, options.cores) for point in expand(spec)]
    for each in statuses:
        if each.broken:
            print(f"warning: {store.record_path(each.point.id)} is no record ({each.broken}).", file=sys.stderr)
        mark = ", of another commit" if each.other_commit else ""
        said = each.why or each.speed
        print(f"{each.point.id}  {each.point.name}: {each.state}{f' ({said})' if said else ''}{mark}")
    print(f"{spec.name} ({spec.preset}): {status.counts(statuses)}")
    other = sum(each.other_commit for each in statuses)
    if other and bench:
        print(f"{other} {'record comes' if other == 1 else 'records come'} from another commit than this build ({bench.commit}). "
              f"`sweep run {options.spec} --fresh` makes {'it' if other == 1 else 'them'} again.")
    return 0


def list_specs(_options: argparse.Namespace) -> int:
    for path in sorted(SPECS.glob("*.json")):
        try:
            numbers = {preset: len(expand(read_spec(path, preset))) for preset in ("quick", "full")}
            print(f"{path.stem:<18} {numbers['quick']:>4} points quick, {numbers['full']:>4} full: "
                  f"{read_spec(path).title}")
        except InputError as error:
            print(f"{path.stem:<18} {error}")
    return 0


def print_schema(_options: argparse.Namespace) -> int:
    print(json.dumps(spec_schema(), indent=1))
    return 0


def _read(options: argparse.Namespace) -> Spec:
    if options.cores < 1:
        raise InputError(f"{options.cores} cores make no sense (--cores). Give 1 or more.")
    path = Path(options.spec)
    if not path.suffix and not path.exists():
        path = SPECS / f"{options.spec}.json"
        if not path.exists():
            raise InputError(f"there is no spec '{options.spec}' (in {SPECS}). "
                             f"{nearest(options.spec, [each.stem for each in sorted(SPECS.glob('*.json'))])}")
    return read_spec(path, options.preset)


def _tell_troubles(statuses: list[PointStatus]) -> None:
    for each in statuses:
        if each.state in (FAILED, CHECK_FAILED):
            print(f"  {each.state}: {each.point.name} ({each.point.id}): {each.why}", file=sys.stderr)
    if any(each.state in (FAILED, CHECK_FAILED) for each in statuses):
        print("  --rerun-failed runs them again", file=sys.stderr)
