# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of a surface that is read: its points and contacts, bounds and dips, each with its source."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ...project.project import Surface
from ...readers.tables.observations import Bounds, Origin, source_text
from ...settings.dips import Dips
from ...settings.methods import METHODS

Sources = dict[int, tuple[Origin, ...]]  # by the rows of points; several of one at the place of several holes
MOST_CONTACTS = 10_000  # points of a surface; more are a survey, which a mesh need not resolve


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceData:
    """points: (P, 3) float64, model units, that a surface goes through: its own and picks in the order of
    their coordinates, then the contacts that follow from observations. contacts_from: how many are no such
    contacts. sources: of picks and contacts. bounds: heights that it lies at or above, or at or below.
    dips: all that count for it, those of the surface first. error: the mean variance of the errors of the
    heights of its points. has_only_bound_points: no contact is known of it, and its points are places on
    its bounds. rows: (contacts_from,) int64, the numbers that points had in their file or array, for
    messages; None: these."""

    points: np.ndarray = field(default_factory=lambda: np.empty((0, 3)))
    contacts_from: int = 0
    sources: Sources = field(default_factory=dict)
    bounds: Bounds = field(default_factory=lambda: Bounds.at_or_above(np.empty((0, 3))))
    dips: Dips | None = None
    error: float = 0.0
    has_only_bound_points: bool = False
    rows: np.ndarray | None = None

    @property
    def own(self) -> np.ndarray:
        """(O, 3) the points that are no contacts from observations."""
        return self.points[: self.contacts_from]

    @property
    def contacts(self) -> np.ndarray:
        """(C, 3) the contacts that follow from observations."""
        return self.points[self.contacts_from :]

    @property
    def measured_points(self) -> np.ndarray:
        """(P, 3) the points that are known to be on the surface: not places on its bounds."""
        return self.points[:0] if self.has_only_bound_points else self.points

    def tied_points(self, surface: Surface) -> np.ndarray:
        """(C, 3) the points that a surface which ties passes through: all, but none of a grid or of so many
        that they are a survey of the surface. Both are finer than a planar mesh should be."""
        has_contacts = METHODS[surface.method_options()[0]].has_contacts
        return self.points if has_contacts and len(self.points) <= MOST_CONTACTS else self.points[:0]

    def row(self, number: int) -> int:
        """The number that a point had in the table or array that it comes from, for messages."""
        return number if self.rows is None or number >= len(self.rows) else int(self.rows[number])

    @property
    def picks(self) -> Sources:
        """The sources of the points that are no contacts."""
        return {row: origins for row, origins in self.sources.items() if row < self.contacts_from}

    def source(self, number: int) -> Origin:
        """That of a point, the first of several."""
        return self.sources.get(number, (Origin(),))[0]

    def source_text(self, number: int) -> str:
        """Where a point comes from, for messages: its hole with the depth, or its place."""
        hole, depth, *_ = self.source(number)
        return source_text(hole, np.nan if depth is None else depth, self.points[number])

    def some(self, chosen: np.ndarray) -> SurfaceData:
        """The same with some of the points, (P,) bool."""
        is_pick = chosen[: self.contacts_from]
        rows = np.arange(len(is_pick)) if self.rows is None else self.rows
        number = np.cumsum(chosen) - 1
        return replace(
            self,
            points=self.points[chosen],
            contacts_from=int(is_pick.sum()),
            sources={int(number[row]): origins for row, origins in self.sources.items() if chosen[row]},
            rows=rows[is_pick],
        )

    def through(self, points: np.ndarray) -> SurfaceData:
        """The same with other points (P, 3), which have no sources."""
        return replace(self, points=points, contacts_from=len(points), sources={}, rows=None)
