# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces by the method auto that are conformable: a series is proposed."""

from dataclasses import replace

import numpy as np
import pytest
from realmodel.core import Project, Surface, build
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
