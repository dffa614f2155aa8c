# SPDX-License-Identifier: GPL-3.0-or-later
"""Bedding in layers of series: within large polygons, too, it follows the field."""

import numpy as np
import pytest
from folded_rocks import OF_FOLD, SIZE, folded_project, given_field, recumbent
from realmodel.core import build
from realmodel.core.display import polygon_mesh
from realmodel.core.display.fine_polygons import fine_polygons

TETRAHEDRON = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]], float)
FACES = np.array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3])


def is_closed(offsets, corners):
    """Whether each edge is passed as often one way as the other."""
    following = np.roll(corners, -1)
    following[offsets[1:] - 1] = corners[offsets[:-1]]
    there, back = (
        np.sort(a.astype(np.int64) * 2**32 + b) for a, b in ((corners, following), (following, corners))
    )
    return np.array_equal(there, back)


@pytest.mark.parametrize("longest", [9.0, 3.0, 0.7])
def test_polygons_are_divided_and_the_mesh_stays_closed(longest):
    chosen = np.array([False, True, False, True])
    fine = fine_polygons(TETRAHEDRON, np.arange(0, 13, 3), FACES, chosen, longest)
    positions = fine.extended(TETRAHEDRON)
    assert is_closed(fine.offsets, fine.corners)
    counts = np.bincount(fine.polygon, minlength=4)
    assert counts[[0, 2]].tolist() == [1, 1] and (counts[[1, 3]] > 1).all() == (longest < 9.0)
    area = np.zeros((4, 3))
    for polygon, begin, end in zip(fine.polygon, fine.offsets[:-1], fine.offsets[1:], strict=True):
        ring = positions[fine.corners[begin:end]]
        area[polygon] += np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0) / 2
        if chosen[polygon]:
            assert len(ring) == 3
            assert np.linalg.norm(ring - np.roll(ring, -1, axis=0), axis=1).max() <= longest
    assert area == pytest.approx(np.array([[0, 0, -8], [0, -8, 0], [-8, 0, 0], [8, 8, 8]]))
    values = np.arange(12.0)[:, None]
    of_corner = fine.of_corners(np.arange(0, 13, 3), FACES, values)
    own = np.repeat(fine.polygon, np.diff(fine.offsets))
    assert (of_corner[:, 0] // 3 == own).all()  # by halves between corners of the polygon
    given = fine.corners < 4
    assert (FACES[of_corner[given, 0].astype(int)] == fine.corners[given]).all()


def true_share(layer, points, field):
    """How high points lie in a layer of the fold, from its base to its top."""
    f = recumbent(points)
    levels = [field.values.min(), *OF_FOLD, field.values.max()]
    return (f - levels[layer]) / (levels[layer + 1] - levels[layer])


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_cut_faces_of_a_fold_have_the_bedding_of_its_field(monkeypatch, cells):
    given_field(monkeypatch, recumbent, OF_FOLD)
    project = folded_project()
    project.rocks[0].series[0].resolution = 0.4
    model = build(project, cells=cells)
    cut = model.cut_by_plane((0.0, 0.5 * SIZE, 0.0), (0.0, 1.0, 0.0)).above
    field = model.field("folded")
    meshes = polygon_mesh.of_blocks(cut, np.zeros(3))
    inside = 0
    for layer, (block, shape) in enumerate(zip(cut.blocks, meshes, strict=True)):
        assert is_closed(shape.offsets, shape.corners), block.name
        points, height = np.float64(shape.coordinates[shape.corners]), shape.bedding.height
        polygons = np.flatnonzero(shape.face_surface == -3)  # on the plane
        begins = shape.offsets[polygons]
        assert (np.diff(shape.offsets)[polygons] == 3).mean() > 0.5
        corner = begins[:, None] + np.arange(3)
        middle = points[corner].mean(axis=1)
        off = np.abs(height[corner].mean(axis=1) - true_share(layer, middle, field))
        assert off.max() < 0.2 and off.mean() < 0.05, (block.name, off.max(), off.mean())
        inside += len(polygons)
    assert inside > 300
    apart = polygon_mesh.of_cells(cut, np.zeros(3), 1.0)  # cells by themselves have no more corners
    assert sum(shape.polygons for shape in apart) == np.count_nonzero(cut.face_cells >= 0)
