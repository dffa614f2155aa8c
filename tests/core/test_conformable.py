# SPDX-License-Identifier: GPL-3.0-or-later
"""Conformable surfaces: their heights vary alike; of those by the method auto a series is proposed."""

from dataclasses import replace

import numpy as np
import pytest
from realmodel.core import Dips, Fault, Project, Surface, build
from test_series_of_sheets import height, rock_of, surfaces_of


def proposed(surfaces, **more):
    model = build(Project("p", [rock_of(surfaces, **more)]))
    return [each.text for each in model.warnings if each.kind == "series"]


def automatic(counts, seed=1):
    return [replace(each, series=None) for each in surfaces_of(counts, seed, method="auto")]


def unconformity(count=40):
    plan = np.random.default_rng(8).uniform(0, 1000, (count, 2))
    z = 200 + 30 * np.cos(plan[:, 1] / 60) - 0.1 * plan[:, 0]
    return Surface("U", points=np.column_stack([plan, z]), method="auto")


@pytest.mark.parametrize(("count", "seed"), [(15, 3), (15, 4), (60, 2), (60, 3)])
def test_a_folded_succession_is_proposed(count, seed):
    """But not the unconformity over it."""
    (text,) = proposed([*automatic([count] * 3, seed), unconformity()])
    assert text.startswith(
        "surfaces 'S0', 'S1' and 'S2' are conformable: a contact that is left out is estim"
    )


def test_what_it_says_holds():
    """As a series the surfaces are better than each by itself."""
    surfaces = automatic([15, 15, 15], 4)
    assert len(proposed(surfaces)) == 1
    errors = []
    for series in (None, "J"):
        given = [replace(each, series=series, method="kriging" if series else "auto") for each in surfaces]
        model = build(Project("p", [rock_of(given)]))
        vertices = [model.surface(number)[0] for number in range(3)]
        errors.append([np.std(v[:, 2] - height(k, v[:, :2])) for k, v in enumerate(vertices)])
    assert max(errors[1]) < 0.8 * min(errors[0])


def test_what_is_not_proposed():
    surfaces = automatic([15, 15, 15], 4)
    other = [replace(each, name=f"T{n}") for n, each in enumerate((unconformity(), unconformity(60)))]
    other[1].points = other[1].points[:, [1, 0, 2]]
    assert proposed(other) == [], "they have nothing in common"
    assert proposed([surfaces[0], replace(surfaces[1], method="spline"), surfaces[2]]) == [], "not both auto"
    assert proposed([surfaces[0], unconformity(), surfaces[2]]) == [], "not one after the other"
    assert proposed(automatic([15, 7], 4)) == [], "too few contacts show nothing"
    assert proposed(automatic([301, 60], 2)) == [], "so many show it themselves"
    assert proposed(surfaces_of([15, 15, 15], 4)) == [], "they are a series"


def fold(plan):
    """Folds whose axes run north and plunge."""
    return 60 * np.sin(plan[:, 0] / 90) + 15 * np.sin(plan[:, 1] / 200)


def folds(rules, methods=("kriging",) * 3):
    """Of the oldest surface few contacts are known, and one dip."""
    surfaces = []
    for number, (rule, method) in enumerate(zip(rules, methods, strict=True)):
        draw = np.random.default_rng(number)
        contacts, plan = (draw.uniform(0, 1000, (count, 2)) for count in ((9, 1) if not number else (14, 14)))
        points = np.column_stack([contacts, fold(contacts) + 50 * number])
        slopes = np.column_stack([60 / 90 * np.cos(plan[:, 0] / 90), 15 / 200 * np.cos(plan[:, 1] / 200)])
        dips = Dips(plan, slopes)
        surfaces.append(Surface(f"S{number}", points=points, dips=dips, rule=rule, method=method))
    return surfaces


def of_oldest(model):
    """Its error, and its variogram."""
    vertices, _ = model.surface(0)
    return np.std(vertices[:, 2] - fold(vertices[:, :2])), model.interpolations[0].variogram


def test_conformable_surfaces_share_how_their_heights_vary():
    """So those with few data have the folds that the others show: their length and direction."""
    rules = ("erosional", "conformable", "conformable")
    error, found = of_oldest(build(Project("p", [rock_of(folds(rules))])))
    alone, _ = of_oldest(build(Project("p", [rock_of(folds(["erosional"] * 3))])))
    assert error < 0.7 * alone
    _, wave = found.structures
    assert wave.model == "wave"
    assert wave.range / wave.anisotropy["ratio"] == pytest.approx(2 * np.pi * 90, rel=0.02)
    assert min(wave.anisotropy["azimuth"], 180 - wave.anisotropy["azimuth"]) < 2
    assert found.range == found.structures[0].range, "that of the wave is how far it goes on"


def test_what_is_not_conformable_says_nothing():
    """Nor does a surface of a method without a variogram."""
    alone = of_oldest(build(Project("p", [rock_of(folds(["erosional"] * 3))])))[1]
    for rules, methods in (
        (("base", "conformable", "conformable"), ("kriging",) * 3),
        (("erosional", "erosional", "conformable"), ("kriging",) * 3),
        (("erosional", "conformable", "conformable"), ("kriging", "spline", "spline")),
    ):
        assert of_oldest(build(Project("p", [rock_of(folds(rules, methods))])))[1] == alone


def test_in_each_compartment_its_own_data_count():
    """A throw between them does not change how heights vary."""
    surfaces = folds(("erosional", "conformable", "conformable"))
    for surface in surfaces:
        surface.points[surface.points[:, 1] > 500, 2] += 400
    trace = np.array([[-100.0, 500], [1100, 500]])
    model = build(
        Project("p", [rock_of(surfaces)], faults=[Fault("F", trace=trace, dip=90, dip_direction=0)])
    )
    found = model.interpolations[0].variogram
    assert found.sill < 100**2
    assert model.interpolations[1].variogram.range == found.range


def test_a_faulted_succession_is_proposed():
    """As far as it lies on one side of the fault."""
    surfaces = [*automatic([60] * 3, 2), unconformity()]
    for surface in surfaces[:3]:
        surface.points[surface.points[:, 1] > 500, 2] += 400
    trace = np.array([[-100.0, 500], [1100, 500]])
    fault = Fault("F", trace=trace, dip=90, dip_direction=0, youngest="S2")
    model = build(Project("p", [rock_of(surfaces)], faults=[fault]))
    (text,) = [each.text for each in model.warnings if each.kind == "series"]
    assert text.startswith(
        "surfaces 'S0', 'S1' and 'S2' are conformable: a contact that is left out is estim"
    )
