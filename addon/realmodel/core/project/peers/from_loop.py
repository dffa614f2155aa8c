# SPDX-License-Identifier: GPL-3.0-or-later
"""A project from what users of LoopStructural have: one table of all features, and a stratigraphic column."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...base.errors import InputRefused, number_list
from ...settings.dips import SpaceDips
from ..project import Project
from .peer_groups import ERODE, FAULT, Box, GroupSettings, PeerGroup, PeerSurface, project_of_groups
from .peer_table import ANGLES, VECTORS, XYZ, normals_of, positions_of, read_peer_table

_FEATURE = "feature_name"
_INTRUSION = "intrusion_contact_type"
_KNOWN = {
    **XYZ,
    **ANGLES,
    **VECTORS,
    _FEATURE: (_FEATURE,),
    "val": ("val",),
    "coord": ("coord",),
    _INTRUSION: (_INTRUSION,),
}

Group = str | Sequence[str]
Column = Sequence[Group] | Mapping[str, Mapping[str, Mapping]]


def from_loop(
    data: Any,
    column: Column,
    *,
    bounds: ArrayLike,
    faults: Sequence[str] = (),
    settings: GroupSettings | None = None,
    name: str = "model",
) -> Project:
    """The project of a LoopStructural model.

    data: a CSV file or a data frame with feature_name, X, Y, Z, val (and coord, of faults), and nx, ny, nz or
    gx, gy, gz, or strike and dip. column: groups of conformable units, both youngest first; a unit is a
    feature of the data, whose points with a value are its base: of one value, or of several, of which the
    greater ones are younger and make units named after the feature and the value. Where no unit of a group is
    a feature, they are those of the one feature that is left, by its values. Or column is that of
    LoopStructural, {"strati": {"sand": {"min": 0, "max": 60}, ...}, ...}. Each group erodes what is older;
    the last unit of all may be without data: the basement. faults: features whose surface is where coordinate
    0 is 0; they displace all groups. bounds: the lower and the upper corner of the box, which is filled to
    its top. settings: of groups, as of from_gempy. name: of the project. Features that are not named are not
    used.

    Raises InputRefused for what cannot be read or does not fit together, and for intrusions.

    >>> data = {"X": [0, 9, 0, 9], "Y": [0, 9, 9, 0], "Z": [4, 4, 4, 4], "val": [0] * 4}
    >>> data["feature_name"] = ["sand"] * 4
    >>> from_loop(data, [["sand"]], bounds=((0, 0, 0), (9, 9, 9))).rocks[0].block_names()
    ['basement', 'sand']
    """
    features = _Features.read(data)
    faults = [faults] if isinstance(faults, str) else list(faults)
    if isinstance(column, Mapping):
        groups, basement = _of_ranges(features, column)
    else:
        groups, basement = _of_names(features, column, faults)
    of_faults = [_fault(features, fault) for fault in faults]
    box = np.asarray(bounds, np.float64)
    if box.shape != (2, 3):
        raise InputRefused("'bounds' must be two corners of three numbers")
    return project_of_groups([*of_faults, *groups], Box(box[0], box[1], "bounds"), name, basement, settings)


@dataclass(frozen=True)
class _Features:
    """The rows of data: places and normals (N, 3), NaN where a row has none, values and coordinates (N,), the
    names of features, and which rows are of intrusions."""

    places: np.ndarray
    normals: np.ndarray
    values: np.ndarray
    coordinates: np.ndarray
    names: np.ndarray
    intrusions: np.ndarray

    @classmethod
    def read(cls, data: Any) -> _Features:
        table = read_peer_table(data, _KNOWN, (_FEATURE, _INTRUSION), "data")
        if _FEATURE not in table:
            raise InputRefused(f"data have no column {_FEATURE}", advice=f"name the column {_FEATURE}")
        unknown = np.full(len(table), np.nan)
        coordinates = np.nan_to_num(table.get("coord", unknown))
        is_intrusion = table[_INTRUSION] != "" if _INTRUSION in table else np.zeros(len(table), bool)
        places = positions_of(table, "data")
        values = table.get("val", unknown)
        return cls(places, normals_of(table), values, coordinates, table[_FEATURE], is_intrusion)

    def has(self, name: str) -> bool:
        return bool((self.names == name).any())

    def rows(self, name: str) -> np.ndarray:
        """(N,) bool: those of a feature, of a fault those of its surface. Refuses an intrusion."""
        rows = self.names == name
        if not rows.any():
            there = number_list(map(repr, sorted(set(self.names.tolist()))))
            raise InputRefused(f"data have no feature '{name}'", advice=f"there are {there}")
        if (rows & self.intrusions).any():
            raise InputRefused(
                f"feature '{name}' is an intrusion, which is not made from data of LoopStructural",
                advice="leave it out, and add its closed surface as a Body",
            )
        return rows & (self.coordinates == 0)

    def levels(self, name: str) -> list[tuple[float, np.ndarray]]:
        """The values of a feature with their points (P, 3), the greatest first."""
        rows = self.rows(name) & np.isfinite(self.values)
        if not rows.any():
            what = f"feature '{name}' has no points with a value: it shows no surface"
            raise InputRefused(what, advice="give its points a val")
        values = np.unique(self.values[rows])[::-1]
        return [(float(value), self.places[rows & (self.values == value)]) for value in values]

    def dips(self, names: Sequence[str]) -> SpaceDips:
        rows = np.isin(self.names, names) & (self.coordinates == 0) & np.isfinite(self.normals[:, 0])
        return SpaceDips(self.places[rows], self.normals[rows])


def _fault(features: _Features, name: str) -> PeerGroup:
    """A fault through the points at value 0, or, where there are none, through those with a normal."""
    rows, dips = features.rows(name), features.dips([name])
    on_it = rows & (features.values == 0)
    points = features.places[on_it] if on_it.any() else dips.positions
    if not len(points):
        what = f"fault '{name}' has no points where its coordinate 0 is 0, and no normals"
        raise InputRefused(what, advice="give its points coord = 0 and val = 0")
    return PeerGroup(name, [PeerSurface(name, points)], dips, FAULT)


def _of_names(
    features: _Features, column: Sequence[Group], faults: Sequence[str]
) -> tuple[list[PeerGroup], str | None]:
    members = [[group] if isinstance(group, str) else list(group) for group in column]
    named = {name for group in members for name in group}
    left = sorted(set(features.names.tolist()) - named - {*faults, ""})
    groups, basement = [], None
    for number, units in enumerate(members, 1):
        levels = features.levels(left[0]) if len(left) == 1 and not any(map(features.has, units)) else None
        is_last = number == len(members)
        has_base = (
            [*map(features.has, units)] if levels is None else [n < len(levels) for n in range(len(units))]
        )
        if is_last and has_base and not has_base[-1]:
            *units, basement = units
        if levels is not None:
            groups.append(_of_levels(left.pop(), levels, units, features))
        elif units:
            surfaces = [surface for unit in units for surface in _of_feature(features, unit)]
            groups.append(PeerGroup(_name_of(units), surfaces, features.dips(units), ERODE))
    return groups, basement


def _name_of(units: Sequence[str]) -> str:
    return units[0] if len(units) == 1 else f"{units[0]} to {units[-1]}"


def _of_feature(features: _Features, name: str) -> list[PeerSurface]:
    levels = features.levels(name)
    if len(levels) == 1:
        return [PeerSurface(name, levels[0][1])]
    return [PeerSurface(f"{name} {value:g}", points) for value, points in levels]


def _of_levels(
    feature: str, levels: Sequence[tuple[float, np.ndarray]], units: Sequence[str], features: _Features
) -> PeerGroup:
    """Units that are the values of one feature, in their order."""
    if len(levels) != len(units):
        what = f"feature '{feature}' has {len(levels)} values for the {len(units)} units {_name_of(units)}"
        raise InputRefused(what, advice="each unit needs the value of its base")
    surfaces = [PeerSurface(unit, points) for unit, (_, points) in zip(units, levels, strict=True)]
    return PeerGroup(feature, surfaces, features.dips([feature]), ERODE)


def _of_ranges(
    features: _Features, column: Mapping[str, Mapping[str, Mapping]]
) -> tuple[list[PeerGroup], str | None]:
    """Groups of a column of LoopStructural: of each unit the values that it has."""
    groups: list[PeerGroup] = []
    basement = None
    names = [feature for feature in column if feature != "faults"]
    for feature in names:
        units = column[feature]
        lowest = {unit: float(entry.get("min", -np.inf)) for unit, entry in units.items()}
        points_of = dict(features.levels(feature))
        surfaces = []
        for unit in sorted(lowest, key=lambda unit: -lowest[unit]):
            value = next((v for v in points_of if np.isclose(v, lowest[unit])), None)
            if value is not None:
                surfaces.append(PeerSurface(unit, points_of[value]))
            elif lowest[unit] == -np.inf and feature == names[-1]:
                basement = unit
            else:
                values = number_list(f"{v:g}" for v in points_of)
                what = f"no points of '{feature}' have the value {lowest[unit]:g}, the base of '{unit}'"
                raise InputRefused(what, advice=f"they have {values}")
        if surfaces:
            groups.append(PeerGroup(feature, surfaces, features.dips([feature]), ERODE))
    return groups, basement
