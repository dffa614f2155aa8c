# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheets of a surface in all compartments: from its own data where these are enough, else from the sheet of
a neighbor, shifted by the throw of the fault between them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from ..build_warning import BuildWarning
from ..errors import InputRefused
from ..project import Rock, surface_item
from ..surface_heights import named_surfaces, needed_surfaces
from .families import Family, around_tips, families
from .interpolated_sheets import InterpolatedSurface
from .ready_sheets import ReadyMesh
from .throws import FEW, OWN, TAKEN, UNKNOWN, Sheets, Shift, Throws


class CompartmentSheets:
    """The sheets of surface `number` of a RockInput with faults, family by family. surface: its data.

    Raises InputRefused for a surface that has data in no compartment."""

    def __init__(self, entry, number: int, surface: InterpolatedSurface | ReadyMesh):
        self.entry, self.number, self.surface = entry, number, surface
        self.every = families(entry.structure, number)
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
        own = [family for family in self.own if family.key not in self.made]
        if not own or not self._is_ready():
            return False
        self.made |= {family.key: self.surface.sheets(family) for family in own}
        return True

    def tell(self, throws: Throws) -> None:
        """Tells of all its sheets, and of those that only wait for the older surface from which they are to
        keep a minimum thickness: without it."""
        for family in self.every:
            if family.key in self.made and family.key not in self.told:
                self._tell(family, self.made[family.key], throws)
        rock = self.entry.rock
        if not self._is_ready() and self._is_ready(named_surfaces(rock, self.number).values()):
            free = self.surface.without_thickness()
            for family in self.own:
                if family.key not in self.waited:
                    self.waited.add(family.key)
                    throws.tell(self.number, family, free.sheets(family), self._rank(family))

    def neighbors(self, family: Family, throws: Throws) -> list[Borrowing]:
        """From which families across one fault one without enough data may take its sheets now."""
        if family in self.own or not self._is_ready():
            return []
        found = []
        for source in self.every:
            fault = throws.fault_between(source, family) if source.key in self.made else None
            if fault is not None:
                shift = throws.shift(self.number, fault, source, family)
                found.append(Borrowing(self, family, source, fault, shift))
        return found

    def borrow(self, borrowing: Borrowing, throws: Throws) -> None:
        """Makes the sheets of a family from those of another one."""
        family, source, shift = borrowing.family, borrowing.source, borrowing.shift
        sheets = self.made[source.key]
        first = next(iter(sheets.values()))
        taken = {sides: sheets.get(sides, first) for sides in family.members.values()}
        if shift is not None:
            shift = throws.corrected(shift, self.number, borrowing.fault, source, family, taken)
            taken = self.surface.shifted(taken, shift)
        trends = _drawn_together(self.surface, family, taken)
        self.made[family.key] = self.surface.sheets(family, trends)
        self.entry.structure.warnings.append((list(family.members), borrowing.warning()))

    def make_last(self, throws: Throws) -> None:
        """Makes the sheets of families that are across one fault from none with sheets: from the few points,
        or as the family with most data."""
        if not self._is_ready():
            return
        most = max((family for family in self.every if family.key in self.made), key=self.amount)
        for family in self.waiting:
            if family.key in self.few:
                self.made[family.key] = self.surface.sheets(family)
            else:
                self.borrow(Borrowing(self, family, most), throws)

    def amount(self, family: Family) -> tuple:
        """By which families are compared: how many data they have."""
        return self.surface.count(family), family.key

    def finish(self) -> None:
        """Gives the compartments the sheets, once all are made; those beyond tips are drawn together."""
        structure, number = self.entry.structure, self.number
        for family in self.every:
            for compartment, sides in family.members.items():
                structure.sheets[compartment][number] = self.made[family.key][sides]
        for together in around_tips(structure, number, self.every):
            sheets = {sides: structure.sheets[each][number] for each, sides in together.members.items()}
            drawn = _drawn_together(self.surface, together, sheets)
            for compartment, sides in together.members.items():
                structure.sheets[compartment][number] = drawn[sides]
        self.surface.finish(structure.distinct(number))

    def _is_ready(self, others: Iterable[int] | None = None) -> bool:
        """Whether the surfaces that this one needs, or some others, are finished."""
        rock = self.entry.rock
        if not rock.surfaces[self.number].interpolated:
            return True
        needed = needed_surfaces(rock, self.number) if others is None else others
        return all(self.entry.structure.sheets[0][other] is not None for other in needed)

    def _tell(self, family: Family, sheets: Sheets, throws: Throws) -> None:
        self.told.add(family.key)
        throws.tell(self.number, family, sheets, self._rank(family))

    def _rank(self, family: Family) -> int:
        if family.key in self.few:
            return FEW
        return OWN if family in self.own else TAKEN


@dataclass(frozen=True)
class Borrowing:
    """Sheets of a family that are to be made from those of another one, `source`, across a fault; shift: by
    its throw, None where that is not known."""

    of: CompartmentSheets
    family: Family
    source: Family
    fault: int | None = None
    shift: Shift | None = None

    @property
    def rank(self) -> int:
        return UNKNOWN if self.shift is None else self.shift.rank

    def warning(self) -> BuildWarning:
        structure, rock = self.of.entry.structure, self.of.entry.rock
        surfaces, own = rock.surfaces, self.of.surface
        here, there = (structure.names[next(iter(each.members))] for each in (self.family, self.source))
        if self.family.key in self.of.few:
            count = own.count(self.family)
            text = (
                f"its {count} points in compartment '{here}' do not show its shape there" if count > 1 else
                f"its point in compartment '{here}' does not show its shape there"
            )
            text += f": they are interpolated on the sheet of compartment '{there}'"
        else:
            text = f"it has no {own.data} in compartment '{here}': there it goes on as in compartment '{there}'"
        if self.shift is not None:
            names = " and ".join(f"'{surfaces[each].name}'" for each in self.shift.surfaces)
            text += f", shifted {_moved(self.shift)}, by the throw of fault "
            text += f"'{structure.faults.names[self.fault]}' in {names}"
        elif self.fault is not None:
            text += f", shifted by 0: no other surface shows the throw of fault "
            text += f"'{structure.faults.names[self.fault]}' there"
        else:
            text += ", shifted by 0: no single fault is between them"
        return BuildWarning(text, "compartment", rock.name, surfaces[self.of.number].name)


def make_borrowed(
    unfinished: list[CompartmentSheets], throws: Throws, finish: Callable[[CompartmentSheets], None]
) -> None:
    """Makes the sheets of all families without enough data: first those of which the throw is known best. A
    family may be reached through others. finish: is called with each surface whose sheets are all made."""
    while unfinished:
        own = [each for each in unfinished if each.make_own()]
        for each in unfinished:
            each.tell(throws)
        if not own:
            found = [_best(each, family, throws) for each in unfinished for family in each.waiting]
            found = [borrowing for borrowing in found if borrowing is not None]
            least = min((borrowing.rank for borrowing in found), default=UNKNOWN)
            for borrowing in found:
                if borrowing.rank == least:
                    borrowing.of.borrow(borrowing, throws)
            if not found:
                for each in unfinished:
                    each.make_last(throws)
        for each in unfinished:
            if not each.waiting:
                each.tell(throws)
                finish(each)
        unfinished = [each for each in unfinished if each.waiting]


def _best(of: CompartmentSheets, family: Family, throws: Throws) -> Borrowing | None:
    """Of a family's neighbors across one fault those where the throw is known best, and of these the one with
    most data."""
    neighbors = of.neighbors(family, throws)
    least = min((each.rank for each in neighbors), default=UNKNOWN)
    known = [each for each in neighbors if each.rank == least]
    return max(known, key=lambda each: of.amount(each.source), default=None)


@contextmanager
def named(rock: Rock, number: int):
    """Within it errors name a surface of a rock mass."""
    try:
        yield
    except InputRefused as error:
        if error.item is not None and error.item.startswith("rock '"):
            raise
        surface = rock.surfaces[number]
        file, line = surface.shape_source()
        raise error.within(surface_item(rock, surface), file=file, line=line) from error


def _moved(shift: Shift) -> str:
    """By how much a sheet is shifted along a fault."""
    along = shift.at(shift.middles)
    low, high = float(along.min()), float(along.max())
    if low < 0 < high:
        return f"by {low:.4g} to {high:.4g}"
    way, low, high = ("up", low, high) if high > 0 else ("down", -high, -low)
    amounts = dict.fromkeys((f"{low:.4g}", f"{high:.4g}"))
    return f"{way} by {' to '.join(amounts)}"


def _drawn_together(surface, family: Family, sheets: Sheets) -> Sheets:
    """Sheets by sides, equal beyond the tips; the same ones where they were."""
    drawn = surface.drawn_together(family, sheets)
    return {
        sides: sheet if np.array_equal(drawn[sides][0], sheet[0]) else drawn[sides]
        for sides, sheet in sheets.items()
    }
