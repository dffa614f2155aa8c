# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares random points of a finished model that is no stack of sheets with the closed form."""

from __future__ import annotations

import time

import numpy as np

from ..base.errors import place_text
from ..base.sheet import Sheet
from ..base.work import Work, native_module
from ..cells.model_data import ModelData
from ..surfaces.wrong_sides import heights_at
from .closed_form import AIR, blocks_of_all, closed_forms

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
    away = 10.0 ** random.uniform(-6, -1, (len(beside) + len(near), 1)) * np.linalg.norm(high - low)
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
    area = np.linalg.norm(np.cross(apart[1:-1], apart[2:]).sum(axis=0)) / 2
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
