# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces in closed form that faults displace, as points and as ready meshes, and their throws."""

import itertools
from dataclasses import dataclass

import numpy as np
from realmodel.core import Fault, Project, Rock, build
from structure_cases import SQUARE


def level(x, y):
    return 0.0 * (x + y)


def tilted(x, y):
    return 0.3 * x + 0.2 * y


def dome(x, y):
    return np.cos((x - 5) / 3) * np.cos((y - 5) / 3)


def basin(x, y):
    return -dome(x, y)


def folded(x, y):
    return 0.8 * np.sin(1.2 * y) + 0.0 * x


def leaning(x=5.0, lean=0.5, turn=0.0):
    """Where a plane is: its x grows by `lean` for each unit down, and by `turn` along y."""
    return lambda y, z: x - lean * z + turn * (y - 5.0)


@dataclass(frozen=True)
class Displacing:
    """A fault that is at x = at(y, z) everywhere, or up to y = tip. What is east of it lies lower by `drop`,
    a number or a function of y. lines: of its triangles along y and z."""

    name: str
    at: object
    drop: object = 1.0
    tip: float | None = None
    lines: tuple[int, int] = (2, 2)

    def fault(self):
        y, z = (
            np.linspace(-5, 15 if self.tip is None else self.tip, self.lines[0]),
            np.linspace(-9, 9, self.lines[1]),
        )
        y, z = (each.ravel() for each in np.meshgrid(y, z, indexing="ij"))
        n = np.arange(len(y)).reshape(self.lines)
        a, b, c, d = (each.ravel() for each in (n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]))
        triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(np.int32)
        vertices = np.column_stack([self.at(y, z) + 0.0 * y, y, z])
        return Fault(self.name, vertices, triangles, dies_out=self.tip is not None)

    def lowered(self, y):
        return self.drop(y) if callable(self.drop) else self.drop


def height(shape, faults, sides, x, y):
    """Of the sheet on some sides (-1 west, 1 east) of the faults."""
    return shape(x, y) - sum(fault.lowered(y) for fault, side in zip(faults, sides, strict=True) if side > 0)


def zero(of, low, high):
    """Where a function of numbers that changes its sign between two is 0."""
    low, high = float(low), float(high)
    below = of(low) < 0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if (of(middle) < 0) == below else (low, middle)
    return (low + high) / 2


def lip(shape, faults, sides, number, y):
    """Where the sheet on some sides meets a fault at y; None beside the square or beyond another fault."""
    fault = faults[number]
    x = zero(lambda x: x - fault.at(y, height(shape, faults, sides, x, y)), -9.0, 19.0)
    z = float(height(shape, faults, sides, x, y))
    there = [
        other is fault or side * (x - other.at(y, z)) > 0 for other, side in zip(faults, sides, strict=True)
    ]
    return (x, y, z) if 0 <= x <= 10 and all(there) else None


def points_and_sides(shape, faults, lips=1.0, shift=0.0, steps=(0.75, 1.0), gap=0.25):
    """Points (P, 3) at such steps, at least `gap` away from faults, and of all lips, `shift` off these; and
    (P, F) on which sides they are of each fault."""
    points = []
    for sides in itertools.product((-1, 1), repeat=len(faults)):
        for x, y in itertools.product(np.arange(0, 10.01, steps[0]), np.arange(0, 10.01, steps[1])):
            z = float(height(shape, faults, sides, x, y))
            if all(side * (x - fault.at(y, z)) >= gap for fault, side in zip(faults, sides, strict=True)):
                points.append((x, y, z, *sides))
        for number, fault in enumerate(faults):
            for y in np.arange(0, (10.0 if fault.tip is None else fault.tip) + 0.01, lips) if lips else ():
                if (place := lip(shape, faults, sides, number, y)) is not None:
                    points.append((place[0] + shift, *place[1:], *sides))
    points = np.unique(np.array(points), axis=0)
    return points[:, :3], points[:, 3:].astype(int)


def points_of(*arguments, **more):
    """The points of points_and_sides."""
    return points_and_sides(*arguments, **more)[0]


def mesh_of(shape, faults, shift=0.0, count=(21, 12)):
    """A ready mesh, vertices and triangles, of strips between faults that do not cross, from west to east.
    shift: of the vertices on lips along x."""
    vertices, triangles = [], []
    rows, columns = count
    n = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (each.ravel() for each in (n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]))
    strip = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    for k in range(len(faults) + 1):
        sides = [1 if number < k else -1 for number in range(len(faults))]
        part = []
        for y in np.linspace(0, 10, rows):
            begin = 0.0 if k == 0 else lip(shape, faults, sides, k - 1, y)[0] + shift
            end = 10.0 if k == len(faults) else lip(shape, faults, sides, k, y)[0] + shift
            x = np.linspace(begin, end, columns)
            part.append(np.column_stack([x, 0 * x + y, height(shape, faults, sides, x - shift, y) + 0 * x]))
        vertices.append(np.concatenate(part))
        triangles.append(strip + k * rows * columns)
    return np.concatenate(vertices), np.concatenate(triangles).astype(np.int32)


def built(faults, surface, edge_length=0.8):
    rock = Rock("r", [surface], region=SQUARE, edge_length=edge_length, base_elevation=-8.0)
    return build(Project("p", [rock], faults=[fault.fault() for fault in faults]))


def expected(shape, faults, number, places):
    """throw and heave (N,) in closed form at places (N, 3) on the cutoff line below a fault."""
    fault, found = faults[number], []
    for x, y, z in places:
        dy, dz = ((fault.at(y + 1e-5 * a, z + 1e-5 * b) - fault.at(y, z)) / 1e-5 for a, b in ((1, 0), (0, 1)))
        across = np.array([1.0, -dy]) / np.hypot(1.0, dy)
        is_west_below = dz <= 0
        sides = np.sign([x - other.at(y, z) for other in faults])
        sides[number] = -1 if is_west_below else 1
        lower = height(shape, faults, sides, x, y)
        sides[number] *= -1

        def off(t, x=x, y=y, across=across, sides=sides):
            x, y = (x, y) + t * across
            return x - fault.at(y, height(shape, faults, sides, x, y))

        t = zero(off, -4.0, 4.0)
        upper = height(shape, faults, sides, *((x, y) + t * across))
        found.append((lower - upper, abs(t)))
    return np.array(found).T
