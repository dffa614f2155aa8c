# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements in processes of their own: each has its own peak of memory, and none can end the others.

A measurement is a function of this package that takes and returns what JSON can hold; `alone` runs it in
a fresh interpreter and adds `peak`, bytes resident at most.
"""

from __future__ import annotations

import importlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

_LEFT_FREE = 2e9  # bytes that everything else on the machine keeps
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


def peak_resident(process: int | str = "self") -> int:
    """Bytes that a process had in memory at most. (ru_maxrss would count its parent's at the fork too.)"""
    status = Path(f"/proc/{process}/status")
    for line in status.read_text(encoding="ascii").splitlines():
        if line.startswith("VmHWM:"):
            return 1024 * int(line.split()[1])
    raise OSError(f"no VmHWM in {status}")


def run_apart(command: list, seconds: float, memory: int) -> tuple[str, float, int]:
    """Runs a command in a process group of its own: its standard output, seconds, and peak memory in bytes.

    Raises Skipped where it takes longer, where it fails, where it comes to more than `memory` bytes or leaves
    less than _LEFT_FREE to the machine, and before it begins where there is less than that now.
    """
    if available_memory() < _LEFT_FREE:
        raise Skipped(
            f"{available_memory() / 1e9:.1f} GB are free, and {_LEFT_FREE / 1e9:.0f} are left alone"
        )
    began = time.perf_counter()
    with subprocess.Popen(
        [str(part) for part in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        process_group=0,  # not a session: it keeps the priority that it is given
        cwd=ROOT,
    ) as process:
        try:
            out, err, peak, why = _watched(process, began, seconds, memory)
        finally:
            if process.poll() is None:  # too long, too large, or the whole run is being stopped
                os.killpg(process.pid, signal.SIGKILL)
                process.communicate()
    if why is not None:
        raise Skipped(why)
    if process.returncode != 0:
        lines = (err or out).strip().splitlines() or [f"status {process.returncode}"]
        raise Skipped(f"failed: {lines[-1][:200]}")
    return out, time.perf_counter() - began, peak


def _watched(process, began: float, seconds: float, memory: int) -> tuple[str, str, int, str | None]:
    """What it wrote to both streams, its peak memory, and why it should not go on, if it did not end."""
    peak = 0
    while True:
        try:
            out, err = process.communicate(timeout=0.1)
            return out, err, peak, None
        except subprocess.TimeoutExpired:
            peak = max(peak, _resident(process.pid))
        if time.perf_counter() - began > seconds:
            return "", "", peak, f"not done within {seconds:.0f} s"
        if peak > memory:
            return "", "", peak, f"more than {memory / 1e9:.0f} GB"
        if available_memory() < _LEFT_FREE:
            return "", "", peak, "the machine's memory ran low"


def _resident(number: int) -> int:
    try:
        pages = int(Path(f"/proc/{number}/statm").read_text(encoding="ascii").split()[1])
    except (OSError, IndexError, ValueError):  # ended meanwhile
        return 0
    return pages * os.sysconf("SC_PAGESIZE")


def alone(function: str, *arguments, seconds: float = 600.0, memory: float = 12e9, python: str | None = None):
    """Calls "module.function" of this package with the arguments in a fresh interpreter.

    Returns what it returns, a dictionary, with `peak` added: bytes resident at most in that process,
    unless it says so itself.
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
    print(json.dumps({"peak": peak_resident(), **result}))


if __name__ == "__main__":
    # As the module that measurements import: their Skipped is the one that is caught.
    importlib.import_module("benchmarks.process").main()
