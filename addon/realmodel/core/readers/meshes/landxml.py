# SPDX-License-Identifier: GPL-3.0-or-later
"""LandXML (1.0 to 2.0): all triangulated surfaces (TIN) of a file, as one mesh. Points are northing, easting,
elevation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ...base.errors import InputRefused
from ...base.mapped_arrays import MakeRows, Rows
from ...base.text import Step, no_step
from ...base.xml_text import feed_xml
from .pending_mesh import PendingMesh, VertexNumbers
from .triangle_mesh import TriangleMesh

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
_FACE = "\0"  # no point has this name


def begins_as_landxml(head: bytes) -> bool:
    """Whether a file that begins so is one."""
    return b"<LandXML" in head


def read_landxml(file: str | Path, step: Step = no_step, rows: MakeRows = Rows) -> TriangleMesh:
    """Reads all surfaces; faces that are marked as invisible (i="1") are left out. rows: where they are kept.
    Raises InputRefused."""
    file = Path(file)
    found = _Surfaces(PendingMesh(file, rows))
    feed_xml(file, found, step)
    if not found.has_faces:
        raise InputRefused(
            "it has no triangulated surface", file=file, advice="export surfaces with their faces"
        )
    return replace(found.mesh.mesh(), unit=found.unit)


class _Surfaces:
    """The handler of the elements of a file (ElementHandler); adds their surfaces to a mesh."""

    def __init__(self, mesh: PendingMesh):
        self.mesh = mesh
        self.unit: str | None = None
        self.has_faces = False
        self._surface: str | None = None  # its name, while it lasts
        self._numbers = VertexNumbers()
        self._others: dict = {}
        self._name: str | None = None  # of the point whose text is read, or _FACE
        self._text: list[str] = []

    def begin(self, name: str, attributes: dict[str, str]) -> None:
        self._end_text()  # text after another element is not part of it
        if name in ("Metric", "Imperial"):
            self.unit = _UNITS.get(attributes.get("linearUnit", ""), self.unit)
        elif name == "Surface":
            self._surface = attributes.get("name", "")
            self._numbers, self._others = VertexNumbers(), {}
        elif self._surface is None:
            return
        elif name == "P" and "id" in attributes:
            self._name, self._text = attributes["id"], []
        elif name == "F" and attributes.get("i") != "1":
            self._name, self._text = _FACE, []

    def text(self, text: str) -> None:
        if self._name is not None:
            self._text.append(text)

    def end(self, name: str) -> None:
        self._end_text()
        if name == "Surface":
            self._surface = None

    def _end_text(self) -> None:
        if self._name is None:
            return
        name, words = self._name, "".join(self._text).split()
        self._name = None
        try:
            if name != _FACE:
                north, east, up = map(float, words[:3])
                self._number(name)
                self.mesh.vertices.append([east, north, up])
            else:
                self.mesh.add_face([self._vertex(word) for word in words[:3]])
                self.has_faces = True
        except (ValueError, KeyError, IndexError) as error:
            what = f"surface '{self._surface}': '{' '.join(words):.40}' cannot be read"
            raise InputRefused(what, file=self.mesh.file) from error
        self.mesh.flush_some()

    def _number(self, name: str) -> None:
        """Adds the name of the next vertex, mostly a number."""
        if _is_number(name):
            self._numbers[int(name)] = self.mesh.vertex_count
        else:
            self._others[name] = self.mesh.vertex_count

    def _vertex(self, name: str) -> int:
        return self._numbers[int(name)] if _is_number(name) else self._others[name]


def _is_number(name: str) -> bool:
    """Whether the name is the only one that means this number."""
    return name.isdecimal() and name.isascii() and (name == "0" or name[0] != "0")
