#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the kernels of native/cuda take no more than native/cuda/limits.txt allows, and whether they are
without fused multiply-add, which would give other bytes than the CPU. LOG is what nvcc printed (-Xptxas=-v),
with each kernel for each architecture; PTX is their code.

    scripts/check_kernels.py LOG PTX
"""

import re
import sys
from pathlib import Path

LIMITS = Path(__file__).resolve().parents[1] / "native" / "cuda" / "limits.txt"
QUANTITIES = ("registers", "bytes of shared memory", "bytes spilled")
_OTHERS = "CUB"


def read_limits(text):
    """{name: (registers, shared memory, spilled)}."""
    rows = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    return {name: tuple(map(int, numbers)) for name, *numbers in rows}


def kernels(log):
    """(mangled name, architecture, (registers, shared memory, spilled)) of each kernel."""
    for part in log.split("Compiling entry function '")[1:]:
        name, architecture = re.match(r"(\w+)' for '(\w+)'", part).groups()
        found = [
            re.search(pattern, part)
            for pattern in (r"Used (\d+) registers", r"(\d+) bytes smem", r"(\d+) bytes spill stores")
        ]
        if not found[0]:
            raise SystemExit(f"check_kernels.py: the log does not say what {name} takes")
        yield name, architecture, tuple(int(match[1]) if match else 0 for match in found)


def failures(log, limits):
    """What is wrong, line by line."""
    measured = set()
    for name, architecture, taken in kernels(log):
        ours = [key for key in limits if re.search(rf"(?<!\d){len(key)}{key}", name)]
        if "realmodel" in name and "3cub" not in name and len(ours) != 1:
            yield f"{name} ({architecture}): no limits in {LIMITS.name}"
            continue
        kind = ours[0] if ours else _OTHERS
        measured.add(kind)
        for quantity, number, most in zip(QUANTITIES, taken, limits[kind], strict=True):
            if number > most:
                yield f"{kind} ({architecture}): {number} {quantity}, at most {most} are allowed"
    yield from (f"{key}: the log has no such kernel" for key in limits if key not in measured)


def fused(ptx):
    """What is wrong with the code of kernels: fused operations of doubles."""
    found = re.findall(r"\bfma\.[\w.]*f64", ptx)
    return [f"{len(found)} fused operations ({found[0]}): compile with -fmad=false"] if found else []


def main():
    log = Path(sys.argv[1]).read_text(encoding="utf-8")
    wrong = list(failures(log, read_limits(LIMITS.read_text(encoding="utf-8"))))
    wrong += fused(Path(sys.argv[2]).read_text(encoding="utf-8"))
    for line in wrong:
        print(line)
    architectures = sorted({architecture for _, architecture, _ in kernels(log)})
    print(f"{len(list(kernels(log)))} kernels for {', '.join(architectures)}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
