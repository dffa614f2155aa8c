# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a model is written to, by their ending: one registry (docs/dev/extending.md).

Comes in: `ModelData`, a mesh for simulation, surfaces or a section, and a path. Goes out: a file that appears
whole or not at all, with the same bytes for the same model.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..base.atomic import Outputs, writable_folder, writable_target
from ..base.errors import UsageError
from ..base.packages import require_extra
from ..cells.model_data import ModelData
from ..simulation import PolyhedralMesh
from ..simulation.cleaned_cells import cleaned_cells
from ..simulation.patches import solver_names
from .endings import by_ending
from .map_files import write_geojson, write_geopackage
from .meshes import MESH_FORMATS, write_mesh
from .npz import write_npz
from .objects.geoh5 import write_geoh5
from .objects.ifc import write_ifc
from .objects.omf import write_omf
from .regular import write_ascii_grids, write_block_table, write_geotiff, write_vti
from .shapes.dxf import write_dxf
from .shapes.gltf import write_glb
from .shapes.obj import write_mtl, write_obj
from .shapes.parts import Part, model_parts
from .shapes.ply import write_ply
from .shapes.stl import write_stl
from .shapes.tsurf import write_tsurf

Step = Callable[[float], None]


@dataclass(frozen=True)
class ModelFormat:
    """A format that models are written in.

    label, description: of the panel's menu. write(model, path, outputs, step) writes it by outputs.file or
    outputs.folder; step(share) is called now and then, last with 1. folder: what is renewed where the format
    is a folder, "" for a file. has_cell_size: it is a regular grid, and write takes the size of its cells
    too, as of regular_cells.checked_size. has_contours: it is a map, and write takes the interval of its
    contours too, as of contours.checked_interval. has_cells: it has the model's cells, and write takes these,
    too. has_origin: its coordinates may count from a place, and write takes this, too. needs: the library
    that writes it and the extra that has this, if it is one.
    """

    ending: str
    label: str
    description: str
    write: Callable[..., None]
    folder: str = ""
    has_cell_size: bool = False
    has_cells: bool = False
    has_contours: bool = False
    has_origin: bool = False
    needs: tuple[str, str] | None = None


def _file(write: Callable) -> Callable:
    """write(model, file, step) as a ModelFormat has it."""

    def write_it(model: ModelData, path: Path, outputs: Outputs, step: Step) -> None:
        with outputs.file(path) as file:
            write(model, file, step)

    return write_it


_EACH_BLOCK = "{block}"  # in a file's name: a file for each


def _parts(write: Callable) -> Callable:
    """write(parts, file, step) of the blocks of a model: in one file, or in one for each block."""

    def write_it(
        model: ModelData, path: Path, outputs: Outputs, step: Step, origin: Sequence[float] | None
    ) -> None:
        path, parts = Path(path), _parts_from(model, origin)
        if _EACH_BLOCK not in path.name:
            with outputs.file(path) as file:
                write(parts, file, step)
            return
        for part, word in zip(parts, solver_names(part.name for part in parts), strict=True):
            with outputs.file(path.with_name(path.name.replace(_EACH_BLOCK, word))) as file:
                write([part], file, no_step)
        step(1.0)

    return write_it


def _parts_from(model: ModelData, origin: Sequence[float] | None) -> list[Part]:
    """The blocks of a model, their coordinates from a place."""
    parts = model_parts(model)
    return parts if origin is None else [replace(p, vertices=p.vertices - np.array(origin)) for p in parts]


def _write_obj(
    model: ModelData, path: Path, outputs: Outputs, step: Step, origin: Sequence[float] | None
) -> None:
    parts, materials = _parts_from(model, origin), Path(path).with_suffix(".mtl")
    with outputs.file(materials) as file:
        write_mtl(parts, file)
    with outputs.file(path) as file:
        write_obj(parts, file, step, materials.name)


def _cells(model: ModelData, path: Path, outputs: Outputs, step: Step, cells: PolyhedralMesh | None) -> None:
    """The cells as a mesh for simulation, the exact ones where none are given."""
    write_mesh(cells or PolyhedralMesh.of_model(model), path, outputs, step, model.project.units)


FORMATS: dict[str, ModelFormat] = {
    known.ending: known
    for known in (
        ModelFormat(".npz", "NumPy", "All arrays of the model, for Python", _file(write_npz)),
        ModelFormat(
            ".vtu",
            "VTK Unstructured Grid",
            "The polyhedral cells, for ParaView and simulation",
            _cells,
            has_cells=True,
        ),
        ModelFormat(
            ".foam",
            "OpenFOAM Case",
            "A folder with the polyhedral cells as polyMesh, with zones of cells and patches",
            _cells,
            MESH_FORMATS[".foam"].folder,
            has_cells=True,
        ),
        ModelFormat(
            ".exo",
            "Exodus II",
            "The polyhedral cells, an element block for each block",
            _cells,
            has_cells=True,
        ),
        ModelFormat(
            ".disu",
            "MODFLOW 6 DISU",
            "The polyhedral cells as an unstructured grid, and a table of the block of each",
            _cells,
            has_cells=True,
        ),
        ModelFormat(
            ".obj",
            "Wavefront OBJ",
            "The closed boundary of every block, an object for each",
            _write_obj,
            has_origin=True,
        ),
        ModelFormat(
            ".ply",
            "PLY",
            "The closed boundaries of the blocks; triangles know block and property",
            _parts(write_ply),
            has_origin=True,
        ),
        ModelFormat(
            ".stl",
            "STL",
            "The closed boundary of every block, a solid for each",
            _parts(write_stl),
            has_origin=True,
        ),
        ModelFormat(
            ".glb",
            "glTF Binary",
            "The closed boundary of every block in the color of its property, for the web",
            _parts(write_glb),
            has_origin=True,
        ),
        ModelFormat(
            ".dxf",
            "DXF",
            "The closed boundary of every block, a layer for each, for CAD",
            _parts(write_dxf),
            has_origin=True,
        ),
        ModelFormat(
            ".ts",
            "GOCAD TSurf",
            "The closed boundary of every block, an object for each",
            _file(lambda model, file, step: write_tsurf(model_parts(model), file, step, model.project.units)),
        ),
        ModelFormat(
            ".csv",
            "Block Model",
            "Regular cells with the share of each block, a row for each",
            write_block_table,
            has_cell_size=True,
        ),
        ModelFormat(
            ".vti", "VTK Image", "Regular cells with the share of each block", write_vti, has_cell_size=True
        ),
        ModelFormat(
            ".tif",
            "GeoTIFF",
            "Elevation, and top and thickness of every block, as bands",
            write_geotiff,
            has_cell_size=True,
        ),
        ModelFormat(
            ".asc",
            "ESRI ASCII Grids",
            "Elevation, and top and thickness of every block, a file for each",
            write_ascii_grids,
            has_cell_size=True,
        ),
        ModelFormat(
            ".gpkg",
            "GeoPackage",
            "The geological map of the top, and contours, for GIS",
            write_geopackage,
            has_contours=True,
        ),
        ModelFormat(
            ".geojson",
            "GeoJSON",
            "The geological map of the top, and contours, as text for GIS and the web",
            write_geojson,
            has_contours=True,
        ),
        ModelFormat(
            ".omf",
            "Open Mining Format",
            "Closed blocks, surfaces and boreholes (OMF 1), with cells where their size is given",
            write_omf,
            has_cell_size=True,
            needs=("omf", "omf"),
        ),
        ModelFormat(
            ".geoh5",
            "geoh5",
            "Closed blocks, surfaces and boreholes, with cells where their size is given (ANALYST)",
            write_geoh5,
            has_cell_size=True,
            needs=("geoh5py", "geoh5"),
        ),
        ModelFormat(
            ".ifc",
            "IFC 4.3",
            "A geomodel of closed strata with their shared boundaries, and boreholes, for BIM",
            write_ifc,
            needs=("ifcopenshell", "ifc"),
        ),
    )
}


def format_for(path: str | Path) -> ModelFormat:
    """The format that this ending says. Raises UsageError, where its library is missing, too."""
    known = by_ending(path, FORMATS, "files ending in {} are not supported")
    if known.needs is not None:
        require_extra(*known.needs, f"writing {known.label}")
    return known


def check_tolerance(path: str | Path, tolerance: float | None) -> None:
    """Raises UsageError where the format is unknown, or has no cells that a tolerance would clean."""
    known = format_for(path)
    if tolerance is not None and not known.has_cells:
        raise UsageError(f"{path}: {known.label} has no polyhedral cells: it takes no tolerance")


def output_target(path: str | Path) -> Path:
    """The path, links followed, where an output will stand, of a model or another. Raises OutputFailed."""
    known = FORMATS.get(Path(path).suffix.lower())
    return writable_folder(path, known.folder) if known and known.folder else writable_target(path)


def no_step(_share: float) -> None:
    """For callers without progress."""


class ExportOptions(NamedTuple):
    """What some formats of models take. cell_size: of regular grids, and of cells beside objects;
    contour_interval: of maps; cells: of formats with the model's cells, in place of the exact ones; origin:
    the place, model coordinates, from which those of shapes count."""

    cell_size: float | Sequence[float] | None = None
    contour_interval: float | None = None
    cells: PolyhedralMesh | None = None
    origin: Sequence[float] | None = None


def write_model(
    model: ModelData, path: str | Path, outputs: Outputs, options: ExportOptions, step: Step = no_step
) -> None:
    """Writes a model in the format of the path's ending; it appears with the other outputs."""
    known = format_for(path)
    taken = zip(
        options, (known.has_cell_size, known.has_contours, known.has_cells, known.has_origin), strict=True
    )
    known.write(model, path, outputs, step, *(option for option, is_taken in taken if is_taken))


def save_model(
    model: ModelData,
    path: str | Path,
    step: Step = no_step,
    cell_size: float | Sequence[float] | None = None,
    contour_interval: float | None = None,
    tolerance: float | None = None,
) -> None:
    """Writes a model to a file, or a folder, that appears whole or not at all. cell_size: of regular grids;
    contour_interval: of maps; tolerance: of formats with the model's cells, to clean these. Raises
    UsageError."""
    check_tolerance(path, tolerance)
    cells = None if tolerance is None else cleaned_cells(model, tolerance, threads=model.threads)
    with Outputs() as outputs:
        write_model(model, path, outputs, ExportOptions(cell_size, contour_interval, cells), step)


__all__ = [
    "FORMATS",
    "ExportOptions",
    "ModelFormat",
    "check_tolerance",
    "format_for",
    "output_target",
    "save_model",
    "write_model",
]
