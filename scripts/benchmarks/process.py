# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements in processes of their own: each has its own peak of memory, and none can end the others.

A measurement is a function of this package that takes and returns what JSON can hold; `alone` runs it in
a fresh interpreter and adds `peak`, bytes resident at most.
"""

from __future__ import annotations

import importlib
import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class Skipped(Exception):
    """A measurement that was not made, and why."""


def available_memory() -> int:
    """Bytes that the machine has free, by /proc/meminfo."""
    for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
        if line.startswith("MemAvailable:"):
            return 1024 * int(line.split()[1])
    raise OSError("no MemAvailable in /proc/meminfo")


def resident() -> int:
    """Bytes of this process in memory now."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGESIZE")


def run_apart(command: list, seconds: float, memory: int) -> tuple[str, float, int]:
    """Runs a command in a process group of its own: its standard output, seconds, and peak memory in bytes.

    Raises Skipped where it takes longer, where it needs more memory than `memory` bytes, where it fails, and
    before it begins where less than that is free.
    """
    if available_memory() < memory:
        free = available_memory() / 1e9
        raise Skipped(f"{memory / 1e9:.0f} GB may be needed and {free:.1f} are free")
    began = time.perf_counter()
    with subprocess.Popen(
        [str(part) for part in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        cwd=ROOT,
    ) as process:
        peak, why = 0, None
        while why is None:
            try:
                out, err = process.communicate(timeout=0.1)
                break
            except subprocess.TimeoutExpired:
                peak = max(peak, _group_memory(process.pid))
            if time.perf_counter() - began > seconds:
                why = f"not done within {seconds:.0f} s"
            elif peak > memory:
                why = f"more than {memory / 1e9:.0f} GB"
        if why is not None:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            raise Skipped(why)
    if process.returncode != 0:
        lines = (err or out).strip().splitlines() or [f"status {process.returncode}"]
        raise Skipped(f"failed: {lines[-1][:200]}")
    return out, time.perf_counter() - began, peak


def _group_memory(leader: int) -> int:
    try:
        pages = int(Path(f"/proc/{leader}/statm").read_text(encoding="ascii").split()[1])
    except (OSError, IndexError, ValueError):  # ended meanwhile
        return 0
    return pages * os.sysconf("SC_PAGESIZE")


def alone(function: str, *arguments, seconds: float = 600.0, memory: float = 12e9, python: str | None = None):
    """Calls "module.function" of this package with the arguments in a fresh interpreter.

    Returns what it returns, a dictionary, with `peak` added: bytes resident at most in that process.
    Raises Skipped as run_apart does.
    """
    command = [python or sys.executable, "-m", "benchmarks.process", function, json.dumps(arguments)]
    out, _, _ = run_apart(command, seconds, int(memory))
    return json.loads(out.splitlines()[-1])


def main() -> None:
    """The fresh interpreter's part."""
    function, arguments = sys.argv[1:]
    module, name = function.rsplit(".", 1)
    try:
        result = getattr(importlib.import_module(f"benchmarks.{module}"), name)(*json.loads(arguments))
    except Skipped as skipped:
        sys.exit(str(skipped))
    peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(json.dumps({**result, "peak": peak}))


if __name__ == "__main__":
    main()
