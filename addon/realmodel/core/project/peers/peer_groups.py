# SPDX-License-Identifier: GPL-3.0-or-later
"""A project of groups of surfaces in a box, as GemPy and LoopStructural have them.

A surface there is the base of the unit of its name, and the box is filled: the youngest unit reaches to its
top, below the oldest surface is the basement. Each group of conformable surfaces is a series of level sets.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...base.algebra import dot, norm
from ...base.errors import InputRefused, number_list
from ...settings.dips import SpaceDips
from ..project import Project, Rock, Surface
from ..project_checks import check_project
from ..series import SERIES, Series
from ..structure_entries import Fault

ERODE, ONLAP, FAULT = "erode", "onlap", "fault"
_RULES = {ERODE: "erosional", ONLAP: "conformable"}
_LOOKED_AT = 200  # points of a surface that are compared with those of another
_BASEMENT, _TOP, _ROCK = "basement", "top", "rock"
_TIE = "tie"  # of surfaces


@dataclass(frozen=True)
class PeerSurface:
    """A surface, the base of the unit of its name. points: (P, 3)."""

    name: str
    points: np.ndarray


@dataclass(frozen=True)
class PeerGroup:
    """Conformable surfaces, the youngest first, or faults. relation: to what is older. dips: of all of
    them."""

    name: str
    surfaces: Sequence[PeerSurface]
    dips: SpaceDips
    relation: str = ERODE


@dataclass(frozen=True)
class Box:
    """The corners (3,) of a model. Raises InputRefused where it has no volume."""

    low: np.ndarray
    high: np.ndarray
    what: str = field(default="extent")

    def __post_init__(self) -> None:
        if self.low.shape != (3,) or self.high.shape != (3,) or not (self.low < self.high).all():
            raise InputRefused(f"'{self.what}' must be a box: the lower corner below the upper one")

    @property
    def corners(self) -> np.ndarray:
        """(4, 2) in plan, counter-clockwise."""
        (x0, y0), (x1, y1) = self.low[:2], self.high[:2]
        return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


GroupSettings = Mapping[str, Mapping[str, Any]]  # of groups by their names: keys of series, and `tie`


def project_of_groups(
    groups: Sequence[PeerGroup], box: Box, name: str, basement: str | None, settings: GroupSettings | None
) -> Project:
    """The project of groups, the youngest first. basement: the name of what is below the oldest surface, if
    it has one. Raises InputRefused."""
    groups = list(map(_by_age, groups))
    beds = [group for group in groups if group.relation != FAULT]
    settings = settings or {}
    _check_settings(settings, [group.name for group in beds])
    youngest_first = [surface for group in beds for surface in group.surfaces]
    if not youngest_first:
        raise InputRefused("there are no surfaces with points besides faults")
    units = [surface.name for surface in youngest_first]
    below = basement or (_BASEMENT if _BASEMENT not in units else f"below {units[-1]}")
    blocks = [*units[1:], below]
    surfaces = [
        Surface(
            surface.name,
            points=surface.points,
            series=group.name,
            rule=_RULES[group.relation],
            block=block,
            tie=settings.get(group.name, {}).get(_TIE, True),
        )
        for (group, surface), block in zip(
            ((group, surface) for group in beds for surface in group.surfaces), blocks, strict=True
        )
    ][::-1]
    top_name = _TOP if _TOP not in units else f"{_TOP} of the box"
    top = np.column_stack([box.corners, np.full(4, box.high[2])])
    triangles = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
    surfaces.append(Surface(top_name, vertices=top, triangles=triangles, block=units[0]))
    series = [
        Series(
            group.name,
            dips=group.dips if len(group.dips) else None,
            **{key: value for key, value in settings.get(group.name, {}).items() if key != _TIE},
        )
        for group in beds
    ][::-1]
    rock = Rock(_ROCK, surfaces, region=box.corners, base_elevation=float(box.low[2]), series=series)
    project = Project(name, [rock], faults=_faults(groups, box))
    check_project(project)
    return project


def _check_settings(settings: GroupSettings, groups: Sequence[str]) -> None:
    keys = [key for key in SERIES if key not in ("name", "kind", "dips")] + [_TIE]
    for group, given in settings.items():
        if group not in groups:
            advice = f"there are {number_list(map(repr, groups))}"
            raise InputRefused(f"'settings' are of '{group}', which is no group of surfaces", advice=advice)
        if unknown := [key for key in given if key not in keys]:
            advice = f"there are {', '.join(keys)}"
            raise InputRefused(f"group '{group}' has no setting '{unknown[0]}'", advice=advice)


def _by_age(group: PeerGroup) -> PeerGroup:
    """A group with its surfaces as points and dips say, the youngest first, as GemPy sorts them by their
    values; with a warning where they are listed otherwise."""
    surfaces, dips = group.surfaces, group.dips
    if group.relation == FAULT or len(surfaces) < 2 or not len(dips):
        return group
    ranks = [
        sum(_above(one.points, other.points, dips) for other in surfaces if other is not one)
        for one in surfaces
    ]
    order = sorted(range(len(surfaces)), key=lambda number: -ranks[number])
    if order == list(range(len(surfaces))):
        return group
    by_age = [surfaces[number] for number in order]
    names = number_list(repr(surface.name) for surface in by_age)
    text = f"group '{group.name}': by its points and dips the order is {names}, youngest first; it is used"
    warnings.warn(f"{text}, not that of the list", stacklevel=4)
    return replace(group, surfaces=by_age)


def _above(points: np.ndarray, others: np.ndarray, dips: SpaceDips) -> float:
    """1 where points lie on the younger side of others, by the nearest dips; -1 on the older; 0 undecided."""
    points, others = (places[:: -(-len(places) // _LOOKED_AT)] for places in (points, others))
    apart = points[:, None] - others[None]
    away = apart[np.arange(len(points)), norm(apart).argmin(axis=1)]
    normals = dips.normals[norm(points[:, None] - dips.positions[None]).argmin(axis=1)]
    return float(np.sign(np.sign(dot(away, normals)).sum()))


def _faults(groups: Sequence[PeerGroup], box: Box) -> list[Fault]:
    """The faults, which go through the box and displace what is listed after them."""
    faults = []
    through = float(norm(box.high - box.low))
    for number, group in enumerate(groups):
        if group.relation != FAULT:
            continue
        older = next((later for later in groups[number:] if later.relation != FAULT), None)
        if older is None:
            what = f"group '{group.name}' of faults displaces nothing: no group of surfaces comes after it"
            raise InputRefused(what, advice="list it before the groups that it displaces")
        for surface in group.surfaces:
            faults.append(
                Fault(
                    surface.name,
                    points=surface.points,
                    dips=group.dips if len(group.dips) else None,
                    youngest=older.surfaces[0].name,
                    extend=through,
                )
            )
    return faults
