# SPDX-License-Identifier: GPL-3.0-or-later
"""Points with heights from files of shapes: spot heights, contour lines, traces of an outcrop."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import HeightsMissing, InputRefused
from ..map_layer import MapLayer
from ..point_file import PointFile
from .map_input import read_shapes
from .shapes import Heights
from .text import Step, no_step


def read_map_points(given: PointFile, step: Step = no_step) -> tuple[np.ndarray, list[str]]:
    """(P, 3) float64, in the file's unit: its points, and the corners of its lines and polygons; and
    warnings, sentences. Raises InputRefused naming the file and the feature."""
    file = Path(given.file)
    shapes = read_shapes(MapLayer(file, given.layer, given.where), step=step, heights=Heights(given.height))
    parts = [np.atleast_2d(point) for _, point in shapes.points]
    parts += [line for _, line in shapes.lines]
    parts += [ring for polygon in shapes.polygons for ring in polygon.rings]
    points = np.concatenate(parts) if parts else np.empty((0, 3))
    if not len(points):
        raise InputRefused("there are no points in it", file=file)
    missing = [float(value) for value in given.nodata_values if not isinstance(value, str)]
    known = np.isfinite(points[:, 2]) & ~np.isin(points[:, 2], missing)
    if not known.any():
        what = "its positions have no height"
        if given.height is not None:
            what = f"attribute '{given.height}' has no heights"
        advice = 'name the attribute with the height: height = "ELEVATION"'
        raise HeightsMissing(what, file=file, advice=advice if given.height is None else None)
    left_out = int(len(points) - known.sum())
    warnings = [f"{file}: {left_out} points have no value and are left out"] if left_out else []
    return points[known], warnings
