"""Errors that end a sweep with one sentence."""
import difflib
from collections.abc import Iterable
from typing import Any


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


def an_object(value: Any, where: str) -> dict:
    """The value; InputError if it is no JSON object."""
    if not isinstance(value, dict):
        raise InputError(f"an object is expected, not {value!r} ({where}). Write {{...}}.")
    return value
