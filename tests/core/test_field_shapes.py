# SPDX-License-Identifier: GPL-3.0-or-later
"""The field of a series on sections, and its level sets in the rock."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from realmodel.core import UsageError, build, load_project
from realmodel.core.base.algebra import norm
from realmodel.core.base.work import run
from realmodel.core.display import polygon_mesh
from realmodel.core.display.field_shapes import (
    field_levels,
    field_range,
    field_section,
    field_surfaces,
    series_with_fields,
)
from realmodel.core.validation.closed_form import closed_forms

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"
PLANE = (500.0, 400.0, -300.0), (0.2, 1.0, 0.1)


@pytest.fixture(scope="module", params=["recumbent_fold", "faulted_dome"])
def model(request):
    project = load_project(SAMPLES / request.param / "project.toml")
    (rock,) = project.rocks
    coarse = replace(rock, edge_length=100.0, series=[replace(rock.series[0], resolution=80.0)])
    return build(replace(project, rocks=[coarse]), cells="blocks")


def own_blocks(model):
    (own,) = model.rock_inputs[0].fields
    return [n for n, block in enumerate(model.blocks) if block.surface in own.numbers]


def test_a_section_is_divided_and_whole(model):
    (name,) = series_with_fields(model)
    values = np.linspace(*field_range(model, name), 8)[1:-1]
    section = model.section(*PLANE)
    places, bands = field_section(model, name, section, values)
    across = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    areas = np.linalg.norm(across, axis=1) / 2
    expected = section.area_by_block()[own_blocks(model)].sum()
    assert np.isclose(areas.sum(), expected, rtol=1e-9)
    assert ((across @ PLANE[1]) > -1e-6).all()  # all face the same way
    assert len(np.unique(bands)) == len(values) + 1
    middles = places.mean(axis=1)
    (own,) = model.rock_inputs[0].fields
    where = run(lambda work: closed_forms(model)[0].compartments_of(work, middles))
    edges = np.concatenate([[-np.inf], values, [np.inf]])
    bend = 0.05 * np.ptp(values)  # of f within an edge, where it is drawn as linear
    for number, field in enumerate(own.fields):
        f = field.at(middles[where == number])
        band = bands[where == number]
        assert (f > edges[band] - bend).all() and (f < edges[band + 1] + bend).all()


def test_level_sets_lie_in_the_rock(model):
    (name,) = series_with_fields(model)
    values = np.linspace(*field_range(model, name), 5)[1:-1]
    places, numbers = field_levels(model, name, values)
    assert set(numbers.tolist()) == {0, 1, 2}
    middles = places.mean(axis=1)
    (own,) = model.rock_inputs[0].fields
    form = closed_forms(model)[0]
    where = run(lambda work: form.compartments_of(work, middles))
    inside = np.isin(run(lambda work: form.blocks_at(work, middles)), own_blocks(model))
    assert inside.mean() > 0.999  # but for small corners of its border
    for number, field in enumerate(own.fields):
        here = where == number
        near = 1e-9 * np.ptp(field.values)
        assert np.allclose(field.at(middles[here]), values[numbers[here]], rtol=0, atol=near)


@pytest.mark.parametrize("model", ["recumbent_fold"], indirect=True)  # with one field in all of the rock
def test_level_sets_end_at_the_border_of_the_rock(model):
    """At walls, base and ground, as the surfaces of the model do."""
    (name,) = series_with_fields(model)
    (own,) = model.rock_inputs[0].fields
    surface, (_, level) = own.numbers[1], field_surfaces(model, name)[1]
    places, _ = field_levels(model, name, np.array([level]))
    faces = np.flatnonzero(model.face_surface == surface)
    offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    shapes = [model.vertices[each] for each in np.split(corners, offsets[1:-1])]
    expected = sum(float(norm(np.cross(p[1:-1] - p[0], p[2:] - p[0]).sum(axis=0))) / 2 for p in shapes)
    across = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    assert float(norm(across).sum()) / 2 == pytest.approx(expected, rel=2e-3)


def test_another_name_is_refused(model):
    with pytest.raises(UsageError, match="no series 'other'"):
        field_range(model, "other")


def test_layers_of_a_series_have_their_heights_by_its_field(model):
    """So that laminae of looks follow beds that stand upright or are overturned."""
    (own,) = model.rock_inputs[0].fields
    blocks = zip(model.blocks, polygon_mesh.of_blocks(model, np.zeros(3)), strict=True)
    series = {block.surface: shape for block, shape in blocks if block.surface in own.numbers}
    seen = 0
    for surface, shape in series.items():
        of_corner = np.repeat(shape.face_surface, np.diff(shape.offsets))
        for bound, expected in ((surface, 1.0), (surface - 1, 0.0)):
            if bound in own.numbers:
                heights = shape.bedding.height[of_corner == bound]
                assert heights == pytest.approx(expected, abs=1e-6)
                seen += len(heights)
        inner = shape.bedding.height[of_corner < 0]
        assert inner.min() < 0.3 and inner.max() > 0.7
        (thickness,) = set(shape.bedding.thickness.tolist())
        assert 20.0 < thickness < 450.0
    assert seen > 1000


def test_surfaces_have_the_values_of_the_field(model):
    (name,) = series_with_fields(model)
    surfaces = field_surfaces(model, name)
    (own,) = model.rock_inputs[0].fields
    assert [each for each, _ in surfaces] == [model.surface_names[number] for number in own.numbers]
    assert [level for _, level in surfaces] == own.fields[0].levels.tolist()
    with pytest.raises(UsageError, match="no series 'other' with a field"):
        field_surfaces(model, "other")
