# SPDX-License-Identifier: GPL-3.0-or-later
"""The positions of the corners of blocks within their layers as deposited, for pictures; in series the
bedding follows the field."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..base.algebra import norm
from ..base.work import Work, native_module
from ..cells.built_cells import native_rocks
from ..cells.model_data import ModelData
from ..fields.series_field import SeriesField
from ..results.layer_values import local_compartments
from ..settings.rules import RULES
from ..surfaces.rock_structure import RockStructure, fault_sides

_SAMPLES = 4096  # corners of a layer by which its mean thickness is measured


@dataclass(frozen=True, eq=False)
class SeriesLayer:
    """The layer beneath a surface of a series, or the one on its youngest surface, beneath an unconformity.
    surface: the number in the rock mass of the surface that it lies beneath. local: for each compartment of
    the model its number in the rock mass, -1: none. thickness: its mean, model units. The oldest layer of a
    series begins at the least value of its fields, the one on the youngest surface ends at the largest."""

    own: SeriesField
    surface: int
    local: np.ndarray
    thickness: float

    @staticmethod
    def of(
        own: SeriesField, surface: int, local: np.ndarray, points: np.ndarray, compartment: np.ndarray
    ) -> SeriesLayer:
        """points: (N, 3) of its corners; compartment: (N,) of the model."""
        where = local[compartment]
        layer = SeriesLayer(own, surface, local, 0.0)
        away = layer._away(points, where)
        if np.isnan(away).all():
            return layer
        whole = layer._whole(away, points, where)
        chosen = np.flatnonzero(np.isfinite(away))[:: max(1, len(away) // _SAMPLES)]
        steep = norm(own.slopes(points[chosen], where[chosen])).mean()
        return replace(layer, thickness=float(np.nanmean(whole) / steep) if steep > 0 else 0.0)

    @property
    def has_top(self) -> bool:
        """Whether a surface of the series is its top."""
        return self.surface in self.own.numbers

    @property
    def has_base(self) -> bool:
        """Whether a surface of the series is its base."""
        return self.surface > self.own.first

    @property
    def longest(self) -> float:
        """The longest edge between whose ends bedding may be linear, model units: twice the smallest edge of
        the lattices of its fields."""
        return 2.0 * min(min(field.lattice.spacing) for field in self.own.fields)

    def shares(self, points: np.ndarray, compartment: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(N,) the shares of the height of the layer at points in compartments of the model, and (N,) bool
        where these are known."""
        where = self.local[compartment]
        away = self._away(points, where)
        whole = self._whole(away, points, where)
        share = away / np.where(whole > 0, whole, np.nan)
        share = np.clip(1.0 - share if self.has_top else share, 0.0, 1.0)
        return share, np.isfinite(share)

    def _away(self, points: np.ndarray, where: np.ndarray) -> np.ndarray:
        """(N,) how much the field changes from the top into the layer; from its base if it has no top."""
        if self.has_top:
            change = -self.own.excess(self.surface, points, where)
        else:
            change = self.own.excess(self.surface - 1, points, where)
        return np.where(np.isfinite(change), change, np.nan)

    def _whole(self, away: np.ndarray, points: np.ndarray, where: np.ndarray) -> np.ndarray:
        """(N,) how much the field rises from the base of the layer to its top."""
        if self.has_top and self.has_base:
            return away + self.own.excess(self.surface - 1, points, where)
        fields = self.own.distinct()
        if self.has_top:
            most = max(field.levels[0] - field.values.min() for field in fields)
        else:
            most = max(field.values.max() - field.levels[self.own.count - 1] for field in fields)
        return np.full(len(away), float(most))


_INSIDE = 0.1  # of the size of a face: from its middle to a point in its cell
_INWARDS = 1e-5  # of the distance from a corner to the inner point
_NO_LAYER = -1


@dataclass(frozen=True, eq=False)
class Bedding:
    """height, thickness, depth: (C,) float32 of each corner: its position in its layer at the time of
    deposition, from 0 at the base to 1 at the top, independent of later erosion; the thickness of the layer
    there, as it was deposited; how deep it lies below the youngest top there, as the sheets of its
    compartment have it. Model units. is_top: (F,) bool, the polygons on which nothing lies, but for the
    floors of voids. age: (F,) float32, the number of the surface in its rock mass that the block was
    deposited beneath; of a body half a step more than that which it came after.

    In a body height and thickness are those of its mesh, from its lowest point to its highest."""

    height: np.ndarray
    thickness: np.ndarray
    depth: np.ndarray
    is_top: np.ndarray
    age: np.ndarray

    def part(self, corners: slice, polygons: slice) -> Bedding:
        """The bedding of some polygons."""
        return Bedding(
            self.height[corners],
            self.thickness[corners],
            self.depth[corners],
            self.is_top[polygons],
            self.age[polygons],
        )

    @staticmethod
    def joined(parts: list[Bedding | None]) -> Bedding | None:
        """Several, one after another; None where one is not known."""
        arrays = [vars(part) for part in parts if part is not None]
        if len(arrays) < len(parts):
            return None
        return Bedding(*(np.concatenate([part[name] for part in arrays]) for name in arrays[0]))


def bedding_of(
    work: Work, model: ModelData, faces: np.ndarray, is_second: np.ndarray
) -> tuple[Bedding, dict[int, SeriesLayer]]:
    """Bedding coordinates of the faces of a model, cell by cell, and the layers of series, by the index of
    the surface that each lies beneath. faces: (N,) numbers; is_second: (N,) bool, of the second cell; then
    the corners are those of the face in reverse order. Raises Cancelled."""
    faces = np.ascontiguousarray(faces, np.int32)
    cells = np.where(is_second, model.face_cells[faces, 1], model.face_cells[faces, 0])
    block = model.cell_block[cells]
    rocks = native_rocks(model)
    first = np.cumsum([0, *(len(surfaces) for surfaces, *_ in rocks)])
    rock = np.array([model_block.rock for model_block in model.blocks], np.int32)
    surface = np.array([model_block.surface for model_block in model.blocks], np.int32)
    layer = np.where(surface < first[-1], surface - first[rock], _NO_LAYER).astype(np.int32)
    histories: list[tuple] = []
    history = np.zeros(len(faces), np.int32)
    corner_begin = np.cumsum(np.append(0, np.diff(model.face_offsets)[faces]))
    of_corners = None
    for number, (surfaces, _, base_elevation, rules) in enumerate(rocks):
        polygons = np.flatnonzero(rock[block] == number)
        history[polygons] = len(histories)
        structure = model.rock_inputs[number].structure if model.rock_inputs else None
        if structure is None:
            histories.append((surfaces, base_elevation, rules))
            continue
        if of_corners is None:
            of_corners = np.zeros(corner_begin[-1], np.int32)
        compartments = _compartments(
            work, model, structure, faces[polygons], is_second[polygons], cells[polygons]
        )
        of_corners[_runs(corner_begin, polygons)] = len(histories) + compartments
        histories += [
            ([sheet.arrays for sheet in structure.of_compartment(c)], base_elevation, rules)
            for c in range(len(structure.sheets))
        ]
    if of_corners is not None:
        plain = [n for n, entry in enumerate(model.rock_inputs) if entry.structure is None]
        polygons = np.flatnonzero(np.isin(rock[block], plain))
        of_corners[_runs(corner_begin, polygons)] = np.repeat(
            history[polygons], np.diff(corner_begin)[polygons]
        )
    height, thickness, depth = work.native(
        native_module().bedding,
        model.native(),
        histories,
        (faces, np.ascontiguousarray(is_second, bool), history, layer[block]),
        np.zeros(0, np.int32) if of_corners is None else of_corners,
    )
    grows = (model.surface_kind == 0) | np.isin(np.arange(len(model.surface_kind)), surface)
    is_top = (model.face_cells[faces, 1] < 0) & (model.face_surface[faces] >= 0)
    is_top &= grows[np.maximum(model.face_surface[faces], 0)]
    is_top[is_top] = ~seen_from_below(model, faces[is_top])
    age = np.array([_age(model, number, layer) for number in range(len(model.blocks))], np.float32)
    bedding = Bedding(height, thickness, depth, is_top, age[block])
    bedding, layers = _with_series(model, bedding, faces, is_second, cells)
    body = np.where(layer == _NO_LAYER, surface, -1)
    return _with_bodies(model, bedding, faces, is_second, body[block]), layers


def _age(model: ModelData, block: int, layer: np.ndarray) -> float:
    if layer[block] != _NO_LAYER:
        return float(layer[block])
    body = model.blocks[block].surface - len(model.surface_names) + len(model.structures.bodies)
    return model.structures.times[body].get(model.blocks[block].rock, 0) + 0.5


def _with_bodies(
    model: ModelData, bedding: Bedding, faces: np.ndarray, is_second: np.ndarray, body: np.ndarray
) -> Bedding:
    """body: (N,) the surface of the body that each polygon is of, -1: none."""
    if (body < 0).all():
        return bedding
    offsets, corners = model.face_corners(faces, is_second)
    of_corner = np.repeat(body, np.diff(offsets))
    height, thickness = bedding.height.copy(), bedding.thickness.copy()
    for surface in np.unique(body[body >= 0]):
        mask = of_corner == surface
        levels = model.surface(surface)[0][:, 2]
        thickness[mask] = np.ptp(levels)
        height[mask] = np.clip((model.vertices[corners[mask], 2] - levels.min()) / np.ptp(levels), 0.0, 1.0)
    return replace(bedding, height=height, thickness=thickness)


def _with_series(
    model: ModelData, bedding: Bedding, faces: np.ndarray, is_second: np.ndarray, cells: np.ndarray
) -> tuple[Bedding, dict[int, SeriesLayer]]:
    """Heights and thicknesses of the layers of series by their fields, also where these are vertical or
    overturned. The thickness of a layer is its mean, so that laminae are level sets of the field."""
    layers: dict[int, SeriesLayer] = {}
    if not any(entry.fields for entry in model.rock_inputs):
        return bedding, layers
    offsets, corners = model.face_corners(faces, is_second)
    beneath = np.array([block.surface for block in model.blocks], np.int64)[model.cell_block[cells]]
    height, thickness, first = bedding.height.copy(), bedding.thickness.copy(), 0
    for entry in model.rock_inputs:
        local = local_compartments(model, entry)
        of_series = {number for series_field in entry.fields for number in series_field.numbers}
        unconformities = {
            number
            for number, surface in enumerate(entry.rock.surfaces)
            if RULES[surface.rule].cuts and number not in of_series
        }
        for series_field in entry.fields:
            after = series_field.first + series_field.count
            above = [after] if after in unconformities else []  # what lies on it was folded with it
            for number in (*series_field.numbers, *above):
                polygons = np.flatnonzero(beneath == first + number)
                rows = _runs(offsets, polygons)
                where = np.repeat(model.cell_compartment[cells[polygons]], np.diff(offsets)[polygons])
                points = model.vertices[corners[rows]]
                layer = SeriesLayer.of(series_field, number, local, points, where)
                share, is_known = layer.shares(points, where)
                height[rows[is_known]] = share[is_known]
                thickness[rows[is_known]] = layer.thickness
                layers[first + number] = layer
        first += len(entry.rock.surfaces)
    return replace(bedding, height=height, thickness=thickness), layers


def _runs(begin: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """The indices of the corners of some polygons, one polygon after the other. begin: (N + 1,) of all."""
    size = begin[numbers + 1] - begin[numbers]
    ends = np.cumsum(size)
    return np.repeat(begin[numbers] - (ends - size), size) + np.arange(ends[-1] if len(ends) else 0)


def _compartments(
    work: Work,
    model: ModelData,
    structure: RockStructure,
    faces: np.ndarray,
    is_second: np.ndarray,
    cells: np.ndarray,
) -> np.ndarray:
    """(C,) the compartment of a rock mass that each corner of some faces lies in, by its rows of sides. What
    a compartment of the model leaves open - a fault that does not divide the block, or that dies out - is
    where the corner lies, drawn a little into its cell."""
    faults = structure.faults
    assert model.compartment_sides is not None  # the model has faults
    offsets, _ = model.face_corners(faces, is_second)
    of_polygon = model.compartment_sides[model.cell_compartment[cells]][:, faults.numbers]
    sides = np.repeat(of_polygon, np.diff(offsets), axis=0)
    points = None
    for number, shape in enumerate(faults.shapes):
        is_open = np.flatnonzero(sides[:, number] == 0)
        if len(is_open):
            points = _points_inside(model, faces, is_second) if points is None else points
            sides[is_open, number] = fault_sides(work, points[is_open], shape)
    sides = faults.without_dropped(sides)
    distinct, row = np.unique(sides, axis=0, return_inverse=True)
    equal = (distinct[:, None] == structure.compartments).sum(axis=2)
    return equal.argmax(axis=1).astype(np.int32)[row.ravel()]


def _points_inside(model: ModelData, faces: np.ndarray, is_second: np.ndarray) -> np.ndarray:
    """(C, 3) for each corner a point in its cell close by."""
    offsets, corners = model.face_corners(faces, is_second)
    begin, count = offsets[:-1], np.diff(offsets)
    points = model.vertices[corners]
    local = points - np.repeat(points[begin], count, axis=0)
    following = np.arange(1, len(corners) + 1)
    following[offsets[1:] - 1] = begin
    area = np.add.reduceat(np.cross(local, local[following]), begin) / 2
    size = np.sqrt(np.linalg.norm(area, axis=1))[:, None]
    middle = points[begin] + np.add.reduceat(local, begin) / count[:, None]
    inside = middle - _INSIDE * area / np.maximum(size, np.finfo(float).tiny)
    return points + _INWARDS * (np.repeat(inside, count, axis=0) - points)


def seen_from_below(model: ModelData, faces: np.ndarray) -> np.ndarray:
    """(N,) bool: the faces whose corners go clockwise seen from above."""
    offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    if not len(faces):
        return np.zeros(0, bool)
    x, y = model.vertices[corners, 0], model.vertices[corners, 1]
    following = np.arange(1, len(corners) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    first = np.repeat(offsets[:-1], np.diff(offsets))
    x, y = x - x[first], y - y[first]
    return np.add.reduceat(x * y[following] - y * x[following], offsets[:-1]) < 0
