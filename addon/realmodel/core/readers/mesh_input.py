# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces from files; the format follows from the content."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ..base.errors import InputRefused
from ..base.mapped_arrays import MakeRows, Rows
from ..base.text import FileBytes, Step, no_step
from ..base.units import unit_of
from ..settings.data_files import MeshFile
from .formats import MESH, OBJECTS, format_of, labels
from .meshes.triangle_mesh import TriangleMesh
from .object_input import objects_in, read_object
from .objects.geo_object import SURFACE
from .tables.dialects.dialect import comment_units

# Formats whose layout is not public, or that hold solids of curved faces, and the programs that write them.
_CLOSED = {
    ".00t": "Vulcan",
    ".dwg": "AutoCAD",
    ".dgn": "MicroStation",
    ".skp": "SketchUp",
    ".3dm": "Rhino",
    ".fbx": "the program that wrote it",
    ".stp": "the program that wrote it",
    ".step": "the program that wrote it",
}
# Of formats that have no place for a unit, and what begins their comments.
_WITHOUT_UNIT = (".stl", ".obj", ".ply", ".off")
_COMMENTS = ("#", "comment", "obj_info")
_HEAD = 4096


def is_mesh_file(file: str | Path) -> bool:
    """Whether there is a surface in a file, by its content or else by its ending. Raises InputRefused where
    it cannot be read."""
    file_format = format_of(file, OBJECTS, MESH)
    if file_format is None or file_format.holds == MESH:
        return file_format is not None
    return any(obj.kind == SURFACE for obj in objects_in(Path(file)))


def read_mesh(file: str | Path | MeshFile, step: Step = no_step, rows: MakeRows = Rows) -> TriangleMesh:
    """Reads a mesh in any format that is known. A MeshFile may name the object in a file of several. rows:
    where it is kept, if its format is read in pieces; else it is in memory. Raises InputRefused naming file
    and line."""
    mesh = _read_mesh(file, step, rows)
    path = Path(file.file if isinstance(file, MeshFile) else file)
    if mesh.unit is None and mesh.said_unit is None and path.suffix.lower() in _WITHOUT_UNIT:
        return replace(mesh, said_unit=_unit_in_comments(path))
    return mesh


def _unit_in_comments(file: Path) -> str | None:
    """The unit that a comment, or the header of STL, names as "units: mm": not all programs mean it."""
    head = FileBytes(file)[:_HEAD].decode("latin-1")
    lines = [
        head[:80].partition("\n")[0].rstrip("\0 "),
        *(line for line in head.split("\n") if line.startswith(_COMMENTS)),
    ]
    plan, _ = comment_units(line.strip("# \0\r") for line in lines)
    return unit_of(plan)


def _read_mesh(file: str | Path | MeshFile, step: Step, rows: MakeRows) -> TriangleMesh:
    """As read_mesh, without units in comments."""
    layer = file.layer if isinstance(file, MeshFile) else None
    file = Path(file.file if isinstance(file, MeshFile) else file)
    file_format = format_of(file, OBJECTS, MESH)
    if file_format is not None and file_format.holds == OBJECTS:
        surface = read_object(file, layer, (SURFACE,), step)
        assert surface.triangles is not None
        return TriangleMesh(
            surface.vertices,
            surface.triangles,
            surface.face_of_triangle,
            surface.unit,
            surface.said_unit,
            surface.warnings,
        )
    if layer is not None:
        what = f"it is not a file of objects, so it has no '{layer}'"
        raise InputRefused(what, file=file, advice="take 'layer' out")
    if file_format is None:
        what = f"neither its content nor its extension is that of a mesh ({labels(MESH, OBJECTS)})"
        program = _CLOSED.get(file.suffix.lower())
        advice = f"export it from {program} as DXF or OBJ" if program else None
        raise InputRefused(what, file=file, advice=advice)
    return file_format.read(file, step, rows)
