# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of the surfaces of rock masses before they are interpolated: their extent, and elevations on
their data."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...base.errors import InputRefused
from ...base.work import Work
from ...heights import Task, heights
from ...project.project import Surface, surface_item
from ...settings.methods import CONTINUATION, CONTINUATION_OPTIONS, checked_options
from ...surfaces.rock_input import RockInput
from ...surfaces.wrong_sides import heights_at

Top = tuple[RockInput, int | None]  # a rock mass that is read, and the number of a surface
_MANY = 10_000  # points: these are enough for the elevations of a line
_LIFTS = ("thickness", "minimum_thickness")  # by which a surface may lie above another one's data


def plan_of(tops: list[Top]) -> np.ndarray:
    """(2, 2) corners around rock masses in plan."""
    coordinates = []
    for entry, _ in tops:
        if entry.rock.region is not None:
            coordinates += entry.rock.rings()
        else:
            coordinates += [data[:, :2] for data in _every_data(entry)]
    every = np.concatenate([np.empty((0, 2)), *coordinates])
    return np.array([every.min(axis=0), every.max(axis=0)])


def levels_of(tops: list[Top], others: np.ndarray) -> tuple[float, float]:
    """The lowest and the highest elevation of the data of rock masses, and of `others` (NaN: none)."""
    elevations, lift = [others[~np.isnan(others)]], 0.0
    for entry, _ in tops:
        elevations += [data[:, 2] for data in _every_data(entry)]
        elevations += [np.array([base]) for base in [entry.rock.base_elevation] if base is not None]
        for surface in entry.rock.surfaces:
            elevations += [np.array([value]) for value in [_constant(surface)] if value is not None]
            lift += sum(abs(value) for value in map(_number(surface), _LIFTS))
    every = np.concatenate(elevations)
    low, high = (float(every.min()), float(every.max())) if len(every) else (0.0, 0.0)
    return low - lift, high + lift


def heights_on(work: Work, plan: np.ndarray, tops: list[Top]) -> np.ndarray:
    """(N,) elevations of surfaces at places (N, 2): on the triangles of ready meshes; else by natural
    neighbors between their points, and beyond these as at the nearest. Raises InputRefused."""
    z, points = np.full(len(plan), np.nan), []
    surfaces = [(entry, number) for entry, number in tops if number is not None]
    for entry, number in surfaces:
        shape = entry.surfaces[number]
        if shape is not None:
            mesh_heights = heights_at(work, shape, plan)
            z = np.where(np.isnan(z), mesh_heights, z)
        value = _constant(entry.rock.surfaces[number])
        if value is not None and not len(_data(entry, number)):
            z[np.isnan(z)] = value
        points.append(_data(entry, number))
    rest = np.isnan(z)
    if not rest.any():
        return z
    data = np.concatenate(points)
    if not len(data):
        entry, number = surfaces[0]
        named = surface_item(entry.rock, entry.rock.surfaces[number])
        what = f"the elevation of its trace is not known: {named} has no points or mesh"
        raise InputRefused(what, advice="give the elevation, or another surface: elevation = ...")
    options = checked_options(CONTINUATION, CONTINUATION_OPTIONS)
    near = np.ascontiguousarray(np.unique(_near(data, plan[rest]), axis=0))
    z[rest] = heights(CONTINUATION, Task(work, near, plan[rest], options)).z
    return z


def _near(points: np.ndarray, plan: np.ndarray) -> np.ndarray:
    """Of very many points those around places, as far as these reach; all, if there are few."""
    low, high = plan.min(axis=0), plan.max(axis=0)
    margin = (high - low).max()
    inside = ((points[:, :2] >= low - margin) & (points[:, :2] <= high + margin)).all(axis=1)
    return points[inside] if np.count_nonzero(inside) >= _MANY else points


def _every_data(entry: RockInput) -> list[np.ndarray]:
    return [_data(entry, number) for number in range(len(entry.surfaces))]


def _data(entry: RockInput, number: int) -> np.ndarray:
    """(P, 3) the points of a surface, or the vertices of its mesh."""
    shape, points = entry.surfaces[number], entry.rock.surfaces[number].points
    if shape is not None:
        used = np.zeros(len(shape.vertices), bool)
        used[shape.triangles.ravel()] = True
        return shape.vertices[used]
    return np.empty((0, 3)) if points is None else np.asarray(points, np.float64).reshape(-1, 3)


def _number(surface: Surface) -> Callable[[str], float]:
    """number(key): its value from a surface; 0 where that is no number."""

    def number(key: str) -> float:
        value = surface.options.get(key, getattr(surface, key, None))
        return float(value) if isinstance(value, (int, float)) else 0.0

    return number


def _constant(surface: Surface) -> float | None:
    """The elevation that the options of a surface set everywhere."""
    value = surface.options.get("value")
    return float(value) if surface.method == "constant" and isinstance(value, (int, float)) else None
