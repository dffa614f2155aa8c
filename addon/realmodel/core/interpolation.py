# SPDX-License-Identifier: GPL-3.0-or-later
"""Heights of a surface at given places, from scattered points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .errors import InputRefused, UsageError, place_text
from .methods import DEFAULT_NEIGHBOURS, check_threads, checked_options
from .mis_ties import without_mis_ties
from .work import Cancel, Progress, Work, native_module, run


@dataclass(frozen=True)
class Variogram:
    """gamma(h) = nugget + (sill - nugget) f(h / range), 0 at h = 0; the sill includes the nugget.

    `model` is spherical, exponential, gaussian, cubic, matern32 or matern52; `range` is the practical range
    in model units, `sill` and `nugget` are in units of height squared. Where it was fitted to points,
    `lags` (L,), `gamma` (L,) and `pairs` (L,) are the experimental semivariogram; else they are None.
    """

    model: str
    range: float
    sill: float
    nugget: float = 0.0
    lags: np.ndarray | None = field(default=None, compare=False, repr=False)
    gamma: np.ndarray | None = field(default=None, compare=False, repr=False)
    pairs: np.ndarray | None = field(default=None, compare=False, repr=False)

    @property
    def fitted(self) -> bool:
        return self.lags is not None

    def settings(self) -> dict:
        """As a project file writes it."""
        return {"model": self.model, "range": self.range, "sill": self.sill, "nugget": self.nugget}


@dataclass(frozen=True)
class Interpolation:
    """z (N,) heights; variance (N,) of the error, None where the method gives none; the method used;
    the variogram, None where the method has none; warnings, sentences about the points."""

    z: np.ndarray
    variance: np.ndarray | None
    method: str
    variogram: Variogram | None
    warnings: tuple[str, ...] = ()


def interpolate(
    points,
    nodes,
    method: str = "kriging",
    triangles=None,
    neighbours: int = DEFAULT_NEIGHBOURS,
    threads: int = 0,
    *,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    **options,
) -> Interpolation:
    """Interpolates scattered points at nodes.

    points: (P, 3) float64, model units. nodes: (N, 2). method: "kriging" (ordinary; options variogram =
    {model, range, sill, nugget}, fitted to the points where it is left out, and anisotropy = {ratio,
    azimuth}; Matheron 1963, Isaaks and Srivastava 1989, chapter 12) or "idw" (option power; Shepard 1968).
    triangles: (T, 3) of the nodes' mesh; neither of these methods needs them.
    neighbours: the nearest in plan that make a node's system, 0 for all points. threads: 0 for all.

    Points at one place count once; where their heights differ a little (mis-ties of measured lines, up to
    a twentieth of the whole height range) the mean is taken, with a warning, and larger ones are refused.

    Raises InputRefused for points or options that make no sense, UsageError for a wrong call, Cancelled.
    """
    points = checked_points(points)
    nodes = np.ascontiguousarray(_array(nodes, 2, "nodes"))
    if not np.isfinite(nodes).all():
        raise InputRefused(f"node {_first_bad(nodes)} is not finite", item="nodes")
    settings = checked_options(method, {"neighbours": neighbours, **options})
    threads = check_threads(threads)
    if triangles is not None and np.shape(triangles)[1:] != (3,):
        raise UsageError(f"triangles must be an array (T, 3), not {np.shape(triangles)}")

    def task(work: Work) -> Interpolation:
        with work.phase(0.0, 1.0, "interpolating"):
            return heights(work, points, nodes, method, settings, threads)

    return run(task, progress, cancel)


def checked_points(points, item: str = "points") -> np.ndarray:
    """(P, 3) float64 points, at least one, all finite. Raises InputRefused."""
    points = np.ascontiguousarray(_array(points, 3, item))
    if not len(points):
        raise InputRefused("there are no points", item=item)
    if not np.isfinite(points).all():
        bad = _first_bad(points)
        raise InputRefused(f"point {bad} is {place_text(points[bad])}, not finite", item=item)
    return points


def _array(values, columns: int, item: str) -> np.ndarray:
    try:
        array = np.asarray(values, np.float64)
    except (TypeError, ValueError) as error:
        raise InputRefused("not an array of numbers", item=item) from error
    if array.ndim != 2 or array.shape[1] != columns:
        raise InputRefused(f"must be an array (N, {columns}), not {array.shape}", item=item)
    return array


def _first_bad(array: np.ndarray) -> int:
    return int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])


def heights(work: Work, points, nodes, method: str, settings: dict, threads: int) -> Interpolation:
    """interpolate within a work that is already running, from checked arrays and complete settings."""
    native = native_module()
    points, mis_ties = without_mis_ties(points)
    warnings = (mis_ties,) if mis_ties else ()
    try:
        if method == "idw":
            z = work.native(native.idw, points, nodes, **settings, threads=threads)
            return Interpolation(z, None, method, None, warnings)
        anisotropy = {f"anisotropy_{key}": value for key, value in settings["anisotropy"].items()}
        given = settings["variogram"]
        if given is None:
            given = work.native(native.fit_variogram, points, **anisotropy)
        variogram = Variogram(**given)
        z, variance = work.native(
            native.krige,
            points,
            nodes,
            **variogram.settings(),
            neighbours=settings["neighbours"],
            **anisotropy,
            threads=threads,
        )
        return Interpolation(z, variance, method, variogram, warnings)
    except native.InputError as error:
        raise InputRefused(str(error), item="points", place=error.place) from error
