# SPDX-License-Identifier: GPL-3.0-or-later
"""A region that was drawn somewhere else than the points lie is refused with the distance."""

import numpy as np
import pytest
from realmodel.core import InputRefused, Project, Rock, Surface, build

SQUARE = [(0, 0), (100, 0), (100, 100), (0, 100)]
GRID = np.array([(x, y, 10.0 + 0.01 * x) for x in range(0, 101, 25) for y in range(0, 101, 25)], float)


def moved(points, *by):
    return points + np.array(by, float)


def project(points, units="m", **settings):
    surfaces = [Surface("low", points=points, method="plane", **settings)]
    rock = Rock("ground", surfaces, region=SQUARE, edge_length=20.0, base_elevation=-100.0)
    return Project("p", [rock], units=units)


@pytest.mark.parametrize(
    ("shift", "said"),
    [
        ((3_430_000, 0, 0), "its points lie 3,430 km east of the region"),
        ((0, -9000, 0), "its points lie 8,900 m south of the region"),
        ((-700, 700, 0), "its points lie 849 m northwest of the region"),
    ],
)
def test_all_points_elsewhere(shift, said):
    with pytest.raises(InputRefused, match="rock 'ground', surface 'low': " + said):
        build(project(moved(GRID, *shift)))


def test_a_mesh_beside_the_region():
    vertices = np.array([(120, 0, 1), (220, 0, 1), (120, 100, 1)], float)
    surface = Surface("low", vertices=vertices, triangles=np.array([[0, 1, 2]]))
    rock = Rock("ground", [surface], region=SQUARE, edge_length=20.0, base_elevation=-100.0)
    with pytest.raises(InputRefused, match="surface 'low': its mesh lies 20 m east of the region"):
        build(Project("p", [rock]))


def test_in_feet():
    with pytest.raises(InputRefused, match="1,894 mi north of the region"):
        build(project(moved(GRID, 0, 1e7, 0), units="ft"))


@pytest.mark.parametrize(
    "points",
    [
        moved(GRID, 200, 0, 0),  # extrapolated, but from no farther than the region is wide
        moved(GRID, 0, 240, 0),
        np.concatenate([GRID, moved(GRID, 1e6, 0, 0)]),  # some lie in the region
        (GRID - (50, 50, 0)) * (60, 60, 1),  # few, and all far around a small region
        moved(GRID[:6] * (10, 10, 1), 500, 0, 0),  # an area much larger than the region, not far from it
    ],
    ids=["beside", "north", "some", "around", "large"],
)
def test_extrapolation_is_legitimate(points):
    model = build(project(points))
    assert model.blocks[0].volume > 0


def test_a_surface_without_points_lies_nowhere():
    surfaces = [Surface("level", method="constant", options={"value": 3.0})]
    rock = Rock("ground", surfaces, region=SQUARE, edge_length=20.0, base_elevation=0.0)
    assert build(Project("p", [rock])).volume == pytest.approx(30_000)
