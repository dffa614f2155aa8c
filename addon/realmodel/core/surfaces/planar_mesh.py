# SPDX-License-Identifier: GPL-3.0-or-later
"""The planar mesh of a region, on whose vertices surfaces are interpolated."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.errors import InputRefused, place_text
from ..base.triangles import Sheet, Triangulation
from ..base.work import Cancel, NativeError, Progress, Work, native_module, refused_as, run
from ..heights.ties import TieData, tie_data
from ..project.plan_input import numbered_ring, region_rings
from ..settings.meshers import DEFAULT_MESHER, check_mesher, local_lengths, places_of, size_of_edges
from .rock_input import RockInput
from .rock_structure import sides_of

_SAME = 1e-9  # of the extent: nearer places are one
_LOOKED_AT = 8  # places around one
# of the square of what a datum asks of the corners of its triangle, a third in its middle: where others leave
# less the corrections of nodes are much larger than those of data. Beside a fault the points on its two sides
# are close together in plan and ask for nothing of one another: there only data that hardly can be met are
# crowded
_CROWDED, _HARDLY_MET = 0.25, 0.05
_BESIDE_BOUND = 4  # contacts that say whether a surface may lie on a bound
_BESIDE = 0.25  # of the distance to another datum of the same surface: the vertex of another one serves, too


@dataclass(frozen=True)
class MeshEstimate:
    """What a mesh will take: triangles (within some 5 % where the outline has no fine detail), and bytes of
    memory at the peak."""

    triangles: int
    memory: int


@dataclass(frozen=True)
class MeshOptions:
    """How a region is meshed, as the arguments of mesh_region say."""

    edge_length: float | str | None
    mesher: str = DEFAULT_MESHER
    triangles: int | None = None
    size: Iterable[Mapping] = ()
    constraints: Iterable = ()
    constraint_points: ArrayLike | None = None
    points: ArrayLike | None = None

    def request(self) -> dict:
        """The request to the native mesher. Raises InputRefused and UsageError."""
        lines = [places_of(line, f"constraint {number}") for number, line in enumerate(self.constraints)]
        fixed_points = self.constraint_points
        fixed_points = None if fixed_points is None else places_of(fixed_points, "constraint_points")
        length, wanted, density = size_of_edges(self.edge_length, self.triangles, self.points)
        return {
            "edge_length": length,
            "mesher": self.mesher,
            "triangles": wanted,
            "sizes": local_lengths(self.size, lines, fixed_points),
            "constraints": lines,
            "constraint_points": fixed_points,
            "density": density,
        }


def mesh_region(
    outline: ArrayLike,
    holes: Iterable[ArrayLike] = (),
    edge_length: float | str | None = None,
    mesher: str = DEFAULT_MESHER,
    *,
    triangles: int | None = None,
    size: Iterable[Mapping] = (),
    constraints: Iterable = (),
    constraint_points: ArrayLike | None = None,
    points: ArrayLike | None = None,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Triangulation:
    """Meshes a region in plan.

    outline: (N, 2) corners in model units, in either direction, not repeated at the end (a repeated
    corner is dropped). holes: outlines inside; all rings count even-odd.

    edge_length: the edge that triangles should have, model units; or "auto": half as long as the `points`,
    (P, 2) or (P, 3), are apart where they lie, growing gently between them. triangles: how many there should
    be instead (within 5 %); with "auto" it scales what the points ask for.

    mesher: "delaunay", constrained Delaunay refinement: no angle under 25 degrees but between two given
    edges; "frontal", better triangles in more time (mean ratio above 0.95, 0.99 where the size is uniform);
    "grid", the nodes of a grid along the axes, which ends at the outline.

    size: where edges are to be shorter: {"at": "outline", "constraints", a place [x, y] or a line
    [[x, y], ...], "length": model units, "distance": within which they are so long}; beyond, edges grow by
    a quarter of the distance.

    constraints: lines (N, 2) that the mesh must contain (rivers, fault traces); they may cross one another
    and the outline, and what lies outside of the region is left out. constraint_points: (N, 2) or (N, 3)
    points, in the region, that must be vertices.

    Returns vertices (V, 2) float64 and triangles (T, 3) int32, counter-clockwise. The border is the outline,
    subdivided. Vertices come in this order: the rings' corners, points of constraints and where they cross,
    points added on edges, the others. The same input gives the same mesh.

    Raises InputRefused where the rings cross or touch in a way that bounds no region, where a length or a
    constraint is none, or where the mesh would not fit the memory; UsageError; Cancelled.

    >>> vertices, triangles = mesh_region([[0, 0], [4, 0], [4, 4], [0, 4]], edge_length=1)
    >>> vertices.shape[1], triangles.dtype, float(vertices.max())
    (2, dtype('int32'), 4.0)
    """
    check_mesher(mesher)
    options = MeshOptions(edge_length, mesher, triangles, size, constraints, constraint_points, points)
    rings, request = region_rings(outline, holes), options.request()

    def task(work: Work) -> Triangulation:
        with work.phase(0.0, 1.0, "meshing"):
            return Triangulation(*_native_call(work, native_module().mesh_region, rings, request))

    return run(task, progress, cancel)


def estimate_mesh(
    outline: ArrayLike,
    holes: Iterable[ArrayLike] = (),
    edge_length: float | str | None = None,
    mesher: str = DEFAULT_MESHER,
    *,
    triangles: int | None = None,
    size: Iterable[Mapping] = (),
    constraints: Iterable = (),
    constraint_points: ArrayLike | None = None,
    points: ArrayLike | None = None,
) -> MeshEstimate:
    """The expected size of the mesh of mesh_region with the same arguments. Raises the same errors, as far as
    they come before meshing."""
    check_mesher(mesher)
    options = MeshOptions(edge_length, mesher, triangles, size, constraints, constraint_points, points)
    rings, request = region_rings(outline, holes), options.request()
    estimate = native_module().estimate_region_mesh
    made, memory = run(lambda work: _native_call(work, estimate, rings, request))
    return MeshEstimate(round(made), round(memory))


def mesh_rings(work: Work, rings: list[np.ndarray], options: MeshOptions) -> tuple[np.ndarray, np.ndarray]:
    """mesh_region within a work that is already running, from checked rings."""
    return _native_call(work, native_module().mesh_region, rings, options.request())


def triangulate_rings(rings: list[np.ndarray]) -> Triangulation:
    """The region of checked rings in as few triangles as there are, without further vertices."""
    with refused_as(refused_region) as native:
        return Triangulation(*native.triangulate_rings(rings))


def triangulate_polygon(outline: ArrayLike, holes: Iterable[ArrayLike] = ()) -> np.ndarray:
    """Divides a polygon with holes into triangles of its corners: by ear clipping, then swapping edges until
    the triangulation is constrained Delaunay.

    outline, holes: (N, 2) corners in either direction; holes may touch the outline, one another and
    themselves in points. Returns (T, 3) int32, counter-clockwise: corner numbers, counted through the
    outline and the holes one after another. Corners in one line stay corners; one that repeats the corner
    before it is not used.

    Raises InputRefused where a ring bounds nothing. Whether rings cross is looked for only where ears run
    out: mesh_region looks for it always.
    """
    rings = [numbered_ring(outline, "outline")]
    rings += [numbered_ring(hole, f"hole {number}") for number, hole in enumerate(holes, 1)]
    with refused_as(refused_region) as native:
        return native.triangulate_polygon(rings)


def _native_call(work: Work, function: Callable, rings: Sequence[np.ndarray], request: dict) -> Any:
    with refused_as(refused_region):
        return work.native(function, list(rings), request)


def refused_region(error: NativeError) -> InputRefused:
    """The refusal of a region that the native part found fault with."""
    place = tuple(error.place[:2]) if error.place is not None else None
    what = str(error)
    if place is not None and "(" not in what:
        what = f"{what} at {place_text(place)}"
    return InputRefused(what, item="region", place=place)


def crowded_places(work: Work, entry: RockInput, mesh: Sheet, known: np.ndarray) -> np.ndarray:
    """(K, 2) places that should become vertices of a planar mesh beside known ones (N, 2): of contacts that
    it cannot honor beside others of their surface, but with large corrections, and of bounds. Those nearest
    to other data of their surface come first; of several surfaces' places close together only one is taken,
    for the others may get by with its vertex, or with a known one. Where none is left, those that hardly can
    be met although a known vertex is close."""
    least = _HARDLY_MET if entry.has_faults else _CROWDED
    places, room = _crowded(work, entry, mesh, least)
    if not len(places):
        return places
    same = _SAME * float(np.ptp(mesh.vertices, axis=0).max())
    chosen = _apart(places, room, known, same, _BESIDE)
    if len(chosen):
        return chosen
    if least != _HARDLY_MET:
        places, room = _crowded(work, entry, mesh, _HARDLY_MET)
    return _apart(places, room, known, same, 0.0)


def _crowded(work: Work, entry: RockInput, mesh: Sheet, least: float) -> tuple[np.ndarray, np.ndarray]:
    """(K, 2) the places of crowded data, and (K,) how far from each the next datum of its sheet is."""
    places, rooms = [np.empty((0, 2))], [np.empty(0)]
    for number, surface in enumerate(entry.rock.surfaces):
        if not (surface.tie and entry.rock.is_interpolated(surface)):
            continue
        work.check()
        for data in _data_of_sheets(work, entry, number):
            if not len(data.places):
                continue
            asked = (data.places, data.lower, np.where(_lifts(data), data.lower, data.upper))
            numbers, away = native_module().crowded_data(*mesh.arrays, asked, least)
            places.append(data.places[numbers])
            rooms.append(away)
    return np.concatenate(places), np.concatenate(rooms)


def _lifts(data: TieData) -> np.ndarray:
    """(C,) bool: the bounds from below as high as one of the nearest contacts, such as outcrops beside those
    of a ground: the surface may lie on them."""
    lifts = np.zeros(len(data.places), bool)
    contacts, places = np.split(data.places, [data.contacts])
    if len(contacts) and len(places):
        near, _ = native_module().nearest_points(contacts, places, _BESIDE_BOUND)
        low = np.where(near < 0, np.inf, data.lower[near]).min(axis=1)
        lifts[data.contacts :] = data.lower[data.contacts :] >= low
    return lifts


def _apart(
    places: np.ndarray, room: np.ndarray, known_places: np.ndarray, same: float, beside_known: float
) -> np.ndarray:
    """(K, 2) those of places (N, 2) that are neither beside a known one nor beside one that is taken before,
    which those with the least room are. beside_known: in shares of their room."""
    every = np.concatenate([known_places, places])
    rooms = np.concatenate([np.zeros(len(known_places)), room])[:, None]
    near, away = native_module().nearest_points(every, every, _LOOKED_AT)
    share = np.where(near < len(known_places), beside_known, _BESIDE)
    is_near = (near >= 0) & (away <= np.maximum(same, share * rooms))
    taken = np.arange(len(every)) < len(known_places)
    for number in np.argsort(room, kind="stable") + len(known_places):
        taken[number] = not taken[near[number][is_near[number]]].any()
    return places[taken[len(known_places) :]]


def _data_of_sheets(work: Work, entry: RockInput, number: int) -> Iterator[TieData]:
    """What each sheet of a surface is to honor: the data on the same sides of all faults that displace it,
    once these are known."""
    data, structure = entry.data[number], entry.structure
    points, bounds = data.tied_points(entry.rock.surfaces[number]), data.bounds
    if structure is None or not structure.faults.active(number).any():
        yield tie_data(points, bounds)
        return
    sides = sides_of(work, np.concatenate([points, bounds.places]), structure.faults)[
        :, structure.faults.active(number)
    ]
    rows, sheet = np.unique(sides, axis=0, return_inverse=True)
    for sheet_number in range(len(rows)):
        on_sheet = sheet.ravel() == sheet_number
        yield tie_data(points[on_sheet[: len(points)]], bounds.some(on_sheet[len(points) :]))
