"""Errors that end a sweep with one sentence."""
import difflib
from collections.abc import Iterable


class SweepError(Exception):
    """One sentence "problem (where). what to do", printed to stderr."""
    exit_code = 4


class InputError(SweepError):
    """Something in a spec or on the command line is wrong."""
    exit_code = 3


def nearest(word: str, known: Iterable[str]) -> str:
    """"Did you mean 'x'?" for a near miss, otherwise the list of what is known."""
    known = list(known)
    close = difflib.get_close_matches(word, known, n=1)
    return f"Did you mean '{close[0]}'?" if close else f"Known: {', '.join(known)}."
