# SPDX-License-Identifier: GPL-3.0-or-later
"""Models read from their .npz files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import BuildWarning, InputRefused
from ..base.work import Work
from ..cells.blocks import blocks_of_arrays
from ..cells.cell_complex import CellComplex
from ..cells.model_data import ModelData
from ..cells.model_record import RECORD, read_record, without_record
from ..readers.npz import read_npz
from ..surfaces.surface_input import SurfaceArrays

_READ = 0.9  # of the time
# Rows, type and columns (0: one-dimensional) of each array: rows as another array has them, or plus one.
_ARRAYS: dict[str, tuple[str, str, int]] = {
    "vertices": ("", "f8", 3),
    "face_offsets": ("face_cells+1", "i8", 0),
    "face_vertices": ("", "i4", 0),
    "face_cells": ("", "i4", 2),
    "face_surface": ("face_cells", "i4", 0),
    "cell_block": ("", "i4", 0),
    "cell_compartment": ("cell_block", "i4", 0),
    "block_names": ("", "U", 0),
    "block_rock": ("block_names", "i4", 0),
    "block_surface": ("block_names", "i4", 0),
    "block_property": ("block_names", "i4", 0),
    "block_volume": ("block_names", "f8", 0),
    "block_cells": ("block_names", "i8", 0),
    "block_components": ("block_names", "i8", 0),
    "surface_vertices": ("", "f8", 3),
    "surface_triangles": ("", "i4", 3),
    "surface_vertex_offsets": ("surface_names+1", "i8", 0),
    "surface_triangle_offsets": ("surface_names+1", "i8", 0),
    "surface_kind": ("surface_names", "i4", 0),
    "surface_triangle_sheet": ("surface_triangles", "i4", 0),
    "surface_variance": ("surface_vertices", "f8", 0),
    "surface_distance": ("surface_vertices", "f8", 0),
    "surface_names": ("", "U", 0),
    "compartment_names": ("", "U", 0),
    "rock_names": ("", "U", 0),
}
_LACKS_PROJECT = (
    "the file is of RealModel 0.1, or a tile, and lacks the project: regions, rules, base elevations, and "
    "how surfaces were made; build it from its project and save it again"
)
_AGAIN = "save the model again, or build it from its project"


def read_model(work: Work, path: Path) -> ModelData:
    """The model of an .npz that Model.save has written. Raises InputRefused, which names the file."""
    try:
        with work.phase(0.0, _READ, "reading"):
            arrays = read_npz(path, work.step)
    except OSError as error:
        what = f"cannot be read: {error.strerror or error}"
        raise InputRefused(what, file=path, advice="check the path") from error
    except ValueError as error:
        what = f"not an .npz file, or a damaged one: {error}"
        raise InputRefused(what, file=path, advice="choose a model that Model.save wrote") from error
    lacking = [name for name in ("cell_kind", *_ARRAYS) if name not in arrays]
    if lacking:
        what = f"not a model of RealModel: it has no array '{lacking[0]}'"
        raise InputRefused(what, file=path, advice="choose a model that Model.save wrote")
    with work.phase(_READ, 1.0, "assembling the model"):
        try:
            _check(arrays)
            return _model(arrays, path, work.threads)
        except InputRefused:
            raise
        except (ValueError, KeyError, IndexError) as error:
            raise InputRefused(f"a damaged model: {error}", file=path, advice=_AGAIN) from error


def _model(arrays: Mapping[str, np.ndarray], path: Path, threads: int) -> ModelData:
    surfaces = SurfaceArrays.of_arrays(arrays)
    if RECORD in arrays:
        recorded: dict[str, Any] = read_record(arrays, surfaces)
    else:
        recorded = without_record(arrays, surfaces, path.stem)
        recorded |= {"lacks_project": path, "warnings": [BuildWarning(_LACKS_PROJECT, "file")]}
    model = ModelData(
        CellComplex.of(arrays, str(arrays["cell_kind"])),
        blocks_of_arrays(arrays),
        surfaces,
        surface_names=arrays["surface_names"].tolist(),
        surface_kind=arrays["surface_kind"],
        cell_compartment=arrays["cell_compartment"],
        compartment_names=arrays["compartment_names"].tolist(),
        threads=threads,
        **recorded,
    )
    _check_record(model, arrays["rock_names"].tolist())
    return model


def _check(arrays: Mapping[str, np.ndarray]) -> None:
    """Raises ValueError where arrays are not as docs/dev/geometry.md has them, or name what is not there."""
    if arrays["cell_kind"].shape != () or str(arrays["cell_kind"]) not in ("columns", "blocks"):
        raise ValueError("cell_kind is neither columns nor blocks")
    for name, (rows, kind, columns) in _ARRAYS.items():
        array = arrays[name]
        is_kind = array.dtype.kind == "U" if kind == "U" else array.dtype == np.dtype(kind)
        if not is_kind or array.shape[1:] != ((columns,) if columns else ()) or not array.ndim:
            raise ValueError(f"{name} has the type {array.dtype} and the shape {array.shape}")
        other, _, more = rows.partition("+")
        if other and len(array) != len(arrays[other]) + bool(more):
            raise ValueError(f"{name} has {len(array)} rows")
    if not (np.isfinite(arrays["vertices"]).all() and np.isfinite(arrays["surface_vertices"]).all()):
        raise ValueError("a coordinate is not a finite number")
    for name, of in (
        ("face_offsets", "face_vertices"),
        ("surface_vertex_offsets", "surface_vertices"),
        ("surface_triangle_offsets", "surface_triangles"),
    ):
        offsets = arrays[name]
        if offsets[0] != 0 or offsets[-1] != len(arrays[of]) or (np.diff(offsets) < 0).any():
            raise ValueError(f"{name} do not ascend to the length of {of}")
    sizes = np.diff(arrays["surface_vertex_offsets"])
    counts = np.repeat(sizes, np.diff(arrays["surface_triangle_offsets"]))
    triangles = arrays["surface_triangles"]
    if (triangles < 0).any() or (triangles.max(axis=1, initial=-1) >= counts).any():
        raise ValueError("surface_triangles name vertices that do not exist")
    for name, least, of in (
        ("face_vertices", 0, "vertices"),
        ("face_cells", -1, "cell_block"),
        ("face_surface", -3, "surface_names"),
        ("cell_block", 0, "block_names"),
        ("block_rock", 0, "rock_names"),
        ("block_surface", 0, "surface_names"),
        ("cell_compartment", 0, "compartment_names"),
    ):
        numbers = arrays[name]
        if numbers.size and not least <= numbers.min() <= numbers.max() < len(arrays[of]):
            raise ValueError(f"{name} has numbers that are not of {of}")
    kinds = arrays["surface_kind"]
    if (arrays["face_cells"][:, 0] < 0).any() or not np.isin(kinds, (0, 1, 2)).all():
        raise ValueError("face_cells has faces of no cell, or surface_kind another number than 0, 1, 2")


def _check_record(model: ModelData, rocks: list[str]) -> None:
    """Raises ValueError where the record is of another model than the arrays."""
    inputs, structures = model.rock_inputs, model.structures
    kinds = np.repeat(
        [0, 1, 2],
        [sum(len(entry.surfaces) for entry in inputs), len(structures.faults), len(structures.bodies)],
    )
    names = [surface.name for rock in model.project.rocks for surface in rock.surfaces] + structures.names
    has_all = all(
        len(rock.surfaces) == len(entry.surfaces) == len(entry.interpolations) == len(entry.file_faces)
        for rock, entry in zip(model.project.rocks, inputs, strict=True)
    )
    if not (
        has_all
        and [rock.name for rock in model.project.rocks] == rocks
        and names == model.surface_names
        and np.array_equal(kinds, model.surface_kind)
    ):
        raise ValueError("its project is that of another model")
