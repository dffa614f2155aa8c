# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces of which each height follows from the points nearest to it: parts of them are interpolated apart,
from the points around them, and have the same heights to the last bit."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .errors import InputRefused
from .heights import from_neighbours
from .heights.interpolation import Task, run_method
from .heights.regular_grid import (
    RegularGrid,
    bilinear,
    find_grid,
    has_each_node_once,
    require_one_height,
)
from .heights.run import elsewhere, few_points, runs_away
from .mapped_arrays import MappedArrays, in_memory
from .methods import METHODS
from .mis_ties import each_place_once, without_mis_ties
from .project import Rock, Surface
from .surface_heights import needed_surfaces
from .work import Work, native_module

_MOST = 1e150  # as data_points.cpp


@dataclass(frozen=True)
class LocalHeights:
    """What the parts of a surface have in common. needed: how many of the points nearest to a node count.
    lowest, highest: of the points. known: for kriging the variogram of all points; spacing: for splines their
    mean spacing; grid: which one they are."""

    method: str
    settings: dict
    needed: int
    known: from_neighbours.Structure | None
    lowest: float
    highest: float
    spacing: float = 0.0
    grid: RegularGrid | None = None

    def heights(self, work: Work, points: np.ndarray, nodes: np.ndarray, threads: int) -> np.ndarray:
        """(N,) heights at nodes (N, 2) from points (P, 3): a part of those that `local_heights` gave, the
        first of them and the others in their order, with the `needed` nearest to each node."""
        task = Task(work, points, nodes, self.settings, threads)
        if self.known is not None:
            return from_neighbours.krige(task, self.known).z
        if self.grid is not None:
            return bilinear(task, self.grid).z
        if self.method == "spline":
            return from_neighbours.thin_plate(task, self.spacing).z
        return run_method(self.method, task).z

    def runs_away(self, lowest: float, highest: float) -> list[str]:
        """As run.runs_away, of the lowest and highest of all heights."""
        points = np.array([[0, 0, self.lowest], [0, 0, self.highest]])
        return runs_away(points, np.array([lowest, highest]), self.method)


def local_surfaces(rock: Rock) -> set[int]:
    """The numbers of the surfaces of a rock mass that are such, and that no other surface has to know."""
    found = {number for number, surface in enumerate(rock.surfaces) if _is_local(surface)}
    others = set(range(len(rock.surfaces))) - found
    while others:
        needed = {each for number in others for each in needed_surfaces(rock, number)}
        others = needed & found
        found -= others
    return found


def _is_local(surface: Surface) -> bool:
    if not surface.interpolated or surface.minimum_thickness is not None or not len(surface.points):
        return False
    method, settings = surface.method_options()
    return (
        METHODS[method].is_local
        and (method == "grid" or settings.get("neighbours", 0) != 0)
        and settings.get("octants", 0) == 0
        and not settings.get("radius")
        and settings["extrapolate"] == "method"
    )


def local_heights(
    work: Work,
    points: np.ndarray,
    extent: np.ndarray,
    method: str,
    settings: dict,
    threads: int,
    arrays: MappedArrays | None = None,
) -> tuple[LocalHeights, np.ndarray, list[str]]:
    """What is found once from all points of a surface, which may be in a file; the points that its parts are
    interpolated from, each place once; and what there is to tell. extent: (2, 2), of all nodes. arrays: where
    those of as many rows as points are kept; None: in memory. Raises InputRefused."""
    native = native_module()
    room, gather = (np.zeros, in_memory) if arrays is None else (arrays.room, arrays.gather)
    given, grid, mis_ties, are_apart = points, None, None, False
    try:
        if method == "grid":  # mostly nothing is to be sorted out of a raster
            grid = find_grid(points)
            are_apart = has_each_node_once(points, grid, room)
        if not are_apart:
            points, mis_ties, are_apart = each_place_once(given, room, gather)
            if method == "grid":  # where it lies, points that repeat others tell, too
                counted, _ = without_mis_ties(given, room, gather)
                grid = find_grid(counted)
                require_one_height(counted, grid, room=room)
            elif not are_apart or not _are_usable(points):
                native.mean_spacing(without_mis_ties(given)[0])  # it refuses them
        told = [*([mis_ties] if mis_ties else []), *few_points(points, method), *elsewhere(points, extent)]
        task = Task(work, points, np.empty((0, 2)), settings, threads)
        known, spacing = None, 0.0
        needed = 1 if method == "grid" else settings["neighbours"]  # where the grid lacks a node
        if "kriging" in method:
            known = from_neighbours.structure(task, are_apart=True)
            needed = known.neighbours
            told += known.warnings
            known = replace(known, warnings=())
        elif method == "spline":
            spacing = native.mean_spacing(points, are_apart=True)
        found = LocalHeights(method, settings, needed, known, *_range(points[:, 2]), spacing, grid)
        found.heights(work, np.array(points[:1]), task.nodes, threads)  # of no nodes: it checks the settings
    except native.InputError as error:
        raise InputRefused(str(error), item="points", place=error.place) from error
    return found, points, told


def _are_usable(points: np.ndarray) -> bool:
    """Whether native code takes them: it squares coordinates."""
    return all(points[:, axis].min() > -_MOST and points[:, axis].max() < _MOST for axis in range(3))


def _range(z: np.ndarray) -> tuple[float, float]:
    return float(z.min()), float(z.max())
