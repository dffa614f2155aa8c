# SPDX-License-Identifier: GPL-3.0-or-later
"""The traces of faults in a section: the segments in which its planes meet the faces of faults."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ...base.algebra import dot
from ...cells.model_data import ModelData

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
