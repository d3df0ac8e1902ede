"""What a run would take on more threads than the machine has, from the trace of a run on one."""
from projection.cli import main

__all__ = ["main"]
