# SPDX-License-Identifier: GPL-3.0-or-later
"""GeoJSON (RFC 7946): polygons, lines and points, and the properties by which features are chosen."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from ...base.algebra import is_number
from ...base.errors import InputRefused
from ...base.text import BOM, Step, no_step, read_bytes
from ...settings.data_files import MapLayer
from .shapes import Heights, Selection, Shapes

_RECORD_SEPARATOR = b"\x1e"  # begins each text of a GeoJSON text sequence (RFC 8142)
_BETWEEN = re.compile(r"[ \t\r\n\x1e]*")


def begins_as_geojson(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is JSON."""
    return head.removeprefix(BOM).lstrip()[:1] in (b"{", b"[", _RECORD_SEPARATOR)


def read_geojson(layer: MapLayer, _step: Step = no_step, heights: Heights | None = None) -> Shapes:
    """What a GeoJSON file holds; heights of positions are left out where they are not wanted.

    Raises InputRefused naming the file and the line, or the feature.
    """
    file = Path(layer.file)
    try:
        text = read_bytes(file).decode()
    except UnicodeDecodeError as error:
        raise InputRefused("not UTF-8 text", file=file, advice="save it as UTF-8") from error
    try:
        content = _parsed(text)
    except json.JSONDecodeError as error:
        raise InputRefused(f"not valid JSON: {error.msg}", file=file, line=error.lineno) from error
    except _NotANumberError as error:
        line = text[: text.find(str(error))].count("\n") + 1
        raise InputRefused(f"{error} is not a finite number", file=file, line=line) from error
    except (RecursionError, ValueError) as error:
        what = "lists nested too deep" if isinstance(error, RecursionError) else "a number of too many digits"
        raise InputRefused(f"cannot be read: {what}", file=file) from error
    walk = _Walk(file, layer.where, heights)
    walk.node(content, "")
    walk.selection.require_some()
    return walk.shapes


def _parsed(text: str) -> Any:
    """One JSON text; or several after each other, as one collection: one a line, or each behind a record
    separator (RFC 8142)."""
    decoder = json.JSONDecoder(parse_constant=_refuse_constant)
    members: list = []
    at = _after_blanks(text, 0)
    while at < len(text) or not members:
        member, at = decoder.raw_decode(text, at)
        members.append(member)
        at = _after_blanks(text, at)
    return members[0] if len(members) == 1 else {"type": "FeatureCollection", "features": members}


def _after_blanks(text: str, at: int) -> int:
    match = _BETWEEN.match(text, at)
    return match.end() if match else at


class _NotANumberError(ValueError):
    pass


def _refuse_constant(name: str) -> NoReturn:
    raise _NotANumberError(name)


class _Walk:
    def __init__(self, file: Path, where: Mapping, heights: Heights | None):
        self.file = file
        self.selection = Selection(file, where)
        self.shapes = Shapes.wanted(heights)
        self.attribute = heights.attribute if heights else None

    def refuse(self, what: str, item: str) -> InputRefused:
        return InputRefused(what, file=self.file, item=item or None)

    def node(self, node: Any, item: str) -> None:
        kind = node.get("type") if isinstance(node, dict) else None
        if kind == "FeatureCollection":
            for number, feature in enumerate(self.members(node, "features", item), 1):
                self.node(feature, f"feature {number}")
        elif kind == "Feature":
            if "geometry" not in node:
                raise self.refuse("a Feature has no geometry", item)
            properties = node.get("properties")
            properties = properties if isinstance(properties, dict) else {}
            if self.selection.takes(properties) and node["geometry"] is not None:
                before = self.shapes.counts()
                self.node(node["geometry"], item)
                if self.shapes.attributes is not None:
                    self.shapes.attributes[item] = properties
                if self.attribute is not None:
                    height = self.selection.height(properties, self.attribute, item)
                    self.shapes.set_height(before, height)
        elif kind == "GeometryCollection":
            for number, part in enumerate(self.members(node, "geometries", item), 1):
                self.node(part, f"{item}, geometry {number}" if item else f"geometry {number}")
        elif kind == "Polygon":
            self.polygon(self.members(node, "coordinates", item), item)
        elif kind == "MultiPolygon":
            for polygon in self.members(node, "coordinates", item):
                self.polygon(polygon, item)
        elif kind == "LineString":
            self.shapes.lines.append((item, self.positions(self.members(node, "coordinates", item), item, 2)))
        elif kind == "MultiLineString":
            for line in self.members(node, "coordinates", item):
                self.shapes.lines.append((item, self.positions(line, item, 2)))
        elif kind == "Point":
            self.shapes.points.append((item, self.positions([node.get("coordinates")], item, 1)[0]))
        elif kind == "MultiPoint":
            places = self.positions(self.members(node, "coordinates", item), item, 0)
            self.shapes.points += [(item, place) for place in places]
        else:
            raise self.refuse(f"not GeoJSON: an object of type {kind!r}", item)

    def members(self, node: dict, key: str, item: str) -> list:
        members = node.get(key)
        if not isinstance(members, list):
            raise self.refuse(f"not GeoJSON: {node['type']} without a list '{key}'", item)
        return members

    def polygon(self, rings: Any, item: str) -> None:
        if not isinstance(rings, list):
            raise self.refuse("the coordinates of a Polygon must be a list of rings", item)
        ring_positions = []
        for number, ring in enumerate(rings, 1):
            where = f"{item}, ring {number}" if item else f"ring {number}"
            if not isinstance(ring, list) or len(ring) < 3:
                raise self.refuse("a ring needs at least 3 corners", where)
            ring_positions.append(self.positions(ring, where, 3))
        self.shapes.add_polygon(item, ring_positions)

    def positions(self, places: Any, item: str, least: int) -> np.ndarray:
        """(N, 2) float64 of a list of at least so many positions; (N, 3) where heights are wanted."""
        if not isinstance(places, list) or len(places) < least:
            raise self.refuse(f"a list of at least {least} positions is needed", item)
        coordinates = [self.position(place, item, number) for number, place in enumerate(places, 1)]
        return np.array(coordinates, np.float64).reshape(-1, self.shapes.ordinates)

    def position(self, position: Any, item: str, number: int) -> tuple[float, ...]:
        count = self.shapes.ordinates
        plain = isinstance(position, list) and len(position) >= 2
        if not plain or not all(is_number(coordinate) for coordinate in position[:count]):
            raise self.refuse(f"position {number} is not [x, y], finite numbers: {position!r:.40}", item)
        plan_and_height = [float(coordinate) for coordinate in position[:count]]
        return (*plan_and_height, float("nan")) if len(plan_and_height) < count else tuple(plan_and_height)
