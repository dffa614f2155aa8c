# SPDX-License-Identifier: GPL-3.0-or-later
"""Differential erosion of a closed mesh by the beds in it.

What is nearer to the surface than the depth of erosion is gone. This depth is a function of the place in the
beds: soft beds recede beneath hard ones, joints break hard ones into blocks. So ledges, overhangs and caves
come out as the beds have them. The rest is bounded by a level set of a field that is linear on tetrahedra: it
is closed, does not cross itself, and has no face turned inside out, at any strength.

The distance is exact at the nodes of a regular lattice (`nearest_triangles`), and whether a node is inside
follows from exact winding numbers. The lattice is as fine as the number of faces asks for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..base.algebra import cos, dot, exp, ranks_in_runs, sin
from ..base.errors import InputRefused, UsageError
from ..base.triangles import cross, edges_of
from ..base.work import Work, native_module
from ..fields.lattice import Lattice
from ..structures.shapes.continued import connected
from .beds import Beds
from .noise import chance, fractal, noise
from .strata import Strata, hardness_of_beds

Mesh = tuple[np.ndarray, np.ndarray]

MOST_STRENGTH, MOST_FACES = 20.0, 5_000_000
_OF_AREA = 6.5  # triangles of a level set to a square of the lattice's spacing
_MOST_NODES = 24_000_000  # of the lattice: about a gigabyte
_MARGIN = 2  # nodes around the mesh
_DEEPEST = 3.0  # mean beds: of erosion at strength 1
_LEFT = 0.7  # of the local thickness: what erosion can take
_FINER = 0.7  # of a radius of balls the next one
_LARGE = 0.12  # of the size of the mesh: beds count as no thicker
_ONTO = 0.12  # spacings: a surface this near to a node passes through it, for triangles that are no slivers
_CRUMB = 5e-4  # of the volume: lesser parts that come loose are gone
_FLAT = 0.01  # of the surface: so much of it is a level base
_CHUNK = 400_000  # places that are worked on at once
JOINT_ANGLE = 0.25  # radians: how far from a right angle the two sets of joints are


@dataclass(frozen=True)
class DifferentialErosion:
    """How deep erosion goes. strength: of the depth, from 0 to 20; 1: soft beds recede by about their mean
    thickness. joints: from 0 to 2, how much hard beds break into blocks at two sets of joints, whose spacing
    follows the thickness of the bed. roughness: from 0 to 2, of bays, ribs and bumps. faces: about how many
    triangles the result has, 1,000 to 5,000,000. Raises UsageError."""

    strength: float = 1.0
    joints: float = 1.0
    roughness: float = 1.0
    faces: int = 300_000

    def __post_init__(self) -> None:
        for name, low, high in (
            ("strength", 0.0, MOST_STRENGTH),
            ("joints", 0.0, 2.0),
            ("roughness", 0.0, 2.0),
            ("faces", 1000, MOST_FACES),
        ):
            value = getattr(self, name)
            if isinstance(value, bool) or not low <= value <= high:
                raise UsageError(f"{name} must be from {low:g} to {high:g}, not {value!r}")


def cubic_lattice(origin: np.ndarray, spacing: float, counts: np.ndarray) -> Lattice:
    """Nodes (i, j, k) at origin + spacing * (i, j, k)."""
    x, y, z = origin.tolist()
    nx, ny, nz = counts.tolist()
    return Lattice((x, y, z), (spacing, spacing, spacing), (nx, ny, nz))


def lattice_around(vertices: np.ndarray, corners: np.ndarray, faces: int) -> Lattice:
    """A lattice around a mesh, so fine that a level set like it has about so many faces."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    spacing = math.sqrt(_OF_AREA * float(_areas(corners).sum()) / faces)
    while True:
        counts = np.ceil((high - low) / spacing).astype(int) + 2 * _MARGIN + 1
        if counts.prod() <= _MOST_NODES:
            break
        spacing *= 1.02
    # so that no plane of nodes lies in a face that is level or upright
    offset = spacing * (_MARGIN - np.array([0.313, 0.421, 0.367]))
    return cubic_lattice(low - offset, spacing, counts)


def _points(lattice: Lattice, index: np.ndarray) -> np.ndarray:
    """(N, 3) where nodes (N, 3) are."""
    return np.array(lattice.origin) + lattice.spacing[0] * index


def kept_of(vertices: np.ndarray, triangles: np.ndarray, count: int) -> np.ndarray:
    """(T,) bool: the triangles of a mesh that erosion takes nothing from: the walls and the floor that
    closed_mesh() has added to `count` triangles, or else the level base on which it stands, if any."""
    if len(triangles) > count:
        return np.arange(len(triangles)) >= count
    corners, lowest = vertices[triangles], vertices[:, 2].min()
    is_base = (corners[:, :, 2] == lowest).all(axis=1)
    areas = _areas(corners)
    return is_base & (areas[is_base].sum() > _FLAT * areas.sum())


def eroded_within(
    work: Work, mesh: Mesh, kept: np.ndarray, beds: Beds, strata: Strata, erosion: DifferentialErosion
) -> Mesh:
    """A closed mesh without what erosion takes, as a job. kept: (T,) bool, the triangles from which nothing
    is taken, such as a base. Raises InputRefused, Cancelled."""
    vertices, triangles = mesh
    corners = np.ascontiguousarray(vertices[triangles])
    if kept.all():
        return mesh
    with work.phase(0.0, 0.1, "finding the inside"):
        lattice = lattice_around(vertices, corners, erosion.faces)
        inside = winding(lattice, corners) != 0
    if not inside.any():
        raise InputRefused("it holds no volume that erosion could see", advice="choose more faces")
    unit = mean_thickness(beds, vertices)
    values = _distances(work, lattice, corners, kept, inside, _DEEPEST * unit * erosion.strength)
    depth = _Depth(beds, hardness_of_beds(beds.count, strata), erosion, unit, strata.seed)
    _erode(work, lattice, values, depth)
    if not (values.field < 0.0).any():
        raise InputRefused("erosion leaves nothing of it", advice="choose more faces or less strength")
    with work.phase(0.9, 1.0, "meshing"):
        return meshed(work, lattice, values.field)


def _areas(corners: np.ndarray) -> np.ndarray:
    normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 0.5 * np.sqrt(dot(normal, normal))


def mean_thickness(beds: Beds, vertices: np.ndarray) -> float:
    """Of beds in a mesh with vertices (V, 3), at most a share of its size: what depths are measured in."""
    size = np.ptp(vertices, axis=0)
    sizes = np.concatenate([np.diff(beds.levels) / beds.slant, np.diff(beds.covers)])
    mean = float(sizes.mean()) if len(sizes) else float(size[2]) / max(beds.count, 1)
    return min(mean, _LARGE * float(size.max()))


def winding(lattice: Lattice, corners: np.ndarray) -> np.ndarray:
    """(nx, ny, nz) int8: how often the mesh goes around each node, by the triangles that the vertical line
    through it crosses. Decisions in plan are exact; a node above an edge counts as beside it, in the sense of
    a shift by (e, e * e)."""
    origin, spacing, counts = np.array(lattice.origin), lattice.spacing[0], np.array(lattice.counts)
    plan = (corners[:, :, :2] - origin[:2]) / spacing
    low = np.maximum(np.ceil(plan.min(axis=1)).astype(int) - 1, 0)
    high = np.minimum(np.floor(plan.max(axis=1)).astype(int) + 1, counts[:2] - 1)
    wide = np.maximum(high - low + 1, 0)
    columns = wide.prod(axis=1)
    change = np.zeros(lattice.counts, np.int8)
    chunk = np.cumsum(columns) // _CHUNK
    for triangles in np.split(np.arange(len(corners)), np.flatnonzero(np.diff(chunk)) + 1):
        of, rank = np.repeat(triangles, columns[triangles]), ranks_in_runs(columns[triangles])
        i, j = low[of, 0] + rank % wide[of, 0], low[of, 1] + rank // wide[of, 0]
        places = origin[:2] + spacing * np.column_stack([i, j])
        a, b, c = corners[of].transpose(1, 0, 2)
        first = _turns(a, b, places)
        hit = (first == _turns(b, c, places)) & (first == _turns(c, a, places)) & (first != 0)
        a, b, c, places, i, j = a[hit], b[hit], c[hit], places[hit], i[hit], j[hit]
        normal = cross(b - a, c - a)
        z = a[:, 2] - ((places - a[:, :2]) * normal[:, :2]).sum(axis=1) / normal[:, 2]
        k = np.maximum(np.ceil((z - origin[2]) / spacing).astype(int), 0)
        below = k < counts[2]
        np.add.at(change, (i[below], j[below], k[below]), -first[hit][below])
    return np.cumsum(change, axis=2, dtype=np.int8)


def _turns(a: np.ndarray, b: np.ndarray, places: np.ndarray) -> np.ndarray:
    """(N,) int8: on which side of the line in plan from a to b places are, 1 left; 0 only where a is b."""
    sides = native_module().orient2d(a[:, :2].copy(), b[:, :2].copy(), places).astype(np.int8)
    on = np.flatnonzero(sides == 0)
    along = (b - a)[on]
    sides[on] = np.where(along[:, 1], -np.sign(along[:, 1]), np.sign(along[:, 0]))
    return sides


@dataclass(eq=False)
class _Values:
    """index: (N, 3) the nodes near the surface. inward: (N,) how far they are inside of what may be eroded,
    negative outside. to_kept: (N,) the same of all of the surface. field: (nx, ny, nz), negative inside; it
    is that of what is left in the end."""

    index: np.ndarray
    inward: np.ndarray
    to_kept: np.ndarray
    field: np.ndarray


def _distances(
    work: Work, lattice: Lattice, corners: np.ndarray, kept: np.ndarray, inside: np.ndarray, deepest: float
) -> _Values:
    spacing = lattice.spacing[0]
    border = _beside(inside)
    near = border | (greatest_around(border, math.ceil(deepest / spacing) + 1) & inside)
    index = np.argwhere(near)
    is_inside = inside[near]
    points = _points(lattice, index)
    with work.phase(0.1, 0.4, "measuring distances"):
        reach = deepest + 2.0 * spacing
        eroding = _away(work, corners[~kept], points, reach)
        every = (
            np.minimum(eroding, _away(work, corners[kept], points, 2.0 * spacing)) if kept.any() else eroding
        )
    field = np.where(inside, -1.0, 1.0) * (2.0 * spacing)
    return _Values(index, np.where(is_inside, eroding, -every), np.where(is_inside, every, -every), field)


def _away(work: Work, corners: np.ndarray, points: np.ndarray, reach: float) -> np.ndarray:
    _, distance = work.native(native_module().nearest_triangles, corners, points, reach)
    return np.minimum(distance, reach)


def _beside(inside: np.ndarray) -> np.ndarray:
    """The nodes that an edge of the lattice's tetrahedra joins to one on the other side."""
    found = np.zeros(inside.shape, bool)
    for step in ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1), (1, 1, 1)):
        here = tuple(slice(None, -1) if s else slice(None) for s in step)
        there = tuple(slice(1, None) if s else slice(None) for s in step)
        differs = inside[here] != inside[there]
        found[here] |= differs
        found[there] |= differs
    return found


def _erode(work: Work, lattice: Lattice, values: _Values, depth: _Depth) -> None:
    """Sets the field to that of what is left."""
    inward, spacing = values.inward, lattice.spacing[0]
    most = _LEFT * _thickness(lattice, values)
    chosen = np.flatnonzero((inward > 0) & (inward < np.minimum(most, depth.deepest) + spacing))
    at = tuple(values.index[chosen].T)
    deep, known = np.zeros(lattice.counts, np.float32), np.zeros(lattice.counts, np.float32)
    with work.phase(0.4, 0.9, "eroding"):
        for begin in range(0, len(chosen), _CHUNK):
            rows = slice(begin, begin + _CHUNK)
            points = _points(lattice, values.index[chosen[rows]])
            deep[tuple(axis[rows] for axis in at)] = depth.at(points)
            work.step(begin / len(chosen))
    known[at] = 1.0
    deep, known = _blurred(deep), _blurred(known)
    taken = np.zeros(len(inward))
    all_at = tuple(values.index.T)
    np.divide(deep[all_at], known[all_at], out=taken, where=(known[all_at] > 0) & (inward > 0))
    left = inward - np.minimum(taken, most)
    left[np.abs(left) < _ONTO * spacing] = 0.0
    left = np.minimum(left, values.to_kept)  # exactly, so that walls and the base stay where they are
    values.field[all_at] = -np.clip(left, -2.0 * spacing, 2.0 * spacing)


def _thickness(lattice: Lattice, values: _Values) -> np.ndarray:
    """(N,) the radius of about the largest ball inside of the mesh that each node lies in, as far as
    distances are measured: erosion leaves a part of it, so that thin walls and arches stay beside thick ones
    (local thickness; T. Hildebrand and P. Ruegsegger 1997)."""
    at, spacing = tuple(values.index.T), lattice.spacing[0]
    inward = np.zeros(lattice.counts, np.float32)
    inward[at] = values.inward
    radius = float(inward.max())
    thickness = np.maximum(values.inward, min(radius, spacing))
    while radius > spacing:
        reached = greatest_around(inward >= radius, math.ceil(radius / spacing))[at]
        thickness[reached] = np.maximum(thickness[reached], radius)
        radius *= _FINER
    return thickness


def greatest_around(field: np.ndarray, by: int) -> np.ndarray:
    """The greatest of the values of each node and those in the square or cube of so many around it."""
    for axis in range(field.ndim):
        backward = np.flip(_onward(np.flip(field, axis), axis, by), axis)
        field = np.maximum(_onward(field, axis, by), backward)
    return field


def _onward(field: np.ndarray, axis: int, by: int) -> np.ndarray:
    """The greatest of the values at each node and so many after it along an axis."""
    field, width = field.copy(), 1
    while width < by + 1:
        step = min(width, by + 1 - width)
        here = tuple(slice(None, -step) if a == axis else slice(None) for a in range(field.ndim))
        there = tuple(slice(step, None) if a == axis else slice(None) for a in range(field.ndim))
        field[here] = np.maximum(field[here], field[there])
        width += step
    return field


def _blurred(field: np.ndarray) -> np.ndarray:
    """The mean of neighbors, weighted 1, 2, 1 along each axis: no detail is finer than the lattice shows."""
    for axis in range(3):
        lower = tuple(slice(None, -1) if a == axis else slice(None) for a in range(3))
        upper = tuple(slice(1, None) if a == axis else slice(None) for a in range(3))
        mean = 2.0 * field
        mean[lower] += field[upper]
        mean[upper] += field[lower]
        field = 0.25 * mean
    return field


def meshed(work: Work, lattice: Lattice, field: np.ndarray) -> Mesh:
    """The boundary of where a field (nx, ny, nz) is negative, without small parts that are loose."""
    native = native_module()
    of_native = (lattice.origin, lattice.spacing, lattice.counts)
    values = np.ascontiguousarray(field.transpose(2, 1, 0)).ravel()
    level = np.zeros(1)
    values = native.moved_onto_levels(of_native, values, level)
    no_points = (np.zeros((0, 3)), np.zeros(0))
    ((vertices, triangles, _),) = work.native(native.level_sets, of_native, values, no_points, level)
    return _without_crumbs(vertices, triangles)


def _without_crumbs(vertices: np.ndarray, triangles: np.ndarray) -> Mesh:
    edges = edges_of(triangles)
    part = connected(edges).reshape(-1, len(triangles))[0]
    a, b, c = (vertices[triangles] - vertices[0]).transpose(1, 0, 2)
    volumes = np.bincount(part, dot(a, cross(b, c)))
    large = (volumes > _CRUMB * volumes.sum()) | (volumes < 0)
    triangles = triangles[large[part]]
    used, numbers = np.unique(triangles, return_inverse=True)
    return vertices[used], numbers.reshape(-1, 3).astype(np.int32)


def joints_at(points: np.ndarray, beds: Beds, strata: Strata, unit: float) -> np.ndarray:
    """(N,) float32 how near points (N, 3) are to a joint of their bed, from 0 to 1. unit: the mean thickness
    of beds."""
    depth = _Depth(beds, hardness_of_beds(beds.count, strata), DifferentialErosion(), unit, strata.seed)
    bed, _, thickness = beds.places(points)
    return depth.near(depth.joints(points, bed, thickness)[1]).astype(np.float32)


class _Depth:
    """The depth of erosion at any place."""

    def __init__(
        self, beds: Beds, hardness: np.ndarray, erosion: DifferentialErosion, unit: float, seed: int
    ):
        self._beds, self._hardness, self._erosion, self._unit, self._seed = (
            beds,
            hardness,
            erosion,
            unit,
            seed,
        )
        turn = 2.0 * math.pi * float(chance(seed, 77))
        self._sets = [
            np.array([cos(turn), sin(turn)]),
            np.array([-sin(turn + JOINT_ANGLE), cos(turn + JOINT_ANGLE)]),
        ]
        self.deepest = _DEEPEST * unit * erosion.strength

    def at(self, points: np.ndarray) -> np.ndarray:
        """(N,) model units, at points (N, 3)."""
        erosion, seed, unit = self._erosion, self._seed, self._unit
        bed, share, thickness = self._beds.places(points)
        hard = self._hardness[bed]
        soft = 1.0 - hard
        part = np.floor(0.9999 * share * np.maximum(np.round(thickness / (0.4 * unit)), 1.0))
        depth = 0.1 + 1.35 * soft**1.5 * (0.55 + 0.45 * share * share)
        depth += 0.25 * (chance(bed, part, seed) - 0.3) * (0.4 + soft)
        depth += 0.25 * hard * exp(-(1.0 - share) * thickness / (0.12 * unit))  # upper edges are worn
        if erosion.joints:
            block, away = self.joints(points, bed, thickness)
            fallen = chance(7 * bed + part, *block, seed)
            broken = 0.8 * (fallen < 0.25) + 0.4 * fallen + 0.35 * self.near(away)
            depth += erosion.joints * (0.35 + 0.65 * hard) * broken
        if erosion.roughness:
            bays = fractal(points * np.array([1.0, 1.0, 0.6]) / (7.0 * unit), seed + 3)
            bumps = fractal(points / (1.6 * unit), seed + 13)
            rough = 2.2 * np.maximum(bays - 0.42, 0.0) + 0.55 * (bumps - 0.5) * (0.5 + soft)
            depth += erosion.roughness * rough
        return np.clip(depth, 0.0, _DEEPEST) * unit * erosion.strength

    def near(self, away: np.ndarray) -> np.ndarray:
        """(N,) from 0 to 1 at distances (N,) from a joint."""
        return exp(-((away / (0.08 * self._unit)) ** 2))

    def joints(
        self, points: np.ndarray, bed: np.ndarray, thickness: np.ndarray
    ) -> tuple[list[np.ndarray], np.ndarray]:
        """The numbers of the block between joints that points lie in, and how far the next joint is. Joints
        are upright, in two sets, at uneven distances that follow the thickness of the bed."""
        unit, seed = self._unit, self._seed
        warp = 0.8 * unit * (noise(points / (3.0 * unit), seed + 71) - 0.5)
        block, nearest = [], np.full(len(points), math.inf)
        for number, along in enumerate(self._sets):
            spacing = np.clip(2.4 * thickness, unit, 6.0 * unit) * (1.0 + 0.6 * number)
            place = (dot(points[:, :2], along) + warp) / spacing + chance(bed, number + 5, seed)
            pair = np.floor(place)
            rest = place - pair
            middle = 0.5 + 0.6 * (chance(bed, pair, number + 9, seed) - 0.5)
            block.append(2 * pair + (rest > middle))
            away = np.minimum(np.abs(rest - middle), np.minimum(rest, 1.0 - rest)) * spacing
            nearest = np.minimum(nearest, away)
        return block, nearest
