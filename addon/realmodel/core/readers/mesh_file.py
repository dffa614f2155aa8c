# SPDX-License-Identifier: GPL-3.0-or-later
"""Ready triangulated surfaces from files: one registry of formats (docs/dev/extending.md). The format is
detected from the content of the file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..errors import InputRefused
from .off import begins_as_off, read_off
from .surface_meshes import read_obj, read_ply, read_stl, read_tsurf
from .text import Step, no_step
from .triangle_mesh import TriangleMesh

_HEAD = 512


@dataclass(frozen=True)
class MeshFormat:
    """begins(head): whether a file that begins with these bytes is of this format. read(file, step) raises
    InputRefused naming file and line."""

    name: str
    endings: tuple[str, ...]
    begins: Callable[[bytes], bool]
    read: Callable[[Path, Step], TriangleMesh]


def _by_ending(_head: bytes) -> bool:
    return False


MESH_FORMATS = (
    MeshFormat("OFF", (".off",), begins_as_off, read_off),
    MeshFormat("PLY", (".ply",), lambda head: head.startswith((b"ply\n", b"ply\r")), read_ply),
    MeshFormat("GOCAD TSurf", (".ts",), lambda head: head.startswith(b"GOCAD TSurf"), read_tsurf),
    MeshFormat("OBJ", (".obj",), _by_ending, read_obj),
    MeshFormat("STL", (".stl",), _by_ending, read_stl),
)
MESH_ENDINGS = tuple(ending for known in MESH_FORMATS for ending in known.endings)


def read_mesh(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads a mesh in any format that is known. Raises InputRefused naming file and line."""
    file = Path(file)
    try:
        with file.open("rb") as opened:
            head = opened.read(_HEAD)
    except OSError as error:
        raise InputRefused(f"cannot be read: {error.strerror}", file=file, advice="check the path") from error
    by_ending = [known for known in MESH_FORMATS if file.suffix.lower() in known.endings]
    found = [*(known for known in MESH_FORMATS if known.begins(head)), *by_ending]
    if not found:
        names = ", ".join(known.name for known in MESH_FORMATS)
        raise InputRefused(f"neither its content nor its extension is that of a mesh ({names})", file=file)
    return found[0].read(file, step)
