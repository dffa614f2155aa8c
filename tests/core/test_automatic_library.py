# SPDX-License-Identifier: GPL-3.0-or-later
"""Projects without a library: each layer gets a property with a color of its own where it is drawn."""

import numpy as np
from realmodel.core import Body, Library, Project, Property, Rock, Surface, build
from realmodel.core.results.automatic_library import PALETTE, model_with_library, with_library

REGION = np.array([[0, 0], [10, 0], [10, 10], [0, 10]], float)


def level(name, z, property=0):
    vertices = np.column_stack([REGION, np.full(4, float(z))])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    return Surface(name=name, vertices=vertices, triangles=triangles, property=property)


def project(library=None, properties=(0, 0, 0), bodies=()):
    surfaces = [level(f"S{n}", 10 * n, number) for n, number in enumerate(properties)]
    return Project("p", [Rock("r", surfaces, base_elevation=-10.0)], library, bodies=list(bodies))


def box(name, **given):
    corners = np.array([[x, y, z] for z in (2, 4) for y in (2, 4) for x in (2, 4)], float)
    faces = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4]]
    faces += [[2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]]
    return Body(name, corners, np.array(faces, np.int32), **given)


def test_each_surface_and_body_gets_its_own():
    made = with_library(project(bodies=[box("salt"), box("hole", void=True)]))
    assert [(entry.id, entry.name) for entry in made.library] == [
        (1, "S0"),
        (2, "S1"),
        (3, "S2"),
        (4, "salt"),
    ]
    assert [entry.color for entry in made.library] == list(PALETTE[:4])
    assert [surface.property for surface in made.rocks[0].surfaces] == [1, 2, 3]
    assert [body.property for body in made.bodies] == [4, 0]


def test_given_properties_stay():
    made = with_library(project(properties=(0, 7, 7)))
    assert [(entry.id, entry.name) for entry in made.library] == [(8, "S0"), (7, "property 7")]
    assert [surface.property for surface in made.rocks[0].surfaces] == [8, 7, 7]


def test_a_library_stays():
    given = project(Library([Property(1, "rock")]))
    assert with_library(given) is given
    model = build(given)
    assert model_with_library(model) is model


def test_a_model_keeps_its_cells_and_has_stages():
    model = build(project(bodies=[box("salt", after="S1")]))
    made = model_with_library(model)
    assert made.face_cells is model.face_cells
    assert [block.property for block in made.blocks] == [1, 2, 3, 4]
    assert [block.property for block in made.stage(1).blocks] == [1, 2, 4]
    assert not any(block.property for block in model.blocks)
    assert model.project.library is None


def test_sections_are_drawn_in_these_colors(tmp_path):
    model = build(project())
    section = model.section((5, 5, 0), (0, -1, 0))
    assert [tuple(color) for color in section.block_colors] == [
        tuple(int(code[n : n + 2], 16) / 255 for n in (1, 3, 5)) for code in PALETTE[:3]
    ]
    section.save(tmp_path / "s.svg")
    drawn = (tmp_path / "s.svg").read_text()
    assert all(color in drawn for color in PALETTE[:3])
