# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that are kriged together: the sheets of a series, which share their structure.

The height of a sheet is a field that all of them share plus the thicknesses between it and the oldest one
(a linear model of coregionalization: Chiles and Delfiner 2012, "Geostatistics", section 5.6.4). What sheets
lie apart on average is a constant of each, their drift; it is estimated from all data, and the rest kriged
around it, so that a sheet with few contacts follows the others where it has none.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..base.work import Work, native_module
from ..settings.dips import Dips
from ..settings.variogram import Variogram
from .mis_ties import mean_heights, without_mis_ties

_LEAST, _MOST = 1e-3, 0.5  # of the sill of heights: the variance of one thickness
_FEW = 8  # thicknesses at shared positions: fewer show no variance
_SHOWN = 25  # as many show how they vary with distance
ROUNDS = 2  # of fitting, and estimating what sheets lie apart
_NEAR = (8, 0, 0.0)  # the neighbourhood by which this is estimated at first
MOST_AT_ONCE = 300  # data that all count at each node
MOST_NEIGHBOURS = 64  # of all sheets together, by default


@dataclass(frozen=True)
class Companions:
    """The sheets of a series, oldest first, for a Task of one of them. own: its number. points: (P, 3) of
    each sheet; dips: of each, or None; those of `own` are those of the Task. known: what was fitted to such
    data before, filled as it comes: it is the same for each sheet. model: the variogram and the model to be
    taken in the place of those that fit."""

    own: int
    points: Sequence[np.ndarray]
    dips: Sequence[Dips | None]
    known: dict[bytes, dict | None] = field(default_factory=dict)
    model: tuple[Variogram, SheetModel] | None = None

    def data(self, own: np.ndarray, own_dips: Dips | None) -> tuple[list[np.ndarray], list[Dips | None]]:
        """The points and dips of each sheet, with those of the Task."""
        points = [without_mis_ties(each)[0] if len(each) else each for each in self.points]
        dips = [None if each is None or not len(each) else each.merged()[0] for each in self.dips]
        points[self.own], dips[self.own] = own, own_dips
        return points, dips


@dataclass(frozen=True)
class SheetModel:
    """What sheets have in common. offsets: (S,) what each lies above the first one with points, on average.
    variances: (S,) of its thickness above the oldest, in units of the sill. thickness: their variogram."""

    offsets: np.ndarray
    variances: np.ndarray
    thickness: Variogram

    def native(self, sheets: np.ndarray, of_dips: np.ndarray, asked: int, anisotropy) -> tuple:
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
    """Data of all sheets around their offsets, those of the sheet that is asked for first."""

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
        given = [(number, dips[number]) for number in order]
        known = [(number, each) for number, each in given if each is not None]
        return cls(
            np.concatenate([np.empty((0, 3)), *parts]),
            np.repeat(order, [len(each) for each in parts]).astype(np.int32),
            Dips.joined([each for _, each in known]) if known else None,
            np.repeat([n for n, _ in known], [len(each) for _, each in known]).astype(np.int32),
        )


def pooled(points: Sequence[np.ndarray], offsets: np.ndarray) -> np.ndarray:
    """(P, 3) the points of all sheets around their offsets, the mean of those at one position."""
    every = np.concatenate([each - np.array([0, 0, c]) for each, c in zip(points, offsets, strict=True)])
    return mean_heights(every + 0.0)


def likeliest(task, companions: Companions, data: JointData, spacing: float) -> dict | None:
    """What native fit_sheets finds in the data of all sheets, in their order, for the settings of a Task;
    None where they are many. spacing: of points and dips."""
    settings = task.settings
    along, given = settings["anisotropy"], settings["variogram"]
    variogram = None if given is None else Variogram.from_settings(given).native(along)
    drift, anisotropy = settings.get("drift", "constant"), along and (along["ratio"], along["azimuth"])
    dips, of_dips, count = data.dips, data.of_dips, len(companions.points)
    arrays = [data.points, data.sheets]
    if dips is not None:  # one that counts for several sheets says once how they slope
        first = np.sort(np.unique(dips.positions + 0.0, axis=0, return_index=True)[1])
        dips, of_dips = dips.some(first), of_dips[first]
        arrays += [of_dips, dips.positions, dips.gradients]
    key = hashlib.sha256(repr((variogram, drift, anisotropy, count)).encode())
    for each in arrays:
        key.update(np.ascontiguousarray(each))
    if key.digest() not in companions.known:
        companions.known[key.digest()] = task.run(
            native_module().fit_sheets,
            data.points,
            (data.sheets, of_dips, count),
            anisotropy,
            drift,
            None if dips is None else (dips.positions, dips.gradients, spacing, 0),
            variogram,
        )
    return companions.known[key.digest()]


def likeliest_model(fitted: dict, variogram: Variogram, base: int) -> SheetModel:
    """The model of what `likeliest` found. base: the sheet above which the others lie."""
    first = variogram.parts()[0]
    thickness = Variogram(first.model, first.range, 1.0, anisotropy=first.anisotropy)
    constants = fitted["constants"]
    variances = fitted["thickness"] * np.arange(len(constants), dtype=np.float64)
    return SheetModel(constants - constants[base], variances, thickness)


def first_offsets(work: Work, points: Sequence[np.ndarray]) -> np.ndarray:
    """(S,) what each sheet lies above that with the most points: the median of how far its points lie above
    those of the sheet next to it whose offset is known, nearby; 0 for sheets without points."""
    count = [len(each) for each in points]
    base = int(np.argmax(count))
    offsets = np.full(len(points), np.nan)
    offsets[base] = 0.0
    rest = [number for number in range(len(points)) if count[number] and number != base]
    for number in sorted(rest, key=lambda each: (abs(each - base), each)):
        known = np.flatnonzero(np.isfinite(offsets))
        nearest = min(known.tolist(), key=lambda each: (abs(each - number), each))
        others = pooled([points[nearest]], offsets[[nearest]])
        plan = np.ascontiguousarray(points[number][:, :2])
        z = work.native(native_module().idw, others, plan, neighborhood=_NEAR)
        offsets[number] = np.median(points[number][:, 2] - z)
    return np.nan_to_num(offsets)


def thickness_model(
    work: Work,
    points: Sequence[np.ndarray],
    variogram: Variogram,
    offsets: np.ndarray,
    anisotropy: dict | None,
) -> SheetModel:
    """The sheets' model with these offsets. Thicknesses vary as they do where two
    sheets were met at one position; where there are few such positions, as what remains of heights where the
    other sheets' are known."""
    met = [_met(points[k - 1], points[k]) for k in range(1, len(points))]
    away = [each[:, 2] - each[:, 2].mean() for each in met if len(each) > 1]
    away = [each / np.sqrt(1 - 1 / len(each)) for each in away]
    structured = max(variogram.sill - variogram.nugget, 1e-3 * variogram.sill)
    own = Variogram(variogram.parts()[0].model, variogram.range, 1.0)
    if sum(map(len, away)) >= _FEW:
        variance = float(np.mean(np.concatenate(away) ** 2))
        largest = max(met, key=len)
        if len(largest) >= _SHOWN:
            fitted = Variogram.from_fit(work.native(native_module().fit_variogram, largest), False)
            own = replace(own, model=fitted.parts()[0].model, range=fitted.range)
    else:
        variance = _remaining(work, points, offsets, variogram.native(anisotropy))
    share = float(np.clip(variance / variogram.sill, _LEAST, _MOST * structured / variogram.sill))
    variances = share * np.arange(len(points), dtype=np.float64)
    return SheetModel(offsets, variances, own)


def without_thickness(variogram: Variogram, model: SheetModel) -> Variogram:
    """The variogram of what sheets share, of one that was fitted to the points of all: what their thicknesses
    explain there is no nugget."""
    explained = min(variogram.nugget, float(model.variances.mean()) * variogram.sill)
    return replace(variogram, nugget=variogram.nugget - explained, sill=variogram.sill - explained)


def _met(older: np.ndarray, younger: np.ndarray) -> np.ndarray:
    """(M, 3) the thickness at each position where two sheets have a point."""
    known = {tuple(place): z for *place, z in older.tolist()}
    found = [(x, y, z - known[x, y]) for x, y, z in younger.tolist() if (x, y) in known]
    return np.array(found).reshape(-1, 3)


def _remaining(work: Work, points, offsets: np.ndarray, variogram: dict) -> float:
    """The mean square of what heights of a sheet differ from those kriged from its neighbors, less the part
    that these do not know."""
    found = []
    for number in range(1, len(points)):
        if not (len(points[number]) and len(points[number - 1])):
            continue
        others = pooled([points[number - 1]], offsets[[number - 1]])
        plan = np.ascontiguousarray(points[number][:, :2])
        z, variance, _ = work.native(native_module().krige, others, plan, variogram)
        found.append((points[number][:, 2] - offsets[number] - z) ** 2 - variance)
    return float(np.median(np.concatenate(found))) if found else 0.0
