# SPDX-License-Identifier: GPL-3.0-or-later
"""Two triangulated surfaces intersected: their common refinement, and what it consists of (G. Mei, RealModel,
Freiburg 2014, chapter 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..base.errors import InputRefused, UsageError, place_text
from ..base.named import keyword_only
from ..base.triangles import Triangulation, checked_triangulation
from ..base.work import Cancel, NativeError, Progress, Work, refused_as, run
from ..settings.method_options import check_threads

if TYPE_CHECKING:
    from ..._native import Native

SURFACES = ("the first surface", "the second surface")  # as refusals name them
_KEPT = {
    "union": lambda a, b: a | b,
    "intersection": lambda a, b: a & b,
    "difference": lambda a, b: a & ~b,
    "reverse_difference": lambda a, b: b & ~a,
}
_ADVICE = {
    "too_close": "move one of the surfaces a little, or remove its smallest triangles",
    "too_large": "divide the surfaces into parts",
}


@dataclass(frozen=True, eq=False)
class Loop:
    """Edges along which the surfaces meet, one after another.

    kind: "hard_closed" (each vertex has two intersection edges), "soft_closed" (its first and its last vertex
    have more, and may be the same) or "open" (one of these has one alone). vertices: (N,) int32 in their
    order; of a hard closed loop the first is not repeated.
    """

    kind: str
    vertices: np.ndarray


@dataclass(frozen=True, eq=False)
class SubSurface:
    """A part of one surface that no loop divides.

    source: 0, of the first surface, or 1, of the second. triangles: (N,) int32, rows of
    `Intersection.triangles`. loops: (L,) int32, numbers of `Intersection.loops` that bound it. is_public:
    whether it lies between two sub-blocks.
    """

    source: int
    triangles: np.ndarray
    loops: np.ndarray
    is_public: bool


@dataclass(frozen=True, eq=False)
class SubBlock:
    """A bounded part of space that the surfaces enclose and none of them divides.

    triangles: (N, 3) int32, vertex numbers, closed, counter-clockwise seen from outside. volume: in cubic
    model units. in_a, in_b: whether it is inside of the first and of the second surface.
    """

    triangles: np.ndarray
    volume: float
    in_a: bool
    in_b: bool


class Intersection:
    """The common refinement of two surfaces; the arrays cannot be written to.

    vertices: (V, 3) float64. triangles: (T, 3) int32, which meet in common edges and vertices only, turned as
    those that they are part of. source: (T,) uint8, 0 of the first surface, 1 of the second.
    source_triangle: (T,) int32, the row of that surface's triangles. Where the surfaces coincide, both have
    triangles with the same corners.
    """

    def __init__(self, refinement: Native.Refinement):
        self._native = refinement
        self.vertices: np.ndarray = refinement.vertices
        self.triangles: np.ndarray = refinement.triangles
        self.source: np.ndarray = refinement.source
        self.source_triangle: np.ndarray = refinement.source_triangle
        first, second = refinement.is_closed
        self.is_closed: tuple[bool, bool] = first, second

    @cached_property
    def loops(self) -> list[Loop]:
        """The lines along which the surfaces meet."""
        return [Loop(*entry) for entry in self._native.loops]

    @cached_property
    def sub_surfaces(self) -> list[SubSurface]:
        """The parts that these lines divide both surfaces into."""
        return [SubSurface(*entry) for entry in self._native.sub_surfaces]

    @cached_property
    def sub_blocks(self) -> list[SubBlock]:
        """The parts of space that both surfaces enclose."""
        return [SubBlock(*entry) for entry in self._native.sub_blocks]

    def union(self) -> Triangulation:
        """The volume inside either surface or both: vertices (N, 3) float64 and triangles (M, 3) int32 of its
        boundary, counter-clockwise seen from outside. Raises InputRefused where a surface is open."""
        return self._solid("union")

    def intersection(self) -> Triangulation:
        """The volume inside both surfaces; as `union`."""
        return self._solid("intersection")

    def difference(self) -> Triangulation:
        """The volume inside the first surface and outside the second; as `union`."""
        return self._solid("difference")

    def reverse_difference(self) -> Triangulation:
        """The volume inside the second surface and outside the first; as `union`."""
        return self._solid("reverse_difference")

    def boundary(self, operation: str) -> tuple[np.ndarray, np.ndarray]:
        """The source of the triangles of `union()` and the others: rows (M,) of `triangles`, and (M,) bool,
        whether each is reversed. operation: the name of the method. Raises InputRefused where a surface is
        open, UsageError for another name."""
        if operation not in _KEPT:
            raise UsageError(f"operation must be one of {', '.join(_KEPT)}, not {operation!r}")
        for number in range(2):
            if not self.is_closed[number]:
                raise self._open(number)
        inside = self._native.is_in
        below, above = (_KEPT[operation](inside[:, 0, side], inside[:, 1, side]) for side in (0, 1))
        is_first = self._native.coinciding == np.arange(len(self.triangles))
        rows = np.flatnonzero(is_first & (below != above))
        return rows, above[rows]

    def sides(self, part: SubSurface, number: int) -> tuple[bool, bool]:
        """Whether a part of `sub_surfaces` is inside of the first (number 0) or second (1) surface, below it
        and above it.
        These differ where it lies on that surface."""
        below, above = self._native.is_in[part.triangles[0], number].tolist()
        return below, above

    def rows_of(self, block: int) -> tuple[np.ndarray, np.ndarray]:
        """The rows (N,) of `triangles` that the triangles of a sub-block are, and (N,) bool, whether each is
        turned around."""
        return self._block_rows[block]

    @cached_property
    def _block_rows(self) -> list[tuple[np.ndarray, np.ndarray]]:
        first = np.flatnonzero(self._native.coinciding == np.arange(len(self.triangles)))
        of_blocks = np.concatenate([block.triangles for block in self.sub_blocks])
        corners = np.sort(np.concatenate([self.triangles[first], of_blocks]), axis=1)
        _, same = np.unique(corners, axis=0, return_inverse=True)
        same = same.ravel()
        row = np.empty(len(corners), np.int64)
        row[same[: len(first)]] = first
        rows = row[same[len(first) :]]
        is_turned = _from_least(of_blocks)[:, 1] != _from_least(self.triangles[rows])[:, 1]
        ends = np.cumsum([len(block.triangles) for block in self.sub_blocks])[:-1]
        return list(zip(np.split(rows, ends), np.split(is_turned, ends), strict=True))

    def _solid(self, operation: str) -> Triangulation:
        rows, is_turned = self.boundary(operation)
        triangles = self.triangles[rows]
        triangles[is_turned] = triangles[is_turned][:, [0, 2, 1]]
        is_used = np.zeros(len(self.vertices), bool)
        is_used[triangles] = True
        number = np.cumsum(is_used, dtype=np.int32) - 1
        return Triangulation(self.vertices[is_used], number[triangles])

    def _open(self, number: int) -> InputRefused:
        edges, uses = self._border(number)
        place = tuple(self.vertices[edges[0]].mean(axis=0).tolist())
        if (uses % 2 == 0).all():
            what = f"its triangles face both ways, for example near {place_text(place)}"
            advice = "turn them so that all face outward"
        else:
            what = f"it is open, for example near {place_text(place)}"
            advice = "close it, or divide the surfaces: only solids can be joined and taken from one another"
        return InputRefused(what, item=SURFACES[number], advice=advice, place=place)

    def _border(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """(E, 2) edges that the triangles of a surface pass more often one way than the other, and how often
        they pass each (E,)."""
        triangles = self.triangles[self.source == number]
        edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        forward = edges[:, 0] < edges[:, 1]
        edges, same, uses = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
        net = np.bincount(same.ravel(), np.where(forward, 1, -1), len(edges))
        return edges[net != 0], uses[net != 0]


def _from_least(triangles: np.ndarray) -> np.ndarray:
    """The same triangles, each rotated to begin with its smallest vertex."""
    order = (triangles.argmin(axis=1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(triangles, order, axis=1)


@keyword_only
def intersect(
    a: Sequence[ArrayLike],
    b: Sequence[ArrayLike],
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Intersection:
    """Intersects two triangulated surfaces, open or closed.

    a, b: (vertices, triangles) each; vertices (V, 3) of finite numbers, triangles (T, 3) of whole numbers.
    They may consist of several parts, cross themselves, touch and coincide. A point is inside a closed
    surface if its winding number is not zero. A region covered twice is inside, once. A component turned
    inside out is a hole in another component, and a solid if it is alone. threads: 0, all processors.
    progress(fraction, text), cancel() -> True to stop: called from this thread.

    Decisions are exact on the given coordinates, except for features thinner than rounding
    (docs/dev/exactness.md); new vertices are rounded to doubles, and no triangles cross after that. The
    result is the same for any number of threads.

    Raises InputRefused (with the numbers of the triangles and a place), UsageError, Cancelled, BuildFailed.

    >>> level = [[0, 0, 1], [4, 0, 1], [0, 4, 1]], [[0, 1, 2]]
    >>> upright = [[1, -1, 0], [1, 5, 0], [1, 2, 4]], [[0, 1, 2]]
    >>> found = intersect(level, upright)
    >>> len(found.triangles), [loop.kind for loop in found.loops]
    (8, ['open'])
    """
    threads = check_threads(threads)
    return run(lambda work: intersect_within(work, a, b), progress, cancel, threads=threads)


def intersect_within(
    work: Work, a: Sequence[ArrayLike], b: Sequence[ArrayLike], share: float = 1.0
) -> Intersection:
    """`intersect` as the first part of a job, which takes this share of its progress."""
    first, second = _checked(a, 0), _checked(b, 1)
    with work.phase(0.0, share, "intersecting"), refused_as(_refused) as native:
        return Intersection(work.native(native.intersect, *first, *second))


def _checked(surface: Sequence[ArrayLike], number: int) -> tuple[np.ndarray, np.ndarray]:
    try:
        vertices, triangles = surface
    except (TypeError, ValueError) as error:
        raise UsageError(f"{SURFACES[number]} must be (vertices, triangles)") from error
    try:
        return checked_triangulation(vertices, triangles)
    except InputRefused as error:
        raise error.within(SURFACES[number]) from error


def _refused(error: NativeError) -> InputRefused:
    place = tuple(error.place) if error.place is not None else None
    near = f" near {place_text(place)}" if place else ""
    return InputRefused(
        f"{error}{near}",
        item=SURFACES[error.surface] if error.surface in (0, 1) else "the intersection",
        advice=_ADVICE.get(error.kind),
        place=place,
    )
