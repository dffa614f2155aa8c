# SPDX-License-Identifier: GPL-3.0-or-later
"""Windows in plan that stand for a whole rock mass: the surfaces' triangles over a few squares.

What is counted in a window is scaled by triangles: those of the whole over those in the window. Each
triangle, face and cell counts for the window that its reference point (the mean of its corners in plan)
lies in, so nothing is counted in part, and what the torn edge of the sample makes is left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

TRIANGLES_PER_WINDOW = 3_000
FEWEST_OF_A_SURFACE = 150  # in a window
_STRATA = (4, 2)  # one window in each of so many parts with equally many triangles, along x and then along y
_MARGIN = {"columns": 1.0, "blocks": 2.0}  # triangles wide: blocks tell apart by tiles what crosses
_WHOLE_BELOW = 60_000  # triangles: a rock mass so small is its own sample
_CENTRES_LOOKED_AT = 100_000
_PRODUCTS_AT_ONCE = 4_000_000

Plan = tuple[np.ndarray, np.ndarray]  # vertices (V, 2 or 3) float64, triangles (T, 3) int32


@dataclass(frozen=True)
class Window:
    """A rectangle in plan: low <= place < high. What is built for it reaches further by a margin, so that the
    sample's torn edge divides nothing that counts."""

    low: np.ndarray
    high: np.ndarray
    margin: float = 0.0

    def holds(self, places: np.ndarray) -> np.ndarray:
        """(N,) bool: which places (N, 2) lie in it."""
        return ((places >= self.low) & (places < self.high)).all(axis=1)

    def overlapping(self, plan: Plan) -> np.ndarray:
        """The numbers of the triangles whose bounding boxes meet the window and its margin."""
        vertices, triangles = plan
        low, high = self.low - self.margin, self.high + self.margin
        x, y = vertices[:, 0], vertices[:, 1]
        # outcodes as in Cohen and Sutherland's clipping: beyond which sides a vertex lies
        code = (x < low[0]).astype(np.uint8)
        code |= (x > high[0]).astype(np.uint8) << 1
        code |= (y < low[1]).astype(np.uint8) << 2
        code |= (y > high[1]).astype(np.uint8) << 3
        beyond = code[triangles[:, 0]] & code[triangles[:, 1]] & code[triangles[:, 2]]
        return np.flatnonzero(beyond == 0)


def everything() -> Window:
    return Window(np.full(2, -np.inf), np.full(2, np.inf))


def sample_windows(
    plans: Sequence[Plan], rings: Sequence[np.ndarray] | None, cells: str = "columns"
) -> tuple[list[Window], float]:
    """The windows of a rock mass, and how many triangles of its surfaces lie inside its region.

    plans: the triangulation of each surface. rings: the region's, counted even-odd, or None.
    Windows stand round triangles drawn by lot, one in each of eight parts with equally many of them, the
    same on every run; each holds about TRIANGLES_PER_WINDOW of all surfaces together. A small rock mass has
    one window, which holds everything.
    """
    total = sum(len(triangles) for _, triangles in plans)
    random = np.random.default_rng(total)
    centres = np.concatenate(
        [
            _centres(plan, random.integers(0, len(plan[1]), 1 + _CENTRES_LOOKED_AT * len(plan[1]) // total))
            for plan in plans
            if len(plan[1])
        ]
    )
    inside = np.ones(len(centres), bool) if rings is None else within_rings(centres, rings)
    used = total * float(inside.mean())
    if used <= _WHOLE_BELOW:
        return [everything()], used
    centres = centres[inside]
    wanted = max(TRIANGLES_PER_WINDOW, FEWEST_OF_A_SURFACE * len(plans))
    windows = []
    for stratum in _strata(centres):
        number = random.choice(stratum)
        distance = np.abs(centres - centres[number]).max(axis=1)
        rank = min(len(centres) - 1, round(len(centres) * wanted / used))
        reach = np.partition(distance, rank)[rank]
        triangle = 2 * reach * np.sqrt(2 * len(plans) / wanted)  # its size, where all surfaces are alike
        margin = _MARGIN[cells] * triangle
        windows.append(Window(centres[number] - reach, centres[number] + reach, margin))
    return windows, used


def _strata(centres: np.ndarray) -> list[np.ndarray]:
    """The numbers of the centres by parts of the plan that hold equally many."""
    columns = np.array_split(np.argsort(centres[:, 0], kind="stable"), _STRATA[0])
    return [
        column[part]
        for column in columns
        for part in np.array_split(np.argsort(centres[column, 1], kind="stable"), _STRATA[1])
    ]


def _centres(plan: Plan, numbers) -> np.ndarray:
    vertices, triangles = plan
    return vertices[triangles[numbers], :2].mean(axis=1)


def triangles_in(window: Window, plan: Plan, rings: Sequence[np.ndarray] | None) -> int:
    """How many triangles have their reference point in the window and in the region."""
    centres = _centres(plan, slice(None))
    centres = centres[window.holds(centres)]
    return len(centres) if rings is None else int(within_rings(centres, rings).sum())


def cut_out(plan: Plan, numbers: np.ndarray) -> Plan:
    """The triangles of these numbers with the vertices that they use."""
    vertices, triangles = plan
    used, corners = np.unique(triangles[numbers], return_inverse=True)
    return np.ascontiguousarray(vertices[used]), corners.reshape(-1, 3).astype(np.int32)


def within_rings(places: np.ndarray, rings: Sequence[np.ndarray]) -> np.ndarray:
    """(N,) bool: places that a ray to the east crosses an odd number of the rings' edges from."""
    starts = np.concatenate(rings)
    ends = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    inside = np.empty(len(places), bool)
    rows = max(1, _PRODUCTS_AT_ONCE // len(starts))
    for first in range(0, len(places), rows):
        x, y = places[first : first + rows, 0, None], places[first : first + rows, 1, None]
        spans = (starts[:, 1] > y) != (ends[:, 1] > y)
        rise = np.where(ends[:, 1] == starts[:, 1], 1.0, ends[:, 1] - starts[:, 1])
        crossed = spans & (x < starts[:, 0] + (y - starts[:, 1]) * (ends[:, 0] - starts[:, 0]) / rise)
        inside[first : first + rows] = crossed.sum(axis=1) % 2 == 1
    return inside


@dataclass(frozen=True)
class Counts:
    """What lies in a window of a built sample: cells, faces, corners of faces, vertices."""

    cells: float = 0.0
    faces: float = 0.0
    corners: float = 0.0
    vertices: float = 0.0

    def __add__(self, other: Counts) -> Counts:
        return Counts(*(a + b for a, b in zip(self.values(), other.values(), strict=True)))

    def times(self, factor: float) -> Counts:
        return Counts(*(factor * value for value in self.values()))

    def values(self) -> tuple[float, float, float, float]:
        return self.cells, self.faces, self.corners, self.vertices


def counted(built: dict, window: Window, cells: str) -> Counts:
    """Counts of a native result within a window. Where cells are whole blocks, those that lie inside it are
    counted, each weighted by how rarely a window of this size would hold one of its extent (Miles 1974)."""
    plan = built["vertices"][:, :2]
    if not len(built["face_cells"]):
        return Counts()
    size = np.diff(built["face_offsets"])
    corners = plan[built["face_vertices"]]
    sums = np.add.reduceat(corners, built["face_offsets"][:-1], axis=0)
    here = window.holds(sums / size[:, None])
    found = Counts(0.0, float(here.sum()), float(size[here].sum()), float(window.holds(plan).sum()))
    if cells == "blocks":
        return found + Counts(_whole_cells(built, window, corners))
    middle = np.zeros((len(built["cell_block"]), 2))
    sides = np.zeros(len(middle))
    for column in (0, 1):
        cell = built["face_cells"][:, column]
        there = cell >= 0
        sides += np.bincount(cell[there], size[there], len(sides))
        for axis in (0, 1):
            middle[:, axis] += np.bincount(cell[there], sums[there, axis], len(sides))
    return found + Counts(float(window.holds(middle / sides[:, None]).sum()))


def _whole_cells(built: dict, window: Window, corners: np.ndarray) -> float:
    """How many cells there are for a window, judged by those that lie wholly inside it."""
    count = len(built["cell_block"])
    if not np.isfinite(window.low).all():
        return float(count)
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    starts = built["face_offsets"][:-1]
    face_low = np.minimum.reduceat(corners, starts, axis=0)
    face_high = np.maximum.reduceat(corners, starts, axis=0)
    for column in (0, 1):
        cell = built["face_cells"][:, column]
        there = cell >= 0
        np.minimum.at(low, cell[there], face_low[there])
        np.maximum.at(high, cell[there], face_high[there])
    whole = ((low > window.low) & (high < window.high)).all(axis=1)
    extent = window.high - window.low
    return float(np.prod(extent / (extent - (high - low)[whole]), axis=1).sum())
