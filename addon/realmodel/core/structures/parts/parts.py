# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts into which faults and bodies divide the space of a project, and the compartments of its rock
masses."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...base.errors import InputRefused, number_list, place_text
from ...base.triangles import Sheet
from ...base.work import NativeError, Work, refused_as
from ...project.project import Project
from ...project.structure_entries import Body, Fault
from ...project.structure_history import body_times, displaced_surfaces
from ...surfaces.rock_input import RockInput
from ...surfaces.rock_structure import FaultShape, RockFaults, RockStructure

_ADVICE = {
    "not_closed": "close its surface: each edge must belong to two triangles",
    "is_closed": "a closed surface is a body: write [[body]]",
    "one_sided": "cut it open where it returns to itself",
    "branching": "make each branch a separate fault, and set 'ends_at'",
    "folded": "make each part that lies beside another one a separate fault",
    "does_not_meet": "extend it to that fault, or take it out of 'ends_at'",
    "equal_halves": "make it longer on the side of that fault on which it is to remain",
    "open_cell": "move the fault or body that cuts there a little",
    "ends_inside": "extend it beyond the rock, set 'dies_out' or 'ends_at', or choose an older 'youngest'",
}


def ends_inside(fault: Fault, place: tuple[float, ...] | None) -> InputRefused:
    """The refusal of a fault whose border is inside the rock at a place; the caller raises it."""
    file, line = fault.shape_source()
    what = "it ends inside the rock that it displaces" + (f" near {place_text(place)}" if place else "")
    advice = _ADVICE["ends_inside"]
    return InputRefused(what, file=file, line=line, item=fault.item, advice=advice, place=place)


def refused_structure(error: NativeError, faults: Sequence[Fault], bodies: Sequence[Body]) -> InputRefused:
    """The refusal for a native InputError about structures; the caller raises it."""
    place = tuple(error.place) if error.place is not None else None
    near = f" near {place_text(place)}" if place else ""
    advice: str | None = _ADVICE.get(error.kind)
    if not 0 <= error.surface < len(faults) + len(bodies):
        return InputRefused(f"{error}{near}", advice=advice, place=place)
    fault = faults[error.surface] if error.surface < len(faults) else None
    entry = fault or bodies[error.surface - len(faults)]
    file, line = entry.shape_source()
    what, items = str(error), [int(number) for number in error.items]
    if error.kind == "does_not_meet" and items:
        what = f"it ends at fault '{faults[items[0]].name}', but does not meet it"
    elif error.kind == "equal_halves" and items:
        what = f"fault '{faults[items[0]].name}', at which it ends, cuts it into two halves of one area"
    elif error.kind == "ends_inside" and fault is not None and fault.dies_out:
        what = "beyond its tip the surfaces differ on its two sides"
        advice = "extend it, or give data beyond the tip that agree"
    elif error.kind == "ends_inside" and fault is not None:
        return ends_inside(fault, place)
    elif items:
        what = f"{what} (triangle{'s' if len(items) > 1 else ''} {number_list(items)})"
    return InputRefused(what + near, file=file, line=line, item=entry.item, advice=advice, place=place)


_BEYOND = 0.25  # of the range of heights of the data: how far above and below there may be rock


@dataclass
class Structures:
    """faults, bodies: of a project, with arrays; structures are numbered through both. displaced: of each
    fault its youngest displaced surface, by rock mass; times: of each body the surface after which it came.
    sides: (P, S) int8 of the parts: 1 above a fault or outside of a body, -1 below or inside, 0 where a
    branch is not there. low, high: (P, 3) a box around each part. box: (2, 3) corners of what was divided.

    For those around a tile (tiles/windows.py): continued, as from native continued_structures; ends:
    heights below and above all rock. None: both are found from the structures and sheets themselves."""

    faults: list[Fault]
    bodies: list[Body]
    displaced: list[dict[int, int]]
    times: list[dict[int, int]]
    sides: np.ndarray = field(default_factory=lambda: np.zeros((1, 0), np.int8))
    low: np.ndarray | None = None
    high: np.ndarray | None = None
    box: np.ndarray | None = None
    continued: list[tuple] | None = None
    ends: tuple[float, float] | None = None

    def __len__(self) -> int:
        return len(self.faults) + len(self.bodies)

    @property
    def is_divided(self) -> bool:
        """Whether rock masses were divided into compartments: not where there are no faults and no bodies."""
        return self.box is not None

    @property
    def largest(self) -> float:
        """The largest coordinate of the whole that a window is a part of; 0 for a whole itself."""
        if self.continued is None:
            return 0.0
        assert self.ends is not None  # as there are continued structures
        return float(max(np.abs(self.divided_box()).max(), *map(abs, self.ends)))

    def divided_box(self) -> np.ndarray:
        """(2, 3) corners of what was divided."""
        assert self.box is not None
        return self.box

    def boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """(P, 3) low and high: a box around each part, once they are found."""
        assert self.low is not None and self.high is not None
        return self.low, self.high

    @property
    def names(self) -> list[str]:
        return [entry.name for entry in (*self.faults, *self.bodies)]

    @property
    def shapes(self) -> list[Sheet]:
        """The triangles of each."""
        return [Sheet(*entry.triangulation()) for entry in (*self.faults, *self.bodies)]

    @property
    def kinds(self) -> list[int]:
        """The number of each structure in `surface_kind`."""
        return [1] * len(self.faults) + [2] * len(self.bodies)

    def native(self) -> list[tuple]:
        """The arguments of the native module."""
        number = {fault.name: n for n, fault in enumerate(self.faults)}
        arguments = [
            (*fault.triangulation(), False, [number[name] for name in fault.ends_at], fault.dies_out)
            for fault in self.faults
        ]
        return arguments + [(*body.triangulation(), True, [], False) for body in self.bodies]

    def fault_shapes(self) -> list[FaultShape]:
        """The shape of each fault."""
        alone = {f.name: FaultShape(*f.triangulation(), f.dies_out) for f in self.faults}
        return [replace(alone[f.name], ends=tuple(alone[name] for name in f.ends_at)) for f in self.faults]

    def of_rock(self, rock: int) -> RockFaults:
        """The faults that act in a rock mass; those that end at others as the parts have it."""
        numbers = [n for n, displaced in enumerate(self.displaced) if rock in displaced]
        here = {self.faults[number].name: at for at, number in enumerate(numbers)}
        ends = []
        for number in numbers:
            sides = self._kept_sides(number)
            ends.append([(here[name], side) for name, side in sides.items() if name in here])
        faults, shapes = [self.faults[number] for number in numbers], self.fault_shapes()
        return RockFaults(
            [fault.name for fault in faults],
            [shapes[number] for number in numbers],
            [self.displaced[number][rock] for number in numbers],
            [fault.dies_out for fault in faults],
            numbers,
            ends,
        )

    def _kept_sides(self, number: int) -> dict[str, int]:
        """For each fault at which a fault ends, by name: the side on which it remains. So it is only in parts
        on these sides."""
        names = list(self.faults[number].ends_at)
        all_names = self.names
        others = self.sides[:, [all_names.index(name) for name in names]]
        for sides in itertools.product((-1, 1), repeat=len(names)):
            is_beyond = (others == -np.array(sides, np.int8)).any(axis=1)
            if np.array_equal(is_beyond, self.sides[:, number] == 0):
                return dict(zip(names, sides, strict=True))
        raise AssertionError(f"the sides of {all_names[number]} and of the faults at which it ends disagree")

    def has_block(self, number: int) -> bool:
        """Whether a structure has a block: a body that is not void and exists in some rock mass."""
        body = number - len(self.faults)
        return body >= 0 and not self.bodies[body].void and bool(self.times[body])

    def blocks_of_bodies(self) -> list[tuple[int, Body, int]]:
        """For each block of a body: the number of its structure, the body, its first rock mass."""
        count = len(self.faults)
        return [
            (count + number, body, min(self.times[number]))
            for number, body in enumerate(self.bodies)
            if self.has_block(count + number)
        ]

    def stage(self, m: int) -> Structures:
        """The structures at stage m: with the bodies that are there just after surface m."""
        times = [
            {rock: after for rock, after in times_of_body.items() if after <= m}
            for times_of_body in self.times
        ]
        return replace(self, times=times)

    def there(self) -> list[int]:
        """The numbers of the faults, and of the bodies that are there."""
        count = len(self.faults)
        return [*range(count), *(count + body for body, times in enumerate(self.times) if times)]

    def only(self, numbers: list[int]) -> tuple[Structures, np.ndarray]:
        """All faults and some bodies, by their numbers; and (P,) int32 a part of these structures for each
        part that those leave."""
        bodies = [number - len(self.faults) for number in numbers[len(self.faults) :]]
        sides, first, part = np.unique(self.sides[:, numbers], axis=0, return_index=True, return_inverse=True)
        low, high = np.full((len(sides), 3), np.inf), np.full((len(sides), 3), -np.inf)
        own_low, own_high = self.boxes()
        np.minimum.at(low, part.ravel(), own_low)
        np.maximum.at(high, part.ravel(), own_high)
        few = replace(
            self,
            bodies=[self.bodies[body] for body in bodies],
            times=[self.times[body] for body in bodies],
            sides=np.ascontiguousarray(sides),
            low=low,
            high=high,
            continued=self.continued and [self.continued[number] for number in numbers],
        )
        return few, first.astype(np.int32)


def structures_of(project: Project, faults: list[Fault], bodies: list[Body]) -> Structures:
    """faults, bodies: those of the project, with arrays."""
    displaced = [displaced_surfaces(project, fault) for fault in faults]
    return Structures(faults, bodies, displaced, [body_times(project, body) for body in bodies])


def divide(work: Work, structures: Structures, box: np.ndarray) -> Structures:
    """The parts of a box, (2, 3). Raises InputRefused."""
    with refused_as(lambda error: refused_structure(error, structures.faults, structures.bodies)) as native:
        sides, low, high = work.native(native.structure_parts, box.tolist(), structures.native())
    return replace(structures, sides=sides, low=low, high=high, box=box)


def box_around(inputs: list[RockInput], structures: Structures, has_sheets: bool = False) -> np.ndarray:
    """(2, 3) corners of a box around all rock that there may be: around RockInputs, or their sheets where
    these are made, and bodies, with a margin for what is not interpolated yet."""
    x, y, z = [], [], [body.triangulation()[0][:, 2] for body in structures.bodies]
    is_known = True
    for entry in inputs:
        if entry.region is not None:
            x.append(entry.region.vertices[:, 0])
            y.append(entry.region.vertices[:, 1])
        for number, (data, shape) in enumerate(zip(entry.data, entry.surfaces, strict=True)):
            has_made = has_sheets and entry.divided().is_made(number)  # not younger than the stage
            shapes = entry.divided().distinct(number) if has_made else [shape]
            is_known &= None not in shapes
            for coordinates in (data.points if shape is None else shape.vertices for shape in shapes):
                places = np.asarray(coordinates, np.float64).reshape(-1, 3)
                z.append(places[:, 2])
                if entry.region is None:
                    x.append(places[:, 0])
                    y.append(places[:, 1])
        if entry.rock.base_elevation is not None:
            z.append(np.array([entry.rock.base_elevation]))
    if not any(map(len, z)):
        z = [fault.triangulation()[0][:, 2] for fault in structures.faults]
    low, high = (
        np.array([corner([corner(values) for values in axis if len(values)]) for axis in (x, y, z)])
        for corner in (np.min, np.max)
    )
    margin = np.array([0.0, 0.0, 0.0 if is_known else _BEYOND * (high[2] - low[2])])
    margin = margin if low[2] < high[2] else np.array([0.0, 0.0, 1.0])
    box = np.array([low - margin, high + margin])
    bases = [base for entry in inputs if (base := entry.rock.base_elevation) is not None]
    if len(bases) == len(inputs):  # no rock is lower
        box[0, 2] = min(bases)
    return box


def add_compartments(structures: Structures, inputs: list[RockInput]) -> None:
    """Sets the compartments of each rock mass (RockInput): the parts, by their sides of the faults that act
    in it."""
    for number, entry in enumerate(inputs):
        faults = structures.of_rock(number)
        rows = np.unique(structures.sides[:, faults.numbers], axis=0)
        # level sets have a place (place_level_sets) until their fields are made
        placed = [
            shape if entry.rock.is_level_set(surface) else None
            for surface, shape in zip(entry.rock.surfaces, entry.surfaces, strict=True)
        ]
        sheets: list[list[Sheet | None]] = [list(placed) for _ in rows]
        entry.structure = RockStructure(faults, rows, compartment_names(faults.names, rows), sheets)


def compartment_of(structures: Structures, entry: RockInput, part: int) -> int:
    """The compartment of a RockInput that a part lies in."""
    structure = entry.divided()
    row = structures.sides[part][structure.faults.numbers]
    return int(np.flatnonzero((structure.compartments == row).all(axis=1))[0])


def compartment_names(names: list[str], rows: np.ndarray) -> list[str]:
    """A name for each row of sides: "above F1, below F2"; "" for one without."""
    words = {1: "above", -1: "below"}
    return [
        ", ".join(f"{words[side]} {name}" for name, side in zip(names, row, strict=True) if side)
        for row in rows.tolist()
    ]
