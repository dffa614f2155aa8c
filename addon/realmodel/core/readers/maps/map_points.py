# SPDX-License-Identifier: GPL-3.0-or-later
"""Points with heights from files of shapes: spot heights, contour lines, traces of an outcrop."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np

from ...base.errors import HeightsMissing, InputRefused
from ...base.mapped_arrays import Gather, in_memory
from ...base.text import LINES_AT_ONCE, Step, no_step
from ...settings.map_layer import MapLayer
from ...settings.point_file import PointFile
from .map_input import shapes_in_turn
from .shapes import Heights, Shapes


def read_map_points(
    given: PointFile, step: Step = no_step, gather: Gather = in_memory
) -> tuple[np.ndarray, list[str]]:
    """(P, 3) float64, in the file's unit: its points, and the corners of its lines and polygons; and
    warnings, sentences. gather: where the points are kept. Raises InputRefused naming the file and the
    feature."""
    file = Path(given.file)
    missing = [float(value) for value in given.nodata_values if not isinstance(value, str)]
    count = 0

    def known(pieces: Iterable[np.ndarray]) -> Iterator[np.ndarray]:
        nonlocal count
        count = 0
        for piece in pieces:
            count += len(piece)
            yield piece[np.isfinite(piece[:, 2]) & ~np.isin(piece[:, 2], missing)]

    try:
        points = gather(known(_places(given, step, list(_KINDS))), np.empty((0, 3)))
    except _SeveralKinds:
        pieces = (piece for kind in _KINDS for piece in _places(given, step, [kind]))
        points = gather(known(pieces), np.empty((0, 3)))
    if not count:
        raise InputRefused("there are no points in it", file=file)
    if not len(points):
        what = "its positions have no height"
        if given.height is not None:
            what = f"attribute '{given.height}' has no heights"
        advice = 'name the attribute with the height: height = "ELEVATION"'
        raise HeightsMissing(what, file=file, advice=advice if given.height is None else None)
    left_out = count - len(points)
    warnings = [f"{file}: {left_out} points have no value and are left out"] if left_out else []
    return points, warnings


_KINDS: dict[str, Callable[[Shapes], list[np.ndarray]]] = {  # in the order in which they are read
    "points": lambda shapes: [point[None] for _, point in shapes.points],
    "lines": lambda shapes: [line for _, line in shapes.lines],
    "polygons": lambda shapes: [ring for polygon in shapes.polygons for ring in polygon.rings],
}


class _SeveralKinds(Exception):
    """Shapes of several kinds, and too many to put them in order in memory."""


def _places(given: PointFile, step: Step, kinds: list[str]) -> Iterator[np.ndarray]:
    """The positions (N, 3) of shapes of these kinds, some at a time. Raises _SeveralKinds."""
    waiting: dict[str, list[np.ndarray]] = {kind: [] for kind in kinds}
    count = 0
    had: set = set()

    def some() -> np.ndarray:
        had.update(kind for kind in kinds if waiting[kind])
        found = np.concatenate([places for kind in kinds for places in waiting[kind]])
        for each in waiting.values():
            each.clear()
        return found

    layer = MapLayer(Path(given.file), given.layer, given.where)
    for shapes in shapes_in_turn(layer, step, Heights(given.height)):
        if count >= LINES_AT_ONCE:
            yield some()
            count = 0
        for kind, places_of in _KINDS.items():
            if kind in waiting:
                places = places_of(shapes)
                waiting[kind] += places
                count += sum(map(len, places))
            getattr(shapes, kind).clear()
        if len(had.union(kind for kind in kinds if waiting[kind])) > 1 and had:
            raise _SeveralKinds
    if count:
        yield some()
