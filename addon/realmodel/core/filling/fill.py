# SPDX-License-Identifier: GPL-3.0-or-later
"""The exact fill: the stack of the beds, cut by the solid."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import twice_area
from ..base.errors import BuildWarning, InputRefused, place_text
from ..base.named import keyword_only
from ..base.triangles import Sheet, border_loops, checked_triangulation, open_edges, welded
from ..base.work import Cancel, Progress, Work, native_module, run
from ..model.build import build
from ..model.cutting import cut_by_surface
from ..model.model import Model
from ..project.project import Project, Rock
from ..results.booleans import intersect_within
from ..settings.method_options import check_threads
from ..surfaces.planar_mesh import triangulate_polygon
from ..surfaces.surface_input import SurfaceArrays
from .bed_sheets import sheets_of
from .beds import Beds, check_gap, lay_beds
from .erosion import DifferentialErosion, eroded_within, kept_of
from .pegs import place_pegs
from .strata import Strata, rocks_of_beds

Mesh = tuple[np.ndarray, np.ndarray]

ITEM = "the mesh"  # as refusals name it
_FAR = 10.0  # sizes of the mesh: how far away the solid is that takes nothing from it


def closed_mesh(vertices: ArrayLike, triangles: ArrayLike, base: float | None = None) -> Mesh:
    """A mesh without open edges: the given one, or, where that has one height at each position, it with walls
    and a level floor at the elevation `base` (None: as far beneath its lowest point as its highest is above).

    vertices (V, 3), triangles (T, 3). Vertices that are given come first, unchanged. Raises InputRefused for
    a mesh that is open otherwise, or that reaches down to the base.
    """
    vertices, triangles = checked_triangulation(vertices, triangles)
    edges = open_edges(vertices, triangles)
    if not len(edges):
        return vertices, triangles
    place = tuple(vertices[edges[0]].mean(axis=0).tolist())
    native, plan = native_module(), vertices[:, :2]
    turns = native.orient2d(*(plan[triangles[:, k]] for k in range(3)))
    if not ((turns > 0).all() or (turns < 0).all()):
        raise InputRefused(
            f"it is open, for example near {place_text(place)}, and has not one height at each position",
            item=ITEM,
            advice="close it, or remove overhangs and vertical faces",
            place=place,
        )
    if turns[0] < 0:
        triangles = triangles[:, ::-1]
    lowest, highest = float(vertices[:, 2].min()), float(vertices[:, 2].max())
    base = 2.0 * lowest - highest if base is None else float(base)
    if base >= lowest:
        raise InputRefused(
            f"it is open and reaches down to {lowest:.6g}, which is not above the base at {base:.6g}",
            item=ITEM,
            advice="choose a deeper base",
        )
    return _down_to(vertices, triangles, base)


def without_holes(vertices: ArrayLike, triangles: ArrayLike) -> Mesh:
    """A mesh whose holes are closed, each by triangles around the mean of its border. Vertices that are given
    come first, unchanged. Raises InputRefused."""
    vertices, triangles = checked_triangulation(vertices, triangles)
    if not len(open_edges(vertices, triangles)):
        return vertices, triangles
    loops = border_loops(triangles)
    middles = np.array([vertices[loop].mean(axis=0) for loop in loops])
    fans = [
        np.column_stack([np.roll(loop, -1), loop, np.full(len(loop), len(vertices) + number)])
        for number, loop in enumerate(loops)
    ]
    closed = np.concatenate([triangles, *fans]).astype(np.int32)
    return np.concatenate([vertices, middles]), closed


def _down_to(vertices: np.ndarray, triangles: np.ndarray, base: float) -> Mesh:
    """A mesh that faces up with walls and a floor."""
    loops = border_loops(triangles)
    outer = [loop for loop in loops if twice_area(vertices[loop, :2]) > 0]
    if len(outer) != 1:
        place = tuple(vertices[loops[-1][0]].tolist())
        raise InputRefused(
            f"it is open and in {len(outer)} parts, one of them near {place_text(place)}",
            item=ITEM,
            advice="join the parts, or fill one after the other",
            place=place,
        )
    loops = outer + [loop for loop in loops if loop is not outer[0]]
    corners = np.concatenate(loops)
    below = np.arange(len(vertices), len(vertices) + len(corners))
    deep = np.column_stack([vertices[corners, :2], np.full(len(corners), base)])
    plan = [vertices[loop, :2] for loop in loops]
    floor = below[triangulate_polygon(plan[0], plan[1:])][:, ::-1]
    onward = np.concatenate([np.roll(part, -1) for part in np.split(np.arange(len(corners)), _ends(loops))])
    walls = [
        np.column_stack([corners[onward], corners, below]),
        np.column_stack([corners[onward], below, below[onward]]),
    ]
    closed = np.concatenate([triangles, *walls, floor]).astype(np.int32)
    return np.concatenate([vertices, deep]), closed


def _ends(loops: list[np.ndarray]) -> np.ndarray:
    return np.cumsum([len(loop) for loop in loops])[:-1]


def solid_within(work: Work, mesh: Mesh, share: float) -> Mesh:
    """What is inside a closed mesh as a solid that does not cross itself, as the first part of a job. Where
    it does, what it covers twice counts once, as in Booleans. Raises InputRefused where its triangles face
    both ways, or it holds nothing."""
    try:
        intersection = intersect_within(work, mesh, _far_from(mesh[0]), share)
        made = intersection.difference()
    except InputRefused as error:
        raise InputRefused(
            error.what, item=ITEM, advice=error.advice, triangles=error.triangles, place=error.place
        ) from error
    if not len(made[1]):
        raise InputRefused("it holds no volume", item=ITEM, advice="give it some thickness")
    return made


def _far_from(vertices: np.ndarray) -> Mesh:
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    size = float((high - low).max()) or 1.0
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]) * size + high + _FAR * size
    return corners, np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)], np.int32)


_SOLID, _STACK = 0.3, 0.35  # the progress at the end of these steps
_EROSION = 0.3  # the same of erosion, where there is any


@keyword_only
def fill_with_strata(
    vertices: ArrayLike,
    triangles: ArrayLike,
    strata: Strata,
    *,
    erosion: DifferentialErosion | None = None,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Model:
    """Fills a closed mesh with strata, or an open one with a single height at each position down to a base.

    vertices (V, 3), triangles (T, 3). erosion: what is taken off the mesh first, so that hard beds stand out;
    None: nothing. Returns a model whose blocks are the beds, oldest first, `Bed 1` and so on: closed, with
    common faces, and together the mesh. Vertices of a mesh without erosion are not changed. Beds that are
    nowhere in the mesh are blocks without cells. With a gap, what is between beds is blocks, too, without a
    property: `Gap 1` and so on, each with the number of the bed beneath, and `Gap at Faults`.

    Raises InputRefused with a place for a mesh that is open otherwise, UsageError, Cancelled, BuildFailed.

    >>> corners = [(x, y, z) for x in (0, 4) for y in (0, 4) for z in (0, 3)]
    >>> sides = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    >>> sides += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    >>> model = fill_with_strata(corners, sides, Strata(beds=3, variation=0))
    >>> [(block.name, round(block.volume, 9)) for block in model.blocks]
    [('Bed 1', 16.0), ('Bed 2', 16.0), ('Bed 3', 16.0)]
    """
    threads = check_threads(threads)
    mesh = closed_mesh(vertices, triangles, strata.base)
    beds = lay_beds(strata, mesh[0])
    kept = kept_of(*mesh, len(np.asarray(triangles)))

    def fill(work: Work) -> tuple[Model, np.ndarray]:
        if erosion is None:
            return fill_within(work, mesh, beds, strata)
        with work.part(0.0, _EROSION):
            eroded = eroded_within(work, mesh, kept, beds, strata, erosion)
        with work.part(_EROSION, 1.0):
            return fill_within(work, eroded, beds, strata)

    model, places = run(fill, progress, cancel, threads=threads)
    surfaces = SurfaceArrays([Sheet(beds.leaned(nodes), of) for nodes, of in model.surface_arrays.shapes])
    return replace(model, complex=replace(model.complex, vertices=places), surface_arrays=surfaces)


def fill_within(
    work: Work, mesh: tuple[np.ndarray, np.ndarray], beds: Beds, strata: Strata
) -> tuple[Model, np.ndarray]:
    """`fill_with_strata` of a closed mesh with the beds that were laid through it, as a job. Returns the
    model in the space in which folds stand upright (`Beds`), where its surfaces have one height at each
    position, and where its vertices (V, 3) belong."""
    vertices, triangles = mesh
    mesh = beds.upright(vertices), triangles
    check_gap(beds, strata.gap)
    solid = solid_within(work, mesh, _SOLID)
    library, rocks = rocks_of_beds(beds.count, strata.palette, strata.seed)
    pegs = place_pegs(beds, strata, *mesh)
    surfaces = sheets_of(beds, rocks, strata.gap, pegs)
    project = Project("strata", [Rock("strata", surfaces)], library=library)
    with work.part(_SOLID, _STACK):
        stack = build(project, cells="blocks")
    with work.part(_STACK, 1.0):
        model = cut_by_surface(stack, *solid).inside
    lacking = strata.pegs * len(pegs.places) - pegs.count
    if lacking:
        model.warnings.append(
            BuildWarning(f"there is room for only {pegs.count} of the pegs; {lacking} are left out")
        )
    return model, _where_they_belong(beds, model.vertices, vertices)


def _where_they_belong(beds: Beds, vertices: np.ndarray, mesh_vertices: np.ndarray) -> np.ndarray:
    """(V, 3) vertices (V, 3) of the upright space, those of the given mesh without any change. Where rounding
    makes two equal, the later one takes a neighboring double, as everywhere in a model."""
    if not beds.lean.any():
        return vertices
    places = beds.leaned(vertices)
    same = welded(np.concatenate([beds.upright(mesh_vertices), vertices]))[len(mesh_vertices) :]
    is_of_mesh = same < len(mesh_vertices)
    places[is_of_mesh] = mesh_vertices[same[is_of_mesh]]
    order = np.argsort(~is_of_mesh, kind="stable")
    while True:
        ranks = welded(places[order])
        equal = order[ranks != np.arange(len(order))]
        if not len(equal):
            return places
        places[equal, 0] = np.nextafter(places[equal, 0], math.inf)
