#!/usr/bin/python3
"""Stands in for likwid-perfctr in the tests of the counters: runs the program with a stand-in for LIKWID's library, and
prints the regions as likwid-perfctr -O -m of LIKWID 5.2 does. STAND_IN_LIKWID says how it behaves, see BEHAVIOUR."""
import os
import subprocess
import sys
import tempfile

BEHAVIOUR = ("xeon", "knl", "zeros", "dashes", "refusal", "truncated", "regions", "silent", "dead", "infinite", "alone")
FIXED = [("INSTR_RETIRED_ANY", "FIXC0"), ("CPU_CLK_UNHALTED_CORE", "FIXC1"), ("CPU_CLK_UNHALTED_REF", "FIXC2")]
BRANCH = [("BR_INST_RETIRED_ALL_BRANCHES", "PMC0"), ("BR_MISP_RETIRED_ALL_BRANCHES", "PMC1")]
TIMES = ["Runtime (RDTSC) [s]", "Runtime unhalted [s]", "Clock [MHz]", "CPI"]
# group -> further events, further metrics; as in LIKWID's groups for broadwellEP and knl
XEON = {
    "CLOCK": ([], []), "BRANCH": (BRANCH, ["Branch misprediction rate"]),
    "FLOPS_DP": ([("FP_ARITH_INST_RETIRED_128B_PACKED_DOUBLE", "PMC0")], ["DP [MFLOP/s]", "AVX DP [MFLOP/s]"]),
    "FLOPS_SP": ([("FP_ARITH_INST_RETIRED_128B_PACKED_SINGLE", "PMC0")], ["SP [MFLOP/s]"]),
    "MEM": ([("CAS_COUNT_RD", "MBOX0C0")], ["Memory bandwidth [MBytes/s]", "Memory data volume [GBytes]"]),
    "L2": ([("L1D_REPLACEMENT", "PMC0")], ["L2 bandwidth [MBytes/s]", "L2 data volume [GBytes]"]),
    "L3": ([("L2_LINES_IN_ALL", "PMC0")], ["L3 bandwidth [MBytes/s]", "L3 data volume [GBytes]"]),
    "ENERGY": ([("PWR_PKG_ENERGY", "PWR0")], ["Energy [J]", "Power [W]"])}
KNL = {
    "CLOCK": ([], []), "BRANCH": (BRANCH, ["Branch misprediction rate"]),
    "MEM": ([("MC_CAS_READS", "MBOX0C0")], ["Memory data volume [GBytes]"]),
    "HBM": ([("EDC_RPQ_INSERTS", "EDBOX0C0")], ["Memory data volume [GBytes]"]),
    "L2": ([("L2_REQUESTS_REFERENCE", "PMC0")], ["L2 data volume [GByte]"]),
    "ENERGY": ([("PWR_PKG_ENERGY", "PWR0")], ["Energy [J]"])}


def main() -> int:
    how = os.environ["STAND_IN_LIKWID"]
    groups, short = (KNL, "knl") if how == "knl" else (XEON, "broadwellEP")
    words = sys.argv[1:]
    if words == ["-i"]:
        print(f"CPU name:\tImagined\nCPU short:\t{short}")
        return 0
    if how == "refusal":
        print("ERROR - [./src/perfmon.c:perfmon_init_maps:1427] Unsupported Processor", file=sys.stderr)
        return 1
    assert words[0] == "-O" and "-C" not in words, "-C pins: TBB would get one thread"
    cpus = words[words.index("-c") + 1].split(",")
    group = words[words.index("-g") + 1]
    if group not in groups:
        print(f"ERROR - [./src/perfgroup.c:960] Cannot read group {group}", file=sys.stderr)
        return 1
    command = words[words.index("-g") + 2:]
    if "-m" not in words:
        print_tables(None, cpus, group, groups[group], dict.fromkeys(cpus, 1), how)
        return subprocess.run(command, check=False).returncode
    with tempfile.NamedTemporaryFile("r") as file:
        done = subprocess.run(command, check=False, env={
            **os.environ, "LIKWID_FILEPATH": file.name, "LIKWID_THREADS": ",".join(cpus),
            "LD_LIBRARY_PATH": os.environ["STAND_IN_LIBRARY"]})
        calls: dict[str, dict[str, int]] = {}
        for line in file.read().splitlines():
            region, cpu, count = line.split()
            calls.setdefault(region, dict.fromkeys(cpus, 0))[cpu] = int(count)
    if how == "regions":
        calls.pop("merge", None)
    if how == "alone":
        calls["merge"] = {cpu: calls["merge"][cpu] if cpu == cpus[0] else 0 for cpu in cpus}
    for region, by_cpu in calls.items() if how != "silent" else ():
        print_tables(region, cpus, group, groups[group], by_cpu, how)
    return done.returncode


def print_tables(region, cpus, group, rows, calls, how) -> None:
    """All tables of one region (None: of the whole run). Each entry counts 1000 of each event and takes 1 ms; a metric is
    one unit per entry."""
    events, metrics = FIXED + rows[0], TIMES + rows[1]
    how = "" if how in ("dead", "infinite") and region is None else how  # they count while nothing is asked of them
    where = f"Region {region},Group 1" if region else "Group 1"
    heads = ",".join(f"HWThread {cpu}" for cpu in cpus)
    lines = ["STRUCT,Info,3,", "CPU name:,Imagined,,", "CPU type:,Imagined,,", "CPU clock:,2.0 GHz,,",
             f"TABLE,{where} Raw,{group},{len(events)},"]
    if region:
        lines += [f"Region Info,{heads},", f"RDTSC Runtime [s],{','.join(f'{calls[c] * 1e-3:.6f}' for c in cpus)},",
                  f"call count,{','.join(str(calls[c]) for c in cpus)},"]
    lines += [f"Event,Counter,{heads}"]
    lines += [f"{name},{counter},{','.join(cell(1000 * calls[c], how) for c in cpus)}" for name, counter in events]
    lines += [f"TABLE,{where} Raw STAT,{group},1,", "Event,Counter,Sum,Min,Max,Avg", "INSTR_RETIRED_ANY STAT,FIXC0,1,1,1,1"]
    lines += [f"TABLE,{where} Metric,{group},{len(metrics)},", f"Metric,{heads}"]
    lines += [f"{name},{','.join(cell(calls[c], how, metric=True) for c in cpus)}" for name in metrics]
    lines += [f"TABLE,{where} Metric STAT,{group},1,", "Metric,Sum,Min,Max,Avg", "CPI STAT,1,1,1,1"]
    print("\n".join(lines[:-8] if how == "truncated" and region else lines))


def cell(value: int, how: str, metric: bool = False) -> str:
    if how == "dead" or how == "zeros" and not metric:
        return "0"
    if how == "infinite":
        return "inf"
    if how in ("zeros", "dashes"):
        return "-" if value % 2 else "inf" if metric else "-"
    return str(value) if value or not metric else "nan"  # a thread that never entered has no rates


if __name__ == "__main__":
    sys.exit(main())
