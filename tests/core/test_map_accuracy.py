# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of a map, and heights of observations, that are not exact."""

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from realmodel.core import InputRefused, Observations, Series, SpaceDips, Surface, build, load_project
from realmodel.core.base.work import run
from realmodel.core.ensembles import Realizer
from realmodel.core.heights import Task, heights
from realmodel.core.heights.from_neighbors import thinned
from realmodel.core.project.project_writer import save_project
from realmodel.core.settings.methods import checked_options
from realmodel.core.surfaces.field_data import read_field_data
from structure_cases import cells_at, heights_at

WIDTH, LENGTH, RELIEF, WAVE = 3000.0, 2000.0, 60.0, 1000.0
NORMAL = np.array([0.0, -0.02, 1.0]) / np.hypot(0.02, 1.0)  # of the plane that the hills cut
PROJECT = """format = 1
name = "map"

[[rock]]
name = "r"
region = [[0, 0], [3000, 0], [3000, 2000], [0, 2000]]
edge_length = 100
base_elevation = -300
map = {{ file = "map.geojson", block = "unit", ground = "ground.asc"{more} }}

[[rock.surface]]
name = "contact"
block = "old"
method = "{method}"

[[rock.surface]]
name = "ground"
block = "young"
method = "grid"
"""


def ground(x):
    """Hills whose axes run north."""
    return RELIEF * np.sin(2 * np.pi * x / WAVE + 0.4)


def contact(y):
    """A plane that they cut."""
    return -20 + 0.02 * y


@pytest.fixture
def map_of(tmp_path):
    """map_of(off, more, method): the project of a map whose lines are so far off, now to one side and now to
    the other."""

    def write(off=0.0, more="", method="kriging"):
        y = np.linspace(0, LENGTH, 81)
        angle = np.arcsin(contact(y) / RELIEF)
        lines = []
        for number in range(-1, 7):
            at = number * np.pi + (-1) ** number * angle - 0.4
            lines.append(np.clip(at * WAVE / (2 * np.pi) + off * np.cos(y / 37 + number), 0, WIDTH))
        areas = []
        for number, (west, east) in enumerate(pairwise(lines)):
            ring = np.concatenate([np.column_stack([west, y]), np.column_stack([east, y])[::-1]])
            if (east - west).max() > 0:
                areas.append(("old" if number % 2 == 0 else "young", [*ring.tolist(), ring[0].tolist()]))
        features = [
            {
                "type": "Feature",
                "properties": {"unit": unit},
                "geometry": {"type": "Polygon", "coordinates": [ring]},
            }
            for unit, ring in areas
        ]
        text = json.dumps({"type": "FeatureCollection", "features": features})
        (tmp_path / "map.geojson").write_text(text)
        heights = " ".join(f"{z:.6f}" for z in ground(np.arange(61) * 50.0))
        head = "ncols 61\nnrows 41\nxllcenter 0\nyllcenter 0\ncellsize 50\n"
        (tmp_path / "ground.asc").write_text(head + "\n".join([heights] * 41) + "\n")
        (tmp_path / "project.toml").write_text(PROJECT.format(more=more, method=method))
        return load_project(tmp_path / "project.toml")

    return write


def errors(model):
    """How far the surface is from the plane, in the order of its vertices."""
    vertices, _ = model.surface(0)
    return np.abs(vertices[:, 2] - contact(vertices[:, 1]))


@pytest.mark.parametrize(
    ("off", "method", "most"), [(0, "kriging", 0.3), (10, "kriging", 1.5), (10, "auto", 1.5)]
)
def test_a_surface_does_not_follow_the_ground_between_lines(map_of, off, method, most):
    model = build(map_of(off, method=method))
    assert np.median(errors(model)) < most
    assert np.percentile(errors(model), 90) < 3 * most
    seen = model.observed()
    assert seen.share == 1.0
    assert not seen.left_out
    assert max(abs(each.residual) for each in seen.contacts) < 1e-9 * RELIEF
    assert not [each for each in model.warnings if "range of the fitted" in each.text]


@pytest.mark.parametrize("more", ["", ", accuracy = 0"])
def test_a_level_set_does_not_follow_the_ground_between_lines(map_of, more):
    """Also where errors are not given: the data show them."""
    project = map_of(10.0, more)
    rock = project.rocks[0]
    rock.series = [Series("S", dips=SpaceDips([[500.0, 500.0, -10.0], [2500.0, 1500.0, 10.0]], [NORMAL] * 2))]
    rock.surfaces[0] = Surface("contact", block="old", series="S")
    model = build(project)
    draw = np.random.default_rng(1).uniform((100, 100, -80), (WIDTH - 100, LENGTH - 100, 60), (4000, 3))
    points = draw[draw[:, 2] < ground(draw[:, 0]) - 2]
    found = model.cell_block[cells_at(model, points)]
    right = np.mean(found == (points[:, 2] > contact(points[:, 1])))
    assert right > 0.99
    assert max(abs(each.residual) for each in model.observed().contacts) < 1e-9 * RELIEF


def test_exact_lines(map_of):
    model = build(map_of(more=", accuracy = 0"))
    assert model.interpolations[0].variogram.nugget == 0
    assert errors(model).max() > 5  # it follows the ground
    assert errors(build(map_of())).max() < 2


def test_contacts_are_off_by_what_the_ground_rises_over_the_accuracy(map_of):
    field = read_field_data(*_of(map_of(more=", accuracy = 5")))
    observed = field.rock.observations
    on_line = observed.errors > 0
    slope = RELIEF * 2 * np.pi / WAVE * np.cos(2 * np.pi * observed.places[on_line, 0] / WAVE + 0.4)
    assert on_line.sum() > 100
    assert observed.errors[on_line] == pytest.approx(5 * np.abs(slope), rel=0.05)
    model = build(map_of(more=", accuracy = 5"))
    variance = np.mean(observed.errors[on_line] ** 2)
    assert model.rock_inputs[0].data[0].error == pytest.approx(variance)
    assert model.interpolations[0].variogram.nugget >= variance * (1 - 1e-12)


def test_contacts_are_off_by_a_tenth_of_the_relief_at_most(map_of):
    """Else a map of a large area would say nothing where the ground is steep."""
    observed = read_field_data(*_of(map_of(more=""))).rock.observations
    assert np.sqrt(np.mean(observed.errors[observed.errors > 0] ** 2)) == pytest.approx(
        0.1 * RELIEF / np.sqrt(2), rel=0.1
    )


def _of(project):
    return project, project.rocks[0]


def test_the_accuracy_is_checked(map_of):
    with pytest.raises(InputRefused, match="'accuracy' must be 0 or more, not -1"):
        map_of(more=", accuracy = -1")


def test_realizations_are_as_smooth_as_the_surface(map_of):
    """Errors are those of the points: they make no realization rough."""
    project = map_of()
    x = np.arange(400.0, 2600.0, 10.0)
    realizer = Realizer(build(project))
    nodes = np.column_stack([x, np.full(len(x), 1030.0)])
    for number in range(3):
        heights = heights_at(nodes, *realizer.realization(number, threads=1).surface(0))
        rough = np.diff(heights, 2)
        assert np.median(np.abs(rough)) < 0.1  # the nugget is 44: nodes would differ by 6


def test_errors_of_observations(tmp_path):
    (tmp_path / "seen.csv").write_text(
        "x,y,z,block,height_error\n0,0,10,old,2\n0,0,10,young,2\n50,60,4,old,\n"
    )
    text = PROJECT.format(more="", method="kriging").replace(
        'map = { file = "map.geojson", block = "unit", ground = "ground.asc" }', 'observations = "seen.csv"'
    )
    (tmp_path / "project.toml").write_text(text.replace('"grid"', '"constant"\nvalue = 99'))
    project = load_project(tmp_path / "project.toml")
    observed = read_field_data(*_of(project)).rock.observations
    assert observed.errors.tolist() == [2, 2, 0]
    save_project(build(project).project, tmp_path / "again.toml")
    again = load_project(tmp_path / "again.toml")
    assert read_field_data(*_of(again)).rock.observations.errors.tolist() == [2, 2, 0]
    (tmp_path / "seen.csv").write_text("x,y,z,block,height_error\n0,0,10,old,-2\n")
    with pytest.raises(InputRefused, match=r"seen.csv:2.*the error of the elevation, -2, is negative"):
        read_field_data(*_of(project))


def test_a_surface_has_no_spikes_at_points_that_are_off():
    """Tied or not: it passes near its points, at a node there as beside it."""
    draw = np.random.default_rng(2)
    plan = draw.uniform(0, 100, (40, 2))
    points = np.column_stack([plan, 0.3 * plan[:, 0] + draw.normal(0, 2, 40)])

    def kriged(nodes):
        settings = checked_options("kriging", {})
        return run(lambda work: heights("kriging", Task(work, points, nodes, settings, error=4.0)).z)

    at, beside = kriged(plan), kriged(plan + 1e-6)
    assert at == pytest.approx(beside, abs=1e-4)
    assert np.abs(at - points[:, 2]).max() > 1
    assert np.std(at - 0.3 * plan[:, 0]) < 1


def test_of_many_points_that_are_off_an_even_part_counts():
    """All of them: what is near is on one line. A point that is far from the others is among the part."""
    draw = np.random.default_rng(2)
    lines = np.column_stack([draw.uniform(0, 100, 5000), draw.integers(0, 3, 5000) * 10.0])
    points = np.column_stack([np.vstack([lines, [[50.0, 90.0]]]), np.zeros(5001)])
    task = Task(None, points, np.empty((0, 2)), checked_options("kriging", {}), error=1.0)
    part = thinned("kriging", task, points)
    assert 500 < len(part) <= 1000
    assert (part == points[-1]).all(axis=1).any()
    assert np.diff(np.sort(part[part[:, 1] == 10, 0])).max() < 1.5
    asked = replace(task, settings=checked_options("kriging", {"neighbours": 0}))
    for method, other in (("kriging", asked), ("kriging", replace(task, error=0.0)), ("dsi", task)):
        assert thinned(method, other, points) is points


def test_errors_of_arrays():
    one = Observations([[0, 0, 5]], ["sand"], height_errors=[2])
    joined = Observations.joined([one, Observations([[1, 0, 5]], ["clay"])])
    assert joined.errors.tolist() == [2, 0]
    assert joined.some(np.array([True, False])).errors.tolist() == [2]
    with pytest.raises(InputRefused, match="negative, or not finite"):
        Observations([[0, 0, 5]], ["sand"], height_errors=[-1])
    with pytest.raises(InputRefused, match="1 places have 2 errors"):
        Observations([[0, 0, 5]], ["sand"], height_errors=[1, 1])
