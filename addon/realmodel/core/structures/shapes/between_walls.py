# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies from intervals, such as veins, sills and lenses: what lies between their hanging and footwall
contacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...base.algebra import ascending, cos, dot, norm, principal_axes, sin
from ...base.errors import InputRefused, counted, number_list
from ...base.triangles import Sheet
from ...base.work import Work
from ...heights import Task, heights
from ...readers.tables.observations import Observations, in_one_interval
from ...settings.methods import checked_options
from ...surfaces.planar_mesh import MeshOptions, mesh_rings
from .fitted import convex_hull, plane_axes

_IN_LINE = 0.1  # of the extent of contacts along a line: so near to it, they show no dip across it
_ALONG = 0.1  # of a direction: with so little of it across a plane it runs along that
_ROUND = 16  # places around a contact where the body has ended
_EDGES = 5  # from a contact to where the body ends, at least
_MOST_EDGES = 50  # across the body
_NEAR = 0.05  # of an edge: contacts so near one another, seen along the plane, are one place
_OFF = 1e-3  # of a share of the thickness: no vertex is nearer to where the body ends


class Pierced(NamedTuple):
    """What holes say of a body. ends: (K, 2, 3) where each hole enters and leaves it. without: (S, 2, 3) ways
    along holes that are not in it."""

    ends: np.ndarray
    without: np.ndarray


def pierced(name: str, observations: Sequence[Observations]) -> tuple[Pierced, list[str]]:
    """What the intervals of holes say of a body; and warnings, sentences. Of several intervals in one hole
    the longest counts."""
    ends: dict[str, list[np.ndarray]] = {}
    open_ended: list[str] = []
    without: list[np.ndarray] = []
    for seen in observations:
        in_hole = in_one_interval(seen, seen.in_use) & (seen.holes != "")
        for row in np.flatnonzero(in_hole).tolist():
            way = seen.places[row - 1 : row + 1]
            if seen.blocks[row] != name:
                without.append(way)
                continue
            intervals = ends.setdefault(str(seen.holes[row]), [])
            if intervals and (intervals[-1][1] == way[0]).all():
                way = np.array([intervals.pop()[0], way[1]])
            intervals.append(way)
            if row + 1 == len(seen) or seen.holes[row + 1] != seen.holes[row]:
                open_ended.append(f"'{seen.holes[row]}'")
    longest = [max(intervals, key=lambda way: norm(way[1] - way[0])) for intervals in ends.values()]
    several = [f"'{hole}'" for hole, intervals in ends.items() if len(intervals) > 1]
    warnings = []
    for holes, said in (
        (several, "met it several times: the longest interval counts; name the others differently"),
        (open_ended, "ended in it: it is taken to end there, and may be thicker"),
    ):
        if holes:
            warnings.append(f"{'hole' if len(holes) == 1 else 'holes'} {number_list(holes)} {said}")
    return Pierced(_ways(longest), _ways(without)), warnings


def _ways(ways: list[np.ndarray]) -> np.ndarray:
    return np.array(ways, np.float64).reshape(-1, 2, 3)


def body_between_walls(work: Work, met: Pierced, reach: float | None = None) -> tuple[Sheet, list[str]]:
    """The closed surface of a body around its intervals: vertices (V, 3) float64 and triangles (T, 3) int32;
    and warnings, sentences.

    Its hanging wall passes through the upper contacts, its footwall through the lower ones, both over the
    plane that fits the middles of the intervals best. Its thickness is interpolated between them, and falls
    to 0 halfway to holes that pass the plane without it; elsewhere at the distance `reach` from the contacts,
    by default half of that between neighboring holes. Raises InputRefused."""
    order = ascending(*met.ends.reshape(-1, 6).T)  # the order of holes must not decide a result
    ends, without = met.ends[order], met.without
    ends = ends[norm(ends[:, 1] - ends[:, 0]) > 0]
    if not len(ends):
        raise InputRefused(
            "no interval of a borehole is in it", advice="give its name to intervals, or a mesh"
        )
    axes, warnings = _plane(ends)
    center = ends.mean(axis=(0, 1))
    walls, passing = (_local(ways - center, axes) for ways in (ends, without))
    is_over = walls[:, 0, 2] >= walls[:, 1, 2]
    hanging, footwall = (
        np.where(chosen[:, None], walls[:, 0], walls[:, 1]) for chosen in (is_over, ~is_over)
    )
    middles = (hanging + footwall) / 2
    places = np.unique(np.vstack([hanging[:, :2], footwall[:, :2]]), axis=0)
    absent = _crossings(work, middles, passing)
    reach = _reach(middles[:, :2], absent, reach)
    plan, triangles, share = _extent(work, places, absent, reach)
    middle = _kriged(work, middles, plan)
    top, bottom = (
        _wall(work, plan, middle, share, contacts, sign, warnings)
        for contacts, sign in ((hanging, 1.0), (footwall, -1.0))
    )
    local = _closed(triangles, share, top, bottom)
    vertices = center + dot(local.vertices[:, None], axes.T[None])
    return Sheet(vertices, local.triangles), warnings


def _plane(ends: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """The axes, in rows, of the plane of a body by its intervals (K, 2, 3), the last one upward; warnings.
    Where they lie in a line, or holes run along the plane, it is as level as they allow."""
    middles = ends.mean(axis=1)
    ways = ends[:, 0] - ends[:, 1]
    hole = ways.sum(axis=0) / norm(ways).sum()
    level = np.array([0.0, 0.0, 1.0])
    spread, directions = principal_axes(middles)
    normal, warnings = directions[2], list[str]()
    if len(ends) < 3 or spread[1] <= _IN_LINE * spread[0] or abs(dot(hole, normal)) < _ALONG:
        across = hole if abs(hole[2]) < _ALONG else level
        along = directions[0] if len(ends) > 1 else np.zeros(3)
        normal = across - dot(across, along) * along
        if abs(dot(hole, normal)) < _ALONG * norm(normal) or norm(normal) < _ALONG:
            normal = hole  # in holes above one another
        those = "one interval shows no dip" if len(ends) == 1 else "intervals in a line show no dip across it"
        warnings = [f"{those}: it is as level as they allow; give a mesh, or intervals of more holes"]
    normal = normal / norm(normal)
    along, down, normal = plane_axes(-normal if dot(normal, level) < 0 else normal)
    return np.array([along, down, normal] if normal[2] >= 0 else [along, -down, -normal]), warnings


def _local(places: np.ndarray, axes: np.ndarray) -> np.ndarray:
    return np.stack([dot(places, axis) for axis in axes], axis=-1)


def _kriged(work: Work, points: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """(N,) values at nodes (N, 2) through points (P, 3), of a variogram that is all but linear."""
    size = float(np.ptp(np.vstack([points[:, :2], nodes]), axis=0).max()) or 1.0
    variogram = {"model": "spherical", "range": 4 * size, "sill": 1.0, "nugget": 0.0}
    settings = checked_options("kriging", {"neighbours": 0, "variogram": variogram})
    task = Task(work, np.ascontiguousarray(points), np.ascontiguousarray(nodes), settings)
    return heights("kriging", task).z


def _crossings(work: Work, middles: np.ndarray, ways: np.ndarray) -> np.ndarray:
    """(A, 2) where ways (S, 2, 3) pass the surface through the middles of a body."""
    if not len(ways):
        return np.empty((0, 2))
    ends = ways.reshape(-1, 3)
    above = (ends[:, 2] - _kriged(work, middles, ends[:, :2])).reshape(-1, 2)
    passes = (above[:, 0] > 0) != (above[:, 1] > 0)
    first, last = above[passes].T
    share = (first / (first - last))[:, None]
    plan = ways[passes][:, :, :2]
    return np.unique(plan[:, 0] + share * (plan[:, 1] - plan[:, 0]), axis=0)


def _reach(middles: np.ndarray, absent: np.ndarray, reach: float | None) -> float:
    if reach is not None:
        return reach
    places = np.unique(np.vstack([middles, absent]), axis=0)
    if len(places) < 2:
        raise InputRefused(
            "one hole alone does not say how far it goes", advice="give the distance: reach = ..."
        )
    away = norm(places[:, None] - places[None])
    np.fill_diagonal(away, np.inf)
    return float(np.median(away.min(axis=1))) / 2


def _extent(
    work: Work, places: np.ndarray, absent: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where a body with contacts at places (K, 2) is: nodes (N, 2) and triangles of a planar mesh, and (N,)
    the share of its thickness that it has there: 1 at contacts, 0 where it ends, less beyond."""
    angles = np.arange(_ROUND) * (2 * np.pi / _ROUND)
    around = 2 * reach * np.column_stack([cos(angles), sin(angles)])
    ring = (places[:, None] + around).reshape(-1, 2)
    ring = ring[norm(ring[:, None] - places[None]).min(axis=1) > 2 * reach * (1 - _OFF)]
    outline = convex_hull(ring)
    away = norm(absent[:, None] - places[None]).min(axis=1) if len(absent) else np.empty(0)
    size = float(np.ptp(outline, axis=0).max())
    absent = absent[(away < 2 * reach) & (away > _OFF * reach)]
    nearest = min(reach, away[away > _OFF * reach].min(initial=np.inf) / 2)
    edge = min(max(nearest / _EDGES, size / _MOST_EDGES), reach / 2)
    nodes = _apart(places, _NEAR * edge)
    options = MeshOptions(edge, constraint_points=nodes)
    plan, triangles = mesh_rings(work, [outline], options)
    known = np.vstack([places, absent, ring])
    shares = np.concatenate([np.ones(len(places)), np.full(len(absent) + len(ring), -1.0)])
    points = np.ascontiguousarray(np.column_stack([known, shares]))
    share = heights("tin", Task(work, points, plan, checked_options("tin", {"extrapolate": "nearest"}))).z
    share[np.abs(share) < _OFF] = -_OFF
    share[norm(plan[:, None] - nodes[None]).min(axis=1) <= _OFF * edge] = 1.0
    on_outline = np.bincount(_border(triangles).ravel(), minlength=len(plan)) > 0
    share[on_outline] = np.minimum(share[on_outline], -_OFF)
    return plan, triangles, share


def _border(triangles: np.ndarray) -> np.ndarray:
    """(E, 2) the edges that one triangle alone has."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    return edges[count == 1]


def _apart(places: np.ndarray, least: float) -> np.ndarray:
    """Some of places (K, 2), no two of them nearer than so much."""
    chosen: list[np.ndarray] = []
    for place in places:
        if all(norm(place - other) > least for other in chosen):
            chosen.append(place)
    return np.array(chosen)


def _wall(
    work: Work,
    plan: np.ndarray,
    middle: np.ndarray,
    share: np.ndarray,
    contacts: np.ndarray,
    sign: float,
    warnings: list[str],
) -> np.ndarray:
    """(N, 3) a wall at nodes (N, 2), on its side of the middle: through contacts (K, 3) of it. sign: 1 above,
    -1 below."""
    at = norm(plan[:, None] - contacts[None, :, :2]).argmin(axis=0)  # nodes: _extent sees to it
    thick = sign * (contacts[:, 2] - middle[at])
    if (thick < 0).any():
        wall = "hanging wall" if sign > 0 else "footwall"
        warnings.append(
            f"{counted(int((thick < 0).sum()), 'contact')} of its {wall} lie beyond its middle between other "
            "holes, and are not met: check their depths"
        )
        thick = np.maximum(thick, 0.0)
    half = _kriged(work, np.column_stack([plan[at], thick]), plan)
    half = np.clip(half, thick.min(), thick.max())
    half[at] = thick
    wall_places = np.column_stack([plan, middle + sign * half * share])
    wall_places[at, :2] = contacts[:, :2]  # which may share a node with one of the other wall
    return wall_places


def _closed(triangles: np.ndarray, share: np.ndarray, top: np.ndarray, bottom: np.ndarray) -> Sheet:
    """The closed surface over the part of triangles where a share of nodes is above 0, between a top and a
    bottom (N, 3), which meet where it is 0."""
    middle = (top + bottom) / 2
    vertices: list[np.ndarray] = []
    numbers: dict[tuple, int] = {}

    def vertex(key: tuple, place: np.ndarray) -> int:
        if key not in numbers:
            numbers[key] = len(vertices)
            vertices.append(place)
        return numbers[key]

    def end(a: int, b: int) -> int:
        a, b = min(a, b), max(a, b)
        part = share[a] / (share[a] - share[b])
        return vertex((a, b, 0), middle[a] + part * (middle[b] - middle[a]))

    faces: list[tuple[int, int, int]] = []
    is_in = share > 0
    for triangle in triangles[is_in[triangles].any(axis=1)].tolist():
        for side, wall in ((1, top), (-1, bottom)):
            ring = []
            for a, b in zip(triangle, [*triangle[1:], triangle[0]], strict=True):
                if is_in[a]:
                    ring.append(vertex((a, a, side), wall[a]))
                if is_in[a] != is_in[b]:
                    ring.append(end(a, b))
            ring = ring[::side]
            faces += [(ring[0], ring[at], ring[at + 1]) for at in range(1, len(ring) - 1)]
    return Sheet(np.array(vertices, np.float64), np.array(faces, np.int32))
