# SPDX-License-Identifier: GPL-3.0-or-later
"""The part on GPUs of docs/dev/performance.md, from what device_benchmark printed (scripts/check_gpu.sh).

python3 -m benchmarks.gpu PAGE NAME_OF_GPU < LINES
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

from . import page

PART = "check_gpu.sh"
_WORK = {"merge": "merge {} vertices, 6 corners each", "krige": "krige {} nodes from 16 points each"}
_HEADINGS = ("work", "2 threads, s", "GPU, s", "copying, s", "computing, s", "threads / GPU", "same bytes")


def rows(lines: Iterable[str]) -> list[list[str]]:
    """Of a table. A line: what, how many, then seconds of the CPU, of the GPU, of copying in these, and "yes"
    or "NO"; "-" where it was not measured."""
    table = []
    for line in lines:
        what, count, cpu, gpu, copying, same = line.split()
        ratio = "-" if "-" in (cpu, gpu) else f"**{float(cpu) / float(gpu):.1f}**"
        computing = "-" if gpu == "-" else f"{float(gpu) - float(copying):.2f}"
        times = ["-" if text == "-" else f"{float(text):.2f}" for text in (cpu, gpu, copying)]
        table.append([_WORK[what].format(f"{int(count):,}"), *times, computing, ratio, same])
    return table


def write(path: Path, gpu: str, lines: Iterable[str]) -> None:
    """Writes the table into a page, and beside which GPU it was measured."""
    measured = rows(lines)
    page.write_part(path, PART, [f"{page.machine()} GPU: {gpu}.", "", *page.table(_HEADINGS, measured)])


if __name__ == "__main__":
    write(Path(sys.argv[1]), sys.argv[2], sys.stdin)
