# SPDX-License-Identifier: GPL-3.0-or-later
"""DIGGS 2, XML of ground investigations: boreholes with a reference point and a length, and systems of
lithology whose observations lie between depths along a borehole.

American Society of Civil Engineers, Geo-Institute, *DIGGS Schema* 2.0 to 2.6, diggsml.org.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree.ElementTree import Element

from ...base.errors import InputRefused
from ...base.text import local_name, no_step, parse_xml, read_bytes
from ..tables.hole_tables import RawTable

_HOLES = ("Borehole", "TrialPit", "Sounding")
_CODES = ("classificationCode", "classificationSymbol", "classificationName", "legendCode", "lithDescription")
_GEOGRAPHIC = ("4326", "4979", "4269", "4258", "CRS84", "5498", "4267")


def begins_as_diggs(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is DIGGS."""
    return b"<" in head[:8] and b"Diggs" in head


def read_diggs(file: Path) -> dict[str, RawTable]:
    """The collars and intervals of a file. Raises InputRefused."""
    root = parse_xml(file, read_bytes(file), no_step)
    names: dict[str, str] = {}
    collars: list[tuple[int, list[str]]] = []
    unit = unit_of_plan = unit_of_height = system = ""
    for kind in _HOLES:
        for hole in _all(root, kind):
            name = _text(hole, "name") or _attribute(hole, "id")
            names[_attribute(hole, "id")] = name
            point = next(_all(hole, "referencePoint"), None)
            place = [] if point is None else _numbers(point)
            system = _first_attribute(point, "srsName")
            if any(system.endswith(code) for code in _GEOGRAPHIC):
                what = f"hole '{name}' is placed by longitude and latitude ({system})"
                advice = "give a table of collars in meters or feet beside it: collars = ..."
                raise InputRefused(what, file=file, advice=advice)
            labels = _first_attribute(point, "uomLabels").split()
            unit_of_plan, unit_of_height = (
                (labels[0], labels[-1]) if labels else (unit_of_plan, unit_of_height)
            )
            length = next(_all(hole, "totalMeasuredDepth"), None)
            unit = unit if length is None else _attribute(length, "uom") or unit
            end = "" if length is None else (length.text or "").strip()
            collars.append((0, [name, *[*place, "", "", ""][:3], end]))
    intervals = [
        (0, [names[reference], *depths[:2], code])
        for reference, depths, code in _layers(root, names)
        if len(depths) > 1
    ]
    for what, rows in (("boreholes", collars), ("layers between two depths", intervals)):
        if not rows:
            raise InputRefused(f"it has no {what}", file=file)
    return {
        "collars": RawTable(
            ("hole", "x", "y", "z", "end"),
            collars,
            units=("", unit_of_plan, unit_of_plan, unit_of_height, unit),
            system=system,
        ),
        "intervals": RawTable(("hole", "from", "to", "block"), intervals, 1, ("", unit, unit, "")),
    }


def _layers(root: Element, names: dict[str, str]) -> Iterator[tuple[str, list[str], str]]:
    """For each observation of lithology the id of its hole, its depths and its code."""
    for system in _all(root, "LithologySystem"):
        references = (
            value.lstrip("#")
            for element in system.iter()
            for name, value in element.attrib.items()
            if name.rpartition("}")[2] == "href"
        )
        only = next(iter(names), "") if len(names) == 1 else ""
        hole = next((reference for reference in references if reference in names), only)
        for observation in _all(system, "LithologyObservation"):
            location = next(_all(observation, "location"), None)
            if location is not None and hole:
                code = next((text for name in _CODES if (text := _text(observation, name))), "")
                yield hole, _numbers(location), code


def _all(element: Element, name: str) -> Iterator[Element]:
    return (part for part in element.iter() if isinstance(part.tag, str) and local_name(part) == name)


def _text(element: Element, name: str) -> str:
    return next(((part.text or "").strip() for part in _all(element, name)), "")


def _attribute(element: Element, name: str) -> str:
    return next((value for key, value in element.attrib.items() if key.rpartition("}")[2] == name), "")


def _first_attribute(element: Element | None, name: str) -> str:
    """An attribute of the first of an element and those in it that have it; "" where none does."""
    elements = () if element is None else element.iter()
    return next((text for entry in elements if (text := _attribute(entry, name))), "")


def _numbers(element: Element) -> list[str]:
    """The numbers of the first position in an element, as they are written."""
    for name in ("posList", "pos"):
        if text := _text(element, name):
            return text.replace(",", " ").split()
    return []
