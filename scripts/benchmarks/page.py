# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/dev/performance.md: each run rewrites its own part of the page, between two marks, only."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from pathlib import Path


def write_part(path: Path, name: str, lines: Sequence[str]) -> None:
    """Puts lines in the place of what stands between `<!-- NAME begins -->` and `<!-- NAME ends -->`.

    Where the page has no such part yet, it is added at the end.
    """
    begin, end = f"<!-- {name} begins -->", f"<!-- {name} ends -->"
    text = path.read_text(encoding="utf-8") if path.is_file() else "# Performance\n"
    if begin not in text:
        text = f"{text.rstrip()}\n\n{begin}\n{end}\n"
    before, _, rest = text.partition(begin)
    after = rest.partition(end)[2]
    path.write_text(before + "\n".join([begin, *lines, end]) + after, encoding="utf-8")


def machine() -> str:
    """One sentence about the machine and its load."""
    memory = os.sysconf("SC_PAGESIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return (
        f"Machine: {processor()}, {os.cpu_count()} processors, {memory:.0f} GiB, {platform.system()} "
        f"{platform.release().split('-')[0]}, Python {platform.python_version()}; "
        f"load before the run {os.getloadavg()[0]:.1f}."
    )


def processor() -> str:
    """The processor's name as the system tells it."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.machine()


def table(headings: Sequence[str], rows: Sequence[Sequence[str]], numbers_from: int = 1) -> list[str]:
    """Markdown lines of a table; columns from `numbers_from` on are aligned to the right."""
    marks = ["---" if column < numbers_from else "---:" for column in range(len(headings))]
    return [f"| {' | '.join(row)} |" for row in (headings, marks, *rows)]
