# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines and points that a region's mesh must contain, from the project file and from Python."""

from itertools import pairwise

import numpy as np
import pytest
from realmodel.core import InputRefused, MapLayer, Project, Rock, Surface, build, load_project
from realmodel.core.project.plan_input import read_constraints
from realmodel.core.project.project_writer import save_project

RIVER = '{"type":"LineString","coordinates":[[-1,1],[2,2],[9,1.5]]}'
PROJECT = """format = 1
name = "x"
[[rock]]
name = "r"
region = [[0, 0], [8, 0], [8, 4], [0, 4]]
edge_length = 1
base_elevation = -1
constraints = {constraints}
[[rock.surface]]
name = "S0"
{shape}
"""
CONSTANT = 'method = "constant"\nvalue = 0'
OFF = "OFF\n3 1 0\n0 0 0\n8 0 0\n8 4 0\n3 0 1 2\n"


def edges_of(triangles):
    return {tuple(sorted(edge)) for t in triangles.tolist() for edge in zip(t, t[1:] + t[:1], strict=True)}


def contains(mesh, a, b):
    """Whether the segment from a to b is a chain of edges of a mesh."""
    vertices, triangles = mesh
    a, b = np.asarray(a, float), np.asarray(b, float)
    along = (vertices - a) @ (b - a) / ((b - a) @ (b - a))
    off = np.abs((vertices - a) @ np.array([[0, -1], [1, 0]]) @ (b - a)) / np.hypot(*(b - a))
    on = np.flatnonzero((off < 1e-9) & (along > -1e-9) & (along < 1 + 1e-9))
    chain = on[np.argsort(along[on])]
    edges = edges_of(triangles)
    ends = np.hypot(*(vertices[chain[0]] - a)) < 1e-9 and np.hypot(*(vertices[chain[-1]] - b)) < 1e-9
    return ends and all(tuple(sorted(pair)) in edges for pair in pairwise(chain.tolist()))


def test_constraints_of_the_project_file(write, tmp_path):
    write("river.geojson", RIVER)
    write("fault.wkt", "MULTILINESTRING ((1 3, 3 3.5), (5 3, 7 0.5)); POINT (6.1 3.3)")
    inline = '[[1, 0.5], [4, 0.25]], [3.3, 1.1], "LINESTRING (0.5 2, 0.5 3)"'
    given = f'["river.geojson", {{ file = "fault.wkt" }}, {inline}]'
    project = load_project(write("p.toml", PROJECT.format(constraints=given, shape=CONSTANT)))
    assert {tmp_path / "river.geojson", tmp_path / "fault.wkt"} <= set(project.input_files())
    model = build(project)
    mesh = model.rock_inputs[0].region
    assert contains(mesh, (0, 4 / 3), (2, 2))
    assert contains(mesh, (2, 2), (8, 1.5 + 0.5 / 7))
    for a, b in (((1, 3), (3, 3.5)), ((5, 3), (7, 0.5)), ((1, 0.5), (4, 0.25)), ((0.5, 2), (0.5, 3))):
        assert contains(mesh, a, b)
    for point in ((6.1, 3.3), (3.3, 1.1)):
        assert (mesh.vertices == point).all(axis=1).any()
    assert model.volume == pytest.approx(32)

    again = build(model.project)  # from the arrays that were read
    assert np.array_equal(again.rock_inputs[0].region.vertices, mesh.vertices)
    save_project(model.project, tmp_path / "saved.toml")
    saved = build(load_project(tmp_path / "saved.toml"))
    assert np.array_equal(saved.rock_inputs[0].region.vertices, mesh.vertices)


def test_edges_are_shorter_at_constraints(write):
    size = 'size = [{ at = "constraints", length = 0.1, distance = 0.1 }]\n[[rock.surface]]'
    text = PROJECT.format(constraints="[[[1, 1], [2, 1]]]", shape=CONSTANT)
    vertices, _ = (
        build(load_project(write("p.toml", text.replace("[[rock.surface]]", size)))).rock_inputs[0].region
    )
    near = np.abs(vertices - (1.5, 1)).max(axis=1) < 0.6
    assert near.sum() > 30
    with pytest.raises(InputRefused, match="no constraints") as raised:
        load_project(write("q.toml", text.replace("[[rock.surface]]", size).replace("constraints =", "#")))
    assert raised.value.line == 9


def at_size(entries, write):
    text = PROJECT.format(constraints="[]", shape=CONSTANT)
    return write("p.toml", text.replace("[[rock.surface]]", f"size = [{entries}]\n[[rock.surface]]"))


def test_edges_are_shorter_at_what_files_hold(write, tmp_path):
    write("river.geojson", RIVER)
    write("wells.wkt", "MULTIPOINT ((6 3), (1 3.5))")
    project = load_project(
        at_size(
            '{ at = "river.geojson", length = 0.1, distance = 0 },'
            '{ at = { file = "wells.wkt" }, length = 0.05, distance = 0.1 },'
            '{ at = "POLYGON ((4 3, 5 3, 5 3.5, 4 3))", length = 0.2, distance = 0 },'
            "{ at = [7.5, 0.5], length = 0.1, distance = 0 }",
            write,
        )
    )
    assert {tmp_path / "river.geojson", tmp_path / "wells.wkt"} <= set(project.input_files())
    model = build(project)
    vertices, triangles = model.rock_inputs[0].region
    sides = vertices[triangles] - vertices[np.roll(triangles, 1, axis=1)]
    lengths = np.hypot(*np.moveaxis(sides, -1, 0)).mean(axis=1)
    centers = vertices[triangles].mean(axis=1)

    def mean_at(place):
        return lengths[np.hypot(*(centers - place).T) < 0.25].mean()

    river, well, other, side, point, far = map(
        mean_at, [(2, 2), (6, 3), (1, 3.5), (4.5, 3), (7.5, 0.5), (4, 0.3)]
    )
    assert max(well, other) < 0.1 < river < 0.2 < far
    assert point < 0.2 and side < 0.3 < far

    again = build(model.project)  # from the places that were read
    save_project(model.project, tmp_path / "saved.toml")
    saved = build(load_project(tmp_path / "saved.toml"))
    for mesh in (again.rock_inputs[0].region, saved.rock_inputs[0].region):
        assert np.array_equal(mesh.vertices, vertices)


@pytest.mark.parametrize(
    ("at", "words"),
    [
        ('"outlines"', "file not found: .*outlines"),
        ('{ layer = "x" }', "key 'file' is missing"),
        ('"empty.geojson"', "size 0: there are no lines or points in it"),
        ('"POINT (1"', "size 0"),
    ],
)
def test_places_of_short_edges_refused(write, at, words):
    write("empty.geojson", '{"type":"FeatureCollection","features":[]}')
    with pytest.raises(InputRefused, match=words):
        build(load_project(at_size(f"{{ at = {at}, length = 0.1, distance = 0 }}", write)))


@pytest.mark.parametrize(
    ("constraints", "shape", "line", "words"),
    [
        ('"river.geojson"', CONSTANT, 8, "must be a list"),
        ('[\n"no.geojson"]', CONSTANT, 8, "file not found"),
        ("[\n3]", CONSTANT, 9, "not a file, line or point"),
        ("[\n[[0, 0], [1]]]", CONSTANT, 9, "two finite numbers"),
        ("[[1, 2, 3]]", CONSTANT, 8, "two finite numbers"),
        ('[{ layer = "x" }]', CONSTANT, 8, "key 'file' is missing"),
        ('["empty.geojson"]', CONSTANT, None, "constraint 1: there are no lines or points"),
        ("[[[1, 1], [2, 2]]]", 'mesh = "s.off"', 8, "no surface is interpolated"),
        ("[[20, 20]]", CONSTANT, 8, "outside"),
    ],
)
def test_constraints_refused(write, constraints, shape, line, words):
    write("river.geojson", RIVER)
    write("empty.geojson", '{"type":"FeatureCollection","features":[]}')
    write("s.off", OFF)
    path = write("p.toml", PROJECT.format(constraints=constraints, shape=shape))
    with pytest.raises(InputRefused) as raised:
        build(load_project(path))
    assert words in str(raised.value)
    assert raised.value.line == line


def test_constraints_from_python(write):
    river = write("river.geojson", RIVER)
    lines = read_constraints(
        [river, MapLayer(river), [[0, 0], [0, 0], [1, 1]], (3, 4), "POLYGON ((0 0, 1 0, 1 1))"]
    )
    assert [line.shape for line in lines] == [(3, 2), (3, 2), (2, 2), (1, 2), (4, 2)]
    for bad, words in (
        ([[0, 0], [1, np.nan]], "not finite"),
        ([], r"\(N, 2\)"),
        ("x", "cannot be read"),
        ([["a", 1]], "must be points"),
    ):
        with pytest.raises(InputRefused, match=words):
            read_constraints([bad])
    surface = Surface("S0", method="constant", options={"value": 0.0})
    rock = Rock("r", [surface], [[0, 0], [8, 0], [8, 4], [0, 4]], edge_length=1.0, base_elevation=-1.0)
    rock.constraints = [[[1, 1], [7, 3]], [4.4, 0.6]]
    mesh = build(Project("x", [rock])).rock_inputs[0].region
    assert contains(mesh, (1, 1), (7, 3))
    assert (mesh.vertices == (4.4, 0.6)).all(axis=1).any()
