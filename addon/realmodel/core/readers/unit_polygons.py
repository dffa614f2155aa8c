# SPDX-License-Identifier: GPL-3.0-or-later
"""Polygons of a geological map, each with the name of its unit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..base.algebra import begins_run
from ..base.errors import InputRefused, counted
from ..base.units import MODEL_UNIT
from ..settings.data_files import MapFile
from .map_input import read_shapes
from .maps.shapes import Heights, Shapes, of_name
from .tables.table_layout import names_shown


@dataclass(frozen=True, eq=False)
class UnitPolygon:
    """item: its name in messages, "feature 3". unit: the value of its attribute, "" for none. rings: (N, 2)
    float64 each, open, no corner repeated in a row. has_roles: as of a Polygon."""

    item: str
    unit: str
    rings: list[np.ndarray]
    has_roles: bool


def read_unit_polygons(
    given: MapFile, model_unit: str = MODEL_UNIT
) -> tuple[list[UnitPolygon], list[np.ndarray], list[str]]:
    """The polygons of a map, in the model's unit; the lines (N, 2) beside them, which are faults; and
    warnings about these, and about rings that bound no area. Raises InputRefused naming the file, and the
    feature where there is one."""
    shapes = read_shapes(given.polygons, model_unit, heights=Heights(with_attributes=True))
    if not shapes.polygons:
        advice = "a map needs polygons: Polygon or MultiPolygon"
        raise InputRefused("there is no polygon in it", file=given.file, advice=advice)
    units = _units(shapes, given)
    unit_polygons, warnings = [], []
    for polygon in shapes.polygons:
        feature = polygon.item.partition(",")[0]
        rings = [_corners(ring) for ring in polygon.rings]
        flat = [len(ring) < 3 for ring in rings]
        if any(flat):
            warnings.append(f"{given.file}, {polygon.item}: a ring with fewer than three corners is left out")
        sound_rings = [ring for ring, is_flat in zip(rings, flat, strict=True) if not is_flat]
        if sound_rings and not (flat[0] and polygon.has_roles):
            unit_polygons.append(UnitPolygon(feature, units[feature], sound_rings, polygon.has_roles))
    if not unit_polygons:
        raise InputRefused("no polygon in it has an area", file=given.file)
    lines = [line[:, :2] for _, line in shapes.lines]
    if lines:
        text = (
            f"{given.file}: {counted(len(lines), 'line')} beside its polygons: treated as faults, along which"
        )
        warnings.append(f"{text} no contact is seen; if they are something else, leave them out by 'where'")
    return unit_polygons, lines, warnings


def _corners(ring: np.ndarray) -> np.ndarray:
    plan = ring[:, :2] + 0.0  # no -0.0
    plan = plan[begins_run(plan)]
    plan = plan[:-1] if len(plan) > 1 and (plan[0] == plan[-1]).all() else plan
    return plan if len(np.unique(plan, axis=0)) > 2 else plan[:0]


def _units(shapes: Shapes, source: MapFile) -> dict[str, str]:
    """The attribute of each feature, by its name in messages."""
    if shapes.attributes is None:
        what = "well-known text has no attributes, so no unit is known"
        raise InputRefused(what, file=source.file, advice="save it as GeoJSON or a GeoPackage")
    units, names = {}, {}
    has_any = False
    for polygon in shapes.polygons:
        feature = polygon.item.partition(",")[0]
        attributes: Mapping = shapes.attributes.get(feature, {})
        names.update(dict.fromkeys(map(str, attributes)))
        key = of_name(source.block, attributes)
        has_any |= key is not None
        value = None if key is None else attributes[key]
        units[feature] = "" if value is None else str(value).strip()
    if not has_any:
        advice = f"they have {names_shown(list(names))}" if names else "they have no attributes"
        raise InputRefused(
            f"its features have no attribute '{source.block}'", file=source.file, advice=advice
        )
    return units
