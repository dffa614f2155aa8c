# SPDX-License-Identifier: GPL-3.0-or-later
"""A project from what users of GemPy have: points, orientations, and a stack of groups."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...base.errors import InputRefused, number_list
from ...base.table import Table
from ...settings.dips import SpaceDips
from ..project import Project
from .peer_groups import ERODE, FAULT, ONLAP, Box, GroupSettings, PeerGroup, PeerSurface, project_of_groups
from .peer_table import ANGLES, VECTORS, XYZ, normals_of, positions_of, read_peer_table

_NAME = {"surface": ("surface", "formation", "surfaces", "formations", "name")}
_RELATIONS = (ERODE, ONLAP, FAULT)


def from_gempy(
    points: Any,
    orientations: Any,
    *,
    stack: Mapping[str, str | Sequence[str]],
    extent: Sequence[float],
    faults: Sequence[str] = (),
    relations: Mapping[str, str] | None = None,
    settings: GroupSettings | None = None,
    name: str = "model",
) -> Project:
    """The project of a GemPy model, with the arguments that this has.

    points: a CSV file or a data frame with X, Y, Z and formation (or surface). orientations: the same with
    azimuth, dip and polarity, or with G_x, G_y, G_z; each counts for the group of its surface, or the group
    that it names; None: there are none. stack: the surfaces of each group, both youngest first; a surface is
    the base of the unit of its name. extent: x0, x1, y0, y1, z0, z1 of the box, which is filled to its top.
    faults: names of groups that are faults; they displace the groups after them. relations: of groups, to
    what is older: "erode" (default), "onlap" or "fault". settings: of groups, the keys of their series, and
    `tie` of their surfaces: {"Strat_Series": {"error": 5.0, "range": 2000.0, "tie": False}} smooths as a
    nugget effect does. name: of the project. A surface without points is
    the basement, if it is the last one. Rows may be in any order.

    Raises InputRefused for what cannot be read or does not fit together.

    >>> data = {"X": [0, 9, 0, 9], "Y": [0, 9, 9, 0], "Z": [4, 4, 4, 4], "surface": ["sand"] * 4}
    >>> project = from_gempy(data, None, stack={"beds": ["sand"]}, extent=(0, 9, 0, 9, 0, 9))
    >>> project.rocks[0].block_names()
    ['basement', 'sand']
    """
    members = {
        group: [surfaces] if isinstance(surfaces, str) else list(surfaces)
        for group, surfaces in stack.items()
    }
    kinds = _relations(members, faults, relations or {})
    group_of = _groups_of(members)
    of_points = read_peer_table(points, {**XYZ, **_NAME}, ("surface",), "points")
    places = positions_of(of_points, "points")
    names = _names(of_points, "points")
    unknown = sorted(set(names.tolist()) - group_of.keys())
    if unknown:
        raise InputRefused(
            f"the points are also of {number_list(map(repr, unknown))}, in no group of the stack",
            advice="add the surface to a group, or leave its rows out",
        )
    dips = _dips(orientations, members, group_of)
    with_points = {surface for surface in group_of if (names == surface).any()}
    basement = _basement(members, kinds, with_points)
    groups = [
        PeerGroup(
            group,
            [PeerSurface(surface, places[names == surface]) for surface in surfaces if surface != basement],
            dips[group],
            kinds[group],
        )
        for group, surfaces in members.items()
        if surfaces != [basement]
    ]
    box = np.asarray(extent, np.float64).reshape(-1)
    if box.shape != (6,):
        raise InputRefused(f"'extent' must be six numbers, not {len(box)}", advice="x0, x1, y0, y1, z0, z1")
    return project_of_groups(groups, Box(box[0::2], box[1::2]), name, basement, settings)


def _relations(
    members: Mapping[str, Sequence[str]], faults: Sequence[str], relations: Mapping[str, str]
) -> dict[str, str]:
    faults = [faults] if isinstance(faults, str) else faults
    asked = {**relations, **dict.fromkeys(faults, FAULT)}
    kinds = dict.fromkeys(members, ERODE)
    for group, relation in asked.items():
        word = str(getattr(relation, "name", relation)).lower()
        if group not in kinds:
            advice = f"there are {number_list(map(repr, kinds))}"
            raise InputRefused(f"the stack has no group '{group}'", advice=advice)
        if word not in _RELATIONS:
            what = f"unknown relation {word!r} of group '{group}'"
            raise InputRefused(what, advice=f"there are {', '.join(_RELATIONS)}")
        kinds[group] = word
    return kinds


def _groups_of(members: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """The group of each surface."""
    group_of: dict[str, str] = {}
    for group, surfaces in members.items():
        for surface in surfaces:
            if surface in group_of:
                raise InputRefused(f"the stack has surface '{surface}' twice", advice="list it once")
            group_of[surface] = group
    return group_of


def _names(table: Table, label: str) -> np.ndarray:
    if "surface" not in table:
        raise InputRefused(f"{label} have no column formation or surface", advice="name the column surface")
    return table["surface"]


def _dips(orientations: Any, members: Mapping, group_of: Mapping[str, str]) -> dict[str, SpaceDips]:
    """The orientations of each group."""
    if orientations is None:
        return {group: SpaceDips(np.empty((0, 3)), np.empty((0, 3))) for group in members}
    table = read_peer_table(orientations, {**XYZ, **_NAME, **ANGLES, **VECTORS}, ("surface",), "orientations")
    places, normals = positions_of(table, "orientations"), normals_of(table)
    bad = np.flatnonzero(np.isnan(normals).any(axis=1))
    if len(bad):
        what = f"row {bad[0]} of orientations has no azimuth and dip, and no G_x, G_y and G_z"
        raise InputRefused(what, advice="fill them in, or leave the row out")
    names = _names(table, "orientations").tolist()
    unknown = sorted({name for name in names if name not in group_of and name not in members})
    if unknown:
        what = f"the orientations are also of {number_list(map(repr, unknown))}, not in the stack"
        raise InputRefused(what, advice="add it to a group, or leave its rows out")
    groups = np.array([group_of.get(name, name) for name in names], str)
    return {group: SpaceDips(places[groups == group], normals[groups == group]) for group in members}


def _basement(members: Mapping, kinds: Mapping[str, str], with_points: set[str]) -> str | None:
    """The last surface, if it has no points. Refuses others without."""
    listed = [surface for surfaces in members.values() for surface in surfaces]
    last = listed[-1] if listed and kinds[list(members)[-1]] != FAULT else None
    for surface in listed:
        if surface not in with_points and surface != last:
            raise InputRefused(f"surface '{surface}' of the stack has no points", advice="leave it out")
    return None if last in with_points else last
