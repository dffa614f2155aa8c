# SPDX-License-Identifier: GPL-3.0-or-later
"""Files in another unit than the model's, which they do not name."""

import numpy as np
import pytest
from realmodel.core import InputRefused, build, load_project, read_mesh
from realmodel.core.base.units import METERS, factor
from realmodel.core.surfaces.likely_unit import likely_unit

PROJECT = """format = 1
name = "units"
[[rock]]
name = "site"
region = [[{x0}, {y0}], [{x1}, {y0}], [{x1}, {y1}], [{x0}, {y1}]]
edge_length = 500
base_elevation = 0
[[rock.surface]]
name = "lower"
points = "lower.csv"
property = 1
block = "Clay"
[[rock.surface]]
name = "upper"
mesh = "upper.{ending}"
{keys}
property = 2
block = "Sand"
"""


def corners(place, z):
    return [(place[0] + x, place[1] + y, z) for x, y in ((0, 0), (3000, 0), (3000, 3000), (0, 3000))]


def surface(ending, vertices):
    triangles = ((0, 1, 2), (0, 2, 3))
    if ending == "obj":
        lines = ["v {!r} {!r} {!r}".format(*map(float, vertex)) for vertex in vertices]
        return "\n".join(lines + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]) + "\n"
    if ending == "ply":
        head = "ply\nformat ascii 1.0\nelement vertex 4\n"
        head += "".join(f"property double {axis}\n" for axis in "xyz")
        head += "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
        lines = ["{!r} {!r} {!r}".format(*map(float, vertex)) for vertex in vertices]
        return head + "\n".join(lines + [f"3 {a} {b} {c}" for a, b, c in triangles]) + "\n"
    facets = ""
    for triangle in triangles:
        places = "".join("vertex {!r} {!r} {!r}\n".format(*map(float, vertices[n])) for n in triangle)
        facets += f"facet normal 0 0 1\nouter loop\n{places}endloop\nendfacet\n"
    return f"solid upper\n{facets}endsolid upper\n"


@pytest.fixture
def project(tmp_path):
    def written(ending, unit, place=(0.0, 0.0), keys="", more=""):
        rows = [
            f"{place[0] + x},{place[1] + y},{100 + 0.02 * x}"
            for x in range(0, 3001, 500)
            for y in range(0, 3001, 500)
        ]
        (tmp_path / "lower.csv").write_text("x,y,z\n" + "\n".join(rows) + "\n")
        scaled = np.array(corners(place, 400.0)) / factor(unit)
        (tmp_path / f"upper.{ending}").write_text(surface(ending, scaled.tolist()))
        (x0, y0), (x1, y1) = place, np.add(place, 3000)
        text = PROJECT.format(x0=x0, y0=y0, x1=x1, y1=y1, ending=ending, keys=keys)
        (tmp_path / "project.toml").write_text(text + more)
        return load_project(tmp_path / "project.toml")

    return written


def of_units(model):
    return [str(warning) for warning in model.warnings if warning.kind == "units"]


@pytest.mark.parametrize("ending", ["stl", "obj", "ply"])
def test_millimeters_read_as_meters_are_said(project, ending):
    assert of_units(build(project(ending, "m"))) == []
    assert of_units(build(project(ending, "mm"))) == [
        "rock 'site', surface 'upper': read in meters, it does not have the size or place of the others: if "
        'its lengths are millimeters, write units = "mm"'
    ]
    told = build(project(ending, "mm", keys='units = "mm"'))
    assert of_units(told) == []
    assert told.blocks[1].volume == pytest.approx(build(project(ending, "m")).blocks[1].volume, rel=1e-6)


def test_the_unit_of_a_mesh_beside_the_region(project):
    place = (450_000.0, 5_900_000.0)
    with pytest.raises(InputRefused, match=r'north of the region; if its lengths are feet .*units = "ft"'):
        build(project("obj", "ft", place))
    assert of_units(build(project("obj", "m", place))) == []


CAVE = """
[[body]]
name = "cave"
mesh = "cave.obj"
void = true
"""


def test_the_unit_of_a_body(project, tmp_path):
    low = [(x * 1000.0, y * 1000.0) for x, y in ((1000, 1000), (2000, 1000), (2000, 2000), (1000, 2000))]
    faces = ((4, 3, 2, 1), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8))
    lines = [f"v {x} {y} {z}" for z in (200_000.0, 300_000.0) for x, y in low]
    lines += ["f " + " ".join(map(str, face)) for face in faces]
    (tmp_path / "cave.obj").write_text("\n".join(lines) + "\n")
    said = of_units(build(project("stl", "m", more=CAVE)))
    assert said == [
        "body 'cave': read in meters, it does not lie in the region: if its lengths are millimeters, write "
        'units = "mm"'
    ]
    assert of_units(build(project("stl", "m", more=CAVE + 'units = "mm"\n'))) == []


@pytest.mark.parametrize("seed", range(200))
def test_what_is_in_the_unit_of_the_model_is_never_doubted(seed):
    """Surfaces of a size between a tenth of the region's and ten times it, over it, in any place; and the
    right unit is found for coordinates far from the origin."""
    random = np.random.default_rng(seed)
    model_unit = random.choice(list(METERS))
    low = random.uniform(-1, 1, 2) * 10.0 ** random.uniform(0, 7)
    size = 10.0 ** random.uniform(1, 5) * random.uniform(0.2, 1, 2)
    region = low, low + size
    share = 10.0 ** random.uniform(-0.9, 0.9)
    start = low + random.uniform(min(0, 1 - share), max(0, 1 - share), 2) * size
    box = start, start + share * size
    assert likely_unit(box, region, model_unit) is None
    assert likely_unit(box, region, model_unit, is_part=True) is None
    if np.abs(low).min() > 100 * size.max():
        for unit in ("mm", "cm", "in", "ft", "km", "yd", "mi"):
            by = factor(unit, model_unit)
            if abs(by - 1.0) < 1e-5:  # also of feet and survey feet
                continue
            other = tuple(end / by for end in region)
            assert likely_unit(other, region, model_unit) == unit


@pytest.mark.parametrize(
    ("ending", "first", "other"),
    [
        ("obj", "v ", "# File units = millimeters\nv "),
        ("ply", "element vertex", "comment Units: mm\nelement vertex"),
        ("stl", "solid upper", "solid upper UNITS=mm"),
    ],
)
def test_units_in_comments_are_said(tmp_path, ending, first, other):
    path = tmp_path / f"upper.{ending}"
    text = surface(ending, corners((0, 0), 400.0))
    path.write_text(text)
    assert read_mesh(path).warnings == []
    path.write_text(text.replace(first, other, 1))
    (warning,) = read_mesh(path).warnings
    assert 'its header says mm; it is read in the unit of the model, m: write units = "mm"' in warning
    assert read_mesh(path, file_units="mm").vertices.max() == 3.0
