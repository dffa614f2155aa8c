# SPDX-License-Identifier: GPL-3.0-or-later
"""LandXML (1.0 to 2.0): the triangulated surfaces (TIN) of a file, as one. Points stand as northing, easting,
elevation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import InputRefused
from .text import Step, no_step, read_bytes
from .triangle_mesh import TriangleMesh, mesh_of_faces
from .xml_text import local_name, parse_xml

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


def begins_as_landxml(head: bytes) -> bool:
    """Whether a file that begins so is one."""
    return b"<LandXML" in head


def read_landxml(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads all surfaces; faces that are marked as invisible (i="1") are left out. Raises InputRefused."""
    file = Path(file)
    root = parse_xml(file, read_bytes(file))
    step(0.5)
    vertices, faces, unit = [], [], None
    for element in root.iter():
        name = local_name(element)
        if name in ("Metric", "Imperial"):
            unit = _UNITS.get(element.get("linearUnit", ""), unit)
        if name != "Surface":
            continue
        index: dict[str, int] = {}
        for part in element.iter():
            kind = local_name(part)
            words = (part.text or "").split()
            try:
                if kind == "P" and "id" in part.attrib:
                    north, east, up = map(float, words[:3])
                    index[part.attrib["id"]] = len(vertices)
                    vertices.append((east, north, up))
                elif kind == "F" and part.get("i") != "1":
                    faces.append([index[word] for word in words[:3]])
            except (ValueError, KeyError) as error:
                what = f"surface '{element.get('name', '')}': '{' '.join(words):.40}' cannot be read"
                raise InputRefused(what, file=file) from error
    if not faces:
        raise InputRefused(
            "it has no triangulated surface", file=file, advice="export surfaces with their faces"
        )
    mesh = mesh_of_faces(file, np.array(vertices), faces)
    return replace(mesh, unit=unit)
