# SPDX-License-Identifier: GPL-3.0-or-later
"""Ready triangulated surfaces from files: one registry of formats (docs/dev/extending.md). The format is
detected from the content of the file."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ...base.errors import InputRefused
from ...base.mapped_arrays import MakeRows, Rows
from ...base.text import Step, no_step
from ...settings.point_file import MeshFile
from ..objects.geo_object import SURFACE
from ..objects.object_file import OBJECT_ENDINGS, OBJECT_NAMES, is_object_file, read_object
from .dxf_mesh import begins_as_dxf, read_dxf
from .gmsh_mesh import begins_as_msh, read_msh
from .landxml import begins_as_landxml, read_landxml
from .off import begins_as_off, read_off
from .ply_mesh import begins_as_ply, read_ply
from .stl_mesh import begins_as_stl, read_stl
from .surface_meshes import begins_as_obj, read_obj, read_tsurf
from .triangle_mesh import TriangleMesh, mesh_of_faces
from .vtk_mesh import begins_as_vtk_xml, read_vtk_xml

_HEAD = 4096


@dataclass(frozen=True)
class MeshFormat:
    """begins(head, size): whether a file of so many bytes that begins with these is of this format.
    read(file, step) raises InputRefused naming file and line. read_in_pieces(file, step, rows): the same of
    a format that large files have; rows: where the mesh is kept."""

    name: str
    endings: tuple[str, ...]
    begins: Callable[[bytes, int], bool]
    read: Callable[[Path, Step], TriangleMesh]
    read_in_pieces: Callable[[Path, Step, MakeRows], TriangleMesh] | None = None


def _by_head(begins: Callable[[bytes], bool]) -> Callable[[bytes, int], bool]:
    return lambda head, _size: begins(head)


MESH_FORMATS = (
    MeshFormat("OFF", (".off",), _by_head(begins_as_off), read_off, read_off),
    MeshFormat("PLY", (".ply",), _by_head(begins_as_ply), read_ply, read_ply),
    MeshFormat("GOCAD TSurf", (".ts",), _by_head(lambda head: head.startswith(b"GOCAD TSurf")), read_tsurf),
    MeshFormat("VTK XML", (".vtp", ".vtu"), _by_head(begins_as_vtk_xml), read_vtk_xml),
    MeshFormat("Gmsh", (".msh",), _by_head(begins_as_msh), read_msh),
    MeshFormat("LandXML", (".xml", ".landxml"), _by_head(begins_as_landxml), read_landxml),
    MeshFormat("DXF", (".dxf",), _by_head(begins_as_dxf), read_dxf),
    MeshFormat("STL", (".stl",), begins_as_stl, read_stl),
    MeshFormat("OBJ", (".obj",), begins_as_obj, read_obj),
)
MESH_ENDINGS = tuple(ending for known in MESH_FORMATS for ending in known.endings)


def is_mesh_file(file: str | Path) -> bool:
    """Whether a file is one of a mesh, by its content or else by its ending. Raises InputRefused where it
    cannot be read."""
    return bool(_formats_of(Path(file)))


def read_mesh(file: str | Path | MeshFile, step: Step = no_step, rows: MakeRows = Rows) -> TriangleMesh:
    """Reads a mesh in any format that is known. A MeshFile may name the object in a file of several. rows:
    where it is kept, if its format is read in pieces; else it is in memory. Raises InputRefused naming file
    and line."""
    layer = file.layer if isinstance(file, MeshFile) else None
    file = Path(file.file if isinstance(file, MeshFile) else file)
    if is_object_file(file):
        found_object = read_object(file, layer, (SURFACE,))
        assert found_object.triangles is not None
        return mesh_of_faces(file, found_object.vertices, found_object.triangles)
    if layer is not None:
        what = f"it is not a file of objects ({', '.join(OBJECT_ENDINGS)}), so it has no '{layer}'"
        raise InputRefused(what, file=file, advice="take 'layer' out")
    found = _formats_of(file)
    if not found:
        names = ", ".join((*(known.name for known in MESH_FORMATS), *OBJECT_NAMES))
        raise InputRefused(f"neither its content nor its extension is that of a mesh ({names})", file=file)
    if found[0].read_in_pieces is not None:
        return found[0].read_in_pieces(file, step, rows)
    return found[0].read(file, step)


def _formats_of(file: Path) -> list[MeshFormat]:
    """The formats that fit the content, then the format of the ending."""
    try:
        with file.open("rb") as opened:
            head = opened.read(_HEAD)
            size = opened.seek(0, os.SEEK_END)
    except OSError as error:
        raise InputRefused(f"cannot be read: {error.strerror}", file=file, advice="check the path") from error
    by_ending = [known for known in MESH_FORMATS if file.suffix.lower() in known.endings]
    return [*(known for known in MESH_FORMATS if known.begins(head, size)), *by_ending]
