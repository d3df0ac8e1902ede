"""The command `sweep`: run, status, counters, project, export, list, merge, import, schema."""
import argparse
import os
import sys
from pathlib import Path

from sweep import commands
from sweep.bench import usable_cores
from sweep.commands import ROOT
from sweep.errors import SweepError
from sweep.exchange import FORMATS

EPILOG = """exit codes: 0 all done, 1 a point or its check failed, 3 usage or spec, 4 environment, 130 interrupted.
An interrupted sweep resumes when the same command is given again: finished points are skipped."""


class Parser(argparse.ArgumentParser):
    """Wrong usage exits with 3, as in all programs of the project."""

    def error(self, message: str):
        self.exit(3, f"{message} ({self.prog}). See {self.prog} --help.\n")


def main(argv: list[str] | None = None) -> int:
    """Runs the command line; returns the exit code."""
    options = _parser().parse_args(argv)
    try:
        return options.command(options)
    except SweepError as error:
        print(error, file=sys.stderr)
        return error.exit_code
    except BrokenPipeError:  # the reader of a pipe went away, as `sweep list | head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        place = error.filename or getattr(options, "results", "standard output")
        print(f"cannot write or read ({place}: {error.strerror}). Records that are there are whole; mend that, and the same "
              "command resumes.", file=sys.stderr)
        return SweepError.exit_code


def _parser() -> Parser:
    parser = Parser(prog="sweep", description=__doc__, epilog=EPILOG,
                    formatter_class=argparse.RawDescriptionHelpFormatter)
    known = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, do, what: str, **more) -> Parser:
        command = known.add_parser(name, help=what, **more)
        command.set_defaults(command=do)
        return command

    run = _of_points(add("run", commands.run, "run the points of a spec that have no record yet", epilog=EPILOG))
    run.add_argument("--dry-run", action="store_true", help="only list the points and what would become of them")
    run.add_argument("--shard", metavar="I/N", help="only the I-th of N equal parts, for several machines")
    run.add_argument("--rerun-failed", action="store_true", help="run failed points again")
    run.add_argument("--fresh", action="store_true", help="run points again whose record is of another commit")
    _of_spec(add("status", commands.show_status, "what became of the points of a spec"))
    join = _of_spec(add("merge", commands.take_over, "take over records that other machines made, as of shards"))
    join.add_argument("others", nargs="+", type=Path, metavar="RESULTS", help="results folders of other runs")
    counted = _of_points(add("counters", commands.count, "count hardware events of finished points, in runs of their own"))
    counted.add_argument("--fresh", action="store_true", help="count again what has been counted")
    more = _of_points(add("project", commands.project, "what finished points would take on more threads, from a trace of one"))
    more.add_argument("--fresh", action="store_true", help="trace again what has been projected")
    out = _of_points(add("export", commands.export, "every sample in a format that other tools read"))
    out.add_argument("--format", choices=FORMATS, default="csv", help="default: %(default)s")
    out.add_argument("--out", type=Path, metavar="FILE", help="the file to write (default: print it)")
    old = add("import", commands.import_spec, "make a spec of an option file (INI) of the ancestor's sweeps")
    old.add_argument("file", type=Path)
    old.add_argument("--out", type=Path, metavar="SPEC", help="the spec to write (default: print it)")
    add("list", commands.list_specs, "the specs there are")
    add("schema", commands.print_schema, "print the JSON Schema of specs")
    return parser


def _of_spec(parser: Parser) -> Parser:
    parser.add_argument("spec", metavar="SPEC", help="a spec file, or the name of one in experiments/specs")
    preset = parser.add_mutually_exclusive_group()
    preset.add_argument("--quick", dest="preset", action="store_const", const="quick", help="the small preset (default)")
    preset.add_argument("--full", dest="preset", action="store_const", const="full", help="the published sizes")
    preset.add_argument("--preset", metavar="NAME", help="any other preset of the spec")
    parser.add_argument("--results", type=Path, default=ROOT / "results", metavar="DIR", help="default: %(default)s")
    parser.add_argument("--bin", type=Path, metavar="DIR", help="where dem_bench is (default: beside this program)")
    parser.add_argument("--cores", type=int, default=usable_cores(), metavar="N",
                        help="points with more threads are not run (default: %(default)s, what this machine offers)")
    return parser


def _of_points(parser: Parser) -> Parser:
    _of_spec(parser).add_argument("--only", action="append", default=[], metavar="K=V[,V]", help="only points with these values")
    return parser
