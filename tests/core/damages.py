# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that were damaged on their way, the same ones in every run."""

import numpy as np


def damaged_bytes(whole, least=1):
    """300 times the bytes of a file with three of them changed; of three in ten the end is missing, too.
    At least `least` bytes are left."""
    draw = np.random.default_rng(1)
    for _ in range(300):
        raw = bytearray(whole[: draw.integers(least, len(whole))] if draw.random() < 0.3 else whole)
        for at in draw.integers(0, len(raw), 3):
            raw[at] = draw.integers(0, 256)
        yield bytes(raw)
