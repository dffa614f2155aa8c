# SPDX-License-Identifier: GPL-3.0-or-later
"""The exact fill: the stack of the beds, cut by the solid."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..base.build_warning import BuildWarning
from ..base.named import keyword_only
from ..base.sheet import Sheet
from ..base.triangles import welded
from ..base.work import Cancel, Progress, Work, run
from ..model.build import build
from ..model.cutting import cut_by_surface
from ..model.model import Model
from ..project.project import Project, Rock
from ..settings.method_options import check_threads
from ..surfaces.surface_arrays import SurfaceArrays
from .beds import Beds, check_gap, lay_beds
from .palettes import rocks_of_beds
from .pegs import place_pegs
from .sheets import sheets_of
from .solid import closed_mesh, solid_within
from .strata import Strata

_SOLID, _STACK = 0.3, 0.35  # the progress at the end of these steps


@keyword_only
def fill_with_strata(
    vertices: ArrayLike,
    triangles: ArrayLike,
    strata: Strata,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Model:
    """Fills a closed mesh with strata, or an open one of one height everywhere down to a base.

    vertices (V, 3), triangles (T, 3). Returns a model whose blocks are the beds, oldest first, `Bed 1` and so
    on: closed, with common faces, and together the mesh. Vertices of the mesh stay as they are. Beds that are
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
    model, places = run(lambda work: fill_within(work, mesh, beds, strata), progress, cancel, threads=threads)
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
