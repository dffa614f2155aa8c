# SPDX-License-Identifier: GPL-3.0-or-later
"""LandXML (1.0 to 2.0; schemas of landxml.org): the triangulated surfaces (TIN) of a file by their names, and
the points of those without faces. Points are northing, easting, elevation."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from ...base.errors import InputRefused
from ...base.text import Step, local_name, no_step, parse_xml, read_bytes
from ..objects.geo_object import ObjectName, point_object
from .triangle_mesh import surface_object


def begins_as_landxml(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return b"<LandXML" in head


def read_landxml(file: str | Path, step: Step = no_step) -> list[ObjectName]:
    """The surfaces; faces that are marked as invisible (i="1") are left out. Raises InputRefused."""
    file = Path(file)
    root = parse_xml(file, read_bytes(file), step)
    unit: str | None = None
    objects: list[ObjectName] = []
    for element in root.iter():
        kind = local_name(element)
        if kind in ("Metric", "Imperial"):
            unit = element.get("linearUnit") or unit
        elif kind == "Surface":
            objects += _surface(file, element, unit)
    if not objects:
        raise InputRefused(
            "it has no triangulated surface", file=file, advice="export surfaces with their faces"
        )
    return objects


def _surface(file: Path, element: ElementTree.Element, unit: str | None) -> list[ObjectName]:
    """A surface, its points where it has no faces, nothing where it has neither."""
    name = element.get("name", "")
    index: dict[str, int] = {}
    vertices: list[tuple[float, ...]] = []
    faces: list[tuple[int, ...]] = []
    for part in element.iter():
        kind = local_name(part)
        if kind not in ("P", "F"):
            continue
        words = (part.text or "").split()
        try:
            if kind == "F":
                if part.get("i") != "1":
                    faces.append(tuple([index[word] for word in words[:3]]))
            elif kind == "P":
                north, east, up = map(float, words[:3])
                index[part.get("id", str(len(vertices) + 1))] = len(vertices)
                vertices.append((east, north, up))
        except (ValueError, KeyError) as error:
            what = f"surface '{name}': '{' '.join(words):.40}' cannot be read"
            raise InputRefused(what, file=file) from error
    if faces:
        return [surface_object(file, name, vertices, faces, unit=unit)]
    return [point_object(name, vertices, unit=unit)] if vertices else []
