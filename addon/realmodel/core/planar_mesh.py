# SPDX-License-Identifier: GPL-3.0-or-later
"""The planar mesh of a region, on whose vertices surfaces are interpolated."""

from __future__ import annotations

import math

import numpy as np

from .errors import InputRefused, UsageError, place_text
from .region_rings import region_rings
from .work import Cancel, Progress, Work, native_module, run

MESHERS = ("delaunay",)


def mesh_region(
    outline,
    holes=(),
    edge_length: float | None = None,
    mesher: str = "delaunay",
    *,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Meshes a region in plan by constrained Delaunay refinement.

    outline: (N, 2) corners in model units, in either direction, not repeated at the end (a repeated
    corner is dropped). holes: outlines inside; all rings count even-odd. edge_length: the edge that
    triangles should have, model units. Returns vertices (V, 2) float64 and triangles (T, 3) int32,
    counter-clockwise; the border is the outline, subdivided.

    Raises InputRefused where the rings cross or touch in a way that bounds no region, or where the mesh
    would not fit the memory; Cancelled.
    """
    if mesher not in MESHERS:
        raise UsageError(f"mesher {mesher!r} is not there; use 'delaunay'")
    if (
        isinstance(edge_length, bool)
        or not isinstance(edge_length, (int, float, np.integer, np.floating))
        or not (math.isfinite(edge_length) and edge_length > 0)
    ):
        raise InputRefused(f"edge_length must be a finite number above 0, not {edge_length!r}")
    rings = region_rings(outline, holes)

    def task(work: Work) -> tuple[np.ndarray, np.ndarray]:
        with work.phase(0.0, 1.0, "meshing"):
            return mesh_rings(work, rings, float(edge_length), mesher)

    return run(task, progress, cancel)


def mesh_rings(work: Work, rings: list[np.ndarray], edge_length: float, mesher: str):
    """mesh_region within a work that is already running, from checked rings."""
    native = native_module()
    try:
        return work.native(native.mesh_region, rings, edge_length, mesher)
    except native.InputError as error:
        raise refused_region(error) from error


def triangulate_rings(rings: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The region of checked rings in as few triangles as there are, without further vertices."""
    native = native_module()
    try:
        return native.triangulate_rings(rings)
    except native.InputError as error:
        raise refused_region(error) from error


def refused_region(error) -> InputRefused:
    """The refusal of a region that the native part found fault with."""
    place = tuple(error.place[:2]) if error.place is not None else None
    what = str(error)
    if place is not None and "(" not in what:
        what = f"{what} at {place_text(place)}"
    return InputRefused(what, item="region", place=place)
