# SPDX-License-Identifier: GPL-3.0-or-later
"""UV coordinates of blocks: stretch and density by singular values of the map, heights, seams, packing."""

import math

import numpy as np
import pytest
from realmodel.core import Strata, fill_with_strata
from realmodel.core.base.triangles import fanned
from realmodel.core.display import box_projection, polygon_mesh

UNIT = 0.25
STRATA = {
    "level": Strata(beds=5),
    "dipping": Strata(beds=5, dip=35, dip_direction=60, faults=1, throw=1),
    "folded": Strata(beds=6, dip=20, fold_amplitude=1.5, fold_wavelength=9),
    "overturned": Strata(beds=6, fold_amplitude=2.5, fold_wavelength=9, axial_dip=40),
}


def boulder(n=24, size=6.0):
    """A closed mesh other than a box: vertices and triangles."""
    u, v = np.meshgrid(np.arange(2 * n) * math.pi / n, np.arange(1, n) * math.pi / n)
    way = np.column_stack(
        [(np.sin(v) * np.cos(u)).ravel(), (np.sin(v) * np.sin(u)).ravel(), np.cos(v).ravel()]
    )
    way = np.concatenate([way, [[0, 0, 1], [0, 0, -1]]])
    radius = size * (1 + 0.15 * np.sin(5 * way[:, 0]) * np.cos(4 * way[:, 1]))
    row = np.arange(2 * n)
    a = (np.arange(n - 2)[:, None] * 2 * n + row).ravel()
    b = (np.arange(n - 2)[:, None] * 2 * n + (row + 1) % (2 * n)).ravel()
    top, bottom = np.full(2 * n, len(way) - 2), np.full(2 * n, len(way) - 1)
    last = (n - 2) * 2 * n
    triangles = [
        np.column_stack([a, a + 2 * n, b + 2 * n]),
        np.column_stack([a, b + 2 * n, b]),
        np.column_stack([top, row, (row + 1) % (2 * n)]),
        np.column_stack([bottom, last + (row + 1) % (2 * n), last + row]),
    ]
    return way * radius[:, None], np.concatenate(triangles)


def beds(strata):
    model = fill_with_strata(*boulder(), strata)
    return [shape for shape in polygon_mesh.of_blocks(model, np.zeros(3)) if shape is not None]


def projected(shape, unit=UNIT):
    bedding = shape.face_surface >= 0, shape.bedding.height * shape.bedding.thickness
    return box_projection.project(shape.coordinates, arrays(shape), unit, bedding)


def arrays(shape):
    return shape.offsets, shape.corners, shape.corner_edges


def singular_values(shape, uv):
    """(T, 2) of the map from the surface to UV, of triangles that are no slivers, and (T,) their areas."""
    triangles, _ = fanned(shape.offsets, shape.corners)
    of_corner, _ = fanned(shape.offsets, np.arange(len(shape.corners)))
    a, b, c = shape.coordinates[triangles].astype(float).transpose(1, 0, 2)
    first, second, third = uv[of_corner].astype(float).transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    length, area = np.linalg.norm(b - a, axis=1), np.linalg.norm(normal, axis=1) / 2
    whole = area > 1e-3 * np.maximum(length, np.linalg.norm(c - a, axis=1)) ** 2
    a, b, c, first, second, third, normal, length = (
        part[whole] for part in (a, b, c, first, second, third, normal, length)
    )
    east = (b - a) / length[:, None]
    north = np.cross(normal / (2 * area[whole])[:, None], east)
    flat = np.zeros((len(a), 2, 2))
    flat[:, 0, 0], flat[:, 0, 1] = length, ((c - a) * east).sum(axis=1)
    flat[:, 1, 1] = ((c - a) * north).sum(axis=1)
    uvs = np.stack([second - first, third - first], axis=2)
    return np.linalg.svd(uvs @ np.linalg.inv(flat), compute_uv=False), area[whole]


@pytest.mark.parametrize("strata", STRATA.values(), ids=STRATA)
def test_stretch_and_density(strata):
    for shape in beds(strata):
        values, _ = singular_values(shape, projected(shape).uv)
        assert (values[:, 0] / values[:, 1]).max() <= box_projection.STEEPEST * 1.01
        density = np.sqrt(values.prod(axis=1)) * UNIT
        assert density.max() <= 1.01
        assert density.min() >= 1 / box_projection.STEEPEST


def test_v_is_the_height_above_the_base_of_a_dipping_bed():
    strata = Strata(beds=5, dip=35, dip_direction=60)
    across = math.cos(math.radians(strata.dip))  # of the vertical thickness
    for shape in beds(strata)[1:-1]:  # the outermost beds end in the boulder
        made = projected(shape)
        upright = np.repeat(made.chart % 10 < 8, np.diff(shape.offsets))
        height = shape.bedding.height * shape.bedding.thickness * across / UNIT
        np.testing.assert_allclose(made.uv[upright, 1], height[upright], atol=2e-3)
        assert upright.any()
        assert not upright.all()


def test_around_a_bed_v_has_no_seam():
    """Where two upright planes meet, only u differs."""
    shape = beds(STRATA["dipping"])[2]
    made = projected(shape)
    face = np.repeat(np.arange(shape.polygons), np.diff(shape.offsets))
    is_upright = made.chart[face] % 10 < 8
    order = np.lexsort([shape.corners[is_upright]])
    vertex, v = shape.corners[is_upright][order], made.uv[is_upright, 1][order]
    same = vertex[1:] == vertex[:-1]
    np.testing.assert_allclose(v[1:][same], v[:-1][same], atol=1e-4)


def test_folded_beds_follow_the_local_bedding():
    """Along the limbs of a fold v follows the bedding, which one direction for all would not do."""
    for shape in beds(STRATA["folded"])[1:-1]:
        frames = projected(shape).chart // 10
        assert len(np.unique(frames)) > 1


def test_seams_are_where_the_plane_changes():
    shape = beds(STRATA["folded"])[2]
    made = projected(shape)
    pairs = box_projection.neighbors(shape.offsets, shape.corner_edges)
    assert len(pairs) == len(shape.edges)
    island = box_projection.islands(made, arrays(shape))
    same = made.chart[pairs[:, 0]] == made.chart[pairs[:, 1]]
    assert (island[pairs[:, 0]] == island[pairs[:, 1]])[same].all()
    assert len(np.unique(island)) < 0.1 * shape.polygons


def test_a_mesh_without_bedding_counts_as_level():
    shape = polygon_mesh.of_triangles(
        np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0]], np.float32), np.array([[0, 1, 2]])
    )
    made = box_projection.project(shape.coordinates, arrays(shape), 2.0)
    np.testing.assert_allclose(made.uv, [[0, 0], [1, 0], [0, 1]])


def test_islands_lie_side_by_side_in_the_square_at_one_density():
    shapes = beds(STRATA["dipping"])
    uvs, numbers, first = [], [], 0
    for shape in shapes:
        made = projected(shape)
        island = box_projection.islands(made, arrays(shape))
        uvs.append(made.uv)
        numbers.append(first + np.repeat(island, np.diff(shape.offsets)))
        first += shape.polygons
    gap = 1 / 256
    packed = box_projection.packed(np.concatenate(uvs), np.concatenate(numbers), gap)
    assert packed.min() >= 0.0
    assert packed.max() <= 1.0
    box = []
    for number in np.unique(np.concatenate(numbers)).tolist():
        part = packed[np.concatenate(numbers) == number]
        box.append([*part.min(axis=0), *part.max(axis=0)])
    box = np.array(box)
    apart = np.maximum(box[:, None, :2] - box[None, :, 2:], box[None, :, :2] - box[:, None, 2:]).max(axis=2)
    np.fill_diagonal(apart, 1.0)
    assert apart.min() >= gap * 0.99
    densities, begin = [], 0
    for shape in shapes:
        values, _ = singular_values(shape, packed[begin : begin + len(shape.corners)])
        densities.append(np.sqrt(values.prod(axis=1)))
        begin += len(shape.corners)
    density = np.concatenate(densities)
    assert density.max() / density.min() <= 1.5


def test_a_box_has_no_slanting_planes():
    """Small faces beside large ones around a corner keep their own plane."""
    corners = np.array([(x, y, z) for x in (0, 4.0) for y in (0, 3.0) for z in (0, 2.0)])
    sides = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    sides += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    model = fill_with_strata(corners, sides, Strata(beds=7, variation=1.0))
    for shape in polygon_mesh.of_blocks(model, np.zeros(3)):
        made = projected(shape)
        assert set(made.chart.tolist()) == {0, 2, 4, 6, 8, 9}
        values, _ = singular_values(shape, made.uv)
        np.testing.assert_allclose(values, 1 / UNIT, rtol=1e-3)
