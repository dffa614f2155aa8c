# SPDX-License-Identifier: GPL-3.0-or-later
"""Positions that only rounding keeps apart."""

from __future__ import annotations

from itertools import product

import numpy as np

_ROUNDINGS = 64  # positions nearer than so many units in the last place are one
_MIXED = np.array([0x2545F4914F6CDD1D, 0x1B873593CC9E2D51, 0x3C6EF372FE94F82B])  # odd; of cells that differ


def apart(positions: np.ndarray) -> float:
    """How near positions (N, D) are one, along each axis."""
    return _ROUNDINGS * float(np.spacing(np.abs(positions).max(initial=1.0)))


def near_positions(positions: np.ndarray) -> np.ndarray:
    """(N,) int64: of each of positions (N, D) in 1 to 3 dimensions the first that it is one with. Those that
    are nearer than `apart` along all axes are one, those farther than twice that are not unless others
    between join them."""
    size, count = 2.0 * apart(positions), len(positions)
    cells, members, numbers = [np.empty(0, np.int64)], [np.empty(0, np.int64)], 0
    # near ones share a cell of one of these grids
    for shift in product((0.0, 0.5), repeat=positions.shape[1]):
        indices = np.floor((positions - positions[:1]) / size + shift).astype(np.int64)
        mixed = (indices * _MIXED[: indices.shape[1]]).sum(axis=1)
        _, key, sharing = np.unique(mixed, return_inverse=True, return_counts=True)
        shared = np.flatnonzero(sharing[key.ravel()] > 1)  # few; and some that are not, by chance
        _, cell = np.unique(indices[shared], axis=0, return_inverse=True)
        cells.append(cell.ravel() + numbers)
        members.append(shared)
        numbers += len(shared)
    cell, member = np.concatenate(cells), np.concatenate(members)
    first = np.arange(count)
    first[member] = _joined(cell, member)
    return first


def _joined(group: np.ndarray, member: np.ndarray) -> np.ndarray:
    """For each (group, member) the least member of all that such groups connect."""
    _, group = np.unique(group, return_inverse=True)
    named, member = np.unique(member, return_inverse=True)
    group, member = group.ravel(), member.ravel()
    label = np.arange(len(named))
    while True:
        least = np.full(int(group.max(initial=-1)) + 1, len(label))
        np.minimum.at(least, group, label[member])
        lower = label.copy()
        np.minimum.at(lower, member, least[group])
        lower = lower[lower]
        if (lower == label).all():
            return named[label[member]]
        label = lower
