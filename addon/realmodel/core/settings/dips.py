# SPDX-License-Identifier: GPL-3.0-or-later
"""Dips of a surface or of a rock mass: arrays, or a table with its import options."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import ascending
from ..base.errors import InputRefused, place_text
from .data_files import FieldTable
from .directions import gradient_of, normal_of
from .setting import Setting

NORMAL = ("normal_x", "normal_y", "normal_z")
COLUMNS = (
    *("x", "y", "z", "dip", "dip_direction", "strike", "polarity", "slope_x", "slope_y", *NORMAL),
    *("surface", "block", "use"),
)


@dataclass(frozen=True)
class DipFile(FieldTable):
    """file: a table of dips of a surface, a rock mass or a series: x, y, z (needed for a series alone), dip,
    and dip_direction or strike, in degrees; of a rock mass also the surface or the block that each is of.

    dip: below the horizontal. dip_direction: clockwise from north (+y). strike: by the right-hand rule, the
    dip direction is 90 degrees clockwise from it. polarity: optional, 1 upright, -1 overturned, which is for
    series whose kind is "field" alone. slope_x and slope_y, how much the surface rises along x and along y,
    may take the place of angles; in such a series so may normal_x, normal_y, normal_z, toward younger rock.
    use: optional, 0 where a row is switched off.
    surface, block: their names, or those that the rock mass's names give them; empty: not known.
    columns: {"dip": "INCL", ...}, names or numbers from 1 of columns that are called otherwise. separator,
    decimal: as of a PointFile. units: of x, y and z, "ft", or {"xy": "m", "z": "ft"}; None: those of the
    model.
    """

    known = COLUMNS


DIPS = Setting(kind="table_file", of=DipFile, example='"dips.csv"')


@dataclass(frozen=True, eq=False)
class SpaceDips:
    """Dips in space, at any angle. positions: (D, 3) float64. normals: (D, 3) float64 of the bedding, of any
    length, toward younger rock. used: (D,) bool, False where one is switched off and not used; None: all are
    used. rows: (D,) the numbers of their rows in the table or the arrays that they come from; None: they are
    in its order."""

    positions: np.ndarray
    normals: np.ndarray
    used: np.ndarray | None = None
    rows: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def in_use(self) -> np.ndarray:
        """(D,) bool: which are not switched off."""
        return _in_use(self)

    def of_sheets(self) -> Dips:
        """The same as slopes of sheets. Raises InputRefused where one is vertical or overturned."""
        steep = np.flatnonzero(~(self.normals[:, 2] > 0) & self.in_use)
        if len(steep):
            what = f"dip {steep[0]} is vertical or overturned, and a sheet has one elevation at each position"
            raise InputRefused(what, item="dips", advice='leave it out, or use a series with kind = "field"')
        upward = self.normals[:, 2] > 0
        places, normals = self.positions[upward], self.normals[upward]
        used = None if self.used is None else np.asarray(self.used)[upward]
        gradients = -normals[:, :2] / normals[:, 2:] + 0.0  # no -0
        return Dips(np.ascontiguousarray(places[:, :2]), gradients, places[:, 2].copy(), used=used)

    @classmethod
    def joined(cls, parts: Sequence[SpaceDips]) -> SpaceDips:
        """Several, `parts`, one after another."""
        positions, normals = (
            np.concatenate([np.empty((0, 3)), *(getattr(part, key) for part in parts)])
            for key in ("positions", "normals")
        )
        used = np.concatenate([np.empty(0, bool), *(part.in_use for part in parts)])
        return cls(positions, normals, None if used.all() else used)

    @classmethod
    def from_angles(
        cls, positions: ArrayLike, dip: ArrayLike, dip_direction: ArrayLike, overturned: ArrayLike = False
    ) -> SpaceDips:
        """Dips from measured angles. positions: (D, 3), model units. dip: (D,) degrees below the horizontal,
        beyond 90 overturned. dip_direction: (D,) degrees clockwise from north (+y). overturned: (D,) bool.
        One number counts for all."""
        places = np.asarray(positions, np.float64)
        angles = np.broadcast_arrays(dip, dip_direction, overturned, np.empty(len(places)))[:3]
        rows = zip(*(column.tolist() for column in angles), strict=True)
        normals = [normal_of(*row) for row in rows]
        return cls(places, np.array(normals).reshape(-1, 3))

    def row(self, number: int) -> int:
        """The row that one of them comes from."""
        return _row(self, number)

    def checked(self) -> SpaceDips:
        """The same as arrays of float64, in the order of their places and values: the order of rows must not
        decide a result. Raises InputRefused."""
        positions, normals = (
            _floats(values, (len(self.positions), 3), f"{name} of dips")
            for name, values in (("positions", self.positions), ("normals", self.normals))
        )
        bad = ~np.isfinite(np.column_stack([positions, normals])).all(axis=1)
        bad |= ~normals.any(axis=1)
        if bad.any():
            raise InputRefused(f"dip {np.flatnonzero(bad)[0]} is not finite, or has no normal", item="dips")
        used = _checked_use(self.used, len(positions))
        order = ascending(*positions.T, *normals.T, *([] if used is None else [used]))
        rows = order if self.rows is None else np.asarray(self.rows)[order]
        return SpaceDips(positions[order], normals[order], None if used is None else used[order], rows)


@dataclass(frozen=True, eq=False)
class Dips:
    """Dips of a surface. positions: (D, 2) float64 x, y. gradients: (D, 2) float64, its slope along x and
    along y. z: (D,) float64 heights of the positions, NaN where they are not known, or None: an elevation
    only determines the side of a fault, and the block of a dip without a name. used: (D,) bool, False where
    one is switched off and not used; None: all are used.

    Of a rock mass: surfaces: (D,) texts, the surface that each is of, "" where none is named, or None.
    blocks: (D,) texts, the block that each is of, by its name or that of the surface over it, "" for none, or
    None. A dip of a block counts for the surfaces under and over it that are conformable with it, one
    without a name for all that no unconformity parts from it. rows: as of SpaceDips."""

    positions: np.ndarray
    gradients: np.ndarray
    z: np.ndarray | None = None
    surfaces: np.ndarray | None = None
    blocks: np.ndarray | None = None
    used: np.ndarray | None = None
    rows: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.positions)

    def some(self, kept: np.ndarray) -> Dips:
        """Some of them. kept: (D,) bool, or their numbers."""
        more = (self.z, self.surfaces, self.blocks, self.used, self.rows)
        chosen = [None if array is None else np.asarray(array)[kept] for array in more]
        return Dips(self.positions[kept], self.gradients[kept], *chosen)

    @property
    def in_use(self) -> np.ndarray:
        """(D,) bool: which are not switched off."""
        return _in_use(self)

    def row(self, number: int) -> int:
        """The row that one of them comes from."""
        return _row(self, number)

    def used_only(self) -> Dips | None:
        """Those that are not switched off; None where there are none."""
        dips = self if self.used is None else replace(self.some(self.in_use), used=None)
        return dips if len(dips) else None

    @classmethod
    def from_angles(
        cls, positions: ArrayLike, dip: ArrayLike, dip_direction: ArrayLike, **columns: Any
    ) -> Dips:
        """Dips from measured angles. positions: (D, 2) x, y or (D, 3) x, y, z, model units. dip: (D,) degrees
        below the horizontal, less than 90. dip_direction: (D,) degrees clockwise from north (+y). One number
        counts for all. columns: surfaces, blocks or used. Raises InputRefused where one is vertical.

        >>> Dips.from_angles([[0, 0], [5, 0]], dip=45, dip_direction=[90, 270]).gradients.round(9)
        array([[-1.,  0.],
               [ 1.,  0.]])
        """
        places = np.asarray(positions, np.float64)
        dips, directions, _ = np.broadcast_arrays(dip, dip_direction, np.empty(len(places)))
        steep = np.flatnonzero(~((dips >= 0) & (dips < 90)))
        if len(steep):
            raise InputRefused(
                f"dip {steep[0]} is {dips[steep[0]]:g} degrees; a sheet has one elevation at each position",
                item="dips",
                advice="use SpaceDips in a series whose kind is field",
            )
        rows = zip(dips.tolist(), directions.tolist(), strict=True)
        gradients = np.array([gradient_of(*row) for row in rows]).reshape(-1, 2)
        z = places[:, 2] if places.shape[1:] == (3,) else None
        return cls(places[:, :2], gradients, z, **columns)

    @property
    def heights(self) -> np.ndarray:
        """(D,) float64 the heights of the positions, NaN where they are not known."""
        return np.full(len(self), np.nan) if self.z is None else self.z

    @property
    def named(self) -> tuple[np.ndarray, np.ndarray]:
        """(D,) texts twice: the surface and the block that each is of, "" for none."""
        none = np.full(len(self), "", str)
        return (
            none if self.surfaces is None else self.surfaces,
            none if self.blocks is None else self.blocks,
        )

    @classmethod
    def joined(cls, parts: Sequence[Dips]) -> Dips:
        """Several, `parts`, one after another."""
        positions, gradients = (
            np.concatenate([np.empty((0, 2)), *(getattr(part, key) for part in parts)])
            for key in ("positions", "gradients")
        )
        z = np.concatenate([np.empty(0), *(part.heights for part in parts)])
        used = np.concatenate([np.empty(0, bool), *(part.in_use for part in parts)])
        in_use = None if used.all() else used
        names = [
            np.concatenate([np.empty(0, str), *rows]) for rows in zip(*(p.named for p in parts), strict=True)
        ]
        if not names or not any((array != "").any() for array in names):
            return cls(positions, gradients, z, used=in_use)
        surfaces, blocks = names
        return cls(positions, gradients, z, surfaces, blocks, in_use)

    def checked(self) -> Dips:
        """The same as arrays of float64, in the order of their places and values: the order of rows must not
        decide a result. Raises InputRefused."""
        positions, gradients = (
            _floats(values, (len(self.positions), 2), f"{name} of dips")
            for name, values in (("positions", self.positions), ("gradients", self.gradients))
        )
        z = None if self.z is None else _floats(self.z, (len(positions),), "z of dips")
        bad = np.flatnonzero(~np.isfinite(np.column_stack([positions, gradients])).all(axis=1))
        if len(bad):
            raise InputRefused(f"dip {bad[0]} is not finite", item="dips")
        surfaces, blocks = (
            None if names is None else _texts(names, len(positions), f"{what} of dips")
            for what, names in (("surfaces", self.surfaces), ("blocks", self.blocks))
        )
        used = _checked_use(self.used, len(positions))
        rows = np.arange(len(positions)) if self.rows is None else self.rows
        more = [array for array in (z, surfaces, blocks, used) if array is not None]
        order = ascending(*positions.T, *gradients.T, *more)
        return Dips(positions, gradients, z, surfaces, blocks, used, rows).some(order)

    def merged(self) -> tuple[Dips, str | None]:
        """One dip at each position, the mean of those there, and a warning where they differ."""
        places, place = np.unique(self.positions + 0.0, axis=0, return_inverse=True)
        if len(places) == len(self):
            return self, None
        place = place.reshape(-1)
        first = np.full(len(places), len(self))
        np.minimum.at(first, place, np.arange(len(self)))
        count = np.bincount(place)
        means = np.column_stack([np.bincount(place, weights=axis) / count for axis in self.gradients.T])
        apart = np.abs(self.gradients - means[place]).max(axis=1)
        differ = np.unique(place[apart > 1e-12 * (1 + np.abs(means[place]).max(axis=1))])
        order = np.argsort(first)
        dips = self.some(first[order])
        dips = Dips(dips.positions, np.ascontiguousarray(means[order]), dips.z)
        if not len(differ):
            return dips, None
        where = place_text(tuple(places[differ[0]].tolist()))
        many = "1 position has" if len(differ) == 1 else f"{len(differ)} positions have"
        return dips, f"{many} several dips, one at {where}: their mean slope is used"


SomeDips = TypeVar("SomeDips", bound=SpaceDips | Dips)


def as_given(dips: SomeDips) -> SomeDips:
    """The same in the order of the table or the arrays that they come from."""
    if dips.rows is None:
        return dips
    order = np.argsort(dips.rows)
    arrays = {attribute.name: getattr(dips, attribute.name) for attribute in fields(dips)}
    ordered: dict[str, Any] = {
        name: None if a is None else np.asarray(a)[order] for name, a in arrays.items()
    }
    return replace(dips, **{**ordered, "rows": None})


def dip_file_of(given: Dips | DipFile | str | Path | None) -> DipFile | None:
    """The file of dips and how it is read; None where they are arrays, or there are none."""
    if isinstance(given, (str, Path)):
        return DipFile(given)
    return given if isinstance(given, DipFile) else None


def _in_use(dips: Dips | SpaceDips) -> np.ndarray:
    return np.ones(len(dips), bool) if dips.used is None else np.asarray(dips.used, bool)


def _row(dips: Dips | SpaceDips, number: int) -> int:
    return number if dips.rows is None else int(dips.rows[number])


def _checked_use(used: Any, count: int) -> np.ndarray | None:
    array = None if used is None else np.ascontiguousarray(used, bool)
    if array is not None and array.shape != (count,):
        raise InputRefused(f"{count} dips have {array.size} of 'used'", item="dips")
    return array


def _floats(values: ArrayLike, shape: tuple[int, ...], name: str) -> np.ndarray:
    try:
        array = np.ascontiguousarray(values, np.float64)
    except (TypeError, ValueError) as error:
        raise InputRefused("not an array of numbers", item=name) from error
    if array.shape != shape:
        raise InputRefused(f"must be an array {shape}, not {array.shape}", item=name)
    return array


def _texts(names: Any, count: int, name: str) -> np.ndarray:
    array = np.asarray(names, str)
    if array.shape != (count,):
        raise InputRefused(f"must be {count} names, one for each dip, not {array.shape}", item=name)
    return array
