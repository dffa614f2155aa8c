# SPDX-License-Identifier: GPL-3.0-or-later
"""Rubble: pieces of the blocks into which joints divide hard beds, with broken corners."""

from __future__ import annotations

import math

import numpy as np

from ..base.algebra import cos, dot, sin
from ..base.work import Work
from ..results.booleans import intersect_within
from .beds import Beds
from .erosion import JOINT_ANGLE, Mesh
from .strata import Strata, hardness_of_beds

PIECES = 10  # different ones
_CORNERS = np.array([(n & 1, n >> 1 & 1, n >> 2) for n in range(8)]) - 0.5
_SIDES = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7)]
_BOX = np.array([*_SIDES, (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)], np.int32)
_LEAST, _MOST = np.array([0.8, 0.6, 0.5]), np.array([1.7, 1.2, 1.0])  # sides of a block, of the thickness
_BREAKS = (0.5, 0.8)  # of the half diagonal of a block: how far out it breaks, least and most
_THICK = (0.5, 2.0)  # of the mean thickness of beds: the thickness that counts, least and most
_SUNK = 0.2  # of the height of a piece: so much of it lies in the ground


def broken_piece(work: Work, thickness: float, seed: int) -> Mesh:
    """A piece of a bed of some thickness, as a job: a closed convex mesh, vertices (V, 3) and triangles
    (T, 3). It lies on its bedding plane; the origin is where the ground is."""
    random = np.random.default_rng((seed, 611))
    sides = thickness * (_LEAST + (_MOST - _LEAST) * random.random(3))
    block = _CORNERS * sides
    block[:, 0] += block[:, 1] * sin(JOINT_ANGLE)
    reach = math.sqrt(float(dot(sides, sides)))
    breaking = _CORNERS * reach * (_BREAKS[0] + (_BREAKS[1] - _BREAKS[0]) * random.random(3))
    for axis, turn in zip((0, 1, 2, 0), 2.0 * math.pi * random.random(4), strict=True):
        a, b = (k for k in range(3) if k != axis)
        x, y = breaking[:, a].copy(), breaking[:, b].copy()
        breaking[:, a], breaking[:, b] = x * cos(turn) - y * sin(turn), x * sin(turn) + y * cos(turn)
    vertices, triangles = intersect_within(work, (block, _BOX), (breaking, _BOX)).intersection()
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    ground = np.append(0.5 * (low + high)[:2], low[2] + _SUNK * (high[2] - low[2]))
    return vertices - ground, triangles


def rubble_within(work: Work, beds: Beds, strata: Strata, unit: float) -> list[tuple[int, Mesh]]:
    """Pieces of beds as a job, and the number of the bed of each: of hard beds more than of soft ones, which
    crumble. unit: the mean thickness of beds."""
    random = np.random.default_rng((strata.seed, 612))
    shares = hardness_of_beds(beds.count, strata) ** 3
    chosen = random.choice(beds.count, PIECES, p=shares / shares.sum())
    base, top = beds.bounds()
    thickness = np.clip((top - base) / beds.slant, _THICK[0] * unit, _THICK[1] * unit)
    seeds = random.integers(0, 2**31, PIECES)
    return [
        (int(bed), broken_piece(work, float(thickness[bed]), int(seed)))
        for bed, seed in zip(chosen, seeds, strict=True)
    ]
