# SPDX-License-Identifier: GPL-3.0-or-later
"""Well-known text (OGC 06-103r4): polygons, lines and points, one geometry or several after each other."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import BOM, Step, no_step, read_bytes, read_text
from ...settings.data_files import MapLayer, begins_as_wkt
from .shapes import Heights, Shapes

_TOKEN = re.compile(r"\s*(?:([A-Za-z]+)|([(),;])|([-+0-9.][^\s(),;]*)|(\S))")
_SRID = re.compile(r"\s*SRID\s*=\s*\d+\s*;", re.IGNORECASE)
_KINDS = (
    "POINT",
    "LINESTRING",
    "POLYGON",
    "MULTIPOINT",
    "MULTILINESTRING",
    "MULTIPOLYGON",
    "GEOMETRYCOLLECTION",
)
_BARE = re.compile(r"\s*\(\s*[-+.\d]")  # points of a MULTIPOINT without brackets of their own
_DEEPEST = 50
_OPENS = re.compile(
    r"\s*(?:SRID=\d+;\s*)?[A-Za-z]+\s*(?:Z|M|ZM)?\s*(?:\(|EMPTY)", re.IGNORECASE
)  # no table of points
_HEAD = 4096  # bytes: those of text have no zeros


def parse_wkt(text: str, file: Path | None = None, heights: bool = False) -> Shapes:
    """The shapes of a text; Z only where heights are requested, never M. Raises InputRefused naming the line
    of the text."""
    return _Parser(text, file, heights).shapes


def begins_as_wkt_file(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is well-known text."""
    text = head.removeprefix(BOM).decode("latin-1")
    return begins_as_wkt(text) and _OPENS.match(text) is not None


def read_wkt(layer: MapLayer, _step: Step = no_step, heights: Heights | None = None) -> Shapes:
    """The shapes of a file. Raises InputRefused, also for a file of none of the formats of shapes."""
    file = Path(layer.file)
    text = "" if b"\0" in read_bytes(file)[:_HEAD] else read_text(file)
    if not begins_as_wkt(text):
        what = "neither GeoJSON, well-known text, a shapefile (.shp) nor a GeoPackage"
        raise InputRefused(what, file=file, advice="export it in one of these formats")
    if layer.where:
        raise InputRefused("well-known text has no attributes, so 'where' has no effect", file=file)
    if heights and heights.attribute is not None:
        what = "well-known text has no attributes, so 'height' has no effect"
        raise InputRefused(what, file=file, advice="write the elevations as z")
    return parse_wkt(text, file, heights is not None)


class _Parser:
    def __init__(self, text: str, file: Path | None, heights: bool):
        self.text, self.file, self.at = text, file, 0
        self.shapes = Shapes(has_heights=heights)
        self.only_m = False  # a third number of the present geometry is no height
        number = 0
        several = len(re.findall(r"\b(?:MULTI)?(?:POLYGON|LINESTRING|POINT)\b", text, re.IGNORECASE)) > 1
        while True:
            if srid := _SRID.match(self.text, self.at):
                self.at = srid.end()
            if self.peek() in (";", ","):
                self.next()
                continue
            if self.peek() is None:
                return
            number += 1
            self.geometry(f"geometry {number}" if several else "", 0)

    def refuse(self, what: str) -> InputRefused:
        line = self.text.count("\n", 0, min(self.at, len(self.text))) + 1
        return InputRefused(f"not well-known text: {what}", file=self.file, line=line if self.file else None)

    def peek(self) -> str | None:
        match = _TOKEN.match(self.text, self.at)
        return match.group().strip() if match else None

    def next(self) -> str:
        match = _TOKEN.match(self.text, self.at)
        if match is None:
            raise self.refuse("it ends too early")
        self.at = match.end()
        return match.group().strip()

    def expect(self, wanted: str) -> None:
        word = self.peek()
        if word != wanted:
            raise self.refuse(
                f"'{wanted}' is expected, there is '{word:.20}'" if word else "it ends too early"
            )
        self.next()

    def opens(self) -> bool:
        """Whether brackets open; no for EMPTY."""
        if (self.peek() or "").upper() == "EMPTY":
            self.next()
            return False
        self.expect("(")
        return True

    def more(self) -> bool:
        """Whether another part follows; reads the comma or the closing bracket."""
        if self.peek() == ",":
            self.next()
            return True
        self.expect(")")
        return False

    def geometry(self, item: str, depth: int) -> None:
        word = self.next()
        kind = word.upper()
        self.only_m = kind not in _KINDS and kind.endswith("M") and not kind.endswith("ZM")
        for suffix in ("ZM", "Z", "M"):  # as some write it: POLYGONZ
            if kind not in _KINDS and kind.removesuffix(suffix) in _KINDS:
                kind = kind.removesuffix(suffix)
        if kind not in _KINDS:
            raise self.refuse(f"'{word:.30}' is no geometry that is read")
        if (self.peek() or "").upper() in ("Z", "M", "ZM"):
            self.only_m = self.next().upper() == "M"
        if kind == "GEOMETRYCOLLECTION":
            if depth > _DEEPEST:
                raise self.refuse("collections nested too deep")
            more = self.opens()
            while more:
                self.geometry(item, depth + 1)
                more = self.more()
            return
        several = kind.startswith("MULTI")
        add = {"POINT": self.point, "LINESTRING": self.line, "POLYGON": self.polygon}[
            kind.removeprefix("MULTI")
        ]
        if not several or (kind == "MULTIPOINT" and _BARE.match(self.text, self.at)):
            add(item)
            return
        more = self.opens()
        while more:
            add(item)
            more = self.more()

    def positions(self) -> np.ndarray:
        """(N, 2) of the brackets that come, without what lies behind x and y; (N, 3) where heights are
        wanted."""
        if not self.opens():
            return np.empty((0, self.shapes.ordinates))
        close = self.text.find(")", self.at)
        if close < 0:
            self.at = len(self.text)
            raise self.refuse("a bracket is not closed")
        places = []
        for entry in self.text[self.at : close].split(","):
            numbers = entry.split()
            try:
                if not 2 <= len(numbers) <= 4:
                    raise ValueError
                places.append(self.ordinates(numbers))
            except ValueError as error:
                raise self.refuse(f"'{entry.strip():.40}' is no position x y") from error
        self.at = close + 1
        coordinates = np.array(places, np.float64).reshape(-1, self.shapes.ordinates)
        if not np.isfinite(coordinates[:, :2]).all():
            raise self.refuse("a position is not finite")
        return coordinates

    def ordinates(self, numbers: list[str]) -> list[float]:
        """The coordinates of a position that are used."""
        place = [float(number) for number in numbers[: self.shapes.ordinates]]
        if self.shapes.has_heights and (len(numbers) < 3 or self.only_m):
            place[2:] = [float("nan")]
        return place

    def polygon(self, item: str) -> None:
        rings = []
        more = self.opens()
        while more:
            rings.append(self.positions())
            more = self.more()
        self.shapes.add_polygon(item, [ring for ring in rings if len(ring)])

    def line(self, item: str) -> None:
        places = self.positions()
        if len(places):
            self.shapes.lines.append((item, places))

    def point(self, item: str) -> None:
        self.shapes.points += [(item, place) for place in self.positions()]
