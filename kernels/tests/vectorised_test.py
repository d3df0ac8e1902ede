#!/usr/bin/python3
"""Are the kernels' functions over packs vectorised? Reads the disassembly: nearly all floating-point arithmetic of each
must be packed. usage: vectorised_test.py ARCHIVE"""
import re
import subprocess
import sys
from collections import Counter

LEAST = 0.95  # share of packed instructions; loads and bookkeeping of single lanes are not arithmetic
ARITHMETIC = re.compile(r"\sv?(?:add|sub|mul|div|sqrt|min|max|fn?m(?:add|sub)(?:132|213|231))(p[sd]|s[sd])\s")
FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:$")
HOT = re.compile(r"\b(solve|undecided|pierce)<std::experimental::\S*simd<(double|float), ?(.*?)> ?>")


def packed_shares(archive: str) -> dict[str, tuple[float, int]]:
    """Of each hot function: the share of packed ones among its arithmetic instructions, and how many there are."""
    text = subprocess.run(["objdump", "-d", "-C", "--no-show-raw-insn", archive], capture_output=True, text=True,
                          check=True).stdout
    counts: dict[str, Counter] = {}
    name, file = None, ""
    for line in text.splitlines():
        if line.endswith("file format elf64-x86-64"):
            file = line.split(":")[0]
        elif match := FUNCTION.match(line):
            hot = HOT.search(match[1])
            name = f"{file} {hot[1]}<{hot[2]}, {hot[3].split('::')[-1]}>" if hot else None
        elif name and (match := ARITHMETIC.search(line)):
            counts.setdefault(name, Counter())[match[1][0]] += 1
    return {name: (count["p"] / count.total(), count.total()) for name, count in counts.items()}


def main(archive: str) -> int:
    shares = {name: (share, total) for name, (share, total) in packed_shares(archive).items() if total >= 100}
    for name, (share, total) in sorted(shares.items()):
        print(f"{share:6.1%} packed of {total:5d}  {name}{'' if share >= LEAST else '  NOT VECTORISED'}")
    files = {name.split()[0] for name in shares}
    missing = {"brute_simd.cpp.o", "iterative.cpp.o", "hybrid.cpp.o", "brute_mixed.cpp.o"} - files
    if missing:
        print(f"no function over packs found in {', '.join(sorted(missing))}")
    return 0 if not missing and all(share >= LEAST for share, _ in shares.values()) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
