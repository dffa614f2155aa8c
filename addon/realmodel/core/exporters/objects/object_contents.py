# SPDX-License-Identifier: GPL-3.0-or-later
"""What files of objects hold of a model: its blocks, what lies on the sides of their triangles, its surfaces,
and the boreholes of its project."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.algebra import norm
from ...cells.model_data import ModelData
from ...project.library import Property
from ...project.project import Rock
from ...readers.tables.observations import Observations
from ...surfaces.observed.derived import BlockNumbers
from ...surfaces.rock_input import RockInput
from ..shapes.shape_parts import FaceTriangles, Part, distinct_names, model_parts, surface_parts

WALL, BASE, CUT = "wall", "base", "cut"
_OF_NO_SURFACE = (CUT, BASE, WALL)  # face_surface -3, -2, -1
FAULTS, BODIES = "Faults", "Bodies"
_KINDS = ("Interfaces", FAULTS, BODIES)  # surface_kind
_BODY = _KINDS.index(BODIES)
_OF_PROPERTY = ("name", "rock", "age", "structure", "density", "porosity", "permeability", "description")


@dataclass(frozen=True, eq=False)
class BlockShell:
    """A block's closed boundary. number: of the block. surface (T,): on which of `boundary_names` each
    triangle lies. neighbor (T,): the block beyond it, -1 outside. entry: of the library."""

    number: int
    part: Part
    surface: np.ndarray
    neighbor: np.ndarray
    entry: Property | None

    @property
    def known(self) -> dict[str, str | float]:
        """Its library entry, without its look."""
        values = {key: getattr(self.entry, key, None) for key in _OF_PROPERTY}
        return {key: value for key, value in values.items() if value is not None}


@dataclass(frozen=True, eq=False)
class SurfaceShape:
    """A surface as it was used. group: what it is. values: of its vertices, (V,) each, where they are known
    at all."""

    part: Part
    group: str
    values: dict[str, np.ndarray]


@dataclass(frozen=True, eq=False)
class Hole:
    """A borehole of the project. places (N, 3): its collar, if that is known, the ends of its intervals and
    its picks, downward. blocks (N - 1,): the number of the block between two of them, -1 where that is not
    known, as core was lost. surfaces (N,): the surface there, "" where there is none. rock: the index of the
    rock mass that has them."""

    name: str
    places: np.ndarray
    blocks: list[int]
    surfaces: list[str]
    rock: int = 0

    @property
    def depths(self) -> np.ndarray:
        """(N,) the depth of each place along the hole."""
        return np.append(0.0, np.cumsum(norm(np.diff(self.places, axis=0))))

    @property
    def strata(self) -> list[tuple[int, int]]:
        """The first and the last place of each interval: of one block, with no surface in between."""
        intervals: list[tuple[int, int]] = []
        for at, block in enumerate(self.blocks):
            if intervals and self.blocks[at - 1] == block and not self.surfaces[at]:
                intervals[-1] = (intervals[-1][0], at + 1)
            else:
                intervals.append((at, at + 1))
        return intervals


@dataclass(frozen=True, eq=False)
class Contents:
    """What a file of objects holds; no two parts have one name, and no two holes. triangles: of the blocks.
    block_names: of all blocks of the model, in the file. boundary_names: of surfaces, then of walls, base and
    cuts."""

    triangles: FaceTriangles
    blocks: list[BlockShell]
    surfaces: list[SurfaceShape]
    holes: list[Hole]
    block_names: list[str]
    boundary_names: list[str]

    @classmethod
    def of(cls, model: ModelData) -> Contents:
        """Those of a model."""
        triangles = FaceTriangles.of(model)
        parts, library = model_parts(model, triangles), model.project.library
        shapes, holes = surface_parts(model), _holes(model)
        names = distinct_names(part.name for part in (*parts, *shapes))
        parts = [replace(part, name=name) for part, name in zip(parts, names, strict=False)]
        shapes = [replace(part, name=name) for part, name in zip(shapes, names[len(parts) :], strict=True)]
        named = zip(holes, distinct_names(hole.name for hole in holes), strict=True)
        existing = [number for number, block in enumerate(model.blocks) if block.cells]
        block_names = [block.name for block in model.blocks]
        count = len(model.surface_names)
        blocks = []
        for number, part in zip(existing, parts, strict=True):
            of_block, _ = triangles.around(number)
            surface = model.face_surface[triangles.face[of_block]]
            surface = np.where(surface < 0, count + len(_OF_NO_SURFACE) + surface, surface)
            block_names[number] = part.name
            sides = triangles.blocks[of_block]
            neighbor = np.where(sides[:, 0] == number, sides[:, 1], sides[:, 0])
            entry = library.get(part.property) if library else None
            blocks.append(BlockShell(number, part, surface, neighbor, entry))
        return cls(
            triangles,
            blocks,
            [
                SurfaceShape(part, _KINDS[model.surface_kind[number]], _known_values(model, number))
                for number, part in enumerate(shapes)
            ],
            [replace(hole, name=name) for hole, name in named],
            block_names,
            distinct_names([*model.surface_names, *_OF_NO_SURFACE]),
        )


def _known_values(model: ModelData, number: int) -> dict[str, np.ndarray]:
    if model.surface_kind[number] != 0 or model.lacks_project is not None:
        return {}
    values = model.surface_attributes(number)
    return {
        name: values[name] for name in ("variance", "distance") if np.isfinite(values.get(name, np.nan)).any()
    }


def _holes(model: ModelData) -> list[Hole]:
    """The boreholes of all rock masses: as they were logged; of those without intervals their picks."""
    holes: list[Hole] = []
    hole: Hole | None
    first = 0
    number_of = {block.surface: number for number, block in enumerate(model.blocks) if block.cells}
    bodies = {
        model.surface_names[surface]: number
        for surface, number in number_of.items()
        if model.surface_kind[surface] == _BODY
    }
    for number, (rock, entry) in enumerate(zip(model.project.rocks, model.rock_inputs, strict=True)):
        beneath = [number_of.get(first + k, -1) for k in range(len(rock.surfaces))]
        first += len(rock.surfaces)
        logs = {} if rock.observed is None else rock.observed.logs()
        for name in dict.fromkeys((*rock.hole_picks, *logs)):
            collar, picks = rock.hole_picks.get(name, (None, []))
            if name in logs:
                numbers = BlockNumbers(rock, list(bodies)).of(logs[name].blocks)
                blocks = np.array([*beneath, *bodies.values(), -1])[numbers]
                hole = _logged(entry, logs[name], blocks.tolist(), collar, picks)
            else:
                hole = _picked(rock, name, beneath, collar, picks)
            holes += [] if hole is None else [replace(hole, rock=number)]
    return holes


def _picked(
    rock: Rock,
    name: str,
    beneath: Sequence[int],
    collar: tuple[float, ...] | None,
    picks: Sequence[tuple[str, tuple[float, ...]]],
) -> Hole | None:
    """A hole by its picks; None where they are on no surface of the rock mass. Beneath a surface's pick lies
    the block deposited beneath it; above the highest one, if its collar is known, that beneath the next
    younger surface. beneath: the block of each surface."""
    numbers = {surface.name: number for number, surface in enumerate(rock.surfaces)}
    made = _Path()
    above = -1
    stops = [(numbers[surface], surface, place) for surface, place in picks if surface in numbers]
    if stops and collar is not None:
        made.go_to(collar, -1)
        younger = stops[0][0] + 1
        above = beneath[younger] if younger < len(beneath) else -1
    for number, surface, place in stops:
        made.go_to(place, above, surface)
        above = beneath[number]
    return made.hole(name) if stops else None


def _logged(
    entry: RockInput,
    log: Observations,
    blocks: Sequence[int],
    collar: tuple[float, ...] | None,
    picks: Sequence[tuple[str, tuple[float, ...]]],
) -> Hole:
    """A hole by its intervals; what is between them is not known. blocks: that of each row. Named are the
    contacts where two intervals meet, and picks."""
    made = _Path()
    if collar is not None:
        made.go_to(collar, -1)
    contacts = {
        tuple(place): surface.name
        for surface, data in zip(entry.rock.surfaces, entry.data, strict=True)
        for place in data.contacts.tolist()
    }
    last = None
    for place, block, is_inside in zip(log.places.tolist(), blocks, log.goes_on.tolist(), strict=True):
        surface = contacts.get(tuple(place), "") if place == last else ""
        made.go_to(place, block if is_inside else -1, surface)
        last = place
    tops = set(zip(log.blocks.tolist(), map(tuple, log.places.tolist()), strict=True))
    for surface, place in picks:
        if (surface, tuple(place)) not in tops:  # the top of an interval may lie on any surface
            made.insert(place, surface)
    return made.hole(str(log.holes[0]))


class _Path:
    """The places of a hole, downward, and what is between them."""

    def __init__(self) -> None:
        self._places: list[tuple[float, ...]] = []
        self._surfaces: list[str] = []
        self._blocks: list[int] = []

    def go_to(self, place: tuple[float, ...], block: int, surface: str = "") -> None:
        """The next place, and the block above it. At the last place again only the surface may be new."""
        place = tuple(float(value) for value in place)
        if self._places and place == self._places[-1]:
            self._surfaces[-1] = surface or self._surfaces[-1]
            return
        self._blocks += [block] if self._places else []
        self._places.append(place)
        self._surfaces.append(surface)

    def insert(self, place: tuple[float, ...], surface: str) -> None:
        """Names a place that may be between others, by its height."""
        place = tuple(float(value) for value in place)
        if place in self._places:
            at = self._places.index(place)
            self._surfaces[at] = self._surfaces[at] or surface
            return
        at = sum(other[2] >= place[2] for other in self._places)
        is_between = 0 < at < len(self._places)
        self._blocks.insert(at, self._blocks[at - 1] if is_between else -1)
        self._places.insert(at, place)
        self._surfaces.insert(at, surface)

    def hole(self, name: str) -> Hole:
        return Hole(name, np.array(self._places), self._blocks, self._surfaces)


def stable_uuid(*words: str) -> uuid.UUID:
    """An identifier that these words always give: so the same model has the same bytes."""
    return uuid.uuid5(uuid.NAMESPACE_URL, "\0".join(("realmodel", *words)))


def largest_share(shares: np.ndarray) -> np.ndarray:
    """(N,) int64: the block with the largest of the shares (B, N) of each cell, -1 where there is none."""
    largest = np.full(shares.shape[1], -1, np.int64)
    filled = shares.sum(axis=0) > 0
    if len(shares):
        largest[filled] = shares[:, filled].argmax(axis=0)
    return largest
