# SPDX-License-Identifier: GPL-3.0-or-later
"""The ages of the units of a geological map: columns of ages, dips, and heights on the ground."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..base.errors import InputRefused
from ..readers import UnitNames
from ..readers.map_input import read_shapes
from ..readers.maps.shapes import Heights
from ..readers.tables.dips import dip_warnings, read_dips_of_rock
from ..readers.tables.hole_tables import normalized_name
from ..readers.tables.table_layout import names_shown
from ..readers.unit_polygons import UnitPolygon, read_unit_polygons
from ..settings.data_files import MapFile
from ..settings.dips import DipFile
from ..surfaces.observed.polygon_borders import inside
from .order import Evidence

_GRID = 160  # places across a map
_FAR = 0.1  # of the width of the map: farther along its dip a bed is not followed
_STEPS = 25  # in which it is followed
_NEAR = 5  # steps to the next unit at which the weight of a dip is half
_LEVEL = 3.0  # degrees: flatter beds say nothing of what lies beneath another
_BY_AGE, _BY_HEIGHT = 1000.0, 0.2  # weights; that of a dip is 1
_MANY = 3  # older units beneath one: it lies across them
_SHORT = 0.02  # of the border of a unit: shorter contacts are no sign of this
_UNIT_COLUMNS = (
    *("block", "unit", "formation", "unitname", "unit_name", "code", "geology", "geol", "lithology"),
    *("lith", "rock", "strat", "stratigraphy", "symbol", "map_symbol", "mapunit", "name", "label"),
)
_AGE_COLUMNS = (
    *("age", "age_ma", "max_age", "max_age_ma", "min_age", "min_age_ma", "mean_age", "age_max", "age_min"),
    *("base_age", "top_age", "b_age", "t_age", "b_int_age", "t_int_age", "chronostrat", "period", "era"),
)
_AGES = (  # oldest first; what a name begins with
    *("archean", "archaean", "proterozoic", "precambrian", "cambrian", "ordovician", "silurian", "devonian"),
    *("carboniferous", "mississippian", "pennsylvanian", "permian", "triassic", "jurassic", "cretaceous"),
    *("paleogene", "paleocene", "eocene", "oligocene", "neogene", "tertiary", "miocene", "pliocene"),
    *("quaternary", "pleistocene", "holocene", "recent"),
)


@dataclass
class MapUnits:
    """evidence: of the ages of its units. touches: (U, U) the share of the border of the unit of the row that
    is with that of the column, in the order of the evidence. box: (2, 2) corners in plan. ground: heights.
    has_ages: whether the map has the ages of units. warnings: sentences."""

    polygons: list[UnitPolygon]
    evidence: Evidence
    touches: np.ndarray
    box: np.ndarray
    ground: np.ndarray
    has_ages: bool = False
    warnings: list[str] = field(default_factory=list)


def map_file_of(given: Any) -> MapFile:
    """The map with the attribute that names its units. Raises InputRefused where it is not clear which."""
    if isinstance(given, MapFile):
        return given
    keys = dict(given) if isinstance(given, Mapping) else {"file": given}
    if "block" in keys:
        return MapFile(**keys)
    map_file = MapFile(**keys, block="?")
    shapes = read_shapes(map_file.polygons, heights=Heights(with_attributes=True))
    attributes = shapes.attributes or {}
    names = list(dict.fromkeys(str(name) for entry in attributes.values() for name in entry))
    by_name = {normalized_name(name): name for name in names}
    known = next((by_name[name] for name in _UNIT_COLUMNS if name in by_name), None)
    texts = [name for name in names if any(isinstance(e.get(name), str) for e in attributes.values())]
    if known is None and len(texts) == 1:
        known = texts[0]
    if known is None:
        raise InputRefused(
            f"it is not clear which attribute names its units; there are {names_shown(names) or 'none'}",
            file=map_file.file,
            advice='name it by the key `block`: map = {file = "...", block = "UNIT"}, or --map-block UNIT',
        )
    return replace(map_file, block=known)


def read_map_units(
    map_file: MapFile,
    dips: DipFile | None,
    heights: Callable[[np.ndarray], np.ndarray] | None,
    units: str,
    meanings: Mapping[str, str],
) -> MapUnits:
    """The units of a map and the evidence of their order. heights: of the ground at places (N, 2). meanings:
    as `names` of UnitNames."""
    polygons, _, warnings = read_unit_polygons(map_file, units)
    known = UnitNames(names=meanings)
    polygons = [
        replace(polygon, unit=known.meaning(polygon.unit))
        for polygon in polygons
        if not known.says_nothing(polygon.unit)
    ]
    if not polygons:
        raise InputRefused(f"no feature has a unit in '{map_file.block}'", file=map_file.file)
    names = sorted({polygon.unit for polygon in polygons})
    corners = np.vstack([ring for polygon in polygons for ring in polygon.rings])
    box = np.array([corners.min(axis=0), corners.max(axis=0)])
    grid = _grid(polygons, names, box)
    touches = _touches(grid, len(names))
    evidence = Evidence(names, np.zeros((len(names), len(names))), (touches > 0).astype(float))
    ground = np.zeros(0) if heights is None else heights(_places(box))
    found = MapUnits(polygons, evidence, touches, box, ground[np.isfinite(ground)], warnings=warnings)
    _add_ages(found, map_file)
    if dips is not None:
        of_dips = UnitNames(names, names, names=meanings)
        _add_dips(found, dips, of_dips, units)
    if heights is not None:
        _add_heights(found, grid.ravel(), ground)
    return found


def _places(box: np.ndarray) -> np.ndarray:
    """(N, 2) the places of a grid over a box."""
    x, y = (low + (np.arange(_GRID) + 0.5) / _GRID * (high - low) for low, high in box.T)
    return np.column_stack([np.tile(x, _GRID), np.repeat(y, _GRID)])


def _units_at(polygons: Sequence[UnitPolygon], names: Sequence[str], plan: np.ndarray) -> np.ndarray:
    """(N,) the numbers of the units at places (N, 2), -1 where there is none."""
    units = np.full(len(plan), -1)
    for polygon in polygons:
        units[inside(polygon.rings, plan)] = names.index(polygon.unit)
    return units


def _grid(polygons: Sequence[UnitPolygon], names: Sequence[str], box: np.ndarray) -> np.ndarray:
    return _units_at(polygons, names, _places(box)).reshape(_GRID, _GRID)


def _touches(grid: np.ndarray, count: int) -> np.ndarray:
    borders = np.zeros((count, count))
    for one, other in ((grid[:, 1:], grid[:, :-1]), (grid[1:], grid[:-1])):
        differ = (one != other) & (one >= 0) & (other >= 0)
        np.add.at(borders, (one[differ], other[differ]), 1)
        np.add.at(borders, (other[differ], one[differ]), 1)
    return borders / np.maximum(borders.sum(axis=1, keepdims=True), 1)


def _add_ages(found: MapUnits, map_file: MapFile) -> None:
    """From a column of ages: numbers, more being older, or names of periods."""
    shapes = read_shapes(map_file.polygons, heights=Heights(with_attributes=True))
    attributes = shapes.attributes or {}
    ages: dict[str, list[float]] = {}
    for polygon in found.polygons:
        entry = attributes.get(polygon.item, {})
        by_name = {normalized_name(str(name)): name for name in entry}
        for name in _AGE_COLUMNS:
            age = None if name not in by_name else _age(entry[by_name[name]])
            if age is not None:
                ages.setdefault(polygon.unit, []).append(age)
    means = {unit: float(np.mean(values)) for unit, values in ages.items()}
    for upper, young in means.items():
        for lower, old in means.items():
            if young < old:
                found.evidence.plus(upper, lower, _BY_AGE)
    found.has_ages = bool(means)


def _age(value: Any) -> float | None:
    """More is older."""
    try:
        return float(value)
    except (TypeError, ValueError):
        text = str(value).casefold()
    numbers = [number for number, name in enumerate(_AGES) if re.search(rf"\b\w*{name}", text)]
    return None if not numbers else 1e4 - float(np.mean(numbers))


def _add_dips(found: MapUnits, dips: DipFile, known: UnitNames, units: str) -> None:
    """A bed that dips beneath the next unit is older than that."""
    names = list(found.evidence.names)
    measured, _ = read_dips_of_rock(dips, known, units)
    found.warnings += dip_warnings(dips, units)
    far = _FAR * float(np.ptp(found.box, axis=0).max())
    steepness = np.hypot(*measured.gradients.T)
    used = measured.in_use & (steepness > np.tan(np.radians(_LEVEL)))
    for place, gradient, steep in zip(
        measured.positions[used], measured.gradients[used], steepness[used], strict=True
    ):
        downward = -gradient / steep
        for sign in (1.0, -1.0):
            way = place + sign * np.linspace(0, far, _STEPS + 1)[:, None] * downward
            beds = _units_at(found.polygons, names, way)
            others = np.flatnonzero((beds != beds[0]) & (beds >= 0))
            if beds[0] < 0 or not len(others):
                continue
            here, other = names[beds[0]], names[beds[others[0]]]
            upper, lower = (other, here) if sign > 0 else (here, other)
            found.evidence.plus(upper, lower, 1.0 / (1.0 + others[0] / _NEAR))


def _add_heights(found: MapUnits, units: np.ndarray, ground: np.ndarray) -> None:
    """Higher units are younger, if there is no other evidence."""
    evidence = found.evidence
    for a in range(len(evidence.names)):
        for b in range(len(evidence.names)):
            if a == b or not evidence.adjacent[a, b] or evidence.over[a, b] or evidence.over[b, a]:
                continue
            rise = np.nanmean(ground[units == a]) - np.nanmean(ground[units == b])
            if rise > 0:
                evidence.over[a, b] += _BY_HEIGHT
                evidence.over[b, a] = 0.0


def unconformities(found: MapUnits, order: Sequence[str]) -> dict[str, list[str]]:
    """The units that lie on several older ones on the map, each with these."""
    across: dict[str, list[str]] = {}
    names = list(found.evidence.names)
    for unit in order:
        if unit in names:
            shares = found.touches[names.index(unit)]
            below = order[: order.index(unit)]
            older = [name for name in below if name in names and shares[names.index(name)] > _SHORT]
            if len(older) >= _MANY:
                across[unit] = older
    return across
