# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of stacks: RealModel beside its peers, in one run.

Each measurement is a process of its own. What is compared is measured in pairs whose order alternates, and
the ratio given is the median of the pairs' ratios, so that a machine that others use shifts both alike.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable
from dataclasses import dataclass, field

from . import peers
from .made_stacks import StackSpec
from .process import Skipped, alone

Measure = Callable[[], dict]

SIZES = {100: "10 x 20,000", 300: "10 x 180,000", 700: "10 x 980,000"}
# Pairs by quads: what is short is measured more often. Two at least, so that each side is first as often: on
# virtual machines memory that nobody had for a while comes from the host, 2 s a GB; the second finds it.
_GROWTH = {60: 5, 100: 5, 300: 4, 700: 2}
_SECONDS = 900.0
_SAME_VOLUME = 1e-6
_MOST_MEMORY = 12e9  # of the largest stack
_MANIFOLD = "Manifold"


@dataclass
class Row:
    """One comparison. What was not measured is None, and `notes` says why.

    must, goal: the ratio that is asked for, and the one that would be better still. memory: bytes that ours
    may take at most, None where nothing is asked.
    """

    work: str
    peer: str
    must: float
    goal: float
    memory: float | None = None
    ours: float | None = None
    theirs: float | None = None
    ratio: float | None = None
    our_peak: int | None = None
    their_peak: int | None = None
    notes: list[str] = field(default_factory=list)

    @property
    def met(self) -> bool | None:
        if self.ratio is None:
            return None
        return self.ratio <= self.must and (self.memory is None or self.our_peak <= self.memory)


@dataclass(frozen=True)
class Limits:
    """What the run may take: larger sizes than `triangles` in all are left out, processes that come to more
    than `memory` bytes are ended."""

    triangles: int
    memory: float
    threads: int = 2
    pairs: int | None = None

    def allow(self, spec: StackSpec) -> None:
        """Raises Skipped for a stack that is too large for this run."""
        if spec.triangles * spec.surfaces > self.triangles:
            raise Skipped("not in a quick run")


def compared(row: Row, ours: Measure, theirs: Measure, pairs: int) -> Row:
    """Measures pairs in alternating order into the row."""
    found: list[tuple[dict, dict]] = []
    try:
        for number in range(pairs):
            if number % 2:
                other = theirs()
                found.append((ours(), other))
            else:
                mine = ours()
                row.ours, row.our_peak = mine["seconds"], mine["peak"]
                found.append((mine, theirs()))
    except Skipped as skipped:
        row.notes.append(str(skipped))
    if found:
        row.ours = statistics.median(mine["seconds"] for mine, _ in found)
        row.theirs = statistics.median(other["seconds"] for _, other in found)
        row.ratio = statistics.median(mine["seconds"] / other["seconds"] for mine, other in found)
        row.our_peak = max(mine["peak"] for mine, _ in found)
        row.their_peak = max(other["peak"] for _, other in found)
        mine, other = found[0]
        if row.peer == _MANIFOLD:  # the same blocks
            apart = abs(mine["volume"] - other["volume"]) / abs(other["volume"])
            if apart > _SAME_VOLUME:
                row.notes.append(f"volumes differ by {apart:.1e}")
    return row


class StackRows:
    """Makes the rows one after another; `tell` hears of each when it is there."""

    def __init__(self, limits: Limits, tell: Callable[[Row], None]):
        self.limits, self.tell = limits, tell

    def all(self) -> list[Row]:
        makers = (self.against_manifold, self.against_blender, self.against_cgal, self.against_ourselves)
        return [row for maker in makers for row in maker()]

    def _ours(
        self, spec: StackSpec, cells: str, threads: int | None = None, base: float | None = None
    ) -> Measure:
        def measure() -> dict:
            self.limits.allow(spec)
            threads_given = self.limits.threads if threads is None else threads
            return alone(
                "ours.stack",
                vars(spec),
                cells,
                threads_given,
                base,
                seconds=_SECONDS,
                memory=self.limits.memory,
            )

        return measure

    def _pairs(self, quads: int) -> int:
        return self.limits.pairs or _GROWTH[quads]

    def _done(self, row: Row) -> Row:
        self.tell(row)
        return row

    def against_manifold(self):
        marks = {100: (1.5, 1 / 2), 300: (1.5, 1 / 2), 700: (1.0, 1 / 3)}
        for quads, size in SIZES.items():
            own, shared = StackSpec(10, quads), StackSpec(10, quads, "shared")
            cases = [
                (f"{size}, all cells", own, "columns", *marks[quads]),
                (f"{size} on one plan mesh, all cells", shared, "columns", 1 / 2, 1 / 6),
                (f"{size}, blocks", own, "blocks", 1 / 3, 1 / 8),
                (f"{size} on one plan mesh, blocks", shared, "blocks", 1 / 3, 1 / 8),
            ]
            for work, spec, cells, must, goal in cases:

                def theirs(spec=spec) -> dict:
                    return alone("peers.manifold", vars(spec), seconds=_SECONDS, memory=self.limits.memory)

                row = Row(work, _MANIFOLD, must, goal)
                compared(row, self._ours(spec, cells), theirs, self._pairs(quads))
                if cells == "blocks":
                    row.memory = row.their_peak
                elif quads == max(SIZES):
                    row.memory = _MOST_MEMORY
                yield self._done(row)

    def against_blender(self):
        for quads, pairs in ((100, 5), (400, 1)):
            spec = StackSpec(2, quads, "shared", "half")
            work = f"two layers, {2 * quads * quads + 8 * quads:,} triangles each, coinciding over half"

            def theirs(spec=spec) -> dict:
                # its work grows like that of a stack many times as large
                self.limits.allow(StackSpec(10 * spec.surfaces, spec.quads))
                return peers.blender(spec, "EXACT", _SECONDS, self.limits.memory)

            row = Row(work, "Blender, Boolean EXACT", 1 / 50, 1 / 150)
            ours = self._ours(spec, "columns", base=-5.0)
            yield self._done(compared(row, ours, theirs, self.limits.pairs or pairs))

    def against_cgal(self):
        for surfaces, seconds in ((3, 180.0), (6, 180.0), (10, 180.0)):
            spec = StackSpec(surfaces, 100)

            def theirs(spec=spec, seconds=seconds) -> dict:
                self.limits.allow(StackSpec(spec.surfaces, 3 * spec.quads) if spec.surfaces > 3 else spec)
                return peers.cgal(spec, seconds, self.limits.memory)

            row = Row(f"{surfaces} x 20,000, all cells", "CGAL, exact corefinement of all pairs", 1.0, 1 / 10)
            yield self._done(compared(row, self._ours(spec, "columns"), theirs, self.limits.pairs or 3))

    def against_ourselves(self):
        """Comparisons of RealModel with itself: growth, degenerate input, threads."""
        smallest, largest = (
            StackSpec(10, 60),
            StackSpec(10, 700 if self.limits.triangles >= 9_800_000 else 100),
        )
        generic, lattice = StackSpec(10, 300), StackSpec(10, 300, "lattice", "steps")
        few, many = StackSpec(10, 100), StackSpec(40, 100)
        cases = [
            ("40 x 20,000", many, "10 x 20,000", few, 5.0, 4.0, 1, None),
            ("lattice, heights 0 .. 3, 10 x 180,000", lattice, "10 x 180,000", generic, 3.0, 1.0, 1, None),
            ("two threads, 10 x 180,000", generic, "one thread", generic, 1 / 1.7, 1 / 1.9, 1, 1),
            ("two threads, 10 x 20,000", few, "one thread", few, 1 / 1.7, 1 / 1.9, 3, 1),
        ]
        for work, spec, other, base, must, goal, pairs, threads in cases:
            row = Row(work, f"RealModel, {other}", must, goal)
            theirs = self._ours(base, "columns", threads)
            yield self._done(compared(row, self._ours(spec, "columns"), theirs, pairs))
        for cells in ("columns", "blocks"):
            work = f"10 x {largest.triangles:,}, {cells}, for each triangle"
            row = Row(work, f"RealModel, 10 x {smallest.triangles:,}", 1.5, 1.0)
            compared(row, self._ours(largest, cells), self._ours(smallest, cells), 1)
            if row.ratio is not None:
                row.ratio *= smallest.triangles / largest.triangles
            yield self._done(row)
