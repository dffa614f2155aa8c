# SPDX-License-Identifier: GPL-3.0-or-later
"""What the steps of a build will cost in proportion to one another: what its progress is divided by."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import InputRefused
from .measured_costs import COSTS
from .mesh_sizes import AUTO
from .methods import METHODS
from .plan_input import shapes_of
from .project import Project, Rock, Surface
from .rock_input import RockInput

_BYTES_PER_TRIANGLE = 40  # of a mesh as text
_BYTES_PER_POINT = 30
_MERGE = 0.01  # of the stack builder's time


@dataclass
class Costs:
    """Rough seconds of what comes after reading, of one rock mass."""

    mesh: float = 0.0
    interpolate: float = 0.0
    intersect: float = 0.0

    @property
    def total(self) -> float:
        return self.mesh + self.interpolate + self.intersect


def expected_costs(inputs: Sequence[RockInput], cells: str) -> list[Costs]:
    """For each rock mass what the steps after reading will cost, as `scripts/benchmark.sh --fit` measured."""
    costs = []
    for entry in inputs:
        rock = entry.rock
        triangles = sum(len(shape[1]) for shape in entry.surfaces if shape is not None)
        waiting = [surface for surface in rock.surfaces if surface.interpolated]
        meshed = _meshed_triangles(rock, rock.rings()) if waiting else 0.0
        fitted = [len(surface.points) for surface in waiting if _fits_variogram(surface)]
        costs.append(_costs(cells, triangles, meshed, len(waiting), fitted))
    return costs


def _costs(cells: str, triangles: float, meshed: float, waiting: int, fitted: Sequence[float]) -> Costs:
    """triangles: of ready meshes; meshed: of the region; waiting: surfaces to be interpolated; fitted: the
    points of each that a variogram is fitted to, which takes time like the root of their number."""
    cost = Costs()
    if waiting:
        cost.mesh = 1e-2 + COSTS["mesh"] * meshed
        cost.interpolate = waiting * (1e-2 + COSTS["interpolate"] * meshed)
        cost.interpolate += COSTS["variogram"] * sum(np.sqrt(points) for points in fitted)
    cost.intersect = 0.01 + COSTS[cells]["seconds_per_triangle"] * (triangles + waiting * meshed)
    return cost


def _fits_variogram(surface: Surface) -> bool:
    method, settings = surface.method_options()
    return "variogram" in METHODS[method].options and settings["variogram"] is None


def _meshed_triangles(rock: Rock, rings: Sequence[np.ndarray]) -> float:
    """About how many triangles the mesh of a region will have."""
    if rock.triangles is not None:
        return float(rock.triangles)
    extent = np.ptp(np.concatenate(rings), axis=0)
    if rock.edge_length == AUTO:  # about four edges' squares a point
        points = sum(len(s.points) for s in rock.surfaces if isinstance(s.points, (list, np.ndarray)))
        return min(8.0 * points + 1.0, 1e9)
    return min(float(extent[0] * extent[1]) / (0.433 * rock.edge_length**2), 1e9)


@dataclass(frozen=True)
class Shares:
    """Where reading, and intersecting and cutting, end in the progress of a whole build."""

    read: float
    intersect: float


def expected_shares(project: Project, cells: str) -> Shares:
    """From the sizes of files and arrays, before anything but outlines is read."""
    read = 1e-3 + COSTS["read"] * sum(_size(file) for file in project.input_files())
    rest = Costs()
    for rock in project.rocks:
        triangles, waiting, fitted = 0.0, 0, []
        for surface in rock.surfaces:
            size = _size(surface.input_file) if surface.input_file is not None else 0
            if surface.interpolated:
                waiting += 1
                if _fits_variogram(surface):
                    given = len(surface.points) if isinstance(surface.points, (np.ndarray, list)) else 0
                    fitted.append(given + size / _BYTES_PER_POINT)
            else:
                given = 0 if surface.triangles is None else len(surface.triangles)
                triangles += given + size / _BYTES_PER_TRIANGLE
        meshed = _meshed_triangles(rock, _rings(rock)) if waiting else 0.0
        cost = _costs(cells, triangles, meshed, waiting, fitted)
        rest.mesh += cost.mesh
        rest.interpolate += cost.interpolate
        rest.intersect += cost.intersect
    total = read + rest.total
    return Shares(read / total, 1.0 - _MERGE * rest.intersect / total)


def _size(file: Path) -> int:
    try:
        return file.stat().st_size
    except OSError:  # reading it will say what is wrong
        return 0


def _rings(rock: Rock) -> Sequence[np.ndarray]:
    """The rings as they are given, unchecked; reading them in their turn says what is wrong."""
    try:
        shapes = shapes_of(rock.region)
        if shapes is None:
            return rock.rings()
        return [ring for polygon in shapes.polygons for ring in polygon.rings] or [np.zeros((1, 2))]
    except (InputRefused, ValueError, TypeError, IndexError):
        return [np.zeros((1, 2))]


def stack_pace(inputs: Sequence[RockInput], cells: str) -> Callable[[float], float]:
    """From the fraction that the stack builder counts to the share of its time: between what was measured of
    small stacks and of large ones, as the logarithm of the number of triangles lies between theirs."""
    shared = all(on_one_plan(entry.surfaces) for entry in inputs)
    measured = COSTS[cells]["pace_shared" if shared else "pace_own"]
    triangles = sum(len(made) for entry in inputs for _, made in entry.surfaces)
    sizes = np.log([entry["triangles"] for entry in measured])
    curves = [np.array(entry["knots"]).T for entry in measured]

    def pace(fraction: float) -> float:
        shares = [np.interp(fraction, counted, passed) for counted, passed in curves]
        return float(np.interp(np.log(max(triangles, 1)), sizes, shares))

    return pace


def on_one_plan(meshes: Sequence[tuple[np.ndarray, np.ndarray]]) -> bool:
    """Whether meshes (vertices, triangles) are one in plan."""
    (vertices, triangles), *others = meshes
    return all(
        (other[1] is triangles or np.array_equal(other[1], triangles))
        and np.array_equal(other[0][:, :2], vertices[:, :2])
        for other in others
    )
