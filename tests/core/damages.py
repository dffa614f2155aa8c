# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that were damaged on their way, the same ones in every run."""

import re

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


_WRONG_TEXT = (b"0", b"-1", b"999999999", b"99999999999999999999")
_WRONG_BYTES = (b"\xff\xff\xff\x7f", b"\x7f\xff\xff\xff", b"\xff" * 8, b"\0" * 4)


def wrong_counts(whole, most=60):
    """The bytes of a file with one number of its text, or one of four bytes, that is zero, below zero or far
    too large; at most so many of all such files."""
    numbers = [(found.start(), found.end()) for found in re.finditer(rb"\d+", whole[:4000])]
    all_wrong = [(begin, end, text) for begin, end in numbers for text in _WRONG_TEXT]
    all_wrong += [(at, at + len(raw), raw) for at in range(min(len(whole), 400)) for raw in _WRONG_BYTES]
    draw = np.random.default_rng(2)
    for at in draw.permutation(len(all_wrong))[:most]:
        begin, end, wrong = all_wrong[at]
        yield whole[:begin] + wrong + whole[end:]
