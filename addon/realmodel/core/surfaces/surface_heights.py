# SPDX-License-Identifier: GPL-3.0-or-later
"""The heights of the surfaces of a rock mass: the order of interpolation, and minimum thicknesses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..base.errors import BuildWarning, InputRefused, place_text
from ..base.triangles import Sheet
from ..base.work import Work, native_module
from ..heights import Interpolation, heights
from ..heights.interpolation import Task, heights_of
from ..heights.mis_ties import without_mis_ties
from ..heights.on_mesh import BOUNDS, within_bounds
from ..heights.run import elsewhere
from ..heights.ties import corrected, raised_heights, tie_data
from ..heights.true_thickness import Base
from ..project.project import Rock, Surface
from ..settings.methods import METHODS, checked_options
from .observed.conformable import alike_of, bounds_beside, companions_of
from .observed.surface_data import SurfaceData
from .rock_input import RockInput, named_surfaces
from .wrong_sides import heights_at, listed


class Trend(NamedTuple):
    """What the few points of a surface, or none, are interpolated on. sheet: it; z: (N,) its heights at the
    nodes of the planar mesh, NaN where it has none. interpolation, attributes: of the points that it was made
    from. method, options: by which what points differ from it is interpolated."""

    sheet: Sheet
    z: np.ndarray
    interpolation: Interpolation
    attributes: dict[str, np.ndarray]
    method: str
    options: dict


def used_vertices(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(V,) bool: the vertices that triangles name."""
    used = np.zeros(len(vertices), bool)
    used[triangles] = True
    return used


def needed_surfaces(rock: Rock, number: int) -> list[int]:
    """The surfaces that have to have heights before one of them."""
    needs = list(named_surfaces(rock, number).values())
    if rock.surfaces[number].minimum_thickness is not None:
        needs.append(number - 1)
    return needs


def counts_by_node(rock: Rock, number: int, surface: Surface, data: SurfaceData) -> bool:
    """Whether heights of a surface, instead of one of a rock mass, follow at each node from points near
    it alone, without other surfaces and nodes."""
    method, settings = surface.method_options()
    is_tied = surface.tie and (len(data.bounds) > 0 or len(data.tied_points(surface)) > 0)
    is_more_known = data.dips is not None or len(data.bounds) > 0 or data.error > 0
    if (
        needed_surfaces(rock, number)
        or surface.series is not None  # the other sheets count, too
        or surface.true_thickness  # the other surface counts around each node
        or settings.get("extrapolate") == "none"
        or settings.get("neighbours") == 0  # all points are one system
        or (METHODS[method].is_constrained and is_more_known)  # these count for all nodes together
        or (METHODS[method].needs_points(settings) and not len(data.points))
        or (surface.tie and data.has_only_bound_points)  # where bounds do not hold, its points yield
        or (method == "plane" and settings["extrapolate"] == "nearest")  # its points count only there
    ):
        return False
    if method == "parallel":
        return settings["thickness"] is not None and not is_tied
    return METHODS[method].is_local or METHODS[method].is_triangulated


def interpolation_order(rock: Rock, last: int | None = None) -> list[int]:
    """The surfaces to be given heights so that those up to `last` (None: all) have theirs, each after those
    that it needs. check_project has made sure that there is such an order."""
    order: list[int] = []

    def visit(number: int) -> None:
        if number in order:
            return
        for needed in needed_surfaces(rock, number):
            visit(needed)
        order.append(number)

    for number in range(len(rock.surfaces) if last is None else min(last + 1, len(rock.surfaces))):
        visit(number)
    return [number for number in order if rock.is_interpolated(rock.surfaces[number])]


def _vertex_attributes(work: Work, points: np.ndarray, result: Interpolation, region: Sheet) -> dict:
    """Attributes (V,) of the vertices that `where_known` keeps, for points interpolated on a region's mesh:
    `variance` of the height's error, NaN where it is not known, and `distance` in plan to the nearest point,
    NaN where there are no points."""
    nodes, triangles = region
    is_kept = np.isfinite(result.z)
    if not is_kept.all():
        is_kept = used_vertices(nodes, triangles[is_kept[triangles].all(axis=1)])
    variance = np.full(len(nodes), np.nan) if result.variance is None else result.variance
    if len(points):
        distance = work.native(native_module().nearest_distance, points, nodes)
    else:
        distance = np.full(len(nodes), np.nan)
    return {"variance": variance[is_kept], "distance": distance[is_kept]}


def give_heights(work: Work, entry: RockInput, number: int, trend: Trend | None = None) -> None:
    """Interpolates one surface of a RockInput on the mesh of its region, on a trend if there is one, and
    keeps it above the older one where it has a minimum thickness."""
    rock, surface, data = entry.rock, entry.rock.surfaces[number], entry.data[number]
    nodes, triangles = region = entry.planar_mesh()
    method, settings = surface.method_options()
    others: dict = {name: entry.surfaces[n] for name, n in named_surfaces(rock, number).items()}
    with entry.named(number):
        if trend is not None:
            result, free = _on_trend(work, entry, number, trend, others)
        else:
            draws = None if number == rock.terrain_number else entry.draws  # a terrain is measured
            give = heights if draws is None else draws[number].heights
            companions = companions_of(rock, entry.data, number, entry.joint_fits)
            task = Task(work, data.points, nodes, settings, triangles, surfaces=others)
            task = replace(task, dips=data.dips, companions=companions, ties=surface.tie)
            task = replace(task, alike=alike_of(rock, entry.data, number, entry.joint_fits))
            bounds = bounds_beside(data.bounds, companions)
            task = replace(task, bounds=bounds, true_thickness=surface.true_thickness, error=data.error)
            result, free = _tied(task, give(method, task), surface, data)
        shape = where_known(nodes, triangles, result.z)
        if trend is not None and not len(data.points):
            attributes = trend.attributes
        else:
            attributes = _vertex_attributes(work, data.points, result, region)
        warnings = [BuildWarning(text, "points", rock.name, surface.name) for text in result.warnings]
        if surface.minimum_thickness is not None:
            warnings += _older_points_above(work, entry, number, shape)
            shape, raised = _above_older(work, entry, number, shape)
            warnings += raised
    if free is not result.z and entry.draws is None:
        entry.untied[shape] = where_known(nodes, triangles, free)
    entry.surfaces[number] = shape
    entry.interpolations[number] = result
    entry.attributes[number] = attributes
    entry.warnings += warnings


def _tied(
    task: Task, result: Interpolation, surface: Surface, surface_data: SurfaceData
) -> tuple[Interpolation, np.ndarray]:
    """The heights with which a surface honors its points and bounds on the mesh of its region; and those that
    it had, the same array where it keeps them."""
    if not surface.tie or task.triangles is None or not len(task.triangles):
        return result, result.z
    free = result.z
    data = tie_data(surface_data.tied_points(surface), task.bounds)
    z, warnings = corrected(task.work, task.nodes, task.triangles, free, data)
    if warnings and surface_data.has_only_bound_points:  # its places yield to its bounds
        data = tie_data(np.empty((0, 3)), task.bounds)
        z, warnings = corrected(task.work, task.nodes, task.triangles, free, data)
    if z is not free:
        z = within_bounds(task, z, free)
    return replace(result, z=z, warnings=(*result.warnings, *warnings)), free


def _on_trend(
    work: Work, entry: RockInput, number: int, trend: Trend, others: dict
) -> tuple[Interpolation, np.ndarray]:
    """The heights of a surface of a RockInput on a trend, within the bounds of its method, as of _tied."""
    surface, data, (nodes, triangles) = entry.rock.surfaces[number], entry.data[number], entry.planar_mesh()
    dips = data.dips
    points, mis_ties = without_mis_ties(data.points)
    away = points.copy()
    away[:, 2] -= heights_at(work, trend.sheet, points[:, :2])
    away = away[np.isfinite(away[:, 2])]
    result = replace(trend.interpolation, z=trend.z)
    if len(away):
        # of an ensemble the trend is drawn, too: nothing is the same in the next realization
        give = heights if entry.draws is None else replace(entry.draws[number], known={}).heights
        settings = checked_options(trend.method, trend.options)
        result = give(trend.method, Task(work, away, nodes, settings, triangles))
        result = replace(result, z=trend.z + result.z)
    task = Task(work, points, nodes, surface.method_options()[1], triangles, surfaces=others)
    border = result.z
    if task.settings.get("border") is not None:
        border_heights = heights_of(task, task.settings["border"], nodes, "border")
        border = np.where(np.isfinite(border_heights), border_heights, border)
    warnings = [*([mis_ties] if mis_ties else []), *elsewhere(points, nodes)]
    if dips is not None and len(dips):
        warnings.append(
            f"its {len(dips)} dips have no effect where its points are few: there it follows the surface "
            "beyond a fault"
        )
    result = replace(result, z=within_bounds(task, result.z, border), warnings=tuple(warnings))
    return _tied(replace(task, bounds=data.bounds), result, surface, data)


def _older_points_above(work: Work, entry: RockInput, number: int, shape: Sheet) -> list[BuildWarning]:
    """The points of the older surface above one that is to keep off it, before this is raised."""
    points = entry.data[number - 1].points
    if not len(points):
        return []
    z = heights_at(work, shape, points[:, :2])
    return listed(entry, number - 1, points[:, 2] - z, "above", number)


def where_known(nodes: np.ndarray, triangles: np.ndarray, z: np.ndarray) -> Sheet:
    """The triangles all of whose nodes have a height: all of them, unless extrapolation was not wanted."""
    is_known = np.isfinite(z)
    if is_known.all():
        return Sheet(np.column_stack([nodes, z]), triangles)
    faces = triangles[is_known[triangles].all(axis=1)]
    if not len(faces):
        raise no_triangle_known()
    used = used_vertices(nodes, faces)
    number = np.cumsum(used, dtype=np.int32) - 1
    return Sheet(np.column_stack([nodes[used], z[used]]), number[faces])


def no_triangle_known() -> InputRefused:
    return InputRefused(
        "no triangle of the region's mesh has elevations at all its nodes",
        advice='extrapolate = "method" or "nearest" gives elevations beyond the points',
    )


def _above_older(work: Work, entry: RockInput, number: int, shape: Sheet) -> tuple[Sheet, list[BuildWarning]]:
    """The shape, raised to the minimum thickness above the older surface, and warnings where it was
    raised."""
    rock = entry.rock
    surface = rock.surfaces[number]
    thickness = surface.minimum_thickness
    assert thickness is not None
    (vertices, triangles), older = shape, entry.surface(number - 1)
    if np.array_equal(older.vertices[:, :2], vertices[:, :2]):
        below = older.vertices[:, 2]
    else:
        below = heights_at(work, older, vertices[:, :2])
    if surface.true_thickness:
        plan = np.ascontiguousarray(vertices[:, :2])
        least = Base(work, older, thickness).heights(plan, below, np.full(len(plan), thickness))
    else:
        least = below + thickness
    raised, lift = raise_to(vertices[:, 2], least)
    if raised is None:
        return shape, []
    has_limits = any(key in surface.options for key in BOUNDS)  # they come before data
    if surface.tie and not has_limits:
        plan = np.ascontiguousarray(vertices[:, :2])
        surface_data = entry.data[number]
        data = tie_data(surface_data.tied_points(surface), surface_data.bounds)
        raised = raised_heights(work, plan, triangles, raised, least, data)
    worst = int(lift.argmax())
    place = tuple(vertices[worst, :2].tolist())
    warning = raised_above(rock, number, int((lift > 0).sum()), len(vertices), thickness, lift[worst], place)
    return Sheet(np.column_stack([vertices[:, :2], raised]), triangles), [warning]


def raise_to(z: np.ndarray, least: np.ndarray) -> tuple[np.ndarray | None, np.ndarray]:
    """Heights (N,) raised to the least ones where these are known, None where all are high enough; and by how
    much each was."""
    lift = np.where(np.isfinite(least), least - z, 0.0)
    lift[~(lift > 0)] = 0.0
    return (np.where(lift > 0, least, z) if lift.any() else None), lift


def raised_above(
    rock: Rock,
    number: int,
    count: int,
    nodes: int,
    thickness: float,
    by: float,
    place: Sequence[float] | np.ndarray,
) -> BuildWarning:
    """The warning about a surface that was raised at some of its nodes to its minimum thickness above the
    older one. count: of these nodes; by, place: the largest rise, and where it is."""
    measured = ", perpendicular to it" if rock.surfaces[number].true_thickness else ""
    text = (
        f"raised at {count} of {nodes} nodes to stay {thickness:g} above "
        f"'{rock.surfaces[number - 1].name}'{measured}, by up to {by:.4g} at {place_text(place)}"
    )
    return BuildWarning(text, "minimum_thickness", rock.name, rock.surfaces[number].name)
