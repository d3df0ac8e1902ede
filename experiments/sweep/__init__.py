"""Runs the points of a spec (experiments/specs/*.json), one process each, and keeps one record per point."""
from sweep.cli import main

__all__ = ["main"]
