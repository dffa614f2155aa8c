# SPDX-License-Identifier: GPL-3.0-or-later
"""Where corners of blocks lie in their layers: at places whose answer is known, and over cuts."""

from pathlib import Path

import numpy as np
import pytest
from realmodel.core import Body, Fault, Project, Rock, Surface, build
from realmodel.core.display import polygon_mesh
from sample_scripts import built_sample

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"
ORIGIN = np.zeros(3)


def sheet(height, low=(0.0, 0.0), high=(8.0, 4.0), count=(8, 4)):
    """A grid of heights over a box; height: of arrays x, y."""
    x, y = (np.linspace(low[axis], high[axis], count[axis] + 1) for axis in range(2))
    x, y = (each.ravel() for each in np.meshgrid(x, y, indexing="ij"))
    at = np.arange(len(x)).reshape(count[0] + 1, count[1] + 1)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return np.column_stack([x, y, height(x, y) + 0.0 * x]), triangles.astype(np.int32)


def stack(heights, more=(), **options):
    surfaces = [
        Surface(f"S{n}", *(), **dict(zip(("vertices", "triangles"), sheet(h), strict=True)))
        for n, h in enumerate(heights)
    ]
    return Project(name="p", rocks=[Rock(name="r", surfaces=surfaces, **options)], **dict(more))


def corners(shape):
    """(C, 3) float64 positions of the corners, and the polygon of each."""
    return np.float64(shape.coordinates[shape.corners]), np.repeat(
        np.arange(shape.polygons), np.diff(shape.offsets)
    )


def shapes_of(model, of=polygon_mesh.of_blocks, *more):
    return {b.name: s for b, s in zip(model.blocks, of(model, ORIGIN, *more), strict=True) if s is not None}


def fold(x, y):
    return np.abs(x - 4.0) + 0.25 * y  # linear on each side of a line of the grid


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_folded_bedding_is_cut_by_erosion(cells):
    model = build(stack([fold, lambda x, y: fold(x, y) + 2.0, lambda x, y: 3.0]), cells=cells)
    shape = shapes_of(model)["S1 block"]
    at, polygon = corners(shape)
    low = fold(at[:, 0], at[:, 1])
    found = shape.bedding
    assert found.height == pytest.approx((at[:, 2] - low) / 2.0, abs=1e-5)
    assert found.thickness == pytest.approx(np.full(len(at), 2.0))
    assert found.depth == pytest.approx(3.0 - at[:, 2], abs=1e-5)
    eroded = shape.face_surface == 2
    assert eroded.any() and ((found.height > 0.1) & (found.height < 0.9))[eroded[polygon]].any()
    assert found.is_top.tolist() == eroded.tolist()
    assert set(found.age.tolist()) == {1.0}


def test_cells_by_themselves_have_the_values_of_the_block():
    model = build(stack([fold, lambda x, y: fold(x, y) + 2.0, lambda x, y: 3.0]))
    shape = shapes_of(model, polygon_mesh.of_cells, 1.0)["S1 block"]
    at, _ = corners(shape)
    assert shape.bedding.height == pytest.approx((at[:, 2] - fold(at[:, 0], at[:, 1])) / 2.0, abs=1e-5)


def values_by_place(shapes, polygons=None):
    """{(block, compartment, x, y, z): [(height, thickness, depth)]} of the corners of some polygons."""
    found = {}
    for name, shape in shapes.items():
        at, polygon = corners(shape)
        kept = np.ones(len(at), bool) if polygons is None else polygons(shape)[polygon]
        compartment = 0 * polygon if shape.face_compartment is None else shape.face_compartment[polygon]
        places = zip(compartment[kept].tolist(), *at[kept].T.tolist(), strict=True)
        values = np.column_stack([shape.bedding.height, shape.bedding.thickness, shape.bedding.depth])
        for place, value in zip(places, values[kept].tolist(), strict=True):
            found.setdefault((name, *place), []).append(value)
    return found


@pytest.mark.parametrize(
    ("sample", "cells"), [("two_layers", "columns"), ("gravel_plain", "blocks"), ("fault_blocks", "columns")]
)
def test_lamination_goes_on_over_a_cut(sample, cells):
    """Both caps and the outside have one value where they meet; where a layer has no thickness the faces that
    meet there may differ."""
    model = built_sample(sample, cells=cells)
    middle = (model.vertices.min(axis=0) + model.vertices.max(axis=0)) / 2
    size = np.ptp(model.vertices, axis=0).max()
    equal = (5e-5 if sample == "fault_blocks" else 1e-6) * size  # sheets drawn together at tips, and tied
    cut = model.cut_by_plane(middle, (0.3, 1.0, 0.2))
    caps, compared = [], 0
    for half in (cut.above, cut.below):
        made = polygon_mesh.of_blocks(half, middle)
        shapes = {b.name: s for b, s in zip(half.blocks, made, strict=True) if s is not None}
        shapes.pop("Till", None)  # its base has a step where faults end
        caps.append(values_by_place(shapes, lambda shape: shape.face_surface == -3))
        for place, values in values_by_place(shapes).items():
            if place in caps[-1]:
                values = np.array(values)
                if values[:, 1].min() > 1e-3 * size:
                    assert np.ptp(values[:, 0]) < 1e-4, (place, values)
                assert np.ptp(values[:, 1:], axis=0).max() < equal, (place, values)
    for place in caps[0].keys() & caps[1].keys():
        values = np.array(caps[0][place] + caps[1][place])
        assert np.ptp(values[:, 1:], axis=0).max() < equal, (place, values)
        compared += 1
    assert compared > 150


def test_each_stage_has_its_own_depth_and_top():
    model = build(stack([lambda x, y: 0.0, lambda x, y: 2.0, lambda x, y: 5.0]))
    stage = shapes_of(model.stage(1))["S1 block"]
    assert stage.bedding.depth.max() == pytest.approx(2.0)
    assert stage.bedding.is_top.any()
    whole = shapes_of(model)["S1 block"]
    assert whole.bedding.depth.min() == pytest.approx(3.0)
    assert not whole.bedding.is_top.any()
    assert (
        sorted(set(whole.bedding.height.tolist())) == [0.0, 1.0] == sorted(set(stage.bedding.height.tolist()))
    )


def plane_fault(x):
    vertices = np.array([[x, -9, -99], [x, 99, -99], [x, 99, 99], [x, -9, 99]], float)
    return Fault(name="F", vertices=vertices, triangles=np.array([[0, 1, 2], [0, 2, 3]]), youngest="S1")


def thrown(level):
    """A surface with a step of 3 at the fault, x = 4, as a ready mesh of two parts."""
    parts = [
        sheet(lambda x, y: level, (0.0, 0.0), (4.0, 4.0), (4, 4)),
        sheet(lambda x, y: level + 3.0, (4.0, 0.0), (8.0, 4.0), (4, 4)),
    ]
    vertices = np.concatenate([parts[0][0], parts[1][0]])
    return vertices, np.concatenate([parts[0][1], parts[1][1] + len(parts[0][0])]).astype(np.int32)


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_a_fault_throws_the_bedding(cells):
    surfaces = [
        Surface(name=f"S{n}", vertices=v, triangles=t) for n, (v, t) in enumerate([thrown(0.0), thrown(2.0)])
    ]
    cover = sheet(lambda x, y: 9.0)
    surfaces.append(Surface(name="S2", vertices=cover[0], triangles=cover[1]))
    project = Project(name="p", rocks=[Rock(name="r", surfaces=surfaces)], faults=[plane_fault(4.0)])
    model = build(project, cells=cells)
    shapes = shapes_of(model)
    for name, bottom, top in (("S1 block", 0.0, 2.0), ("S2 block", 2.0, 9.0)):
        shape = shapes[name]
        at, polygon = corners(shape)
        middle = np.bincount(polygon, at[:, 0]) / np.diff(shape.offsets)
        off = np.abs(middle - 4.0)[polygon] > 1e-9
        if name == "S1 block":  # also the two sides of the fault, by the compartment that they bound
            assert not off.all()
        lifted = np.where(off, middle[polygon] > 4.0, at[:, 2] > 2.0 + 1e-6)
        off |= name == "S1 block"
        low = np.where(lifted, bottom + 3.0, bottom)
        high = np.where(lifted & (name == "S1 block"), top + 3.0, top)
        if name == "S1 block":  # a corner on the fault may be of either compartment: take the polygon's
            side = np.array([at[polygon == n, 2].max() > 3.0 + 1e-6 for n in range(shape.polygons)])[polygon]
            at_fault = np.abs(middle - 4.0)[polygon] <= 1e-9
            low = np.where(at_fault, np.where(side, 3.0, 0.0), low)
            high = low + 2.0
        height, thickness = (at[:, 2] - low) / (high - low), high - low
        assert shape.bedding.height[off] == pytest.approx(height[off], abs=1e-5), name
        assert shape.bedding.thickness[off] == pytest.approx(thickness[off], abs=1e-5), name
    assert shapes["S2 block"].bedding.is_top.any() and not shapes["S1 block"].bedding.is_top.any()


def cube(low, high):
    points = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    triangles = np.array([[q[0], q[k], q[k + 1]] for q in quads for k in (1, 2)], np.int32)
    return np.where(points == 0, low, high), triangles


def test_bodies_and_voids_leave_the_bedding_of_layers_as_it_is():
    ore, hole = cube((1, 1, 1), (3, 3, 5)), cube((5, 1, 0.5), (7, 3, 1.5))
    bodies = [
        Body(name="ore", vertices=ore[0], triangles=ore[1], after="S1"),
        Body(name="hole", vertices=hole[0], triangles=hole[1], void=True),
    ]
    model = build(stack([lambda x, y: 0.0, lambda x, y: 2.0, lambda x, y: 6.0], {"bodies": bodies}))
    shapes = shapes_of(model)
    for name, low, thick in (("S1 block", 0.0, 2.0), ("S2 block", 2.0, 4.0), ("ore", 1.0, 4.0)):
        at, _ = corners(shapes[name])
        found = shapes[name].bedding
        assert found.height == pytest.approx((at[:, 2] - low) / thick, abs=1e-6), name
        assert found.thickness == pytest.approx(np.full(len(at), thick)), name
        assert found.depth == pytest.approx(6.0 - at[:, 2], abs=1e-5), name
    assert set(shapes["ore"].bedding.age.tolist()) == {1.5}
    assert not shapes["S1 block"].bedding.is_top.any()  # the floor of the void is none


def test_a_layer_ends_where_its_surface_ends():
    """A surface over half of the plan: its layer is 2 thick there, and the next lies on what is there."""
    half = sheet(lambda x, y: 2.0, (0.0, 0.0), (4.0, 4.0), (4, 4))
    whole = [sheet(lambda x, y: 0.0), half, sheet(lambda x, y: 5.0)]
    surfaces = [Surface(name=f"S{n}", vertices=v, triangles=t) for n, (v, t) in enumerate(whole)]
    shapes = shapes_of(build(Project(name="p", rocks=[Rock(name="r", surfaces=surfaces)])))
    top = shapes["S2 block"]
    at, polygon = corners(top)
    middle = np.bincount(polygon, at[:, 0]) / np.diff(top.offsets)
    for side, thick in ((middle < 4.0 - 1e-9, 3.0), (middle > 4.0 + 1e-9, 5.0)):
        assert top.bedding.thickness[side[polygon]] == pytest.approx(thick)
    wall = np.abs(middle - 4.0) < 1e-9  # the side of the old bed: the younger layer there is the thick one
    assert wall.any() and top.bedding.thickness[wall[polygon]] == pytest.approx(5.0)
    assert shapes["S1 block"].bedding.thickness == pytest.approx(2.0)
