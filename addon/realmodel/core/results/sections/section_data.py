# SPDX-License-Identifier: GPL-3.0-or-later
"""What sections hold: polygons of blocks on a cutter, each with its block and property."""

from __future__ import annotations

import builtins
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ...base.algebra import dot
from ...base.units import number_text
from ...cells.model_data import ModelData
from ...notebook import data_frame, polygon_mesh, with_data
from ...readers.tables.interval_values import IntervalValues
from .section_holes import HoleLine

if TYPE_CHECKING:
    import pandas
    import pyvista


_FAULT = 1  # of `surface_kind`


@dataclass(frozen=True, eq=False)
class FaultTrace:
    """A fault in a section. ends: (N, 2, 3) float64 of its segments. panel: (N,) int32, the panel of a fence
    that each lies on, from 0."""

    name: str
    ends: np.ndarray
    panel: np.ndarray


def traces_on_plane(model: ModelData, point: ArrayLike, normal: ArrayLike) -> list[FaultTrace]:
    """The faults of a model on a plane."""
    return _joined(model, [_segments(model, np.asarray(point, float), np.asarray(normal, float))])


def traces_on_fence(model: ModelData, polyline: np.ndarray) -> list[FaultTrace]:
    """The faults of a model on the vertical panels below the segments of a polyline (N, 2)."""
    return _joined(model, [_on_panel(model, start, end) for start, end in pairwise(polyline)])


def _joined(model: ModelData, panels: list[tuple[np.ndarray, np.ndarray]]) -> list[FaultTrace]:
    ends = np.concatenate([segments for segments, _ in panels])
    surface = np.concatenate([of for _, of in panels])
    panel = np.repeat(np.arange(len(panels), dtype=np.int32), [len(of) for _, of in panels])
    return [
        FaultTrace(model.surface_names[number], ends[surface == number], panel[surface == number])
        for number in np.unique(surface)
    ]


def _segments(model: ModelData, point: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N, 2, 3) where the faces on faults meet a plane, and (N,) the number of each one's fault."""
    kind = np.append(model.surface_kind, 0)  # faces on no surface have numbers below 0
    faces = np.flatnonzero(kind[np.maximum(model.face_surface, -1)] == _FAULT)
    offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    face = np.repeat(np.arange(len(faces)), np.diff(offsets))
    following = np.arange(1, len(corners) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    here = model.vertices[corners]
    away = dot(here - point, normal)
    crossing = np.flatnonzero((away >= 0) != (away[following] >= 0))
    share = away[crossing] / (away[crossing] - away[following[crossing]])
    at = here[crossing] + share[:, None] * (here[following[crossing]] - here[crossing])
    # along the line in which the plane of a face meets the plane
    spokes = here - here[offsets[face]]
    areas = np.zeros((len(faces), 3))
    np.add.at(areas, face, np.cross(spokes, spokes[following]))
    order = np.lexsort(((at * np.cross(normal, areas[face[crossing]])).sum(axis=1), face[crossing]))
    return at[order].reshape(-1, 2, 3), model.face_surface[faces][face[crossing][order][::2]]


def _on_panel(model: ModelData, start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The segments on the plane through two points in plan, between these."""
    step = end - start
    ends, surface = _segments(model, np.array([*start, 0.0]), np.array([step[1], -step[0], 0.0]))
    share = dot(ends[:, :, :2] - start, step) / dot(step, step)
    inside = (share.min(axis=1) < 1.0) & (share.max(axis=1) > 0.0)
    ends, share, surface = ends[inside], share[inside], surface[inside]
    length = share[:, 1:] - share[:, :1]
    part = np.tile([0.0, 1.0], (len(ends), 1))  # for each segment, the part on the panel
    np.divide(np.clip(share, 0.0, 1.0) - share[:, :1], length, out=part, where=length != 0)
    return ends[:, :1] + part[:, :, None] * (ends[:, 1:] - ends[:, :1]), surface


def rgb_bytes(colors: np.ndarray) -> np.ndarray:
    """(N, 3) uint8 of colors (N, 3) from 0 to 1."""
    return np.rint(colors * 255).astype(np.uint8)


@dataclass(eq=False, repr=False)
class SectionData:
    """Convex polygons on a cutter, counter-clockwise seen from above it (from outside of a closed one).

    vertices: (V, 3) float64. Polygon k has the corners polygon_vertices[offsets[k] : offsets[k + 1]];
    offsets (K + 1,) int64, polygon_vertices int32. cells: (K, 2) int32, the model's cells below and above
    (inside and outside): the same where a cell is cut, two where the cutter runs between cells, -1 where
    one side is outside of the model. blocks: (K, 2) int32, their blocks. block, property: (K,) int32, the
    block below, or above where there is none below, and its library id; compartment: (K,) int32, its
    compartment, of compartment_names. block_names: (B,) of the model's, from the oldest of each rock mass;
    block_colors (B, 3), sRGB from 0 to 1. name: of the model; unit: of its lengths. plane: its point and
    normal, where the cutter is one. faults: where they are on planes and fences. holes: the boreholes of the
    model, wherever they are. hole_values: the curves of their logs; None where there are none.
    """

    vertices: np.ndarray
    offsets: np.ndarray
    polygon_vertices: np.ndarray
    cells: np.ndarray
    blocks: np.ndarray
    block: np.ndarray
    property: np.ndarray
    block_names: list[str]
    block_colors: np.ndarray = field(kw_only=True)
    name: str = field(kw_only=True)
    unit: str = field(kw_only=True)
    plane: tuple | None = field(default=None, kw_only=True)
    compartment: np.ndarray = field(kw_only=True)
    compartment_names: list[str] = field(kw_only=True)
    faults: list[FaultTrace] = field(default_factory=list, kw_only=True)
    holes: list[HoleLine] = field(default_factory=list, kw_only=True)
    hole_values: IntervalValues | None = field(default=None, kw_only=True)

    def __repr__(self) -> str:
        met = len(np.unique(self.block))
        return (
            f"{type(self).__name__} of {self.name!r}: {len(self):,} polygons of {met} blocks, "
            f"{number_text(self.area)} {self.unit}²"
        )

    def __len__(self) -> int:
        return len(self.block)

    def polygon(self, k: int) -> np.ndarray:
        """(N, 3) corners of polygon k."""
        return self.vertices[self.polygon_vertices[self.offsets[k] : self.offsets[k + 1]]]

    @cached_property
    def polygon_areas(self) -> np.ndarray:
        """(K,) float64, model units squared."""
        if not len(self):
            return np.zeros(0)
        first = np.repeat(self.offsets[:-1], np.diff(self.offsets))
        following = np.arange(1, len(self.polygon_vertices) + 1)
        following[self.offsets[1:] - 1] = self.offsets[:-1]
        corners = self.vertices[self.polygon_vertices]
        spokes = corners - corners[first]
        doubled = np.add.reduceat(np.cross(spokes, spokes[following]), self.offsets[:-1], axis=0)
        return np.linalg.norm(doubled, axis=1) / 2

    @builtins.property  # a field of this class is called property
    def area(self) -> float:
        """The area of all polygons, model units squared."""
        return float(self.polygon_areas.sum())

    def area_by_block(self) -> np.ndarray:
        """(B,) float64: the area that each block of the model has in the section."""
        return np.bincount(self.block, weights=self.polygon_areas, minlength=len(self.block_names))

    def block_table(self) -> pandas.DataFrame:
        """The areas of the blocks, model units squared: a row for each block that the section meets, with its
        number as index `block`, `name` and `area`.

        Raises UsageError where pandas is missing.
        """
        rows = zip(self.block_names, self.area_by_block().tolist(), strict=True)
        frame = data_frame(({"name": name, "area": area} for name, area in rows), ["name", "area"])
        return frame[frame["area"] > 0].rename_axis("block")

    def to_pyvista(self) -> pyvista.PolyData:
        """The polygons as a mesh of PyVista: cell data `block` (an index of block_names), `property`,
        `compartment`, `cells` (the model's, below and above; -1: outside) and `color` (red, green, blue,
        uint8: plot(scalars="color", rgb=True)); field data `block_names`.

        Raises UsageError where PyVista is missing.
        """
        names = ("block", "property", "compartment", "cells")
        data = {name: getattr(self, name) for name in names}
        data["color"] = rgb_bytes(self.block_colors)[self.block]
        texts = {"block_names": self.block_names}
        return polygon_mesh(self.vertices, self.offsets, self.polygon_vertices, data, texts)

    def arrays(self) -> dict[str, np.ndarray]:
        """All arrays by name, as save writes them."""
        names = ("vertices", "offsets", "polygon_vertices", "cells", "blocks", "block", "property")
        arrays = {name: getattr(self, name) for name in (*names, "compartment")}
        lists = ("block_names", "compartment_names")
        return arrays | {name: np.array(getattr(self, name)) for name in lists}


@dataclass(eq=False, repr=False)
class FenceData(SectionData):
    """Vertical sections along a polyline in plan.

    polyline: (N, 2) float64. panel: (K,) int32, the polyline's segment that each polygon stands on, from 0.
    Above is to the right of the polyline: polygons turn counter-clockwise in the unrolled picture.
    """

    polyline: np.ndarray
    panel: np.ndarray

    def to_pyvista(self) -> pyvista.PolyData:
        """As SectionData.to_pyvista, with the cell data `panel`."""
        return with_data(super().to_pyvista(), {"panel": self.panel})

    def unrolled(self) -> np.ndarray:
        """(V, 2) float64: distance along the polyline and height of each vertex, as fences are drawn."""
        along = np.zeros(len(self.vertices))
        along[self.polygon_vertices] = self.corner_distances()
        return np.column_stack([along, self.vertices[:, 2]])

    def corner_distances(self) -> np.ndarray:
        """(len(polygon_vertices),) float64: distance along the polyline of each polygon's corners."""
        panel = np.repeat(self.panel, np.diff(self.offsets))
        return self.along_panels(self.vertices[self.polygon_vertices], panel)[:, 0]

    def along_panels(self, points: np.ndarray, panel: np.ndarray) -> np.ndarray:
        """(N, 2) float64: distance along the polyline and height of points (N, 3). panel: (N,), that of
        each, or () of all."""
        steps = np.diff(self.polyline, axis=0)
        away = points[:, :2] - self.polyline[panel]
        along = self.bends[panel] + (away * steps[panel]).sum(axis=1) / np.hypot(*steps.T)[panel]
        return np.column_stack([along, points[:, 2]])

    @property
    def bends(self) -> np.ndarray:
        """(N,) float64: distance along the polyline of its points."""
        return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(self.polyline, axis=0).T))])

    @property
    def length(self) -> float:
        """The length of the polyline, model units."""
        return float(self.bends[-1])
