"""Other engines on the same packed bodies: each is checked, then timed, and leaves a record as ours do."""
from peers.cli import main

__all__ = ["main"]
