# SPDX-License-Identifier: GPL-3.0-or-later
"""Random numbers of places: the same for any number of threads and on any machine."""

from __future__ import annotations

import numpy as np

_PRIMES = (0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D, 0x27D4EB2F)


def chance(*numbers: np.ndarray | int) -> np.ndarray:
    """(N,) numbers from 0 to 1, of whole numbers each (N,) or one for all: mixed as by the finalizer of
    MurmurHash3 (Appleby 2011)."""
    mixed = np.zeros(np.broadcast_shapes(*(np.shape(each) for each in numbers)), np.uint64)
    for prime, each in zip(_PRIMES, numbers, strict=False):
        mixed ^= np.asarray(each).astype(np.int64).astype(np.uint64) & np.uint64(0xFFFFFFFF)
        for factor in (prime, 0x2C1B3C6D):
            mixed = (mixed * np.uint64(factor)) & np.uint64(0xFFFFFFFF)
            mixed ^= mixed >> np.uint64(15)
    return mixed.astype(np.float64) / 2.0**32


def noise(points: np.ndarray, seed: int) -> np.ndarray:
    """(N,) value noise, 0 to 1, at points (N, 3): random at whole numbers, smooth between (Ebert et al. 2003,
    "Texturing and Modeling", chapter 2)."""
    cell = np.floor(points)
    share = points - cell
    share = share * share * (3.0 - 2.0 * share)
    cell = cell.astype(np.int64)
    values = chance(
        cell[:, 0] + np.array([0, 1])[:, None, None, None],
        cell[:, 1] + np.array([0, 1])[:, None, None],
        cell[:, 2] + np.array([0, 1])[:, None],
        seed,
    )
    for axis in range(3):
        values = values[0] + (values[1] - values[0]) * share[:, axis]
    return values


def fractal(points: np.ndarray, seed: int, octaves: int = 3) -> np.ndarray:
    """(N,) noise of several octaves, 0 to 1: each of half the size and the strength of that before."""
    total, strength = np.zeros(len(points)), 0.5
    for octave in range(octaves):
        total += strength * noise(points * 2.0**octave + 17.3 * octave, seed + octave)
        strength *= 0.5
    return total / (1.0 - 0.5**octaves)
