"""Imported first: where a Python package is missing it says so in one sentence and ends with exit code 4."""
import importlib.util
import sys

missing = [name for name in ("matplotlib", "numpy") if importlib.util.find_spec(name) is None]
if missing:
    print(f"no Python package {' and '.join(missing)} ({sys.executable}). Run tools/install, and use /usr/bin/python3.",
          file=sys.stderr)
    sys.exit(4)
