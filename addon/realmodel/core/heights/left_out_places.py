# SPDX-License-Identifier: GPL-3.0-or-later
"""Which data are left out together when an estimate is tested by data that it does not know."""

from __future__ import annotations

import numpy as np

from ..base.work import Work, native_module, on_threads

_NODES = 40  # of a grid over the data, along x and along y
_NEARER = 0.5  # of the distance that nodes have: a datum with another so near is in a cluster
_CLUSTERED = 0.1  # the share of data in clusters from which on places are left out
_SIDE = 1.5  # of a square that is one place, in median distances of nodes


def places_of(work: Work, plan: np.ndarray) -> np.ndarray | None:
    """(N,) the numbers of the places of data at plan (N, 2), where they are clustered, as twin holes and the
    points of a survey line are; None where they are not, and each is a separate place.

    The error at a datum that is left out is the model's where other data are as near as they are elsewhere.
    So the distances from data to the nearest other one are compared, rank by rank, with those from the nodes
    of a grid over their hull (after the matching of nearest neighbor distances of Milà, Mateu, Pebesma and
    Meyer 2022). Where more than a tenth are less than half as long, all data in a square are one place; its
    side is 1.5 times the median distance of nodes.
    """
    low, high = plan.min(axis=0), plan.max(axis=0)
    steps = (np.arange(_NODES) + 0.5) / _NODES
    grid = np.stack(np.meshgrid(*(low[k] + steps * (high[k] - low[k]) for k in (0, 1))), axis=-1).reshape(
        -1, 2
    )
    flat = np.column_stack([plan, np.zeros(len(plan))])
    nodes = np.ascontiguousarray(grid[~work.native(native_module().outside_hull, flat, grid)])
    if len(plan) < 3 or not len(nodes):
        return None
    away = np.sort(_distances(plan, nodes, 1))
    apart = np.sort(_distances(plan, plan, 2))
    ranks = ((np.arange(len(apart)) + 0.5) / len(apart) * len(away)).astype(np.int64)
    if (apart < _NEARER * away[ranks]).mean() <= _CLUSTERED:
        return None
    side = _SIDE * float(np.median(away))
    number = np.unique(np.floor((plan - low) / side), axis=0, return_inverse=True)[1].ravel()
    return number if number.max() else None


def in_turn(places: np.ndarray, most: int) -> list[np.ndarray]:
    """(N,) bool, which data are left out at a time, in at most so many turns. places: (N,) the numbers of
    their places."""
    turns = min(int(places.max()) + 1, most)
    return [places % turns == turn for turn in range(turns)]


def _distances(plan: np.ndarray, at: np.ndarray, rank: int) -> np.ndarray:
    points = np.ascontiguousarray(plan)
    nearest = native_module().nearest_points(points, np.ascontiguousarray(at), rank, execution=on_threads(0))
    return nearest[1][:, rank - 1]
