# SPDX-License-Identifier: GPL-3.0-or-later
"""The model's arrays in NumPy's .npz, always the same bytes for the same model."""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Iterable
from typing import IO, BinaryIO

import numpy as np

from ..cells.model_data import ModelData, UsedSurfaces
from ..cells.model_record import record_arrays

_FIRST_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that zip files know: no time of writing in the bytes
_HEADER = 1024  # more than any header of an array


def model_arrays(model: ModelData) -> dict[str, np.ndarray]:
    """The arrays of docs/dev/geometry.md by name, and what describes blocks, surfaces and rock masses."""
    blocks = model.blocks
    return {
        "vertices": model.vertices,
        "face_offsets": model.face_offsets,
        "face_vertices": model.face_vertices,
        "face_cells": model.face_cells,
        "face_surface": model.face_surface,
        "cell_block": model.cell_block,
        "cell_kind": np.array(model.cell_kind),
        "block_names": texts(block.name for block in blocks),
        "block_rock": np.array([block.rock for block in blocks], np.int32),
        "block_surface": np.array([block.surface for block in blocks], np.int32),
        "block_property": np.array([block.property for block in blocks], np.int32),
        "block_volume": np.array([block.volume for block in blocks], np.float64),
        "block_cells": np.array([block.cells for block in blocks], np.int64),
        "block_components": np.array([block.components for block in blocks], np.int64),
        "surface_vertices": model.surface_vertices,
        "surface_triangles": model.surface_triangles,
        "surface_vertex_offsets": model.surface_vertex_offsets,
        "surface_triangle_offsets": model.surface_triangle_offsets,
        "surface_kind": model.surface_kind,
        "surface_triangle_sheet": model.surface_triangle_sheet,
        "cell_compartment": model.cell_compartment,
        "compartment_names": texts(model.compartment_names),
        **{f"surface_{name}": joined_attributes(model, name) for name in ("variance", "distance")},
        "surface_names": texts(model.surface_names),
        "rock_names": texts(rock.name for rock in model.project.rocks),
    }


def joined_attributes(model: UsedSurfaces, name: str) -> np.ndarray:
    """(Vs,) float64: an attribute of the vertices of all surfaces, one surface after another."""
    attributes = [model.surface_attributes(number)[name] for number in range(len(model.surface_names))]
    return np.concatenate([np.empty(0), *attributes])


def texts(given: Iterable[str]) -> np.ndarray:
    """(N,) fixed-width text."""
    given = list(given)
    return np.array(given) if given else np.empty(0, "<U1")


def write_npz(model: ModelData, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes the model's arrays, and its record: what it was built from."""
    write_arrays({**model_arrays(model), **record_arrays(model)}, file, step)


def write_arrays(
    arrays: dict[str, np.ndarray], file: BinaryIO, step: Callable[[float], None] | None = None
) -> None:
    """Writes arrays as numpy.savez does, with a fixed date in place of the clock's."""
    total = sum(array.nbytes for array in arrays.values()) or 1
    done = 0
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            entry = zipfile.ZipInfo(f"{name}.npy", _FIRST_DATE)
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            entry.file_size = array.nbytes + _HEADER  # zipfile decides by it on 64-bit sizes
            with archive.open(entry, "w") as opened:
                _write_array(opened, array)
            done += array.nbytes
            if step is not None:
                step(done / total)


def _write_array(file: IO[bytes], array: np.ndarray) -> None:
    content = np.ascontiguousarray(array).reshape(array.shape)
    np.lib.format.write_array(file, content, version=(1, 0), allow_pickle=False)
