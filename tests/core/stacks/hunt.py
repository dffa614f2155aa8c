# SPDX-License-Identifier: GPL-3.0-or-later
"""Hunts for stacks that the builder gets wrong: python -m tests.core.stacks.hunt SECONDS [SEED] [FAMILY]

Random stacks are built and judged in a process of their own, so that a crash or a hang is a finding
too. Each finding is minimized and written to tests/data/stacks/ (or --into FOLDER), one for every
set of kinds of failure and family; the run ends with a table.
"""

import argparse
import collections
import multiprocessing
import os
import random
import threading
import time
from pathlib import Path

from . import places
from .case import Stack, load_stack, save_stack
from .generate import FAMILIES, random_stack, single_valued
from .judge import failures_of, kinds_of
from .minimize import minimize

PATIENCE = 60.0  # seconds of processor time for one stack, all checks included
STALLED = 1200.0  # seconds by the clock: who waits for ever takes no processor time


def acceptable(stack):
    """Whether a stack is valid input: single-valued surfaces and region, the base below everything."""
    if any(len(single_valued(v, t)) != len(t) for v, t in stack.surfaces):
        return False
    if stack.region is not None and len(single_valued(*stack.region)) != len(stack.region[1]):
        return False
    lowest = min(v[:, 2].min() for v, _ in stack.surfaces)
    return stack.base_elevation is None or stack.base_elevation < lowest


def _end_with_parent():
    multiprocessing.parent_process().join()
    os._exit(1)


def _work(pipe, judge):
    threading.Thread(target=_end_with_parent, daemon=True).start()
    while True:
        stack = pipe.recv()
        if stack is None:
            return
        try:
            pipe.send(judge(stack))
        except Exception as error:
            pipe.send([f"judge: {type(error).__name__}: {error}"])


def _processor_time(process):
    """Seconds of all its threads, 0 once it is gone."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Worker:
    """A process that judges cases, stacks unless another judge is given; started again when one of them kills
    it."""

    def __init__(self, judge=failures_of):
        self.process, self.judged_by = None, judge

    def judge(self, stack):
        """Failures of one stack, a crash and a hang among them."""
        if self.process is None or not self.process.is_alive():
            self.pipe, theirs = multiprocessing.Pipe()
            self.process = multiprocessing.Process(target=_work, args=(theirs, self.judged_by), daemon=True)
            self.process.start()
            theirs.close()
        self.pipe.send(stack)
        if not self._answers():
            self.process.kill()
            self.process.join()
            return [f"hang: no answer within {PATIENCE:.0f} s"]
        try:
            return self.pipe.recv()
        except EOFError:
            self.process.join()
            return [f"crash: exit status {self.process.exitcode}"]

    def _answers(self):
        """Waits by processor time: on a busy machine wall time means nothing."""
        begun, latest = _processor_time(self.process.pid), time.monotonic() + STALLED
        while not self.pipe.poll(2.0):
            if _processor_time(self.process.pid) - begun > PATIENCE or time.monotonic() > latest:
                return False
        return True

    def processor_time(self):
        """Seconds of this process and of all that judged."""
        own = sum(os.times()[:4])
        return own if self.process is None else own + _processor_time(self.process.pid)

    def close(self):
        if self.process is not None and self.process.is_alive():
            self.pipe.send(None)
            self.process.join(5)


def report(worker, stack, failures, folder, number):
    """Minimises a failing stack, writes its file, and says what it is."""
    wanted = min(kinds_of(failures))
    small = minimize(stack, lambda s: wanted in kinds_of(worker.judge(s)), acceptable, steps=600)
    left = worker.judge(small)
    name = f"{wanted}_{stack.label}_{number}".replace(" ", "_").replace("/", "_")
    path = Path(folder) / f"{name}.json"
    save_stack(small, path, "; ".join(left)[:600])
    print(f"  {path.name}: {len(small.surfaces)} surfaces, {small.triangle_count()} triangles")
    for failure in left[:4]:
        print(f"    {failure[:300]}", flush=True)


def hunt(seconds, seed, families, folder, most, largest=3):
    """Judges random stacks until the time is over or enough is found; the number of failing ones."""
    worker = Worker()
    stop = time.monotonic() + seconds
    judged, failed = collections.Counter(), collections.Counter()
    known = set()
    number = seed
    while time.monotonic() < stop and len(known) < most:
        for family in families:
            number += 1
            stack = random_stack(random.Random(f"{family} {number}"), family, largest)
            judged[family] += 1
            failures = worker.judge(stack)
            if not failures:
                continue
            failed[family] += 1
            key = min(kinds_of(failures)), family
            if key in known:
                continue
            known.add(key)
            print(f"{family}, seed {number}: {failures[0][:200]}", flush=True)
            report(worker, stack, failures, folder, number)
            if time.monotonic() > stop:
                break
    worker.close()
    for family in families:
        print(f"{family:18} {judged[family]:7} judged {failed[family]:6} failed")
    return sum(failed.values())


def judge_one(path, folder):
    """Judges one file and minimizes it where it fails; the exit status."""
    worker, stack = Worker(), load_stack(path)
    failures = worker.judge(stack)
    for failure in failures:
        print(failure)
    if failures and isinstance(stack, Stack):  # several rock masses: stack_fuzzer makes them small
        report(worker, stack, failures, folder, path.stem)
    worker.close()
    return 1 if failures else 0


def main():
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")  # small stacks on busy processors: no spinning
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("seconds", type=float)
    parser.add_argument("seed", type=int, nargs="?", default=0)
    parser.add_argument("--family", action="append", choices=sorted(FAMILIES))
    parser.add_argument("--into", default=str(places.CORPUS))
    parser.add_argument("--largest", type=int, default=3, help="squares along a side of the lattice, at most")
    parser.add_argument("--most", type=int, default=40, help="findings to stop at")
    parser.add_argument("--stack", type=Path, help="judge and minimize this file instead of random stacks")
    given = parser.parse_args()
    Path(given.into).mkdir(parents=True, exist_ok=True)
    if given.stack:
        raise SystemExit(judge_one(given.stack, given.into))
    families = given.family or list(FAMILIES)
    raise SystemExit(
        1 if hunt(given.seconds, given.seed, families, given.into, given.most, given.largest) else 0
    )


if __name__ == "__main__":
    main()
