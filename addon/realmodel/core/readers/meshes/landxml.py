# SPDX-License-Identifier: GPL-3.0-or-later
"""LandXML (1.0 to 2.0): all triangulated surfaces (TIN) of a file, as one mesh. Points are northing, easting,
elevation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ...base.errors import InputRefused
from ...base.text import Step, local_name, no_step, parse_xml, read_bytes
from .triangle_mesh import TriangleMesh, mesh_of_faces

_UNITS = {
    "millimeter": "mm",
    "centimeter": "cm",
    "meter": "m",
    "kilometer": "km",
    "inch": "in",
    "foot": "ft",
    "USSurveyFoot": "us-ft",
    "mile": "mi",
}


def begins_as_landxml(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return b"<LandXML" in head


def read_landxml(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads all surfaces; faces that are marked as invisible (i="1") are left out. Raises InputRefused."""
    file = Path(file)
    vertices: list[tuple[float, ...]] = []
    faces: list[tuple[int, ...]] = []
    unit = None
    for element in parse_xml(file, read_bytes(file), step).iter():
        kind = local_name(element)
        if kind in ("Metric", "Imperial"):
            unit = _UNITS.get(element.get("linearUnit", ""), unit)
        if kind != "Surface":
            continue
        index: dict[str, int] = {}
        for part in element.iter():
            kind, words = local_name(part), (part.text or "").split()
            try:
                if kind == "P" and "id" in part.attrib:
                    north, east, up = map(float, words[:3])
                    index[part.attrib["id"]] = len(vertices)
                    vertices.append((east, north, up))
                elif kind == "F" and part.get("i") != "1":
                    faces.append(tuple([index[word] for word in words[:3]]))
            except (ValueError, KeyError) as error:
                what = f"surface '{element.get('name', '')}': '{' '.join(words):.40}' cannot be read"
                raise InputRefused(what, file=file) from error
    if not faces:
        raise InputRefused(
            "it has no triangulated surface", file=file, advice="export surfaces with their faces"
        )
    return replace(mesh_of_faces(file, vertices, faces), unit=unit)
