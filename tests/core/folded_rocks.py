# SPDX-License-Identifier: GPL-3.0-or-later
"""Rock masses with folds whose fields are given in closed form."""

from dataclasses import replace

import numpy as np
from realmodel.core import Project, Rock, Series, SpaceDips, Surface
from realmodel.core.fields import Anisotropy, SolvedField
from realmodel.core.structures import fields

SIZE = 10.0
SQUARE = [[0.0, 0.0], [SIZE, 0.0], [SIZE, SIZE], [0.0, SIZE]]
OF_FOLD = (1.5, 2.5, 4.0)  # levels of `recumbent`


def recumbent(p):
    """A fold that lies on its side: its axial plane is nearly level."""
    x, y, z = np.moveaxis(np.asarray(p, float), -1, 0)
    return 0.45 * x + 2.2 * np.sin(0.9 * z + 0.15 * y) + 0.1 * z


def dome(p):
    x, y, z = np.moveaxis(np.asarray(p, float), -1, 0)
    return z + 0.08 * ((x - 5.0) ** 2 + (y - 4.0) ** 2)


def plunging(p):
    x, y, z = np.moveaxis(np.asarray(p, float), -1, 0)
    return z + 1.4 * np.sin(x + 0.2 * y) + 0.3 * y


def given_field(monkeypatch, f, levels):
    """Makes fields in the place of the solver: f, or the one of several that `f(data)` chooses, with these
    levels. Beside faults that die out it is greater by three times the sum of their coordinates."""
    levels = np.asarray(levels, float)

    def solve_field(lattice, data, work):
        own = f(data) if f.__name__ == "chosen" else f
        none = np.empty(0, np.int64)
        jumps = [0.0] if data.slits is None else 3.0 * data.slits.nodes.sum(axis=2)
        first = SolvedField(
            lattice=lattice,
            values=own(lattice.positions()) + jumps[0],
            levels=levels,
            anisotropy=Anisotropy(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (1.0, 1.0, 1.0)),
            order=3,
            centers=len(data.contacts),
            misfit=0.0,
            dips_missed=none,
            bounds_missed=none,
            critical_points=np.empty((0, 3)),
        )
        others = (replace(first, values=own(lattice.positions()) + jump) for jump in jumps[1:])
        return replace(first, others=tuple(others))

    monkeypatch.setattr(fields, "solve_field", solve_field)


def contacts(f, level, count=12, seed=1, low=0.5, high=9.5):
    """(count, 3) points near a level of f, by bisection along x, y and z from random points."""
    generator = np.random.default_rng(seed)
    found = []
    while len(found) < count:
        a, b = generator.uniform(low, high, (2, 3))
        if (f(a) - level) * (f(b) - level) >= 0:
            continue
        for _ in range(60):
            middle = (a + b) / 2
            a, b = (middle, b) if (f(a) - level) * (f(middle) - level) > 0 else (a, middle)
        found.append(a)
    return np.array(found)


def level_surface(name, f, level, **more):
    return Surface(name, points=contacts(f, level, seed=len(name)), series="folded", **more)


def sheet(name, height, n=5, **more):
    """A ready mesh: height(x, y) on a grid of n x n squares beyond the region."""
    axis = np.linspace(-0.5, SIZE + 0.5, n + 1)
    x, y = (each.ravel() for each in np.meshgrid(axis, axis))
    number = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = (
        each.ravel() for each in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
    )
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(np.int32)
    vertices = np.column_stack([x, y, height(x, y) + 0 * x])
    return Surface(name, vertices=vertices, triangles=triangles, **more)


def folded_rock(surfaces, resolution=1.0, **more):
    return Rock(
        "r",
        surfaces,
        region=SQUARE,
        base_elevation=0.0,
        series=[Series("folded", resolution=resolution)],
        **more,
    )


def folded_project(f=recumbent, levels=(1.5, 2.5, 4.0), younger=(), **more):
    """A series with these levels, a ground, and what is between them."""
    series = [level_surface("f" + "i" * k, f, level) for k, level in enumerate(levels)]
    ground = sheet("ground", lambda x, y: 8.0 + 0.6 * np.sin(x) * np.cos(0.7 * y))
    return Project("folded", [folded_rock([*series, *younger, ground])], **more)


def folded(f=recumbent, levels=OF_FOLD, **more):
    """A project with few contacts and dips of a closed form."""
    project = folded_project(f, levels, **more)
    rock = project.rocks[0]
    for number, level in enumerate(levels):
        rock.surfaces[number].points = contacts(f, level, 9, 11 + number, high=7.0)
    places = np.random.default_rng(5).uniform(0.5, 7.0, (12, 3))
    normals = np.column_stack([f(places + move) - f(places - move) for move in 1e-5 * np.eye(3)])
    rock.series[0].dips = SpaceDips(places, normals)
    return project
