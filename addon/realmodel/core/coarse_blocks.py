# SPDX-License-Identifier: GPL-3.0-or-later
"""How many connected parts the blocks of a rock mass will have, from its surfaces seen on a coarse grid."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .project import Rock
from .rules import RULES
from .work import native_module

_MOST_BINS = 128  # along a side
_FEWEST_BINS = 4
_PLACES_PER_BIN = 2.0  # so that few bins inside a surface are empty


def coarse_blocks(rock: Rock, places: Sequence[np.ndarray]) -> int:
    """The number of connected parts of all blocks on a grid of at most 128 x 128 bins.

    places: (N, 3) of each surface, oldest first: its vertices, or the points that it is interpolated from; a
    bin has the mean height of those in it. What is smaller than a bin is not seen.
    """
    heights = _binned(places)
    interval = _block_intervals(rock, heights)
    present = [high > low for low, high in interval]
    number = np.full((len(present), *heights.shape[1:]), -1, np.int64)
    count = 0
    for layer, there in enumerate(present):
        number[layer][there] = count + np.arange(there.sum())
        count += int(there.sum())
    if not count:
        return 0
    block = np.repeat(np.arange(len(present)), [int(there.sum()) for there in present])
    pairs = [
        np.stack([before.ravel(), after.ravel()], axis=1)
        for before, after in ((number[:, :-1], number[:, 1:]), (number[:, :, :-1], number[:, :, 1:]))
    ]
    neighbours = np.concatenate(pairs)
    neighbours = neighbours[(neighbours >= 0).all(axis=1)]
    part = native_module().cell_components(neighbours, block)
    return int((part == np.arange(count)).sum())


def _binned(places: Sequence[np.ndarray]) -> np.ndarray:
    """(S, G, G) mean heights, NaN where a surface has no place in a bin."""
    low = np.min([given[:, :2].min(axis=0) for given in places], axis=0)
    high = np.max([given[:, :2].max(axis=0) for given in places], axis=0)
    fewest = min(len(given) for given in places)
    side = int(np.clip(np.sqrt(fewest / _PLACES_PER_BIN), _FEWEST_BINS, _MOST_BINS))
    step = np.where(high > low, high - low, 1.0) / side
    heights = np.empty((len(places), side, side))
    for layer, given in zip(heights, places, strict=True):
        column, row = np.clip(((given[:, :2] - low) / step).astype(np.int64), 0, side - 1).T
        bins = column * side + row
        count = np.bincount(bins, minlength=side * side)
        total = np.bincount(bins, given[:, 2], side * side)
        layer[:] = np.where(count, total / np.maximum(count, 1), np.nan).reshape(side, side)
    return heights


def _block_intervals(rock: Rock, heights: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """For each surface the lower and upper height of the block beneath it in each bin, NaN where there is
    none: the closed form of docs/dev/geometry.md."""
    nothing = np.full(heights.shape[1:], np.nan)
    base = nothing if rock.base_elevation is None else np.full(nothing.shape, float(rock.base_elevation))
    top, floor = base, nothing
    under, laid = [], []
    for number, (z, surface) in enumerate(zip(heights, rock.surfaces, strict=True)):
        # fmax and fmin leave out what is NaN
        level = np.fmax(z, top) if number and not RULES[surface.rule].cuts else z
        level = np.where(np.isnan(z), np.nan, np.fmax(level, floor))
        under.append(top)
        laid.append(level)
        covered = ~np.isnan(level)
        if not number:
            top = nothing  # the base bears the oldest surface only
        top = np.where(covered, level, top)
        if RULES[surface.rule].protects:
            floor = np.where(covered, level, floor)
    interval, least = [], nothing
    for level, bottom in zip(reversed(laid), reversed(under), strict=True):
        least = np.fmin(least, level)
        high = np.where(np.isnan(level), np.nan, least)
        interval.append((np.where(np.isnan(bottom), np.nan, np.fmin(bottom, high)), high))
    return interval[::-1]
