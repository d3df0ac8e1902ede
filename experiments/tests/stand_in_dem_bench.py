#!/usr/bin/python3
"""Stands in for dem_bench in the tests of sweep: same command line and outputs, no physics. What it does with a point
is told by --seed, see BEHAVIOUR; each call is a line of the file named by STAND_IN_CALLS."""
import argparse
import json
import os
import signal
import sys
import time

BEHAVIOUR = {"fine": 0, "slow": 1, "crash": 2, "refuse": 3, "silent": 4, "check fails": 5, "half record": 6, "grandchild": 7,
             "memory": 8, "disk full": 9, "unsteady": 10}
LISTING = """scenes
  hopper: grains
kernels
  brute: branchy
  hybrid-pair: both
prechecks
  none: all
  sphere: balls
grids
  none: all pairs
  regular: one size
contact rules
  nearest: one
schemes
  serial: one thread
  plain: blocks
runtimes
  tbb: tasks
"""


def main() -> int:
    if "--list" in sys.argv:
        print(LISTING, end="")
        return 0
    parser = argparse.ArgumentParser()
    for option in ("scene", "scene-file", "grid", "kernel", "scheme", "precheck", "start-state", "point-id", "record",
                   "final-state", "vtk", "runtime"):
        parser.add_argument(f"--{option}")
    for option in ("particles", "vertices", "seed", "threads", "steps", "repeats", "warmup", "check-steps"):
        parser.add_argument(f"--{option}", type=int)
    for option in ("end", "vtk-every"):
        parser.add_argument(f"--{option}", type=float)
    call = parser.parse_args()
    with open(os.environ["STAND_IN_CALLS"], "a", encoding="utf-8") as calls:
        calls.write(f"{call.point_id} {'state' if call.final_state else 'point'} {call.check_steps or ''}".rstrip() + "\n")
    return act(call)


def act(call: argparse.Namespace) -> int:
    seed = call.seed or 0
    if seed == BEHAVIOUR["slow"]:
        print("thinking", flush=True)
        time.sleep(60)
    if seed == BEHAVIOUR["grandchild"]:
        os.fork()
        time.sleep(60)
    if seed == BEHAVIOUR["memory"]:
        return allocate()
    if seed == BEHAVIOUR["disk full"]:
        print(f"stand-in: cannot write '{call.record}' (No space left on device).", file=sys.stderr)
        return 3
    if seed == BEHAVIOUR["crash"]:
        print("before the end", flush=True)
        os.kill(os.getpid(), signal.SIGSEGV)
    if seed == BEHAVIOUR["refuse"]:
        print("stand-in: no such thing (particles). Try another.", file=sys.stderr)
        return 3
    if seed == BEHAVIOUR["silent"]:
        return 0
    if call.start_state and not os.path.exists(call.start_state):
        return 3
    time.sleep(float(os.environ.get("STAND_IN_SLEEP", "0")))
    if call.final_state:
        write(call.final_state, {"time_s": call.end, "threads": call.threads, "bodies": []})
    passed = seed != BEHAVIOUR["check fails"]
    record = {"schema": "trigrain-record-1", "point_id": call.point_id, "status": "finished",
              "params": {"threads": call.threads, "start_state": call.start_state},
              "build": {"commit": os.environ.get("STAND_IN_COMMIT")}, "check": {"passed": passed, "how": [
                  {"what": "kernel", "passed": passed, "detail": "compared"}]},
              "samples": [{"wall_s": 1.0, "cpu_s": 1.0, "steps": call.steps or 1}] * (call.repeats or 1),
              "state_hash": f"{time.time_ns() if seed == BEHAVIOUR['unsteady'] else 1:016x}", "counters": {
                  "cycles": {"value": call.repeats, "source": "perf_event", "status": "measured", "reason": None}}}
    if seed == BEHAVIOUR["half record"]:
        del record["check"]
    write(call.record, record)
    return 0 if passed else 1


def allocate() -> int:
    """Ends as a C++ program does that gets no memory."""
    try:
        bytearray(4 << 30)
    except MemoryError:
        print("stand-in: std::bad_alloc", file=sys.stderr)
        return 4
    return 0


def write(path: str, value: dict) -> None:
    with open(path + ".tmp", "w", encoding="utf-8") as file:
        json.dump(value, file)
    os.rename(path + ".tmp", path)


if __name__ == "__main__":
    sys.exit(main())
