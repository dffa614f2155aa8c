# SPDX-License-Identifier: GPL-3.0-or-later
"""What files of objects hold of a model: its blocks, what lies on the sides of their triangles, its surfaces,
and the boreholes of its project."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ...project.library import Property
from ..shapes.parts import FaceTriangles, Part, distinct_names, model_parts, surface_parts

WALL, BASE, CUT = "wall", "base", "cut"
_OF_NO_SURFACE = (CUT, BASE, WALL)  # face_surface -3, -2, -1
_KINDS = ("Interfaces", "Faults", "Bodies")  # surface_kind
_OF_PROPERTY = ("name", "rock", "age", "structure", "density", "description")


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
        """What the library says of it, but for its looks."""
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
    """A borehole of the project. places (N, 3): its collar, or its highest pick, and its picks, downward.
    blocks (N - 1,): the number of the block between two of them, -1 where that is not known. surfaces (N,):
    what was picked there, "" at a collar."""

    name: str
    places: np.ndarray
    blocks: list[int]
    surfaces: list[str]

    @property
    def depths(self) -> np.ndarray:
        """(N,) the depth of each place along the hole."""
        return np.append(0.0, np.cumsum(np.linalg.norm(np.diff(self.places, axis=0), axis=1)))


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
    def of(cls, model) -> Contents:
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
            own, _ = triangles.around(number)
            surface = model.face_surface[triangles.face[own]]
            surface = np.where(surface < 0, count + len(_OF_NO_SURFACE) + surface, surface)
            block_names[number] = part.name
            sides = triangles.blocks[own]
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


def _known_values(model, number: int) -> dict[str, np.ndarray]:
    if model.surface_kind[number] != 0 or model.lacks_project is not None:
        return {}
    values = model.surface_attributes(number)
    return {
        name: values[name] for name in ("variance", "distance") if np.isfinite(values.get(name, np.nan)).any()
    }


def _holes(model) -> list[Hole]:
    """The boreholes of all rock masses. Beneath a surface's pick lies the block deposited beneath it; above
    the highest one, if its collar is known, that beneath the next younger surface."""
    found, first = [], 0
    for rock in model.project.rocks:
        numbers = {surface.name: first + k for k, surface in enumerate(rock.surfaces)}
        end = first + len(rock.surfaces)
        of_surface = {
            block.surface: number
            for number, block in enumerate(model.blocks)
            if first <= block.surface < end and block.cells
        }
        for name, (collar, picks) in rock.hole_picks.items():
            stops = [(numbers[surface], surface, place) for surface, place in picks if surface in numbers]
            if collar is not None and stops:
                stops.insert(0, (stops[0][0] + 1, "", collar))
            if not stops:
                continue
            blocks = [of_surface.get(number, -1) for number, _, _ in stops[:-1]]
            places = np.array([place for *_, place in stops], np.float64)
            kept = [True, *(bool((a != b).any()) for a, b in pairwise(places))]  # a pick may be at the collar
            found.append(_without_repeats(name, places, blocks, [text for _, text, _ in stops], kept))
        first = end
    return found


def _without_repeats(
    name: str, places: np.ndarray, blocks: list[int], surfaces: list[str], kept: Sequence[bool]
) -> Hole:
    """A hole without stretches that have no length; the later of two picks at one place stays."""
    last = np.append(np.flatnonzero(kept)[1:], len(kept)) - 1  # of the places that are one
    between = [blocks[number] for number in last[:-1].tolist()]
    return Hole(name, places[last], between, [surfaces[number] for number in last.tolist()])


def stable_uuid(*words: str) -> uuid.UUID:
    """An identifier that these words always give: so the same model has the same bytes."""
    return uuid.uuid5(uuid.NAMESPACE_URL, "\0".join(("realmodel", *words)))


def largest_share(shares: np.ndarray) -> np.ndarray:
    """(N,) int64: the block with the largest of the shares (B, N) of each cell, -1 where there is none."""
    found = np.full(shares.shape[1], -1, np.int64)
    filled = shares.sum(axis=0) > 0
    if len(shares):
        found[filled] = shares[:, filled].argmax(axis=0)
    return found
