# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of a series drawn together: a realization is one of the field that they share and of each thickness
between them, with the covariances by which they are kriged (heights/companions.py)."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field, replace

import numpy as np

from ...base.work import Work
from ...settings.dips import Dips
from ...settings.variogram import Variogram
from ..companions import Companions, SheetModel
from ..from_neighbors import KrigingStructure
from ..interpolation import Task
from ..mis_ties import without_mis_ties
from .turning_bands import FieldArea, GaussianField, Noise

NUGGET = -1  # where a noise has the numbers of the nugget; those of lines count from 0


def nugget_noise(noise: Noise, variogram: Variogram, points: np.ndarray, more: int = 0) -> np.ndarray:
    """(P + more,) the nugget at points (P, 2), the same at equal positions, and at so many other places."""
    _, first, place = np.unique(points, axis=0, return_index=True, return_inverse=True)
    drawn = noise.normal(NUGGET, len(points) + more) * math.sqrt(variogram.nugget)
    drawn[: len(points)] = drawn[: len(points)][first[place.reshape(-1)]]
    return drawn


@dataclass(frozen=True)
class SeriesDraw:
    """A realization of the sheets of a series, which its surfaces share. noises: of each sheet, oldest first:
    that of the oldest draws the field in common, the others the thicknesses. known: fields at places, filled
    as they come: the same for each sheet."""

    noises: list[Noise]
    known: dict[tuple, np.ndarray] = field(default_factory=dict)

    def of(self, own: int, area: FieldArea, found: KrigingStructure, anisotropy: dict | None) -> SheetField:
        """The field of one sheet, with the covariances of a structure."""
        assert found.sheets is not None
        return SheetField(self, own, area, found.variogram, found.sheets, anisotropy)


@dataclass(frozen=True)
class SheetField:
    """What is drawn of a sheet, as a GaussianField: without the nugget."""

    draw: SeriesDraw
    own: int
    area: FieldArea
    variogram: Variogram
    sheets: SheetModel
    anisotropy: dict | None

    def at(self, work: Work, places: np.ndarray) -> np.ndarray:
        """(N,) float64 at places (N, 2)."""
        total = self._part(work, 0, self.variogram, places)
        steps = np.diff(self.sheets.variances)
        for number in range(1, self.own + 1):
            thickness = self.sheets.thickness
            scaled = replace(thickness, sill=float(steps[number - 1]) * self.variogram.sill)
            total = total + self._part(work, number, scaled, places)
        return total

    def _part(self, work: Work, number: int, variogram: Variogram, places: np.ndarray) -> np.ndarray:
        """The field in common, or a thickness, at places."""
        at = hashlib.sha256(np.ascontiguousarray(places)).digest()
        key = (number, repr(variogram), repr(self.anisotropy), at)
        if key not in self.draw.known:
            drawn = GaussianField(variogram, self.anisotropy, self.area, self.draw.noises[number])
            self.draw.known[key] = drawn.at(work, places)
        return self.draw.known[key]

    def of_sheet(self, number: int) -> SheetField:
        return replace(self, own=number)


def drawn_companions(task: Task, drawn: SheetField, baseline: float) -> Companions:
    """The sheets of a task with what is drawn of them instead of their heights and slopes. baseline:
    over which slopes count."""
    companions = task.companions
    assert companions is not None
    points, dips = companions.data(without_mis_ties(task.points)[0], task.dips)
    heights, slopes = [], []
    for number, (part, of_sheet) in enumerate(zip(points, dips, strict=True)):
        at_sheet = drawn.of_sheet(number)
        z = at_sheet.at(task.work, part[:, :2]) if len(part) else np.zeros(0)
        if drawn.variogram.nugget > 0:
            z = z + nugget_noise(drawn.draw.noises[number], drawn.variogram, part[:, :2])
        heights.append(np.column_stack([part[:, :2], z]))
        slopes.append(None if of_sheet is None else drawn_dips(task.work, at_sheet, of_sheet, baseline))
    model = replace(drawn.sheets, offsets=np.zeros(len(points)))
    return replace(companions, points=heights, dips=slopes, model=(drawn.variogram, model))


def drawn_dips(work: Work, drawn: GaussianField | SheetField, dips: Dips, baseline: float) -> Dips:
    """Dips with the slopes that are drawn there, over a baseline."""
    slopes = []
    for axis in np.eye(2) * (baseline / 2):
        ends = (dips.positions + axis, dips.positions - axis)
        to, begin = (drawn.at(work, end) for end in ends)
        slopes.append((to - begin) / baseline)
    return replace(dips, gradients=np.column_stack(slopes))
