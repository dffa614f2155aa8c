# SPDX-License-Identifier: GPL-3.0-or-later
"""The input and the result of a method, and its options that refer to another surface."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ..base.errors import InputRefused
from ..base.triangles import Sheet
from ..base.work import Arguments, Work, native_module
from ..base.work import Result as Value
from ..notebook import ShortRepr
from ..readers.tables.observations import Bounds
from ..settings.dips import Dips
from ..settings.method_options import OptionRefused
from ..settings.variogram import Variogram
from .companions import Alike, Companions


@dataclass(frozen=True, repr=False)
class Interpolation(ShortRepr):
    """z (N,) heights, NaN where there are none; variance (N,) of the error, NaN where it is not known, None
    where the method gives none, or the data show no variogram; the method used; the variogram, None where the
    method has none; warnings, sentences about the points.

    extrapolated: share of the nodes that lie outside the convex hull of the points, or outside a grid.
    reason: why a method was chosen, where "auto" chose it. neighbours: how many points at most counted at a
    node, 0 for all, where kriging did it.
    """

    z: np.ndarray
    variance: np.ndarray | None
    method: str
    variogram: Variogram | None
    warnings: tuple[str, ...] = ()
    extrapolated: float = 0.0
    reason: str = ""
    neighbours: int | None = None


@dataclass(frozen=True)
class Task:
    """The input of a method: points (P, 3) without contradictions, nodes (N, 2), the complete settings of the
    method, and the triangles (T, 3) of the nodes' mesh or None. left_out: each point is to be estimated from
    the others, and there are no nodes. surfaces: others by name, (vertices (V, 3), triangles (T, 3)). dips:
    of the surface, no two at one position, or None. bounds: heights that it lies above or below, or None.
    companions: the sheets of its series, with which it is interpolated together, or None. alike: the surfaces
    whose heights vary as its own do, which count for its variogram, or None. true_thickness: the
    thickness above the surface that it is parallel to is measured perpendicular to that. ties: it is tied to
    its points afterwards. error: the mean variance of the errors of the points' heights."""

    work: Work
    points: np.ndarray
    nodes: np.ndarray
    settings: dict
    triangles: np.ndarray | None = None
    left_out: bool = False
    surfaces: Mapping[str, Sheet] = field(default_factory=dict)
    dips: Dips | None = None
    bounds: Bounds | None = None
    companions: Companions | None = None
    alike: Alike | None = None
    true_thickness: bool = False
    ties: bool = False
    error: float = 0.0

    def run(
        self, function: Callable[Arguments, Value], *arguments: Arguments.args, **options: Arguments.kwargs
    ) -> Value:
        """A native function."""
        return self.work.native(function, *arguments, **options)


@dataclass
class Result:
    """z, variance and variogram as in Interpolation. outside: (N,) bool, the nodes that are extrapolated,
    where the method knows better than the points' hull. neighbours: as in Interpolation."""

    z: np.ndarray
    variance: np.ndarray | None = None
    variogram: Variogram | None = None
    warnings: list[str] = field(default_factory=list)
    outside: np.ndarray | None = None
    neighbours: int | None = None


Reference = float | str | np.ndarray | tuple[np.ndarray, np.ndarray]


def heights_of(task: Task, reference: Reference, places: np.ndarray, option: str) -> np.ndarray:
    """(N,) heights of a reference at places, NaN where it has none. Heights at the nodes (N,) can be asked at
    the nodes only, or elsewhere where the nodes have triangles."""
    if isinstance(reference, float):
        return np.full(len(places), reference)
    if isinstance(reference, np.ndarray) and places is task.nodes:
        return _of_nodes(task, reference, option)
    vertices, triangles = _triangulated(task, reference, option)
    if places is task.nodes and len(vertices) == len(places) and np.array_equal(vertices[:, :2], places):
        return vertices[:, 2].copy()  # on one mesh: not a bit is lost
    return task.run(native_module().surface_heights, vertices, triangles, np.ascontiguousarray(places))


def sheet_of(task: Task, reference: Reference, option: str) -> Sheet | None:
    """The triangles of a reference; None where it is a height."""
    return None if isinstance(reference, float) else _triangulated(task, reference, option)


def _of_nodes(task: Task, heights: np.ndarray, option: str) -> np.ndarray:
    if len(heights) != len(task.nodes):
        raise OptionRefused(
            f"'{option}' has {len(heights)} elevations for {len(task.nodes)} nodes", option=option
        )
    return heights


def _triangulated(task: Task, reference: Reference, option: str) -> Sheet:
    """The triangles of a surface that is referred to."""
    if isinstance(reference, str):
        if reference not in task.surfaces:
            raise OptionRefused(
                f"'{option}' names surface '{reference}', which does not exist",
                option=option,
                advice="outside a project give vertices and triangles",
            )
        return task.surfaces[reference]
    if isinstance(reference, np.ndarray):
        heights = _of_nodes(task, reference, option)
        if task.triangles is None:
            raise InputRefused(
                f"'{option}' is known at the nodes only, and they have no triangles", item=option
            )
        finite = np.isfinite(heights)[task.triangles].all(axis=1)
        vertices = np.column_stack([task.nodes, heights])
        return Sheet(vertices, np.ascontiguousarray(task.triangles[finite]))
    assert not isinstance(reference, float)
    return Sheet(*reference)
