# SPDX-License-Identifier: GPL-3.0-or-later
"""Heights of a surface at given places, from scattered points."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import ascending
from ..base.device import check_device, on_device
from ..base.errors import InputRefused, UsageError, place_text
from ..base.mapped_arrays import ROWS_AT_ONCE, in_pieces
from ..base.named import keyword_only
from ..base.work import Cancel, Progress, Work, run
from ..readers.tables.observations import Bounds
from ..settings.dips import Dips
from ..settings.method_options import OptionRefused, check_threads
from ..settings.methods import METHODS, check_method, checked_options
from . import Interpolation, Task, heights


@keyword_only
def interpolate(
    points: ArrayLike | None,
    nodes: ArrayLike,
    method: str = "kriging",
    triangles: ArrayLike | None = None,
    neighbours: int | None = None,
    *,
    threads: int = 0,
    device: str = "cpu",
    dips: Dips | None = None,
    bounds: Bounds | None = None,
    true_thickness: bool = False,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    **options: Any,
) -> Interpolation:
    """Interpolates scattered points at nodes.

    points: (P, 3) float64, model units; None for a method that does without. nodes: (N, 2).
    method and its options: docs/reference/methods.md.
    triangles: (T, 3) of the nodes' mesh, where the method works on it.
    neighbours: the nearest in plan that count at a node, 0 for all points; None for the method's own number,
    16, or 32 for kriging with a variogram that is fitted. threads: 0 for all.
    device: as of `build`, for ordinary kriging from at most 96 neighbors; a warning is in `warnings`.
    dips, bounds: slopes of the surface, and heights that it lies above or below, for methods that use them.
    true_thickness: the thickness of "parallel" is measured perpendicular to the other surface.

    Points at one place count once; where their heights differ a little (mis-ties of measured lines, up to
    a twentieth of the whole height range) the mean is taken, with a warning, and larger ones are refused.

    Raises InputRefused for points or options that make no sense, UsageError for a wrong call, Cancelled.

    >>> points = [[0, 0, 1], [4, 0, 5], [4, 4, 5], [0, 4, 1]]
    >>> interpolate(points, [[2, 2], [3, 1]], method="tin").z
    array([3., 4.])
    """
    settings = method_settings(method, neighbours, options)
    if points is not None or METHODS[method].needs_points(settings):
        data = checked_points(points)
        data = data[ascending(*data.T)]  # the order of rows must not decide a result
    else:
        data = np.empty((0, 3))
    nodes = checked_nodes(nodes)
    threads = check_threads(threads)
    check_device(device)
    triangles = checked_triangles(triangles, len(nodes))
    dips = None if dips is None else dips.checked()

    if true_thickness and method != "parallel":
        raise OptionRefused(
            f"'true_thickness' has no effect with method '{method}'",
            option="true_thickness",
            advice='use method "parallel"',
        )

    def task(work: Work) -> Interpolation:
        with work.phase(0.0, 1.0, "interpolating"), on_device(work, device) as warnings:
            whole = Task(work, data, nodes, settings, triangles, dips=dips, bounds=bounds)
            made = heights(method, replace(whole, true_thickness=true_thickness))
        return replace(made, warnings=(*made.warnings, *map(str, warnings)))

    return run(task, progress, cancel, threads=threads)


def method_settings(method: str, neighbours: int | None, options: dict) -> dict:
    """The complete settings of a method from a caller's arguments. Raises InputRefused."""
    check_method(method)
    if neighbours is not None:
        options = {"neighbours": neighbours, **options}
    return checked_options(method, options)


def checked_triangles(triangles: ArrayLike | None, nodes: int) -> np.ndarray | None:
    """(T, 3) int32 triangles of a mesh, checked against the number of its nodes. Raises UsageError."""
    if triangles is None:
        return None
    if np.shape(triangles)[1:] != (3,):
        raise UsageError(f"triangles must be an array (T, 3), not {np.shape(triangles)}")
    triangles = np.asarray(triangles)
    if not np.issubdtype(triangles.dtype, np.integer):
        raise UsageError(f"triangles must be whole numbers, not {triangles.dtype}")
    if triangles.size and (triangles.min() < 0 or triangles.max() >= nodes):
        raise UsageError(f"triangles must name nodes from 0 to {nodes - 1}")
    return np.ascontiguousarray(triangles, np.int32)


def checked_points(points: ArrayLike | None, item: str = "points") -> np.ndarray:
    """(P, 3) float64 points, at least one, all finite. Raises InputRefused."""
    points = np.ascontiguousarray(_array(points, 3, item))
    if not len(points):
        raise InputRefused("there are no points", item=item)
    bad = _first_bad(points)
    if bad is not None:
        raise InputRefused(f"point {bad} is {place_text(points[bad])}, not finite", item=item)
    return points


def checked_nodes(nodes: ArrayLike) -> np.ndarray:
    """(N, 2) float64 nodes, all finite. Raises InputRefused."""
    nodes = np.ascontiguousarray(_array(nodes, 2, "nodes"))
    bad = _first_bad(nodes)
    if bad is not None:
        raise InputRefused(f"node {bad} is not finite", item="nodes")
    return nodes


def _array(values: ArrayLike | None, columns: int, name: str) -> np.ndarray:
    try:
        array = np.asarray(values, np.float64)
    except (TypeError, ValueError) as error:
        raise InputRefused("not an array of numbers", item=name) from error
    if array.ndim != 2 or array.shape[1] != columns:
        raise InputRefused(f"must be an array (N, {columns}), not {array.shape}", item=name)
    return array


def _first_bad(array: np.ndarray) -> int | None:
    """The first row that is not finite."""
    for number, piece in enumerate(in_pieces(array)):
        finite = np.isfinite(piece).all(axis=1)
        if not finite.all():
            return number * ROWS_AT_ONCE + int(np.flatnonzero(~finite)[0])
    return None
