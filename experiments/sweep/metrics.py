"""Logical metrics, and the LIKWID group and row of each on every architecture where its value can be defended."""
from dataclasses import dataclass

INTEL = ("sandybridgeEP", "ivybridgeEP", "haswellEP", "broadwell", "broadwellEP", "broadwellD", "skylake", "skylakeX", "CLX",
         "ICX", "ICL", "knl")
AMD = ("zen", "zen2", "zen3")
EVENT, METRIC = "Event", "Metric"  # heads of the two kinds of rows


@dataclass(frozen=True)
class Row:
    """A row of a group's tables: its name, whether it is an event or a derived metric, and what one unit of it is in
    ours. `rate`: per second, to be multiplied by the region's run time."""
    group: str
    kind: str
    name: str
    factor: float = 1.0
    rate: bool = False


@dataclass(frozen=True)
class Metric:
    """A logical metric is the sum of `rows`; without rows it is null because of `why_not`."""
    name: str
    rows: tuple[Row, ...]
    why_not: str = ""


NAMES = ("instructions", "cycles", "flops_dp", "flops_sp", "dram_bytes", "l2_bytes", "l3_bytes", "branch_misses", "energy_J")


def metrics_of(arch: str) -> list[Metric]:
    """All logical metrics on LIKWID's architecture `arch` ("broadwellEP", "knl", "zen3"; `likwid-perfctr -i`)."""
    if arch not in INTEL + AMD:
        return [Metric(name, (), f"no table for LIKWID's architecture '{arch}' (experiments/sweep/metrics.py)")
                for name in NAMES]
    return [Metric(name, *_rows(name, arch)) for name in NAMES]


def groups_of(metrics: list[Metric]) -> list[str]:
    """The groups to measure, each once, in order of need."""
    return list(dict.fromkeys(row.group for metric in metrics for row in metric.rows))


def _rows(name: str, arch: str) -> tuple:
    """Rows, or none and the reason."""
    amd, knl = arch in AMD, arch == "knl"
    if name == "instructions":
        return ((Row("BRANCH", EVENT, "RETIRED_INSTRUCTIONS" if amd else "INSTR_RETIRED_ANY"),),)
    if name == "cycles":
        return ((Row("BRANCH", EVENT, "CPU_CLOCKS_UNHALTED" if amd else "CPU_CLK_UNHALTED_CORE"),),)
    if name == "branch_misses":
        return ((Row("BRANCH", EVENT, "RETIRED_MISP_BRANCH_INSTR" if amd else "BR_MISP_RETIRED_ALL_BRANCHES"),),)
    if name in ("flops_dp", "flops_sp"):
        kind = name[-2:].upper()
        if knl:
            return (), f"FLOPS_{kind} of Knights Landing cannot tell the widths of vectors, nor float from double"
        if arch == "haswellEP":
            return (), "Haswell has no events for floating-point operations"
        return ((Row(f"FLOPS_{kind}", METRIC, f"{kind} [MFLOP/s]", 1e6, rate=True),),)
    if name == "dram_bytes":
        if arch == "broadwell":
            return (), "LIKWID has no group MEM for it"
        if arch == "zen3":
            halves = (("MEM1", "0-3"), ("MEM2", "4-7"))
            return (tuple(Row(group, METRIC, f"Memory data volume (channels {which}) [GBytes]", 1e9)
                          for group, which in halves),)
        groups = ("MEM", "HBM") if knl else ("MEM",)
        return (tuple(Row(group, METRIC, "Memory data volume [GBytes]", 1e9) for group in groups),)
    if name == "l2_bytes":
        return ((Row("L2", METRIC, "L2 data volume [GByte]" if knl else "L2 data volume [GBytes]", 1e9),),)
    if name == "l3_bytes":
        if knl:
            return (), "Knights Landing has no L3 cache"
        if arch in ("zen", "zen2"):
            return ((Row("L3", METRIC, "L3 access data volume [GBytes]", 1e9),),)
        return ((Row("L3", METRIC, "L3 data volume [GBytes]", 1e9),),)
    return ((Row("ENERGY", METRIC, "Energy PKG [J]" if amd else "Energy [J]"),),)
