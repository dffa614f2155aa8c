# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheets of a surface in all compartments: from its own data where these are enough, else from the sheet
of a neighbor, shifted by the throw of the fault between them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from ...base.errors import BuildWarning, InputRefused
from ...surfaces.rock_input import RockInput, named_surfaces
from ...surfaces.surface_heights import needed_surfaces
from .borrowed import between_faults
from .families import Family, around_tips, families
from .interpolated_sheets import InterpolatedSurface
from .ready_sheets import ReadyMesh
from .throws import FEW, OWN, TAKEN, UNKNOWN, Sheets, Shift, Throws

_ROUNDS = 8  # of ties beside faults that die out; one to three are enough where points are few


class CompartmentSheets:
    """The sheets of surface `number` of a RockInput with faults, family by family. surface: its data.

    Raises InputRefused for a surface that has data in no compartment."""

    def __init__(self, entry: RockInput, number: int, surface: InterpolatedSurface | ReadyMesh):
        self.entry, self.number, self.surface = entry, number, surface
        self.every = families(entry.divided(), number)
        self.with_data = [family for family in self.every if surface.has_data(family)]
        if not self.with_data:
            raise InputRefused(
                f"its {surface.data} lie in no compartment of the rock mass",
                advice="check the coordinates of the surface and of the faults",
            )
        few: list[Family] = []
        if len(self.every) > 1:
            few = [family for family in self.with_data if surface.has_few_data(family)]
        self.few = {family.key for family in few}
        # where no other compartment shows more, few are enough
        self.own = [f for f in self.with_data if f.key not in self.few] or self.with_data
        self.made: dict[tuple[int, ...], Sheets] = {}
        self.told: set[tuple[int, ...]] = set()
        self.waited: set[tuple[int, ...]] = set()

    @property
    def waiting(self) -> list[Family]:
        return [family for family in self.every if family.key not in self.made]

    def make_own(self) -> bool:
        """Makes the sheets that its own data are enough for, once the surfaces that it needs are finished.
        Returns whether there were any."""
        unmade = [family for family in self.own if family.key not in self.made]
        if not unmade or not self._is_ready():
            return False
        with self.entry.named(self.number):
            self.made |= {family.key: self.surface.sheets(family) for family in unmade}
        return True

    def add_throws(self, throws: Throws) -> None:
        """Tells of all its sheets, and of those that only wait for the older surface from which they are to
        keep a minimum thickness: without it."""
        for family in self.every:
            if family.key in self.made and family.key not in self.told:
                self._tell(family, self.made[family.key], throws)
        rock = self.entry.rock
        if not self._is_ready() and self._is_ready(named_surfaces(rock, self.number).values()):
            assert isinstance(self.surface, InterpolatedSurface)  # a ready mesh waits for no surface
            free = self.surface.without_thickness()
            for family in self.own:
                if family.key not in self.waited:
                    self.waited.add(family.key)
                    throws.add(self.number, family, free.sheets(family), self._rank(family))

    def neighbors(self, family: Family, throws: Throws) -> list[SheetSource]:
        """From which families across one fault one without enough data may take its sheets now: those where
        the throw is known best; where it is not known the one with most data."""
        if family in self.own or not self._is_ready():
            return []
        sources = []
        for source in sorted(self.every, key=self._amount, reverse=True):
            fault = throws.fault_between(source, family) if source.key in self.made else None
            if fault is not None:
                sources.append(SheetSource(source, fault, throws.shift(self.number, fault, source, family)))
        best = min((source.rank for source in sources), default=UNKNOWN)
        return [source for source in sources if source.rank == best][: 1 if best == UNKNOWN else None]

    def borrow(self, family: Family, sources: list[SheetSource], throws: Throws) -> None:
        """Makes the sheets of a family from those of others, the first of which has most data."""
        taken = [self._from(source, family, throws) for source in sources]
        trends = taken[0]
        if len(taken) > 1:
            shapes = self.entry.divided().faults.shapes
            faults = []
            for source in sources:  # several are taken over only by their throws
                assert source.shift is not None and source.fault is not None
                side = source.family.key[source.fault]
                faults.append((source.shift.places, shapes[source.fault], side))
            trends = {}
            for sides, first in taken[0].items():
                plan = np.ascontiguousarray(first.vertices[:, :2])
                others = [sheets[sides] for sheets in taken[1:]]
                heights = [throws.heights_at(self.number, plan, self.number, sheet) for sheet in others]
                heights.insert(0, first.vertices[:, 2])
                trends[sides] = between_faults(throws.work, first, heights, faults)
            self.surface.adopt(trends, taken[0])
        with self.entry.named(self.number):
            trends = _drawn_together(self.surface, family, trends)
            self.made[family.key] = self.surface.sheets(family, trends)
        self.entry.divided().warnings.append((list(family.members), self._warning(family, sources)))

    def _from(self, source: SheetSource, family: Family, throws: Throws) -> Sheets:
        """The sheets of another family by the sides of this one, whose faults that die out may differ."""
        sheets = self.made[source.family.key]
        first = next(iter(sheets.values()))
        taken = {sides: sheets.get(sides, first) for sides in family.members.values()}
        if source.shift is not None and source.fault is not None:
            moved = throws.by_thickness(self.number, source.shift, source.fault, source.family, family, taken)
        elif source.fault is not None:
            moved = self.surface.continued(taken, family, source.family, source.fault)
        else:
            return taken
        self.surface.adopt(moved, taken)
        return moved

    def make_last(self, throws: Throws) -> None:
        """Makes the sheets of families that are across one fault from none with sheets: from the few points,
        or as the family with most data."""
        if not self._is_ready():
            return
        most = max((family for family in self.every if family.key in self.made), key=self._amount)
        for family in self.waiting:
            if family.key in self.few:
                self.made[family.key] = self.surface.sheets(family)
            else:
                self.borrow(family, [SheetSource(most)], throws)

    def _amount(self, family: Family) -> tuple:
        """By which families are compared: how many data they have."""
        return self.surface.count(family), family.key

    def finish(self) -> None:
        """Gives the compartments the sheets, once all are made; those beyond tips are drawn together."""
        structure, number = self.entry.divided(), self.number
        for family in self.every:
            for compartment, sides in family.members.items():
                structure.sheets[compartment][number] = self.made[family.key][sides]
        self._draw_together(around_tips(structure, number, self.every))
        if isinstance(self.surface, InterpolatedSurface) and self.surface.ties_at_end:
            self._tie(self.surface)
        self.surface.finish(structure.distinct(number))

    def _draw_together(self, families: list[Family]) -> bool:
        """Makes the sheets of each family equal beyond the tips of its faults; whether one changed."""
        structure, number = self.entry.divided(), self.number
        has_changed = False
        for together in families:
            sheets = {
                sides: structure.sheet(compartment, number) for compartment, sides in together.members.items()
            }
            drawn = _drawn_together(self.surface, together, sheets)
            for compartment, sides in together.members.items():
                before, after = structure.sheet(compartment, number), drawn[sides]
                structure.sheets[compartment][number] = after
                has_changed |= after is not before
                if before in self.entry.untied:
                    self.entry.untied[after] = self.entry.untied[before]
        return has_changed

    def _tie(self, surface: InterpolatedSurface) -> None:
        """Ties the sheets to their data together. So they rise or fall, and a fault that is not vertical goes
        on beyond its tip through other triangles of theirs: they are made equal there, and tied again."""
        structure, number = self.entry.divided(), self.number
        every = (*self.every, *around_tips(structure, number, self.every))
        around = [replace(family, settled=tuple(family.dying)) for family in every if family.dying]
        warnings: list[BuildWarning] = []
        for _ in range(_ROUNDS):
            before = structure.distinct(number)
            new_sheets, warnings = surface.tied(before)
            tied = dict(zip(before, new_sheets, strict=True))
            if all(after is sheet for sheet, after in tied.items()):
                break
            for compartment, sheets in enumerate(structure.sheets):
                sheets[number] = tied[structure.sheet(compartment, number)]
            if not self._draw_together(around):
                break
        every_compartment = list(range(len(structure.compartments)))
        structure.warnings += [(every_compartment, warning) for warning in warnings]

    def _is_ready(self, others: Iterable[int] | None = None) -> bool:
        """Whether the surfaces that this one needs, or some others, are finished."""
        rock = self.entry.rock
        if not rock.is_interpolated(rock.surfaces[self.number]):
            return True
        needed = needed_surfaces(rock, self.number) if others is None else others
        return all(self.entry.divided().sheets[0][other] is not None for other in needed)

    def _tell(self, family: Family, sheets: Sheets, throws: Throws) -> None:
        self.told.add(family.key)
        throws.add(self.number, family, sheets, self._rank(family))

    def _rank(self, family: Family) -> int:
        if family.key in self.few:
            return FEW
        return OWN if family in self.own else TAKEN

    def _warning(self, family: Family, sources: list[SheetSource]) -> BuildWarning:
        structure, rock = self.entry.divided(), self.entry.rock
        names = [
            structure.names[next(iter(named.members))] for named in (family, *(s.family for s in sources))
        ]
        here, *elsewhere = (f"'{name}'" for name in names)
        if family.key in self.few:
            count = self.surface.count(family)
            text = (
                f"its {count} point{'s' if count > 1 else ''} in compartment {here}, too few or on one line, "
            )
            text += f"are interpolated on the sheet of compartment {' and '.join(elsewhere)}"
        else:
            text = f"it has no {self.surface.data} in compartment {here}: it continues as in compartment "
            text += " and ".join(elsewhere)
        for source in sources:
            fault = "" if source.fault is None else f"fault '{structure.faults.names[source.fault]}'"
            if source.shift is not None:
                others = " and ".join(f"'{rock.surfaces[surface].name}'" for surface in source.shift.surfaces)
                text += f", shifted {_moved(source.shift)}, the throw of {fault} in {others}"
            elif fault:
                text += f", shifted by 0, as no other surface shows the throw of {fault} there"
            else:
                text += ", shifted by 0, as no single fault is between them"
        return BuildWarning(text, "compartment", rock.name, rock.surfaces[self.number].name)


@dataclass(frozen=True)
class SheetSource:
    """A family whose sheets another one takes over, across a fault; shift: by its throw, None where that is
    not known."""

    family: Family
    fault: int | None = None
    shift: Shift | None = None

    @property
    def rank(self) -> int:
        return UNKNOWN if self.shift is None else self.shift.rank


def make_borrowed(
    unfinished: list[CompartmentSheets], throws: Throws, finish: Callable[[CompartmentSheets], None]
) -> None:
    """Makes the sheets of all families without enough data: first those of which the throw is known best. A
    family may be reached through others. finish: is called with each surface whose sheets are all made."""
    while unfinished:
        made = [sheets for sheets in unfinished if sheets.make_own()]
        for sheets in unfinished:
            sheets.add_throws(throws)
        if not made:
            borrowable = [
                (sheets, family, sheets.neighbors(family, throws))
                for sheets in unfinished
                for family in sheets.waiting
            ]
            borrowable = [(sheets, family, sources) for sheets, family, sources in borrowable if sources]
            best = min((sources[0].rank for _, _, sources in borrowable), default=UNKNOWN)
            for sheets, family, sources in borrowable:
                if sources[0].rank == best:
                    sheets.borrow(family, sources, throws)
            if not borrowable:
                for sheets in unfinished:
                    sheets.make_last(throws)
        for sheets in unfinished:
            if not sheets.waiting:
                sheets.add_throws(throws)
                finish(sheets)
        unfinished = [sheets for sheets in unfinished if sheets.waiting]


def _moved(shift: Shift) -> str:
    """By how much a sheet is shifted along a fault."""
    along = shift.at(shift.middles) + 0.0  # no -0
    low, high = float(along.min()), float(along.max())
    if low == high == 0:
        return "by 0"
    if low < 0 < high:
        return f"by {low:.4g} to {high:.4g}"
    way, low, high = ("up", low, high) if high > 0 else ("down", abs(high), -low)
    amounts = dict.fromkeys((f"{low:.4g}", f"{high:.4g}"))
    return f"{way} by {' to '.join(amounts)}"


def _drawn_together(surface: InterpolatedSurface | ReadyMesh, family: Family, sheets: Sheets) -> Sheets:
    """Sheets by sides, equal beyond the tips; the same ones where they were."""
    drawn = surface.drawn_together(family, sheets)
    return {
        sides: sheet if np.array_equal(drawn[sides].vertices, sheet.vertices) else drawn[sides]
        for sides, sheet in sheets.items()
    }
