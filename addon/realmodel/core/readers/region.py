# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions from GeoJSON (RFC 7946): the rings of its polygons, outlines and holes alike."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from ..errors import InputRefused
from ..finite import is_finite

_LINES_AND_POINTS = ("Point", "MultiPoint", "LineString", "MultiLineString")


def read_region(file: str | Path) -> tuple[list[np.ndarray], list[str]]:
    """The rings (N, 2) float64 of all polygons of a GeoJSON file, not repeated at their end; they count
    even-odd. Points and lines have no area: they are left out, and the second result says so.

    Raises InputRefused naming the file and the line, or the feature.
    """
    file = Path(file)
    try:
        text = file.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise InputRefused(f"cannot be read: {error.strerror}", file=file, advice="check the path") from error
    except UnicodeDecodeError as error:
        raise InputRefused("not UTF-8 text", file=file, advice="save it as UTF-8") from error
    try:
        content = json.loads(text, parse_constant=_refuse_constant)
    except json.JSONDecodeError as error:
        raise InputRefused(f"not valid JSON: {error.msg}", file=file, line=error.lineno) from error
    except _NotANumber as error:
        line = text[: text.find(str(error))].count("\n") + 1
        raise InputRefused(f"{error} is not a finite number", file=file, line=line) from error
    except (RecursionError, ValueError) as error:
        what = "lists nested too deep" if isinstance(error, RecursionError) else "a number of too many digits"
        raise InputRefused(f"not a file to be read: {what}", file=file) from error
    walk = _Walk(file)
    walk.node(content, "")
    if not walk.rings:
        raise InputRefused(
            "there is no polygon in it", file=file, advice="a region needs Polygon or MultiPolygon"
        )
    return walk.rings, walk.left_out


class _NotANumber(ValueError):
    pass


def _refuse_constant(name: str):
    raise _NotANumber(name)


class _Walk:
    def __init__(self, file: Path):
        self.file = file
        self.rings: list[np.ndarray] = []
        self.left_out: list[str] = []

    def refuse(self, what: str, item: str) -> InputRefused:
        return InputRefused(what, file=self.file, item=item or None)

    def node(self, node, item: str) -> None:
        kind = node.get("type") if isinstance(node, dict) else None
        if kind == "FeatureCollection":
            for number, feature in enumerate(self.members(node, "features", item), 1):
                self.node(feature, f"feature {number}")
        elif kind == "Feature":
            if "geometry" not in node:
                raise self.refuse("a Feature has no geometry", item)
            if node["geometry"] is not None:
                self.node(node["geometry"], item)
        elif kind == "GeometryCollection":
            for number, part in enumerate(self.members(node, "geometries", item), 1):
                self.node(part, f"{item}, geometry {number}" if item else f"geometry {number}")
        elif kind == "Polygon":
            self.polygon(self.members(node, "coordinates", item), item)
        elif kind == "MultiPolygon":
            for polygon in self.members(node, "coordinates", item):
                self.polygon(polygon, item)
        elif kind in _LINES_AND_POINTS:
            self.left_out.append(f"{self.file}: {item or 'it'} is a {kind}, which bounds no area: left out")
        else:
            raise self.refuse(f"not GeoJSON: an object of type {kind!r}", item)

    def members(self, node: dict, key: str, item: str) -> list:
        members = node.get(key)
        if not isinstance(members, list):
            raise self.refuse(f"not GeoJSON: {node['type']} without a list '{key}'", item)
        return members

    def polygon(self, rings, item: str) -> None:
        if not isinstance(rings, list):
            raise self.refuse("the coordinates of a Polygon must be a list of rings", item)
        for number, ring in enumerate(rings, 1):
            where = f"{item}, ring {number}" if item else f"ring {number}"
            if not isinstance(ring, list) or len(ring) < 3:
                raise self.refuse("a ring needs at least 3 corners", where)
            corners = np.array([self.position(p, where, i) for i, p in enumerate(ring, 1)], np.float64)
            closed = (corners[0] == corners[-1]).all()  # as the format asks; many writers forget it
            self.rings.append(corners[:-1] if closed else corners)

    def position(self, position, item: str, number: int) -> tuple[float, float]:
        plain = isinstance(position, list) and len(position) >= 2
        if not plain or not all(_is_number(coordinate) for coordinate in position[:2]):
            raise self.refuse(f"position {number} is not [x, y]: {position!r:.40}", item)
        if not all(is_finite(coordinate) for coordinate in position[:2]):
            raise self.refuse(f"position {number} is not finite", item)
        return float(position[0]), float(position[1])


def _is_number(value) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
