# SPDX-License-Identifier: GPL-3.0-or-later
"""Hunts for models with faults and bodies, or with folds, that are built wrongly:

    python -m tests.core.faulted.hunt SECONDS [SEED] [--folds]

Random cases are built and judged in a process of their own, so that a crash or a hang is a finding too. Each
finding is minimized and written to tests/data/structures/ (or --into FOLDER), named by its seed.
"""

import argparse
import collections
import os
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # tests/core

import folded.kind
from stacks import places
from stacks.hunt import Worker

import faulted.kind
from faulted.judge import kinds_of


def report(worker, hunted, case, failures, given, name):
    """Makes a failing case small, writes its file, and says what it is."""
    wanted = min(kinds_of(failures))
    small = case
    if given.steps:
        small = hunted.minimize(case, lambda c: wanted in kinds_of(worker.judge(c)), given.steps)
    left = worker.judge(small)
    path = Path(given.into) / f"{wanted}_{name}.json".replace(" ", "_")
    hunted.save_case(small, path, "; ".join(left)[:600])
    print(f"  {path.name}: {small.summary()}, size {small.size()}")
    for failure in left[:3]:
        print(f"    {failure[:300]}", flush=True)


def hunt(hunted, given):
    """Judges cases, each `every`-th seed, until the time is over or enough is found; how many failed."""
    worker = Worker(hunted.failures_of)
    begun = time.monotonic()
    stop = begun + given.seconds
    failed, judged = collections.Counter(), 0
    number = given.seed
    while time.monotonic() < stop and sum(failed.values()) < given.most:
        case = hunted.random_case(number)
        failures = worker.judge(case)
        judged += 1
        if failures:
            failed[min(kinds_of(failures))] += 1
            print(f"seed {number}: {failures[0][:250]}", flush=True)
            report(worker, hunted, case, failures, given, number)
        number += given.every
        if judged % 500 == 0:
            minutes = [spent / 60 for spent in (time.monotonic() - begun, worker.processor_time())]
            print(f"{judged} cases in {minutes[0]:.1f} minutes, {minutes[1]:.1f} of a processor", flush=True)
    worker.close()
    print(f"{judged} cases from seed {given.seed}, {sum(failed.values())} failed {dict(failed)}")
    return sum(failed.values())


def main():
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")  # small models on busy processors: no spinning
    sys.path.insert(0, str(places.ROOT / "addon"))
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("seconds", type=float)
    parser.add_argument("seed", type=int, nargs="?", default=0)
    parser.add_argument("--every", type=int, default=1, help="how many seeds others take")
    parser.add_argument("--into", help="the folder of findings")
    parser.add_argument("--most", type=int, default=40, help="findings to stop at")
    parser.add_argument("--steps", type=int, default=150, help="tries to make a finding smaller; 0: none")
    parser.add_argument("--case", type=Path, help="judge and minimize this file instead of random cases")
    parser.add_argument("--folds", action="store_true", help="series of folds instead of faulted sheets")
    given = parser.parse_args()
    hunted = folded.kind.HUNTED if given.folds else faulted.kind.HUNTED
    given.into = given.into or str(hunted.corpus)
    Path(given.into).mkdir(parents=True, exist_ok=True)
    if given.case:
        worker, case = Worker(hunted.failures_of), hunted.load_case(given.case)
        failures = worker.judge(case)
        print(*failures, sep="\n")
        if failures and given.steps:
            report(worker, hunted, case, failures, given, given.case.stem)
        worker.close()
        raise SystemExit(1 if failures else 0)
    failed = hunt(hunted, given)
    raise SystemExit(1 if failed else 0)


if __name__ == "__main__":
    main()
