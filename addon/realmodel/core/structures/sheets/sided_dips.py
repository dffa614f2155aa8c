# SPDX-License-Identifier: GPL-3.0-or-later
"""The sides of faults on which the dips of a surface lie."""

from __future__ import annotations

import numpy as np

from ...base.work import Work, native_module
from ...project.project import Surface
from ...settings.dips import Dips
from ...surfaces.rock_input import RockInput
from ...surfaces.sides import sides_of


def at_height(dips: Dips, height) -> np.ndarray:
    """(D, 3) the places of dips; heights, or one, of those that have none."""
    own = np.full(len(dips), np.nan) if dips.z is None else dips.z
    return np.column_stack([dips.positions, np.where(np.isfinite(own), own, height)])


def sided_dips(work: Work, surface: Surface, entry: RockInput) -> tuple[Dips | None, np.ndarray]:
    """The dips of a surface and, for each, its sides (D, F) of the faults. A dip without a height has that of
    the nearest point of the surface."""
    dips, faults = surface.known_dips(), entry.divided().faults
    if dips is None or not len(dips):
        return None, np.zeros((0, len(faults)), np.int8)
    height = np.zeros(len(dips))
    points = surface.point_array()
    if len(points):
        nearest = (1, 0, 0.0)
        positions = np.ascontiguousarray(dips.positions)
        height = work.native(native_module().idw, _one_at_each_place(points), positions, neighborhood=nearest)
    return dips, sides_of(work, at_height(dips, height), faults)


def _one_at_each_place(points: np.ndarray) -> np.ndarray:
    _, first = np.unique(points[:, :2], axis=0, return_index=True)
    return np.ascontiguousarray(points[np.sort(first)])
