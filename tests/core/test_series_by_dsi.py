# SPDX-License-Identifier: GPL-3.0-or-later
"""Series of sheets by discrete smooth interpolation."""

from dataclasses import replace

import numpy as np
import pytest
from realmodel.core import Dips, Fault, InputRefused, Project, build
from realmodel.core.project.project_writer import save_project
from realmodel.core.project.series import Series
from realmodel.core.results.surface_quality import surface_quality
from structure_cases import heights_at, plane_fault, prepared
from test_series_of_sheets import alone, bedding, error, height, rock_of, surfaces_of


def built(surfaces, **more):
    return build(Project("p", [rock_of(surfaces, **more)]))


def heights(model, number):
    return model.surface(number)[0][:, 2]


def test_a_sheet_with_one_contact_is_parallel_to_the_others():
    """The others have one thickness: the sheet lies between them as far everywhere, but for what its own
    contact contradicts the mean distance that kriging estimates."""
    plan = np.random.default_rng(1).uniform(0, 1000, (40, 2))
    low, middle, high = surfaces_of([40, 1, 40], method="dsi")
    z = 60 * np.sin(plan[:, 0] / 90)
    low.points, high.points = (np.column_stack([plan, z + shift]) for shift in (0.0, 50.0))
    middle.points = np.column_stack([plan[:1], z[:1] + 20.0])
    given = [replace(each, tie=False) for each in (low, middle, high)]
    model = built(given)
    at = [heights(model, number) for number in range(3)]
    assert np.ptp(at[0]) > 120
    assert np.ptp(at[1] - at[0]) < 3 and np.ptp(at[2] - at[0]) < 3
    assert np.median(at[1] - at[0]) == pytest.approx(20.0, abs=1.5)
    assert np.median(at[2] - at[0]) == pytest.approx(50.0, abs=1.5)


@pytest.mark.parametrize("counts", [(40, 2, 40), (40, 5, 40), (20, 20, 20)])
def test_the_contacts_of_all_count_for_each(counts):
    surfaces = surfaces_of(counts, method="dsi")
    together, apart = built(surfaces), built(alone(surfaces))
    for number in range(3):
        assert error(together, number) < 0.8 * error(apart, number)
    for number, surface in enumerate(surfaces):
        z = heights_at(surface.points[:, :2].copy(), *together.surface(number))
        assert np.abs(z - surface.points[:, 2]).max() < 1e-6
    for number in (1, 2):
        assert (heights(together, number) >= heights(together, number - 1)).all()


def test_dips_of_the_series_and_of_one_sheet_count_for_all():
    surfaces = surfaces_of([8, 8, 8], method="dsi")
    without = built(surfaces)
    plan, slope = bedding(40)
    of_series = built(surfaces, series=[Series("J", "sheets", Dips(plan, slope))])
    surfaces[0].dips = Dips(plan, slope)
    of_sheet = built(surfaces)
    for number in range(3):
        for model in (of_series, of_sheet):
            assert error(model, number) < 0.65 * error(without, number)


def test_bounds_of_its_options_hold():
    surfaces = surfaces_of([40, 2, 40], method="dsi")
    surfaces[2].options = {"above": 40.0}
    free = built([*surfaces[:2], replace(surfaces[2], options={})])
    model = built(surfaces)
    assert heights(free, 2).min() < 30.0
    points = surfaces[2].points
    kept = heights(model, 2) if points[:, 2].min() >= 40.0 else heights(model, 2)[heights(model, 2) < 40.0]
    near = model.surface(2)[0][heights(model, 2) < 39.999, :2]
    gap = np.sqrt(((near[:, None] - points[None, points[:, 2] < 40.0, :2]) ** 2).sum(axis=2))
    assert len(kept) == 0 or gap.min(axis=1).max() < 150.0, "but around its own points below it"


def test_each_compartment_has_its_sheets():
    surfaces = surfaces_of([60, 4, 60], method="dsi")
    for surface in surfaces:
        surface.points[surface.points[:, 0] > 500, 2] += 150.0
    mass = rock_of(surfaces)
    shape = plane_fault(x=500.0)
    corners = (shape[0] - [500.0, 0, 0]) * 1000.0 + [500.0, 0, 0]
    (entry,) = prepared(Project("p", [mass], faults=[Fault("F", corners, shape[1])]))
    assert len(entry.structure.sheets) == 2
    for sheets in entry.structure.sheets:
        for number in (1, 2):
            assert (sheets[number].vertices[:, 2] >= sheets[number - 1].vertices[:, 2] - 1e-9).all()
    known = [sheets[1].vertices for sheets in entry.structure.sheets]
    left, right = sorted(known, key=lambda vertices: np.median(vertices[:, 2]))
    for vertices, side, shift in ((left, -1, 0.0), (right, 1, 150.0)):
        own = vertices[side * (vertices[:, 0] - 500.0) > 50.0]
        away = own[:, 2] - height(1, own[:, :2]) - shift
        assert np.sqrt(np.mean(away**2)) < 30.0, "the fold is 120 high"


def test_cross_validation_and_files_know_of_the_series(tmp_path):
    surfaces = surfaces_of([30, 10, 30], method="dsi")
    together, apart = built(surfaces), built(alone(surfaces))
    quality = [surface_quality(model, 1).cross_validation for model in (together, apart)]
    assert quality[0].rmse < quality[1].rmse
    save_project(together.project, tmp_path / "again.toml")
    assert '"dsi"' in (tmp_path / "again.toml").read_text()


def test_other_methods_are_refused():
    surfaces = surfaces_of([8, 8], method="idw")
    with pytest.raises(InputRefused, match=r"interpolated together, and 'S0' has method 'idw'; .* and dsi"):
        built(surfaces)


def test_the_thickness_is_that_of_the_succession():
    """Where the sheets are well known it varies as it does in truth."""
    surfaces = surfaces_of([200, 200, 200], method="dsi")
    model = built(surfaces)
    plan = model.surface(1)[0][:, :2]
    expected = height(1, plan) - height(0, plan)
    inner = ((plan > 100) & (plan < 900)).all(axis=1)
    away = (heights(model, 1) - heights(model, 0) - expected)[inner]
    assert np.sqrt(np.mean(away**2)) < 5.0
