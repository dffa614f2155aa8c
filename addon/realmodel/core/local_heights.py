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
    Room,
    bilinear,
    find_grid,
    has_each_node_once,
    require_one_height,
)
from .heights.run import elsewhere, few_points, runs_away
from .methods import METHODS
from .mis_ties import without_mis_ties
from .project import Rock, Surface
from .surface_heights import needed_surfaces
from .work import Work, native_module


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
    room: Room = np.zeros,
) -> tuple[LocalHeights, np.ndarray, list[str]]:
    """What is found once from all points of a surface; the points that its parts are interpolated from, each
    place once; and what there is to tell. extent: (2, 2), of all nodes. room: for notes of each point. Raises
    InputRefused."""
    native = native_module()
    grid, mis_ties, is_sorted_out = None, None, False
    if method == "grid":  # mostly nothing is to be sorted out of a raster, which may not fit the memory
        grid = find_grid(points)
        is_sorted_out = has_each_node_once(points, grid, room)
    if not is_sorted_out:
        points, mis_ties = without_mis_ties(points)
    told = [*([mis_ties] if mis_ties else []), *few_points(points, method), *elsewhere(points, extent)]
    task = Task(work, points, np.empty((0, 2)), settings, threads)
    known, spacing = None, 0.0
    needed = 1 if method == "grid" else settings["neighbours"]  # where the grid lacks a node
    try:
        if "kriging" in method:
            known = from_neighbours.structure(task)
            needed = known.neighbours
            told += known.warnings
            known = replace(known, warnings=())
        elif method == "spline":
            spacing = native.mean_spacing(points)
        elif method == "grid" and not is_sorted_out:
            grid = find_grid(points)
            require_one_height(points, grid)
        found = LocalHeights(method, settings, needed, known, *_range(points[:, 2]), spacing, grid)
        found.heights(work, points, task.nodes, threads)  # of no nodes: it checks the points
    except native.InputError as error:
        raise InputRefused(str(error), item="points", place=error.place) from error
    if not is_sorted_out:
        _, first = np.unique(points[:, :2], axis=0, return_index=True)
        points = np.ascontiguousarray(points[np.sort(first)])
    return found, points, told


def _range(z: np.ndarray) -> tuple[float, float]:
    return float(z.min()), float(z.max())
