# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks and cells of models as meshes of polygons."""

import numpy as np
import pytest
from realmodel.core import Project, Rock, Surface, build
from realmodel.core.base.work import native_module
from realmodel.core.display import polygon_mesh

ORIGIN = np.array([0.5, 0.25, -1.0])


@pytest.fixture(scope="module")
def model():
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(0, 1, 7), np.linspace(0, 1, 7), indexing="ij"))
    node = np.arange(49).reshape(7, 7)
    a, b, c, d = (part.ravel() for part in (node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    heights = (0.0 * x, 1.0 + 0.3 * x, 0.9 + np.sin(3 * x + y), -5.0 + 0 * x)
    surfaces = [
        Surface(f"S{n}", vertices=np.column_stack([x, y, z]), triangles=triangles, rule=rule)
        for n, (z, rule) in enumerate(zip(heights, ("erosional",) * 3 + ("conformable",), strict=True))
    ]
    return build(Project("p", [Rock("r", surfaces)]))


def test_blocks_are_their_boundaries(model):
    found = polygon_mesh.of_blocks(model, ORIGIN)
    assert [shape is not None for shape in found] == [block.cells > 0 for block in model.blocks]
    assert None in found, "nothing is deposited beneath a surface that lies below all and does not cut"
    for number, shape in enumerate(found):
        if shape is None:
            continue
        boundary = model.block_boundary(number)
        assert np.array_equal(shape.coordinates, (boundary.vertices - ORIGIN).astype(np.float32))
        assert np.array_equal(shape.offsets, boundary.face_offsets)
        assert np.array_equal(shape.corners, boundary.face_vertices)
        assert np.array_equal(shape.face_surface, boundary.face_surface)
        expect_edges(shape)


def test_cells_have_vertices_of_their_own(model):
    cells = np.bincount(model.cell_block, minlength=len(model.blocks))
    for number, shape in enumerate(polygon_mesh.of_cells(model, ORIGIN, 0.5)):
        if shape is None:
            continue
        expect_edges(shape)
        characteristic = len(shape.coordinates) - len(shape.edges) + shape.polygons
        assert characteristic == 2 * cells[number], "so many separate closed bodies"
        whole = model.block_boundary(number).vertices - ORIGIN
        assert (np.ptp(shape.coordinates, axis=0) < np.ptp(whole, axis=0)).all()


def test_triangles():
    coordinates = np.zeros((4, 3), np.float32)
    shape = polygon_mesh.of_triangles(coordinates, np.array([[0, 1, 2], [0, 2, 3]]), smooth=True)
    assert shape.polygons == 2 and shape.smooth
    assert shape.edges.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]
    assert shape.corner_edges.tolist() == [0, 3, 1, 1, 4, 2]


def test_cancelled(model):
    native = native_module()
    control = native.Execution()
    control.cancel()
    for shrink in (None, 0.5):
        with pytest.raises(native.Cancelled):
            native.complex_shells(model.native(), len(model.blocks), (0, 0, 0), shrink, execution=control)


def expect_edges(shape):
    following = np.arange(1, len(shape.corners) + 1)
    following[shape.offsets[1:] - 1] = shape.offsets[:-1]
    pairs = np.sort(np.column_stack([shape.corners, shape.corners[following]]), axis=1)
    assert np.array_equal(shape.edges[shape.corner_edges], pairs)
    assert len(np.unique(shape.edges, axis=0)) == len(shape.edges) == len(np.unique(pairs, axis=0))
