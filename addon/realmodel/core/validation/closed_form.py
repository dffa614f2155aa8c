# SPDX-License-Identifier: GPL-3.0-or-later
"""The block at a point of a model, from the sheets of its rock masses alone, without building.

For the validation of a model: it shares with the builder only the sides of points at faults and bodies. A
rock mass without faults is one compartment.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import begins_run, norm
from ..base.errors import UsageError, place_text
from ..base.named import keyword_only
from ..base.triangles import Sheet
from ..base.work import Work, native_module, run
from ..cells.model_data import ModelData
from ..fields.series_field import SeriesField
from ..settings.method_options import check_threads
from ..settings.rules import RULES
from ..structures.parts.parts import Structures
from ..surfaces.rock_input import RockInput
from ..surfaces.rock_structure import RockFaults, sides_of
from ..surfaces.wrong_sides import heights_at

AIR = -1
_BASEMENT = -2  # below the first surface: no block, but there to be cut


@dataclass(frozen=True)
class BodyOfRock:
    """A closed body. after: the surface of the rock mass after which it came. block: its number; AIR for a
    void."""

    shape: Sheet
    after: int
    block: int

    def holds(self, work: Work, points: np.ndarray) -> np.ndarray:
        """(N,) bool: the points inside."""
        prepared = native_module().PreparedStructure([(*self.shape, True, [], False)])
        return work.native(prepared.sides, points) < 0


@dataclass(frozen=True)
class ClosedForm:
    """One rock mass. rules: of its surfaces, oldest first. compartments: (C, F) int8 rows of sides; sheets:
    of each compartment one triangulation for each surface. blocks: the number of the block beneath each
    surface (AIR: none). region: triangles in plan that bound it, or None. fields: of surfaces that are level
    sets."""

    rules: Sequence[str]
    faults: RockFaults
    compartments: np.ndarray
    sheets: Sequence[Sequence[Sheet | None]]
    blocks: Sequence[int]
    base_elevation: float | None = None
    bodies: Sequence[BodyOfRock] = ()
    region: Sheet | None = None
    fields: Sequence[SeriesField] = ()

    def compartments_of(self, work: Work, points: np.ndarray) -> np.ndarray:
        """(N,) the compartment that each point (N, 3) lies in; -1 for none."""
        sides = sides_of(work, points, self.faults)
        compartments = np.full(len(points), -1, np.int64)
        for number, row in enumerate(self.compartments):
            compartments[(sides == row).all(axis=1)] = number
        return compartments

    def blocks_at(self, work: Work, points: np.ndarray) -> np.ndarray:
        """(N,) the block at each point (N, 3); AIR for none. Points of no compartment are in none."""
        where = self.compartments_of(work, points)
        heights = [self._heights(work, k, points, where) for k in range(len(self.rules))]
        insides = [body.holds(work, points) for body in self.bodies]
        if self.region is None:  # the rock mass reaches as far as its surfaces
            reached = ~np.isnan(heights).all(axis=0)
            insides = [inside & reached for inside in insides]
        has_base = self.base_elevation is not None
        blocks = history(points[:, 2], heights, self.rules, self.blocks, has_base, self.bodies, insides)
        blocks[where < 0] = AIR
        if self.base_elevation is not None:
            blocks[points[:, 2] < self.base_elevation] = AIR
        blocks[~self.is_over_region(work, points)] = AIR
        return blocks

    def is_over_region(self, work: Work, points: np.ndarray) -> np.ndarray:
        """(N,) bool: the points (N, 3) over or under the region, if there is one; else all."""
        if self.region is None:
            return np.ones(len(points), bool)
        vertices, triangles = self.region
        level = Sheet(np.column_stack([vertices[:, :2], np.zeros(len(vertices))]), triangles)
        return np.isfinite(_heights_in_columns(work, level, points))

    def youngest_heights(self, work: Work, points: np.ndarray) -> np.ndarray:
        """(N,) the heights of the youngest surface over or under points (N, 3), NaN where it has none."""
        return self.heights(work, len(self.rules) - 1, points)

    def heights(self, work: Work, surface: int, points: np.ndarray) -> np.ndarray:
        """(N,) the heights of a surface over or under points (N, 3), NaN where it has none."""
        return self._heights(work, surface, points, self.compartments_of(work, points))

    def above(self, work: Work, surface: int, points: np.ndarray) -> np.ndarray:
        """(N,) how far a surface lies above points (N, 3), NaN where it has no height; a level set about how
        far away on their younger side."""
        for field in self.fields:
            if surface in field.numbers:
                return -field.distances(surface, points, self.compartments_of(work, points))
        return self.heights(work, surface, points) - points[:, 2]

    def _heights(self, work: Work, surface: int, points: np.ndarray, where: np.ndarray) -> np.ndarray:
        """(N,) heights of a surface at points in the compartments `where`. That of a level set is where it
        would be if f rose by 1 along z: above a point where f is less than its level."""
        for field in self.fields:
            if surface in field.numbers:
                return points[:, 2] - field.excess(surface, points, where)
        heights = np.full(len(points), np.nan)
        of_sheet: dict[Sheet, list[int]] = {}
        for compartment, sheets in enumerate(self.sheets):
            sheet = sheets[surface]
            assert sheet is not None  # of a level set alone there is none
            of_sheet.setdefault(sheet, []).append(compartment)
        for sheet, compartments in of_sheet.items():
            here = np.flatnonzero(np.isin(where, compartments))
            if len(here):
                heights[here] = _heights_in_columns(work, sheet, points[here])
        return heights


def _heights_in_columns(work: Work, sheet: Sheet, points: np.ndarray) -> np.ndarray:
    """(N,) the heights of a sheet over or under points (N, 3); asked once for those above one another that
    follow each other."""
    plan = points[:, :2]
    is_new = begins_run(plan)
    return heights_at(work, sheet, plan[is_new])[np.cumsum(is_new) - 1]


def closed_forms(model: ModelData) -> list[ClosedForm]:
    """The closed form of each rock mass of a model; blocks have the model's numbers."""
    number = {block.surface: n for n, block in enumerate(model.blocks)}
    return _forms(model.rock_inputs, model.structures, number)


def surface_forms(entries: Sequence[RockInput], structures: Structures) -> list[ClosedForm]:
    """The closed form of each rock mass before anything is built; blocks have the numbers of the surfaces,
    then of the bodies."""
    count = sum(len(entry.surfaces) for entry in entries) + len(structures.faults) + len(structures.bodies)
    return _forms(entries, structures, {surface: surface for surface in range(count)})


def _forms(entries: Sequence[RockInput], structures: Structures, number: dict[int, int]) -> list[ClosedForm]:
    """number: of the block beneath each surface, or of each body, which are numbered after the faults."""
    count = sum(len(entry.surfaces) for entry in entries)
    forms, first = [], 0
    for rock, entry in enumerate(entries):
        surfaces = range(first, first + len(entry.surfaces))
        first += len(entry.surfaces)
        structure = entry.divided()
        bodies = [
            BodyOfRock(
                Sheet(*body.triangulation()),
                structures.times[n][rock],
                number.get(count + len(structures.faults) + n, AIR),
            )
            for n, body in enumerate(structures.bodies)
            if rock in structures.times[n]
        ]
        forms.append(
            ClosedForm(
                [surface.rule for surface in entry.rock.surfaces],
                structure.faults,
                structure.compartments,
                structure.sheets,
                [number.get(surface, AIR) for surface in surfaces],
                entry.rock.base_elevation,
                bodies,
                entry.region,
                entry.fields,
            )
        )
    return forms


@keyword_only
def block_at(model: ModelData, points: ArrayLike, *, threads: int = 0) -> np.ndarray:
    """(N,) int32 the number of the block at each point (N, 3), model units; -1 where there is none.

    By the closed form of docs/dev/geometry.md, not by the cells: many points are fast. Heights of a surface
    are rounded as its triangles give them: a point that lies on it within a rounding may get either side.
    threads: 0 for all. Raises UsageError where points are no (N, 3) of finite numbers, and for a half: ask
    the whole model.

    >>> model.block_at([(3.5, 1.0, 1.0), (3.5, 1.0, 4.0), (3.5, 1.0, 9.0)])
    array([ 0,  2, -1], dtype=int32)
    """
    if model.is_cut:
        raise UsageError("a cut model has no closed form: ask the whole model")
    points = checked_places(points)
    threads = check_threads(threads)
    blocks = run(lambda work: blocks_of_all(work, closed_forms(model), points), threads=threads)
    return blocks.astype(np.int32)


def checked_places(points: ArrayLike) -> np.ndarray:
    """Points (N, 3) as float64. Raises UsageError."""
    try:
        places = np.ascontiguousarray(points, np.float64)
    except (TypeError, ValueError) as error:
        raise UsageError("points must be an array (N, 3) of numbers") from error
    if places.ndim != 2 or places.shape[1] != 3 or not np.isfinite(places).all():
        raise UsageError(f"points must be an array (N, 3) of finite numbers, not {places.shape}")
    return places


@keyword_only
def grid(model: ModelData, shape: Sequence[int], *, threads: int = 0) -> np.ndarray:
    """(nx, ny, nz) int32 the number of the block at the center of each cell of a regular grid of the model's
    box, as of `block_at`; -1 where there is none. The first cell is the lowest in x, y and z.

    shape: how many cells along x, y and z. threads: 0 for all. Raises UsageError.

    >>> model.grid((2, 1, 3))[:, 0].tolist()
    [[0, -1, -1], [0, 1, -1]]
    """
    if not len(model.vertices):
        box = np.zeros((2, 3))
    else:
        box = np.stack([model.vertices.min(axis=0), model.vertices.max(axis=0)])
    centers = grid_centers(box, shape)
    return block_at(model, centers, threads=threads).reshape(shape)


def grid_centers(box: np.ndarray, shape: Sequence[int]) -> np.ndarray:
    """(N, 3) the centers of the cells of a regular grid of a box (2, 3), z fastest. Raises UsageError."""
    counts = np.asarray(shape)
    if counts.shape != (3,) or counts.dtype.kind not in "iu" or (counts < 1).any():
        raise UsageError(f"a grid has three numbers of cells, along x, y and z, not {shape!r}")
    steps = (box[1] - box[0]) / counts
    index = np.indices(tuple(counts.tolist())).reshape(3, -1).T
    return box[0] + (index + 0.5) * steps


def blocks_of_all(work: Work, forms: list[ClosedForm], points: np.ndarray) -> np.ndarray:
    """(N,) the block at points (N, 3) of several rock masses; AIR for none."""
    blocks = np.full(len(points), AIR, np.int64)
    for form in forms:
        rock_blocks = form.blocks_at(work, points)
        blocks = np.where(rock_blocks != AIR, rock_blocks, blocks)
    return blocks


def history(
    z: np.ndarray,
    heights: Sequence[np.ndarray],
    rules: Sequence[str],
    blocks: Sequence[int],
    has_base: bool,
    bodies: Sequence[BodyOfRock] = (),
    insides: Sequence[np.ndarray] = (),
) -> np.ndarray:
    """(N,) the block at points, by the events oldest first; AIR for none. Base elevation and region are
    ignored.

    z: (N,) of the points. heights: of each surface there (N,), NaN where it does not exist. rules, blocks: of
    each surface, as ClosedForm. insides: of each body (N,) bool.
    """
    state = np.full(len(z), AIR, np.int64)
    covered = np.zeros(len(z), bool)
    protected = np.zeros(len(z), bool)
    for k, (rule, at) in enumerate(zip(rules, heights, strict=True)):
        exists = ~np.isnan(at)
        below, above = exists & (z < at), exists & (z > at)
        if RULES[rule].cuts:
            state[above & ~protected] = AIR
        oldest = blocks[0] if k == 0 and has_base else _BASEMENT
        filled = below & (state == AIR)
        state[filled] = np.where(covered, blocks[k], oldest)[filled]
        covered |= exists
        if RULES[rule].protects:
            protected |= below | (exists & (state != AIR))
        for body, inside in zip(bodies, insides, strict=True):
            if body.after == k:
                state[inside & (has_base | (state != _BASEMENT))] = body.block
    state[state == _BASEMENT] = AIR
    return state


_ROUNDING = 64  # units in the last place of the largest coordinate: nearer points are left undecided
_LOOKED_AT = 200  # disagreeing points that are tested for rounding
_SHOWN = 5  # offenders of each test


def check_points(work: Work, model: ModelData, arrays: dict, places: int, seed: int) -> list[dict]:
    """The tests "places" and "surfaces" of a model with structures or level sets, as the native part gives
    those of others: about so many points spread in the model, beside its faces, and beside faults and bodies.
    arrays: of the model, as native tests take it."""
    random = np.random.default_rng(seed)
    began = time.perf_counter()
    points = _points(model, places, random)
    forms = closed_forms(model)

    def looked_up(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        cells = work.native(native_module().cells_at, arrays, points)
        return cells, blocks_of_all(work, forms, points)

    cells, said = looked_up(points)
    is_block = np.where(cells < 0, AIR, np.append(model.cell_block, AIR)[cells])
    wrong = np.flatnonzero(is_block != said)
    some = wrong[:_LOOKED_AT]
    moves = np.vstack([np.zeros(3), np.eye(3), -np.eye(3)]) * _rounding(model)
    moved = [
        numbers.reshape(-1, len(moves)) for numbers in looked_up((points[some, None] + moves).reshape(-1, 3))
    ]
    # a face or surface that divides rock is nearer than rounding moves the point
    near = np.any([(numbers != numbers[:, :1]).any(axis=1) for numbers in moved], axis=0)
    wrong = np.setdiff1d(wrong, some[near])
    offenders = [
        _offender(model, points[n], int(cells[n]), int(is_block[n]), int(said[n])) for n in wrong[:_SHOWN]
    ]
    tests = [_entry("places", "points", len(points), len(wrong), int(near.sum()), began, offenders)]
    return [*tests, _check_faces(work, model, places, random)]


def _points(model: ModelData, places: int, random: np.random.Generator) -> np.ndarray:
    """(N, 3): a third anywhere in the box of the model, a third near faces, a third near structures."""
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    margin = 0.02 * (high - low)
    third = max(1, places // 3)
    spread = random.uniform(low - margin, high + margin, (places - 2 * third, 3))
    first = model.face_offsets[:-1]
    some = random.integers(0, len(first), third)
    corner = random.integers(0, np.diff(model.face_offsets)[some] - 1)
    at = model.face_vertices[first[some]], *(model.face_vertices[first[some] + corner + k] for k in (0, 1))
    beside = _in_triangles(np.stack([model.vertices[vertex] for vertex in at], axis=1), random)
    structures = (*model.structures.faults, *model.structures.bodies)
    shapes = [
        vertices[triangles] for vertices, triangles in (structure.triangulation() for structure in structures)
    ]
    near = np.empty((0, 3))
    for shape in shapes:
        rows = random.integers(0, len(shape), -(-third // len(shapes)))
        near = np.concatenate([near, _in_triangles(shape[rows], random)])
    away = 10.0 ** random.uniform(-6, -1, (len(beside) + len(near), 1)) * norm(high - low)
    direction = random.normal(size=(len(away), 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    return np.concatenate([spread, np.concatenate([beside, near]) + away * direction])


def _in_triangles(corners: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A random point in each of (N, 3, 3)."""
    weights = -np.log(random.uniform(1e-300, 1.0, corners.shape[:2]))
    return (corners * (weights / weights.sum(axis=1)[:, None])[:, :, None]).sum(axis=1)


def _offender(model: ModelData, point: np.ndarray, cell: int, block: int, said: int) -> dict:
    names = [f"block '{entry.name}'" for entry in model.blocks]
    text = f"the model has {names[block] if block >= 0 else 'nothing'}, the closed form "
    text += f"{names[said] if said >= 0 else 'nothing'} at {place_text(point)}"
    return {
        "text": text,
        "cell": cell,
        "face": -1,
        "vertex": -1,
        "block": block,
        "place": tuple(point.tolist()),
    }


def _check_faces(work: Work, model: ModelData, places: int, random: np.random.Generator) -> dict:
    """Whether the middles of some faces lie on the surface, fault or body that the faces name."""
    began = time.perf_counter()
    faces = np.flatnonzero(model.face_surface >= 0)
    faces = np.sort(random.choice(faces, min(len(faces), places), replace=False))
    offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    points = np.add.reduceat(model.vertices[corners], offsets[:-1]) / np.diff(offsets)[:, None]
    away = np.full(len(faces), np.inf)
    allowed = _rounding(model) * (1 + _steepness(model))
    is_sheet = _are_sheets(model)
    for number in np.unique(model.face_surface[faces]):
        rows = np.flatnonzero(model.face_surface[faces] == number)
        vertices, triangles = model.surface(number)
        if is_sheet[number]:
            for sheet in model.sheet_triangles(number):
                z = heights_at(work, Sheet(vertices, sheet), points[rows, :2])
                off = np.abs(z - points[rows, 2])
                away[rows] = np.fmin(away[rows], off)
        else:
            nearest = native_module().nearest_triangles
            _, away[rows] = work.native(nearest, vertices[triangles], points[rows])
    wrong = np.flatnonzero(away > allowed)
    slivers = np.array([_width(model, faces[n]) <= allowed for n in wrong], bool)
    wrong = wrong[~slivers]
    names = [model.surface_names[number] for number in model.face_surface[faces]]
    offenders = [
        {
            "text": f"face {faces[n]} is {away[n]:.3g} off '{names[n]}'",
            "cell": -1,
            "face": int(faces[n]),
            "vertex": -1,
            "block": -1,
            "place": tuple(points[n].tolist()),
        }
        for n in wrong[:_SHOWN]
    ]
    return _entry("surfaces", "faces", len(faces), len(wrong), int(slivers.sum()), began, offenders)


def _width(model: ModelData, face: int) -> float:
    """The mean width of a face: its area by its longest extent."""
    corners = model.vertices[model.face_vertices[model.face_offsets[face] : model.face_offsets[face + 1]]]
    apart = corners - corners[0]
    area = norm(np.cross(apart[1:-1], apart[2:]).sum(axis=0)) / 2
    return float(area / np.linalg.norm(apart, axis=1).max())


def _rounding(model: ModelData) -> float:
    """How far rounding may move a vertex: by the coordinates of the whole, where this is a part of one."""
    return _ROUNDING * float(np.spacing(max(np.abs(model.vertices).max(), model.structures.largest)))


def _are_sheets(model: ModelData) -> np.ndarray:
    """(S,) bool: the surfaces with one height at each position."""
    return (model.surface_kind == 0) & ~model.surface_is_level_set


def _steepness(model: ModelData) -> float:
    """The steepest slope of a sheet: heights are off by so much more than plan coordinates."""
    steepest = 0.0
    for number in np.flatnonzero(_are_sheets(model)).tolist():
        vertices, triangles = model.surface(number)
        a, b, c = vertices[triangles].transpose(1, 0, 2)
        normal = np.cross(b - a, c - a)
        level = np.abs(normal[:, 2])
        slopes = np.linalg.norm(normal[level > 0, :2], axis=1) / level[level > 0]
        steepest = max(steepest, float(slopes.max(initial=0.0)))
    return steepest


def _entry(
    name: str, unit: str, examined: int, failed: int, undecided: int, began: float, offenders: list[dict]
) -> dict:
    return {
        "name": name,
        "unit": unit,
        "examined": examined,
        "failed": failed,
        "undecided": undecided,
        "seconds": time.perf_counter() - began,
        "offenders": offenders,
    }
