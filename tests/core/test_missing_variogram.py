# SPDX-License-Identifier: GPL-3.0-or-later
"""Where data show no variogram, nothing gives a standard deviation, and what is missing is said."""

import math

import numpy as np
import pytest
from realmodel.core import Dips, Fault, Project, Rock, Series, Surface, build, interpolate
from realmodel.core.ensembles import ensemble
from realmodel.core.results.surface_quality import surface_quality
from realmodel.core.settings.variogram import lacks_deviation

_SQUARE = [[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0], [0.0, 1000.0]]
_PLAN = np.array(
    [
        [200.0, 500],
        [800, 500],
        [500, 150],
        [480, 900],
        [120, 130],
        [880, 160],
        [870, 840],
        [150, 820],
        [500, 480],
    ]
)


def _points(count, spread):
    return np.column_stack([_PLAN[:count], 300.0 + spread * np.sin(np.arange(count) * 1.7)])


def _rock(*surfaces, **options):
    ground = Surface("ground", method="constant", options={"value": 600.0})
    region = {"region": _SQUARE, "edge_length": 100.0, "base_elevation": 0.0}
    return Rock("rock", [*surfaces, ground], **region, **options)


def _model(*surfaces, faults=(), **options):
    return build(Project("p", [_rock(*surfaces, **options)], faults=list(faults)))


def _of(hole, name="A"):
    return [each.deviation for each in hole.contacts if each.surface == name]


def _says_nothing(model):
    hole = model.planned_hole((510.0, 310.0, 650.0), length=600.0)
    assert _of(hole) and all(each is None for each in _of(hole))
    assert any(text.startswith("A: ") and "no standard deviation" in text for text in hole.remarks)
    assert np.isnan(model.surface_attributes(0)["variance"]).all()
    assert model.report()["blocks"][0]["volume_deviation_at_most"] is None
    assert surface_quality(model, 0).mean_deviation is None
    assert any("no standard deviation" in warning.text for warning in model.warnings)


@pytest.mark.parametrize("method", ["kriging", "universal_kriging"])
@pytest.mark.parametrize(("count", "spread"), [(1, 0.0), (2, 0.001), (3, 0.05), (5, 40.0), (9, 0.0)])
def test_few_or_equal_points_give_no_deviation(method, count, spread):
    _says_nothing(_model(Surface("A", points=_points(count, spread), method=method)))


def test_enough_points_or_a_given_variogram_give_one():
    for count, options in (
        (8, {}),
        (1, {"variogram": {"model": "spherical", "range": 500.0, "sill": 100.0}}),
    ):
        model = _model(Surface("A", points=_points(count, 40.0), options=options))
        hole = model.planned_hole((510.0, 310.0, 650.0), length=600.0)
        assert not hole.remarks
        assert all(each > 1.0 for each in _of(hole))
        assert model.report()["blocks"][0]["volume_deviation_at_most"] > 0.0


def test_a_dip_counts_as_two():
    def found(dips):
        slopes = Dips(_PLAN[:dips] + 50.0, np.full((dips, 2), 0.1) * np.arange(1, dips + 1)[:, None])
        return interpolate(_points(1, 0.0), _PLAN, dips=slopes)

    assert found(2).variance is None
    assert lacks_deviation(found(2).warnings)
    assert found(3).variance is not None


def test_sheets_of_a_series_and_of_faults():
    _says_nothing(
        _model(
            Surface("A", points=_points(2, 1.0), series="s"),
            Surface("B", points=_points(1, 1.0) + np.array([0, 0, 100.0]), series="s"),
            series=[Series("s", kind="sheets")],
        )
    )
    for dies_out in (False, True):
        end = 500.0 if dies_out else 1100.0
        fault = Fault(
            "F", trace=[[400.0, -100.0], [420.0, end]], dip=90.0, elevation=600.0, dies_out=dies_out
        )
        _says_nothing(_model(Surface("A", points=_points(4, 20.0)), faults=[fault]))


def test_realizations_show_none_either():
    project = Project("p", [_rock(Surface("A", points=_points(3, 0.05)))])
    found = ensemble(project, 3, seed=1)
    hole = found.planned_hole((510.0, 310.0, 650.0), length=600.0)
    assert _of(hole) == [None]
    assert hole.remarks
    assert np.isnan(found.volume_deviations()).all()
    assert np.isnan(found.surface_deviation[0]).all()
    shown = ensemble(Project("p", [_rock(Surface("A", points=_points(9, 40.0)))]), 3, seed=1)
    assert all(math.isfinite(each) and each > 0 for each in shown.volume_deviations())
