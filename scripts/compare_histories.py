#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How many random points are in the right block in series of random histories (tests/core/histories.py), and
with a plane through each surface. Prints those that are worse than planes by more than 0.05 or refused.

    scripts/compare_histories.py near_flat 0 1000
    scripts/compare_histories.py folded 0 100
    scripts/compare_histories.py rough 0 24
"""

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / folder) for folder in ("addon", "tests/core")]

import histories  # noqa: E402
from realmodel.core import InputRefused  # noqa: E402

NODES = 50_000


def main():
    kind, first, last = sys.argv[1], *map(int, sys.argv[2:4])
    shares = []
    for seed in range(first, last):
        history = getattr(histories, kind)(seed)
        if history is None:
            continue
        planes, own, what = history.share_of_planes(), 0.0, ""
        try:
            own = history.share_right(NODES)
        except InputRefused as refusal:
            what = f", {refusal}"
        shares.append((own, planes))
        if own < planes - 0.05:
            print(f"{kind} {seed}: {own:.3f}, planes {planes:.3f}{what}", flush=True)
    own, planes = np.array(shares).T
    print(f"{len(shares)} histories: mean {own.mean():.4f}, planes {planes.mean():.4f}", end="; ")
    print(f"worst {own.min():.3f}, worst difference {(own - planes).min():.3f}")


if __name__ == "__main__":
    main()
