# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that are correlated: those of which heights vary alike, and among these the sheets of a series,
which are kriged together.

The height of a sheet is a field that all of them share plus the thicknesses between it and the oldest one
(a linear model of coregionalization: Chiles and Delfiner 2012, "Geostatistics", section 5.6.4). What sheets
lie apart on average is a constant of each, their drift; it is estimated from all data, and the rest kriged
around it, so that a sheet with few contacts follows the others where it has none.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from ..base.work import Work, native_module
from ..settings.dips import Dips
from ..settings.variogram import Variogram
from .mis_ties import mean_heights, without_mis_ties

Fit = TypeVar("Fit")

_LEAST = 1e-3  # of the sill of heights: the variance of a thickness of which data show nothing
_NEAR = (8, 0, 0.0)  # the neighbourhood by which what sheets lie apart is estimated where they show no more
MOST_AT_ONCE = 300  # data that all count at each node
MOST_NEIGHBOURS = 64  # of all sheets together, by default


@dataclass(frozen=True)
class Alike:
    """Surfaces of which heights vary alike, oldest first, for a Task of one of them. own: its number. points:
    (P, 3) of each; dips: of each, or None; those of `own` are those of the Task. known: what was fitted to
    such data before, filled as it comes: it is the same for each surface. error: the mean variance of the
    errors of the heights of all points."""

    own: int
    points: Sequence[np.ndarray]
    dips: Sequence[Dips | None]
    known: dict[bytes, Any] = field(default_factory=dict)
    error: float = 0.0

    def data(self, own: np.ndarray, own_dips: Dips | None) -> tuple[list[np.ndarray], list[Dips | None]]:
        """The points and dips of each surface, with those of the Task."""
        points = [without_mis_ties(part)[0] if len(part) else part for part in self.points]
        dips = [None if slopes is None or not len(slopes) else slopes.merged()[0] for slopes in self.dips]
        points[self.own], dips[self.own] = own, own_dips
        return points, dips

    def fitted(self, of: tuple, arrays: Sequence[np.ndarray], fit: Callable[[], Fit]) -> Fit:
        """What `fit` finds in arrays, by settings `of`; found once."""
        key = hashlib.sha256(repr(of).encode())
        for array in arrays:
            key.update(repr(array.shape).encode())
            key.update(np.ascontiguousarray(array))
        if key.digest() not in self.known:
            self.known[key.digest()] = fit()
        return self.known[key.digest()]


@dataclass(frozen=True)
class Companions(Alike):
    """The sheets of a series, for a Task of one of them. model: the variogram and the model to be taken in
    the place of those that fit."""

    model: tuple[Variogram, SheetModel] | None = None


@dataclass(frozen=True)
class SheetModel:
    """What sheets have in common. offsets: (S,) what each lies above the first one with points, on average.
    variances: (S,) of its thickness above the oldest, in units of the sill. thickness: their variogram."""

    offsets: np.ndarray
    variances: np.ndarray
    thickness: Variogram

    def native(self, sheets: np.ndarray, of_dips: np.ndarray, asked: int, anisotropy: dict | None) -> tuple:
        """The argument of native functions. sheets: of the points; of_dips: of the dips."""
        return (
            sheets,
            of_dips,
            self.variances,
            self.thickness.native(anisotropy),
            asked,
        )


@dataclass(frozen=True)
class JointData:
    """Data of all sheets around their offsets, those of the sheet that is requested first."""

    points: np.ndarray
    sheets: np.ndarray
    dips: Dips | None
    of_dips: np.ndarray

    @classmethod
    def of(
        cls, points: Sequence[np.ndarray], dips: Sequence[Dips | None], offsets: np.ndarray, first: int
    ) -> JointData:
        order = [first, *(number for number in range(len(points)) if number != first)]
        parts = [points[number] - np.array([0, 0, offsets[number]]) for number in order]
        pairs = [(number, dips[number]) for number in order]
        entries = [(number, slopes) for number, slopes in pairs if slopes is not None]
        return cls(
            np.concatenate([np.empty((0, 3)), *parts]),
            np.repeat(order, [len(part) for part in parts]).astype(np.int32),
            Dips.joined([slopes for _, slopes in entries]) if entries else None,
            np.repeat([n for n, _ in entries], [len(slopes) for _, slopes in entries]).astype(np.int32),
        )


def pooled(points: Sequence[np.ndarray], offsets: np.ndarray) -> np.ndarray:
    """(P, 3) the points of all sheets around their offsets, the mean of those at one position."""
    every = np.concatenate([part - np.array([0, 0, c]) for part, c in zip(points, offsets, strict=True)])
    return mean_heights(every + 0.0)


def likeliest(
    run: Callable[..., dict], settings: dict, companions: Companions, data: JointData, spacing: float
) -> dict | None:
    """What native fit_sheets finds in the data of all sheets, in their order; None where they are
    too few. run, settings: of the Task. spacing: of points and dips."""
    along, preset = settings["anisotropy"], settings["variogram"]
    variogram = None if preset is None else Variogram.from_settings(preset).native(along)
    error = companions.error
    drift, anisotropy = settings.get("drift", "constant"), along and (along["ratio"], along["azimuth"])
    dips, of_dips, count = data.dips, data.of_dips, len(companions.points)
    arrays = [data.points, data.sheets]
    if dips is not None:  # one that counts for several sheets says once how they slope
        first = np.sort(np.unique(dips.positions + 0.0, axis=0, return_index=True)[1])
        dips, of_dips = dips.some(first), of_dips[first]
        arrays += [of_dips, dips.positions, dips.gradients]

    def fit() -> dict | None:
        given_dips = None if dips is None else (dips.positions, dips.gradients, spacing, 0)
        sheets = (data.sheets, of_dips, count)
        fit_sheets = native_module().fit_sheets
        return run(fit_sheets, data.points, sheets, anisotropy, drift, given_dips, variogram, error)

    return companions.fitted((variogram, drift, anisotropy, count, error), arrays, fit)


def likeliest_model(fitted: dict, variogram: Variogram, base: int) -> SheetModel:
    """The model of what `likeliest` found. base: the sheet above which the others lie."""
    constants = fitted["constants"]
    return _model(constants - constants[base], fitted["thickness"], variogram)


def _model(offsets: np.ndarray, share: float, variogram: Variogram) -> SheetModel:
    """Thicknesses vary as the variogram does. share: the variance of each, of the sill."""
    first = variogram.parts()[0]
    thickness = Variogram(first.model, first.range, 1.0, anisotropy=first.anisotropy)
    return SheetModel(offsets, share * np.arange(len(offsets), dtype=np.float64), thickness)


def plain_model(offsets: np.ndarray, variogram: Variogram) -> SheetModel:
    """The model of sheets whose data are too few, or too plain, to show one. offsets: as of SheetModel."""
    return _model(offsets, _LEAST, variogram)


def first_offsets(work: Work, points: Sequence[np.ndarray]) -> np.ndarray:
    """(S,) what each sheet lies above that with the most points: the median of how far its points lie above
    those of the sheet next to it whose offset is known, nearby; 0 for sheets without points."""
    count = [len(part) for part in points]
    base = int(np.argmax(count))
    offsets = np.full(len(points), np.nan)
    offsets[base] = 0.0
    rest = [number for number in range(len(points)) if count[number] and number != base]
    for number in sorted(rest, key=lambda other: (abs(other - base), other)):
        placed = np.flatnonzero(np.isfinite(offsets))
        nearest = min(placed.tolist(), key=lambda other: (abs(other - number), other))
        others = pooled([points[nearest]], offsets[[nearest]])
        plan = np.ascontiguousarray(points[number][:, :2])
        z = work.native(native_module().idw, others, plan, neighborhood=_NEAR)
        offsets[number] = np.median(points[number][:, 2] - z)
    return np.nan_to_num(offsets)
