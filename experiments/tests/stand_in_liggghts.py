#!/usr/bin/python3
"""Stands in for LIGGGHTS in the tests of peer_bench: reads the same files and writes the same ones, without physics. The bodies
stay where they were, STAND_IN_AWAY (m) beside it; STAND_IN_PAIRS touch."""
import os
import re
import sys
from pathlib import Path

script = Path(sys.argv[sys.argv.index("-in") + 1]).read_text()
atoms = Path("bodies.data").read_text().partition("Atoms")[2].partition("Velocities")[0].split("\n")
away = float(os.environ.get("STAND_IN_AWAY", "0"))
rows = [line.split() for line in atoms if line.strip()]
print("LIGGGHTS (Version LIGGGHTS-PUBLIC 0.0, stand-in)")
Path("log.txt").write_text("".join(f"Loop time of 0.5 on 1 procs for {steps} steps with {len(rows)} atoms\n"
                                   for steps in re.findall(r"^run (\d+)", script, re.MULTILINE)))
for name, number in (("pairs", int(os.environ.get("STAND_IN_PAIRS", "0"))), ("walls", 0)):
    Path(f"{name}.txt").write_text(f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n{number}\n")
Path("end.txt").write_text("\n" * 9 + "".join(f"{row[0]} {float(row[4]) + away} {row[5]} {row[6]} 0 0 0\n" for row in rows))
