# SPDX-License-Identifier: GPL-3.0-or-later
"""The uncertainty of the volumes of blocks that follows from interpolated heights."""

from __future__ import annotations

import numpy as np

from ..base.work import native_module
from ..cells.model_data import ModelData
from ..settings.variogram import lacks_deviation


def volume_deviations(model: ModelData) -> np.ndarray:
    """(B,) float64: what the standard deviation of each block's volume is at most, model units cubed; NaN
    where no surface of known variance bounds the block, or one whose data show no variogram.

    The error of a volume is the sum of the errors of heights over the block's contacts. Its standard
    deviation is largest where all these errors are alike: then it is the integral of the standard deviation
    over the contacts (Cauchy and Schwarz), which is what is summed here; errors that differ from place to
    place cancel out in part. Assumed: variances are right (the variogram holds), and errors are small enough
    that the same contacts remain. Ready meshes and walls count as exact.
    """
    deviations = np.full(len(model.blocks), np.nan)
    if not len(model.face_vertices):
        return deviations
    area, middle = plan_areas(model), _middles(model)
    sides = model.face_blocks
    for number in range(len(model.surface_names)):
        variance = model.surface_attributes(number)["variance"]
        faces = np.flatnonzero((model.face_surface == number) & (sides[:, 0] != sides[:, 1]))
        if not np.isfinite(variance).any() or not len(faces):
            continue
        vertices, _ = model.surface(number)
        deviation = np.sqrt(np.maximum(np.nan_to_num(variance), 0.0))
        shape = np.column_stack([vertices[:, :2], deviation])
        places = np.ascontiguousarray(middle[faces])
        sheets = [
            np.nan_to_num(native_module().surface_heights(shape, triangles, places))
            for triangles in model.sheet_triangles(number)
        ]
        here = np.max(sheets, axis=0)  # of the sheets of a surface that faults displace
        for side in sides[faces].T:
            inside = side >= 0
            blocks = side[inside]
            deviations[np.unique(blocks)] = np.nan_to_num(deviations[np.unique(blocks)])
            deviations += np.bincount(blocks, (here * area[faces])[inside], len(deviations))
    deviations[without_deviation(model)] = np.nan
    return deviations


def without_deviation(model: ModelData) -> np.ndarray:
    """(B,) bool: the blocks that a surface bounds whose data show no variogram, so that nothing says how much
    their volumes vary."""
    missing = missing_deviations(model)
    lacking = [number for number, name in enumerate(model.surface_names) if name in missing]
    sides = model.face_blocks[np.isin(model.face_surface, lacking)]
    sides = sides[sides[:, 0] != sides[:, 1]]
    return np.isin(np.arange(len(model.blocks)), sides)


def missing_deviations(model: ModelData) -> dict[str, str]:
    """By the names of the surfaces whose data show no variogram (in some compartment): what is missing."""
    return {
        note.surface: note.text for note in model.warnings if note.surface and lacks_deviation([note.text])
    }


def plan_areas(model: ModelData, faces: np.ndarray | None = None) -> np.ndarray:
    """(F,) float64: the areas of a model's faces, or of some of them by their numbers, seen from above."""
    offsets, corners = model.face_offsets, model.face_vertices
    if faces is not None:
        offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    if not len(corners):
        return np.zeros(0)
    x, y = _plan(model, corners)
    first, last = offsets[:-1], offsets[1:] - 1
    doubled = x * _next(y, first, last) - y * _next(x, first, last)
    return np.abs(np.add.reduceat(doubled, first)) / 2


def _middles(model: ModelData) -> np.ndarray:
    """(F, 2) float64: the mean of the corners of each face in plan."""
    first, counts = model.face_offsets[:-1], np.diff(model.face_offsets)
    x, y = (np.add.reduceat(values, first) / counts for values in _plan(model, model.face_vertices))
    return np.column_stack([x, y]) + model.vertices[0, :2]


def _plan(model: ModelData, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x and y of corners, relative to the first vertex."""
    plan = model.vertices[:, :2] - model.vertices[:1, :2]
    x, y = (np.ascontiguousarray(plan[:, axis])[corners] for axis in range(2))
    return x, y


def _next(values: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """For each corner of polygons the value at the next corner."""
    following = np.empty_like(values)
    following[:-1] = values[1:]
    following[last] = values[first]
    return following
