# SPDX-License-Identifier: GPL-3.0-or-later
"""The same data give the same bytes in any order of their rows."""

import json
import random
import shutil
from dataclasses import replace

import numpy as np
import pytest
from conftest import ROOT
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import Dips, Observations, build, cross_validate, interpolate, load_project
from realmodel.core.settings.method_options import OptionRefused
from realmodel.core.settings.methods import METHODS, check_uses_dips

LONG = {"rift_basin", "faulted_dome"}  # faults and folds of fault_blocks and recumbent_fold again
SAMPLES = sorted(path.parent for path in (ROOT / "blend_samples").glob("*/project.toml"))
SAMPLES = [sample for sample in SAMPLES if sample.name not in LONG]
COARSER = 4  # times as long are edges


def coarse(file):
    """The model of a project with longer edges: what is looked for here does not depend on them."""
    project = load_project(file)
    rocks = []
    for rock in project.rocks:
        series = [
            replace(each, resolution=COARSER * each.resolution)
            if isinstance(each.resolution, float)
            else each
            for each in rock.series
        ]
        length = rock.edge_length
        length = COARSER * length if isinstance(length, (int, float)) else length
        triangles = None if rock.triangles is None else max(50, rock.triangles // COARSER**2)
        rocks.append(replace(rock, series=series, edge_length=length, triangles=triangles, size=()))
    return build(replace(project, rocks=rocks))


def shuffle_rows(file, draw):
    lines = file.read_text().splitlines()
    first = next(n for n, line in enumerate(lines) if line.strip() and not line.startswith("#"))
    has_header = not lines[first].split(",")[0].replace(".", "").lstrip("-").isdigit()
    head, rows = lines[: first + has_header], lines[first + has_header :]
    draw.shuffle(rows)
    file.write_text("\n".join([*head, *rows]) + "\n")


def arrays_of(model):
    names = ("vertices", "face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block")
    return {name: getattr(model, name).tobytes() for name in names}


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda path: path.name)
def test_shuffled_tables_give_the_same_model(sample, tmp_path):
    shuffled = tmp_path / sample.name
    shutil.copytree(sample, shuffled)
    draw = random.Random(7)
    for table in sorted(shuffled.glob("*.csv")):
        shuffle_rows(table, draw)
    for file in sorted(shuffled.glob("map.geojson")):
        found = json.loads(file.read_text())
        draw.shuffle(found["features"])
        file.write_text(json.dumps(found))
    assert arrays_of(coarse(sample / "project.toml")) == arrays_of(coarse(shuffled / "project.toml"))


def uses_dips(method):
    try:
        check_uses_dips(method)
    except OptionRefused:
        return False
    return True


# "parallel" copies another surface, "grid" takes the points of a grid alone
METHODS_OF_POINTS = [
    name for name, each in METHODS.items() if not each.on_mesh and name not in ("parallel", "grid")
]


@pytest.mark.parametrize("method", METHODS_OF_POINTS)
@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30)
def test_shuffled_points_give_the_same_heights(method, seed):
    """Also where some lie at one place, at equal distances from nodes, or on one circle."""
    draw = np.random.default_rng(seed)
    plan = draw.integers(0, 6, (30, 2)) * 10.0
    points = np.column_stack([plan, np.round(draw.normal(0, 5, 30) + plan[:, 0], 1)])
    points = points[np.unique(plan, axis=0, return_index=True)[1]]
    points = np.concatenate([points, points[:3] + np.array([0, 0, 0.125])])  # mis-ties
    dips = None
    if uses_dips(method):
        dips = Dips(draw.integers(0, 6, (4, 2)) * 10.0 + 5.0, draw.normal(0, 0.1, (4, 2)))
    nodes = np.stack(np.meshgrid(np.arange(0, 51, 5.0), np.arange(0, 51, 5.0)), axis=-1).reshape(-1, 2)
    order = draw.permutation(len(points))
    one, other = (
        interpolate(given, nodes, method, dips=some).z
        for given, some in ((points, dips), (points[order], dips and dips.some(np.array([2, 0, 3, 1]))))
    )
    assert one.tobytes() == other.tobytes()


def test_shuffled_points_give_the_same_cross_validation():
    draw = np.random.default_rng(3)
    points = draw.uniform(0, 100, (40, 3))
    for method in ("kriging", "tin"):
        order = draw.permutation(40)
        one, other = cross_validate(points, method), cross_validate(points[order], method)
        assert one.z[order].tobytes() == other.z.tobytes() and one.rmse == other.rmse


def test_places_of_holes_have_one_order():
    """Holes by name, downward, also where two blocks meet at one depth; places without a hole by position."""
    rows = [
        ("b", 0, "C"),
        ("b", 5, "C"),
        ("b", 5, "A"),
        ("b", 9, "A"),
        ("a", 0, "A"),
        ("a", 3, "A"),
        ("", 1, "B"),
    ]
    places = np.array([(ord(hole or "!"), 0.0, -depth) for hole, depth, _ in rows], float)
    holes, depths, blocks = (np.array(each) for each in zip(*rows, strict=True))
    depths = depths.astype(float)
    for seed in range(20):
        order = np.random.default_rng(seed).permutation(len(rows))
        found = Observations(places[order], blocks[order], holes[order], depths[order]).along_holes()
        assert found.holes.tolist() == ["", "a", "a", "b", "b", "b", "b"]
        assert found.blocks.tolist() == ["B", "A", "A", "C", "C", "A", "A"]


def test_messages_name_the_rows_that_were_given(write):
    rows = [(x, y, 10.0) for x in (0, 50, 100) for y in (100, 50, 0)]
    rows[5] = (*rows[5][:2], -3.0)
    points = "x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in rows)
    write("low.csv", "x,y,z\n" + "".join(f"{x},{y},0\n" for x, y, _ in rows))
    write("high.csv", points)
    project = write(
        "project.toml",
        "format = 1\nname = 'p'\n[[rock]]\nname = 'r'\nedge_length = 20\n"
        "region = [[0,0],[100,0],[100,100],[0,100]]\n"
        "[[rock.surface]]\nname = 'low'\npoints = 'low.csv'\nmethod = 'tin'\n"
        "[[rock.surface]]\nname = 'high'\npoints = 'high.csv'\nmethod = 'tin'\nrule = 'conformable'\n",
    )
    text = "\n".join(str(warning) for warning in build(load_project(project)).warnings)
    assert "point 5 at (50, 0, -3)" in text
