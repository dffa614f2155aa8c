# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that can be interpolated in parts: a part of the nodes, from the points around them or from a few
numbers, gets bit for bit the heights of the whole."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..base.build_warning import BuildWarning
from ..base.mapped_arrays import MappedArrays, in_memory
from ..base.sheet import Sheet
from ..base.work import Work, native_module, refused_as
from ..heights import from_neighbours
from ..heights.from_triangulation import hull_border, hull_corners, outside_hull, replace_extrapolated
from ..heights.interpolation import Result, Task
from ..heights.methods import run_method
from ..heights.mis_ties import each_place_once, without_mis_ties
from ..heights.plain import Plane, fitted_plane, mean_height
from ..heights.regular_grid import RegularGrid, bilinear, find_grid, has_each_node_once, require_one_height
from ..heights.run import elsewhere, few_points, refused_points, runs_away
from ..heights.ties import Terms, TieData, correction, missed_warnings, one_sheet, tied_heights
from ..project.project import Rock, Surface, surface_item
from ..settings.methods import METHODS
from .observed.surface_data import SurfaceData
from .rock_input import RockInput, named_surfaces
from .surface_heights import needed_surfaces, no_triangle_known, raised_above

Box = tuple[float, float, float, float]  # low x, low y, high x, high y
_MOST = 1e150  # as data_points.cpp
_NEIGHBORS_OF_TRIANGLES = 32  # points around a place in the first window where triangles are looked for
_LOOKED_AT = 64  # as neighbor_search.cpp: times the points wanted, until octants may stay empty


@dataclass(frozen=True)
class LocalHeights:
    """The data that the parts of a surface share. nodes: the number of all nodes. needed: the number of
    nearest points that the height of a node depends on; also those within `reach` of it. lowest, highest: of
    the points.

    known: for kriging, the variogram of all points. spacing: for splines, the mean spacing of all points.
    grid: for the method grid, the grid of the points. fit: for plane and constant, the fitted plane or
    height. hull: the corners of the points' hull, where extrapolation differs from the method. border: for
    triangulations, the points on the border of the hull, and the box around all. over: the number of the
    surface that this one is parallel to, or a height. least: the minimum thickness above the older surface.
    ties: it is tied to its points, by terms: the correction with which it honors them, None where it does
    so without.
    """

    method: str
    settings: dict
    nodes: int
    needed: int = 0
    lowest: float = 0.0
    highest: float = 0.0
    reach: float = 0.0
    known: from_neighbours.KrigingStructure | None = None
    spacing: float = 0.0
    grid: RegularGrid | None = None
    fit: Plane | float | None = None
    hull: np.ndarray | None = None
    border: tuple[np.ndarray, Box] | None = None
    over: int | float | None = None
    least: float | None = None
    ties: bool = False
    terms: Terms | None = None

    @property
    def takes_points(self) -> bool:
        return self.needed > 0

    def heights(
        self,
        work: Work,
        points: np.ndarray,
        nodes: np.ndarray,
        others: Mapping[int, np.ndarray] | None = None,
    ) -> np.ndarray:
        """(N,) heights at nodes (N, 2) from points (P, 3): a part of those that `local_heights` gave, the
        first of them and the others in their order, with the `needed` nearest to each node; NaN where the
        surface ends. others: the heights at the nodes of other surfaces, by their numbers. Not raised above
        the surface before."""
        task = self._task(work, points, nodes)
        if self.over is not None:
            if isinstance(self.over, int):
                assert others is not None
                below = others[self.over]
            else:
                below = np.full(len(nodes), self.over)
            return below + self.settings["thickness"]
        return self._tied(task, self._extrapolated(task, self._result(task)).z)

    def certain_heights(
        self, work: Work, points: np.ndarray, nodes: np.ndarray, window: Box
    ) -> tuple[np.ndarray, np.ndarray]:
        """`heights` where there is a border, from all points in a window, the first of all before them; and
        (N,) bool, where they are certain. The others need a larger window."""
        assert self.border is not None  # only such surfaces have uncertain heights
        border, box = self.border
        is_whole = all(window[k] <= box[k] and box[k + 2] <= window[k + 2] for k in (0, 1))
        of_part = getattr(native_module(), f"{self.method}_of_part")
        task = self._task(work, points, nodes)
        z, certain = task.run(of_part, points, nodes, (border, box, window, is_whole))
        return self._tied(task, self._extrapolated(task, Result(z)).z), certain

    def _tied(self, task: Task, z: np.ndarray) -> np.ndarray:
        return z if self.terms is None else tied_heights(task.work, z, task.nodes, self.terms)

    def tied(
        self, work: Work, data: TieData, points: np.ndarray, mesh: Sheet
    ) -> tuple[LocalHeights, list[str]]:
        """The same, tied to its data on a planar mesh, and warnings. points: as of heights."""
        around = native_module().nodes_around(*mesh.arrays, data.places)
        nodes = np.ascontiguousarray(mesh.vertices[around])
        z, free = np.full(len(mesh.vertices), np.nan), replace(self, ties=True)
        if self.border is None:
            z[around] = free.heights(work, points, nodes)
        else:
            z[around], _ = free.certain_heights(work, points, nodes, self.border[1])
        terms, after = correction(work, mesh.vertices, mesh.triangles, *one_sheet(z, data))
        return replace(free, terms=terms if len(terms.radii) else None), missed_warnings(data, after)

    def _extrapolated(self, task: Task, result: Result) -> Result:
        outside = result.outside
        if outside is None:
            if self.hull is None:
                return result
            outside = outside_hull(replace(task, points=self.hull))
        return replace_extrapolated(task, result, outside)

    def _task(self, work: Work, points: np.ndarray, nodes: np.ndarray) -> Task:
        return Task(work, points, nodes, self.settings, ties=self.ties)

    def _result(self, task: Task) -> Result:
        if self.known is not None:
            return from_neighbours.krige(task, self.known)
        if self.grid is not None:
            return bilinear(task, self.grid)
        if isinstance(self.fit, Plane):
            return self.fit.at(task.nodes)
        if self.fit is not None:
            return Result(np.full(len(task.nodes), self.fit))
        if self.method == "spline":
            return from_neighbours.thin_plate(task, self.spacing)
        return run_method(self.method, task)

    def beyond_radius(self, work: Work, points: np.ndarray, nodes: np.ndarray) -> np.ndarray:
        """(N,) bool: the nodes that have no point within the radius."""
        return from_neighbours.beyond_radius(self._task(work, points, nodes))

    def warnings(self, found: PartHeights, rock: Rock, number: int) -> list[BuildWarning]:
        """The warnings about the whole surface. Raises InputRefused where no triangle is left."""
        if not found.triangles:
            file, line = rock.surfaces[number].shape_source()
            raise no_triangle_known().within(surface_item(rock, rock.surfaces[number]), file=file, line=line)
        name = rock.surfaces[number].name
        points = np.array([[0, 0, self.lowest], [0, 0, self.highest]])
        texts = from_neighbours.without_near_points(found.alone, self.nodes)
        texts += runs_away(points, np.array([found.lowest, found.highest]), self.method)
        warnings = [BuildWarning(text, "points", rock.name, name) for text in texts]
        if found.raised and self.least is not None:
            warnings.append(
                raised_above(rock, number, found.raised, self.nodes, self.least, found.by, found.place)
            )
        return warnings


@dataclass(frozen=True)
class PartHeights:
    """Statistics of the heights of a part of a surface. lowest, highest: before any were raised. triangles:
    their number. Of the nodes that are counted in this part: alone, the number without a point within the
    radius; raised, the number of raised ones; by, worst, place: the largest rise, its node, and where it
    is."""

    lowest: float
    highest: float
    triangles: int
    alone: int = 0
    raised: int = 0
    by: float = 0.0
    worst: int = 0
    place: tuple[float, float] = (0.0, 0.0)

    def joined(self, other: PartHeights) -> PartHeights:
        """The statistics of both parts."""
        worst = min((self, other), key=lambda each: (-each.by, each.worst))
        return replace(
            worst,
            lowest=min(self.lowest, other.lowest),
            highest=max(self.highest, other.highest),
            triangles=self.triangles + other.triangles,
            alone=self.alone + other.alone,
            raised=self.raised + other.raised,
        )


def local_surfaces(entry: RockInput) -> set[int]:
    """The numbers of the surfaces of a RockInput that can be interpolated in parts. Surfaces that they need,
    or that other surfaces need, are included only if they have heights everywhere."""
    rock = entry.rock
    pairs = enumerate(zip(rock.surfaces, entry.data, strict=True))
    found = {number for number, (surface, data) in pairs if is_local(rock, surface, data)}
    while True:
        others = set(range(len(rock.surfaces))) - found
        asked = {each for number in others for each in needed_surfaces(rock, number)}
        complete = {number for number in found if not _ends(rock.surfaces[number])}
        complete |= {number for number in others if _is_everywhere(rock, rock.surfaces[number])}
        lacking = {number for number in found if not complete.issuperset(needed_surfaces(rock, number))}
        if not found & (asked | lacking):
            return found
        found -= asked | lacking


def is_local(rock: Rock, surface: Surface, data: SurfaceData) -> bool:
    """Whether the heights of a surface at some nodes do not depend on others."""
    if not rock.is_interpolated(surface):
        return False
    if surface.series is not None:
        return False  # the other sheets count, too
    if surface.true_thickness:
        return False  # the other surface counts around each node
    method, settings = surface.method_options()
    is_more_known = data.dips is not None or len(data.bounds) > 0 or data.error > 0
    if METHODS[method].is_constrained and is_more_known:
        return False  # how dips, bounds and errors count depends on all of them
    if METHODS[method].needs_points(settings) and not len(data.points):
        return False
    if surface.tie and data.is_along_bounds:
        return False  # where bounds do not hold, its points yield
    is_tied = surface.tie and (len(data.bounds) > 0 or len(data.tied_points(surface)) > 0)
    if surface.minimum_thickness is not None and is_tied:
        return False  # raised, it honors data that may share triangles
    if method == "parallel":
        return settings["thickness"] is not None and not is_tied
    if method == "plane" and settings["extrapolate"] == "nearest":  # contradicting points count only there
        return False
    if _ends(surface) and surface.minimum_thickness is not None:  # it is raised where it is left
        return False
    return METHODS[method].is_local or METHODS[method].is_triangulated


def _ends(surface: Surface) -> bool:
    """Whether a surface ends where its points do."""
    return surface.method_options()[1].get("extrapolate") == "none"


def _is_everywhere(rock: Rock, surface: Surface) -> bool:
    """Whether a surface that is made as a whole has a height at each node of the region's mesh."""
    is_made = rock.is_interpolated(surface)
    return is_made and surface.method_options()[0] != "parallel" and not _ends(surface)


def local_heights(
    work: Work,
    points: np.ndarray,
    extent: np.ndarray,
    nodes: int,
    method: str,
    settings: dict,
    arrays: MappedArrays | None = None,
) -> tuple[LocalHeights, np.ndarray, list[str]]:
    """The shared data of a surface, found from all its points, which may be in a file; the points that its
    parts are interpolated from, one at each position in plan; and warnings. extent: (2, 2), of all nodes.
    arrays: where arrays as long as the points are kept; None: in memory. Raises InputRefused."""
    zeros, gather = (np.zeros, in_memory) if arrays is None else (arrays.zeros, arrays.gather)
    given, grid, mis_ties, are_apart = points, None, None, False
    with refused_as(refused_points) as native:
        if method == "grid":  # a raster rarely has several points at a node
            grid = find_grid(points)
            are_apart = has_each_node_once(points, grid, zeros)
        if not are_apart:
            points, mis_ties, are_apart = each_place_once(given, zeros, gather)
            if method == "grid":  # repeated points count for its position and spacing
                counted, _ = without_mis_ties(given, zeros, gather)
                grid = find_grid(counted)
                require_one_height(counted, grid, zeros=zeros)
            elif _compares_points(method) and not (are_apart and _are_usable(points)):
                native.mean_spacing(without_mis_ties(given)[0])  # it refuses them
        warnings = [
            *([mis_ties] if mis_ties else []),
            *few_points(points, method, np.empty(0)),
            *elsewhere(points, extent),
        ]
        found = LocalHeights(method, settings, nodes, grid=grid)
        if len(points):
            found = replace(found, lowest=float(points[:, 2].min()), highest=float(points[:, 2].max()))
        found, of_method = _fitted(found, Task(work, points, np.empty((0, 2)), settings))
        warnings += of_method
        if settings.get("extrapolate") in ("nearest", "none") and method != "grid":
            found = replace(found, hull=hull_corners(points))
        if found.takes_points:  # of no nodes: it checks the settings
            found.heights(work, np.array(points[:1]), np.empty((0, 2)))
    return found, points if found.takes_points else np.empty((0, 3)), warnings


def _fitted(found: LocalHeights, task: Task) -> tuple[LocalHeights, tuple[str, ...]]:
    """With the data that the method finds from all points; and its warnings."""
    method, settings = found.method, found.settings
    if method == "grid":
        return replace(found, needed=1), ()  # where the grid lacks a node
    if method == "constant":
        value = settings["value"]
        return replace(found, fit=mean_height(task.points) if value is None else value), ()
    if method == "plane":
        return replace(found, fit=fitted_plane(task.points, settings)), ()
    if METHODS[method].is_triangulated:
        border = hull_border(task.points)
        if len(native_module().hull_corners(np.ascontiguousarray(border[:, :2] - border[0, :2]))) < 3:
            return replace(found, needed=len(task.points)), ()  # in one line
        low, high = task.points[:, :2].min(axis=0), task.points[:, :2].max(axis=0)
        box = (*low.tolist(), *high.tolist())
        return replace(found, needed=_NEIGHBORS_OF_TRIANGLES, border=(border, box)), ()
    if method == "parallel":
        to = settings["to"]
        return (replace(found, over=float(to)), ()) if isinstance(to, float) else (found, ())
    warnings: tuple[str, ...] = ()
    neighbours = settings["neighbours"]
    if "kriging" in method:
        known = from_neighbours.structure(task, are_apart=True)
        neighbours, warnings = known.neighbours, known.warnings
        found = replace(found, known=replace(known, warnings=()))
    elif method == "spline":
        found = replace(found, spacing=native_module().mean_spacing(task.points, are_apart=True))
    octants, radius = settings["octants"], settings["radius"]
    if not neighbours and not octants and radius is not None:
        return replace(found, needed=1, reach=radius), warnings
    limit = min(neighbours or len(task.points), 8 * octants or len(task.points))
    return replace(found, needed=_LOOKED_AT * limit + 1 if 0 < octants < limit else limit), warnings


def linked(local: LocalHeights, rock: Rock, number: int) -> LocalHeights:
    """The same, linked to the other surfaces that a surface of a rock mass needs."""
    to = local.settings.get("to")
    if isinstance(to, str):
        local = replace(local, over=named_surfaces(rock, number)[to])
    return replace(local, least=rock.surfaces[number].minimum_thickness)


def _compares_points(method: str) -> bool:
    """Whether a method refuses points at one place of which heights differ."""
    return METHODS[method].is_triangulated or "neighbours" in METHODS[method].options


def _are_usable(points: np.ndarray) -> bool:
    """Whether native code takes them: it squares coordinates."""
    return all(points[:, axis].min() > -_MOST and points[:, axis].max() < _MOST for axis in range(3))
