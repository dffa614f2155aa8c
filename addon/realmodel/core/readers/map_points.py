# SPDX-License-Identifier: GPL-3.0-or-later
"""Points with heights from files of shapes: spot heights, contour lines, traces of an outcrop."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..base.errors import HeightsMissing, InputRefused, counted
from ..base.mapped_arrays import JoinPieces, in_memory
from ..base.text import Step, no_step
from ..settings.map_layer import MapLayer
from ..settings.point_file import PointFile
from .map_input import read_shapes
from .maps.shapes import Heights


def read_map_points(
    given: PointFile, step: Step = no_step, gather: JoinPieces = in_memory
) -> tuple[np.ndarray, list[str]]:
    """(P, 3) float64, in the file's unit: its points, and the corners of its lines and polygons; and
    warnings, sentences. gather: where the points are kept. Raises InputRefused naming the file and the
    feature."""
    file = Path(given.file)
    missing = [float(value) for value in given.nodata_values if not isinstance(value, str)]
    shapes = read_shapes(MapLayer(file, given.layer, given.where), step=step, heights=Heights(given.height))
    places = [point[None] for _, point in shapes.points] + [line for _, line in shapes.lines]
    places += [ring for polygon in shapes.polygons for ring in polygon.rings]
    if not sum(map(len, places)):
        raise InputRefused("there are no points in it", file=file)
    positions = np.concatenate(places)
    with_height = positions[np.isfinite(positions[:, 2]) & ~np.isin(positions[:, 2], missing)]
    points = gather([with_height], np.empty((0, 3)))
    if not len(points):
        what = "its positions have no height"
        if given.height is not None:
            what = f"attribute '{given.height}' has no heights"
        advice = 'name the attribute with the height: height = "ELEVATION"'
        raise HeightsMissing(what, file=file, advice=advice if given.height is None else None)
    left_out = len(positions) - len(points)
    warnings = [f"{file}: left out: {counted(left_out, 'point')} without a value"] if left_out else []
    return points, warnings
