# SPDX-License-Identifier: GPL-3.0-or-later
"""What is used when nothing is said: never far below planes, and it follows dips."""

import numpy as np
import pytest
from realmodel.core import Dips, interpolate
from realmodel.core.settings.methods import DEFAULT_METHOD, DEFAULT_OPTIONS

NODES = np.random.default_rng(1).uniform(0, 2000, (300, 2))


def plane_through(points, nodes):
    terms = [np.column_stack([each[:, :2] - 1000, np.ones(len(each))]) for each in (points, nodes)]
    return terms[1] @ np.linalg.lstsq(terms[0], points[:, 2], rcond=None)[0]


def by_default(points, **given):
    return interpolate(points, NODES, DEFAULT_METHOD, **DEFAULT_OPTIONS, **given).z


def history(random, count):
    """Contacts of a bed that is level, dips up to 15 degrees or is waved, with errors; and its heights."""
    slope = random.choice([0.0, 0.1, 0.25]) * np.array(
        [np.sin(turn := random.uniform(0, 6.28)), np.cos(turn)]
    )
    height, length = random.choice([0.0, 15.0, 40.0]), random.uniform(800, 3000)

    def z(plan):
        return plan @ slope + height * np.sin(2 * np.pi * plan[:, 0] / length + turn)

    plan = random.uniform(0, 2000, (count, 2))
    return np.column_stack([plan, z(plan) + random.choice([0.0, 3.0, 15.0]) * random.normal(size=count)]), z(
        NODES
    )


def test_as_good_as_the_best_single_method():
    random = np.random.default_rng(60)
    errors = []
    for count in [4, 6, 10, 20] * 12:
        points, right = history(random, count)
        found = [by_default(points), interpolate(points, NODES, "kriging").z, plane_through(points, NODES)]
        errors.append([np.minimum(np.abs(z - right), 60).mean() for z in found])
    default, kriging, plane = np.mean(errors, axis=0)
    assert default < 0.98 * kriging and default < 0.98 * plane


@pytest.mark.parametrize("away", [10.0, 100.0, 500.0])
def test_one_contact_follows_its_dip(away):
    dips = Dips(np.array([[100.0 + away, 500.0]]), np.array([[-0.176, 0.05]]))
    z = by_default([[100, 500, 300]], dips=dips)
    np.testing.assert_allclose(z, 300 + (NODES - [100, 500]) @ [-0.176, 0.05], atol=1e-6)
