# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that meshes for simulation are written to, by their ending: one registry (docs/dev/extending.md)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from ..base.atomic import Outputs, writable_folder, writable_target
from ..base.errors import UsageError
from ..base.units import MODEL_UNIT
from ..simulation import PolyhedralMesh, VolumeMesh
from ..simulation.element_faces import ElementFaces
from .endings import by_ending
from .solvers.cdb import write_cdb
from .solvers.exodus import write_exodus
from .solvers.f3grid import write_f3grid
from .solvers.gmsh import write_msh
from .solvers.inp import write_inp
from .solvers.modflow import write_disu, write_disv
from .solvers.openfoam import POLY_MESH, write_openfoam
from .solvers.vtu import write_vtu
from .solvers.vtu_elements import write_vtu_elements

Mesh = VolumeMesh | PolyhedralMesh
Step = Callable[[float], None]


@dataclass(frozen=True)
class SimulationFormat:
    """A format of meshes for simulation.

    write(mesh, path, outputs, step, unit) writes it by outputs.file or outputs.folder. polyhedra: whether it
    takes them. folder: as of ModelFormat.
    """

    ending: str
    label: str
    write: Callable[..., None]
    polyhedra: bool = False
    folder: str = ""


def _file(write: Callable) -> Callable:
    def write_it(mesh: Mesh, path: Path, outputs: Outputs, step: Step, _unit: str) -> None:
        with outputs.file(path) as file:
            write(mesh, file, step)

    return write_it


def _write_vtu(mesh: Mesh, file: BinaryIO, step: Step) -> None:
    if isinstance(mesh, PolyhedralMesh):
        write_vtu(mesh, file, step)
    else:
        write_vtu_elements(mesh, file, step)


def _write_openfoam(mesh: Mesh, path: Path, outputs: Outputs, step: Step, _unit: str) -> None:
    with outputs.folder(path, POLY_MESH) as folder:
        write_openfoam(_polyhedral(mesh), folder, step)


def _modflow(write: Callable, prepare: Callable) -> Callable:
    """A grid, and beside it the block of each cell: NAME_block.txt, of DISU NAME_disu_block.txt, so that both
    grids may have one name."""

    def write_it(mesh: Mesh, path: Path, outputs: Outputs, step: Step, unit: str) -> None:
        path = Path(path)
        beside = "_disu_block.txt" if write is write_disu else "_block.txt"
        with (
            outputs.file(path) as file,
            outputs.file(path.with_name(path.stem + beside)) as blocks,
        ):
            write(prepare(mesh), file, blocks, step, unit)

    return write_it


def _polyhedral(mesh: Mesh) -> PolyhedralMesh:
    return mesh if isinstance(mesh, PolyhedralMesh) else ElementFaces(mesh).polyhedral()


MESH_FORMATS: dict[str, SimulationFormat] = {
    known.ending: known
    for known in (
        SimulationFormat(".vtu", "VTK Unstructured Grid, OpenGeoSys", _file(_write_vtu), True),
        SimulationFormat(".foam", "OpenFOAM Case", _write_openfoam, True, POLY_MESH),
        SimulationFormat(".msh", "Gmsh", _file(write_msh)),
        SimulationFormat(".inp", "Abaqus, CalculiX", _file(write_inp)),
        SimulationFormat(".cdb", "ANSYS", _file(write_cdb)),
        SimulationFormat(".exo", "Exodus II", _file(write_exodus), True),
        SimulationFormat(".f3grid", "FLAC3D", _file(write_f3grid)),
        SimulationFormat(".disv", "MODFLOW 6 DISV", _modflow(write_disv, lambda mesh: mesh)),
        SimulationFormat(".disu", "MODFLOW 6 DISU", _modflow(write_disu, _polyhedral), True),
    )
}


def mesh_format_for(path: str | Path) -> SimulationFormat:
    """The format that this ending says. Raises UsageError."""
    return by_ending(path, MESH_FORMATS, "meshes are not written as {}")


def mesh_target(path: str | Path) -> Path:
    """The path, links followed, where a mesh will stand. Raises UsageError, OutputFailed."""
    known = mesh_format_for(path)
    return writable_folder(path, known.folder) if known.folder else writable_target(path)


def write_mesh(
    mesh: Mesh, path: str | Path, outputs: Outputs, step: Step = lambda _: None, unit: str = MODEL_UNIT
) -> None:
    """Writes a mesh in the format of the path's ending; it appears with the other outputs. unit: of its
    lengths. Raises UsageError where the format has no polyhedra."""
    known = mesh_format_for(path)
    if isinstance(mesh, PolyhedralMesh) and not known.polyhedra:
        able = ", ".join(each.ending for each in MESH_FORMATS.values() if each.polyhedra)
        raise UsageError(
            f"{path}: {known.label} has no polyhedra; use one of {able}, or prisms or tetrahedra"
        )
    known.write(mesh, path, outputs, step, unit)


def save_mesh(mesh: Mesh, path: str | Path, step: Step = lambda _: None, unit: str = MODEL_UNIT) -> None:
    """Writes a mesh for simulation, or cleaned cells, to a file or folder by its ending (.foam, .vtu, .msh,
    .inp, .cdb, .exo, ...). It appears whole or not at all.

    step(share) is called now and then, last with 1. unit: of its lengths, for formats that name one. Raises
    UsageError for an ending that is not known, OutputFailed where it cannot be written.
    """
    mesh_format_for(path)
    with Outputs() as outputs:
        write_mesh(mesh, path, outputs, step, unit)
