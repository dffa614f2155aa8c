# SPDX-License-Identifier: GPL-3.0-or-later
"""Which surfaces of a rock mass the dip of a block counts for.

A block was deposited on the surface below it, independent of what that had cut, and is parallel to it; it
lies parallel to the surface above it unless that came as an erosion surface and cut it. So surfaces that cut
part the others into runs that are conformable with one another, each with its unconformity as the lowest.
Where all surfaces cut, as by default, their rules do not say which of them are unconformities: none parts but
the youngest, which may be the ground.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...settings.rules import RULES


def _parting(rules: Sequence[str], ground: int | None) -> list[bool]:
    """Whether each surface parts what is above it from what is below it."""
    last = len(rules) - 1 if ground is None else ground
    if all(RULES[rule].cuts for rule in rules[1:]):
        return [number in (last, ground) and number > 0 for number in range(len(rules))]
    return [RULES[rule].cuts or number == ground for number, rule in enumerate(rules)]


def beside_blocks(rules: Sequence[str], ground: int | None = None) -> np.ndarray:
    """(B, S) bool: of the surfaces under and over each block, those that are conformable with it. ground: the
    number of the surface that is the ground of today."""
    count, parting = len(rules), _parting(rules, ground)
    is_conformable = np.zeros((count, count), bool)
    for block in range(count):
        is_conformable[block, block] = not parting[block]
        if block and block - 1 != ground:
            is_conformable[block, block - 1] = True
    return is_conformable


def runs_of_blocks(rules: Sequence[str], ground: int | None = None) -> np.ndarray:
    """(B, S) bool: the surfaces that no unconformity parts from each block."""
    parting = _parting(rules, ground)
    run = np.cumsum(parting)  # a surface that parts is the lowest of its run
    block_run = np.concatenate([[0], run[:-1]])
    in_run = block_run[:, None] == run[None, :]
    if ground is not None:
        in_run[:, ground] = False
    return in_run


def blocks_at(rules: Sequence[str], heights: np.ndarray, z: np.ndarray) -> np.ndarray:
    """(N,) the block that places lie in. heights: (S, N) of the surfaces there, NaN where one does not exist.
    z: (N,) of the places; NaN, or above the top of what is there: just below this."""
    deposited, top = _deposited(rules, heights)
    z = np.where(np.isnan(z) | (z > top), top, z)
    blocks = np.full(len(z), -1)  # air
    for number, (rule, z_surface) in enumerate(zip(rules, deposited, strict=True)):
        if RULES[rule].cuts:
            blocks[z > z_surface] = -1
        blocks[(blocks < 0) & (z <= z_surface)] = number
    return np.maximum(blocks, 0)


def _deposited(rules: Sequence[str], heights: np.ndarray) -> tuple[list[np.ndarray], np.ndarray]:
    """(N,) the heights of each surface as it came, NaN where it does not exist, and of the top at last."""
    top = np.full(heights.shape[1], np.nan)
    firm = np.full(heights.shape[1], -np.inf)
    deposited = []
    for rule, height in zip(rules, heights, strict=True):
        z = height if RULES[rule].cuts else np.fmax(height, top)
        z = np.where(np.isnan(height), np.nan, np.fmax(z, firm))
        top = np.where(np.isnan(z), top, z)
        firm = np.where(RULES[rule].protects & ~np.isnan(z), z, firm)
        deposited.append(z)
    return deposited, top
