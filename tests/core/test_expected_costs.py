# SPDX-License-Identifier: GPL-3.0-or-later
"""How the progress of a build is divided, and that it tells the share of the work done."""

import json

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.core import Project, Rock, Surface, build
from realmodel.core.expected_costs import expected_shares, stack_pace
from realmodel.core.measured_costs import COSTS
from realmodel.core.rock_input import RockInput


def waves(count, n, own):
    random = np.random.default_rng(2)
    surfaces = []
    for number in range(count):
        vertices, triangles = grid_surface(n, lambda x, y: 0 * x)
        if own:
            inside = ((vertices[:, :2] > 0) & (vertices[:, :2] < 1)).all(axis=1)
            vertices[inside, :2] += random.uniform(-0.2 / n, 0.2 / n, (inside.sum(), 2))
        p, q = random.uniform(0, 6, 2)
        vertices[:, 2] = 0.05 * number + 0.1 * np.sin(3 * vertices[:, 0] + p) * np.cos(4 * vertices[:, 1] + q)
        surfaces.append(Surface(f"S{number}", vertices, triangles))
    return Project("waves", [Rock("rock", surfaces)])


def inputs(project):
    return [
        RockInput(rock, [(surface.vertices, surface.triangles) for surface in rock.surfaces])
        for rock in project.rocks
    ]


@pytest.mark.parametrize("cells", ["columns", "blocks"])
@pytest.mark.parametrize("own", [True, False])
def test_the_pace_rises_from_nothing_to_all(cells, own):
    pace = stack_pace(inputs(waves(2, 3, own)), cells)
    told = [pace(fraction) for fraction in np.linspace(0, 1, 1001)]
    assert told[0] == 0.0
    assert told[-1] == 1.0
    assert told == sorted(told)
    knots = COSTS[cells]["pace_own" if own else "pace_shared"][0]["knots"]
    assert [pace(fraction) for fraction, _ in knots] == pytest.approx([share for _, share in knots])


def test_the_pace_lies_between_those_of_smaller_and_larger_stacks(monkeypatch):
    given = inputs(waves(2, 10, True))
    triangles = sum(len(made) for _, made in given[0].surfaces)
    curves = [
        {"triangles": triangles // 2, "knots": [[0.0, 0.0], [0.5, 0.2], [1.0, 1.0]]},
        {"triangles": triangles * 2, "knots": [[0.0, 0.0], [0.5, 0.6], [1.0, 1.0]]},
    ]
    monkeypatch.setitem(COSTS["blocks"], "pace_own", curves)
    assert stack_pace(given, "blocks")(0.5) == pytest.approx(0.4)
    assert stack_pace(inputs(waves(2, 2, True)), "blocks")(0.5) == pytest.approx(0.2)
    assert stack_pace(inputs(waves(2, 40, True)), "blocks")(0.5) == pytest.approx(0.6)


def test_shares_of_arrays_leave_nothing_to_read():
    shares = expected_shares(waves(3, 40, True), "columns")
    assert shares.read < 0.05
    assert 0.95 < shares.intersect < 1.0


def test_surfaces_of_points_are_mostly_interpolated(write):
    """A large file of points is a small part of what follows, also where the region is in a file."""
    points = "".join(f"{k % 100} {k // 100} {k % 7}\n" for k in range(10_000))
    square = [[0, 0], [100, 0], [100, 100], [0, 100], [0, 0]]
    region = write("region.geojson", json.dumps({"type": "Polygon", "coordinates": [square]}))
    surfaces = [Surface("S0", points=write("points.txt", points))]
    for given in (region, np.array(square[:4], float)):
        project = Project("points", [Rock("rock", surfaces, region=given, edge_length=0.2)])
        shares = expected_shares(project, "columns")
        assert shares.read < 0.1
        assert shares.read < shares.intersect < 1.0
    missing = Project("points", [Rock("rock", surfaces, region=write("bad.geojson", "{"), edge_length=1.0)])
    assert 0.0 < expected_shares(missing, "columns").read < 1.0


@pytest.mark.parametrize("cells", ["columns", "blocks"])
@pytest.mark.parametrize("own", [True, False])
def test_progress_goes_by_the_expected_shares(cells, own):
    """Every part of a build begins and ends in the progress where its costs say."""
    # long enough that every part is told of, twenty times a second
    project = waves(8, 60 if own and cells == "columns" else 200, own)
    told = []
    build(project, cells, 1, progress=lambda share, text: told.append((share, text)))
    shares = np.array([share for share, _ in told])
    assert (np.diff(shares) >= 0).all()
    assert shares[-1] == 1.0
    expected = expected_shares(project, cells)
    cutting = [share for share, text in told if text == "intersecting and cutting"]
    after = [share for share, text in told if text == "assembling the model"]
    assert cutting
    assert min(cutting) >= expected.read
    assert max(cutting) <= expected.intersect + 1e-12
    assert min(after) >= expected.intersect - 1e-12
