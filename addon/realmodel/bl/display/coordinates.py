# SPDX-License-Identifier: GPL-3.0-or-later
"""The coordinates of a position in the model, with its block, property and thickness."""

import json
from dataclasses import asdict, dataclass

import numpy as np

from ..host import caches
from ..objects import exaggeration, meshes, shapes
from ..project import compartments, library_rows, project_settings
from . import modes, stages

_soups = caches.new(most=64)  # by the name of a mesh: its triangles, (T, 3, 3) float32


@dataclass(frozen=True)
class Place:
    """A place of the model, in model coordinates and units.

    x, y, z: where it is, floats. block, rock, surface: names of the block there, of its rock mass, and of the
    surface that it was deposited beneath. property_id, property: of the library. thickness: of the block
    along the vertical through the place.
    """

    x: float
    y: float
    z: float
    block: str
    rock: str
    surface: str
    property_id: int
    property: str
    thickness: float


def under_ray(scene, start, direction):
    """The Place where a ray first meets a block that is shown, or None.

    start, direction: three numbers each, in the coordinates of the scene. Blocks that were moved apart are
    met where they are drawn; the coordinates are those of the rock itself.
    """
    start, direction = np.asarray(start, np.float64), np.asarray(direction, np.float64)
    nearest = None
    for row in scene.realmodel.results:
        if not stages.present(row) or modes.is_hidden(scene, row):
            continue
        body = modes.body_of(scene, row)
        if body is None:
            continue
        matrix = np.array(exaggeration.world_matrix(body), np.float64)
        turn = np.linalg.pinv(matrix[:3, :3])
        begin, along = turn @ (start - matrix[:3, 3]), turn @ direction
        for soup, shift in _pieces(scene, body):
            hits = _hits(soup, begin, along)
            if len(hits) and (nearest is None or hits[0] < nearest[0]):
                place = begin + hits[0] * along - shift
                nearest = (hits[0], row, place, along / np.linalg.norm(along))
    if nearest is None:
        return None
    _, row, local, along = nearest
    span = _span(row.object, local + _rounding(_soup(row.object.data), local) * along)  # not beside a wall
    return _place(scene, row, local, span or _span(row.object, local))


def _pieces(scene, body):
    """(triangles, by how much they were moved) of a body; compartments may have been moved apart."""
    soup, apart = _soup(body.data), modes.apart_shown(scene)
    if not apart:
        return [(soup, np.zeros(3))]
    mesh = body.data
    number = np.empty(len(mesh.polygons), np.int32)
    mesh.attributes[meshes.FACE_COMPARTMENT].data.foreach_get("value", number)
    number = number[shapes.triangle_polygons(mesh)]
    shifts = compartments.shifts(scene, apart)
    return [(soup[number == n], shifts[min(n, len(shifts) - 1)]) for n in np.unique(number)]


def at_point(scene, location):
    """The Place at a point of the scene, or None where it is in no block that is shown."""
    for row in scene.realmodel.results:
        if not stages.present(row) or modes.is_hidden(scene, row):
            continue
        matrix = np.array(exaggeration.world_matrix(row.object), np.float64)
        local = np.linalg.pinv(matrix[:3, :3]) @ (np.asarray(location, np.float64) - matrix[:3, 3])
        span = _span(row.object, local)
        if span is not None and span[0] <= local[2] <= span[1]:
            return _place(scene, row, local, span)
    return None


def _place(scene, row, local, span):
    model = local + project_settings.model_origin(scene)
    entry = library_rows.find(scene, row.property_id)
    return Place(
        *(float(value) for value in model),
        row.name,
        row.rock,
        row.surface,
        row.property_id,
        entry.name if entry is not None else "",
        float(span[1] - span[0]) if span is not None else 0.0,
    )


def _span(obj, local):
    """(lowest, highest) height of a block on the vertical through a point, of its intervals there the one
    that is nearest to the point; None where it is not there. Bodies and reverse faults leave several."""
    soup = _soup(obj.data)
    start = np.array([local[0], local[1], float(soup[:, :, 2].min()) - 1.0])
    distances, leaves = _crossings(soup, start, np.array([0.0, 0.0, 1.0]))
    if not len(distances):
        return None
    # On an edge both of its triangles are met: of several in a row that enter the first counts, else the last
    begins = ~leaves & np.append(True, leaves[:-1])
    ends = leaves & np.append(~leaves[1:], True)
    low, high = start[2] + distances[begins], start[2] + distances[ends]
    if len(low) != len(high):  # met where it is upright
        return start[2] + distances[0], start[2] + distances[-1]
    nearest = np.maximum(low - local[2], local[2] - high).argmin()
    return low[nearest], high[nearest]


def _hits(soup, start, direction):
    """The intersections of a ray with triangles, (N,) float64 ascending, in lengths of the direction."""
    return _crossings(soup, start, direction)[0]


def _crossings(soup, start, direction):
    """The intersections of a ray with triangles, (N,) float64 ascending, in lengths of the direction, and
    (N,) bool, whether the ray leaves the solid there. soup: (T, 3, 3). Projected along the ray, the start is
    a point; it lies in the triangles for which it is on the same side of all three edges."""
    length = np.linalg.norm(direction)
    if not length > 0.0 or not len(soup):
        return np.empty(0), np.empty(0, bool)
    along = direction / length
    side = np.cross(along, np.eye(3)[np.abs(along).argmin()])
    side /= np.linalg.norm(side)
    frame = np.column_stack([side, np.cross(along, side), along])
    corners = (soup - start.astype(np.float32)) @ frame[:, :2].astype(np.float32)
    reach = _rounding(soup, start)
    near = ((corners.min(axis=1) <= reach) & (corners.max(axis=1) >= -reach)).all(axis=1)
    corners = (soup[near].astype(np.float64) - start) @ frame
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    weights = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)])
    inside = ((weights >= 0.0).all(axis=0) | (weights <= 0.0).all(axis=0)) & (weights.sum(axis=0) != 0.0)
    weights, depths = weights[:, inside], corners[inside][:, :, 2].T
    total = weights.sum(axis=0)
    distances = (weights * depths).sum(axis=0) / total
    ahead = np.flatnonzero(distances >= 0.0)
    ahead = ahead[np.argsort(distances[ahead], kind="stable")]
    return distances[ahead] / length, total[ahead] > 0.0


def _rounding(soup, point):
    """The most that rounding to float32 may have moved corners by, seen from a point."""
    return 4 * np.spacing(np.float32(np.abs(soup).max() + np.abs(point).max()))


def _cross(a, b):
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _soup(mesh):
    key = mesh.name_full
    if key not in _soups:
        triangles = shapes.mesh_triangles(mesh)
        _soups[key] = meshes.mesh_coordinates(mesh)[triangles]
    return _soups[key]


def forget(names=None):
    """Clears the cached data of meshes, by their names, or of all."""
    for key in [key for key in _soups if names is None or key in names]:
        del _soups[key]


def remember(scene, place):
    """Stores the last position."""
    scene.realmodel.view.place = "" if place is None else json.dumps(asdict(place))


def last(scene):
    """The last requested Place, or None."""
    text = scene.realmodel.view.place
    return Place(**json.loads(text)) if text else None


def set_zero(scene, point):
    """Sets the point, in model coordinates, that distances are measured from; None for none."""
    scene.realmodel.view.zero = {} if point is None else {"values": np.asarray(point, np.float64)}


def zero(scene):
    """(3,) float64 or None."""
    return scene.realmodel.view.zero.get("values")


def from_zero(scene, place):
    """(3,) float64: how far a place is from the zero, or None where none was set."""
    start = zero(scene)
    return None if start is None else np.array([place.x, place.y, place.z]) - start
