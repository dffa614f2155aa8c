# SPDX-License-Identifier: GPL-3.0-or-later
"""Stacks that every measurement is made on: the same arrays for the same name, on every run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

Surface = tuple[np.ndarray, np.ndarray]  # vertices (V, 3) float64, triangles (T, 3) int32


@dataclass(frozen=True)
class StackSpec:
    """A stack over a square.

    surfaces: how many; quads: cells along a side, so that each surface has 2 quads^2 triangles;
    plan: "own" (jittered nodes, another triangulation for each surface), "shared" (one regular mesh for all)
    or "lattice" (shared, with whole-number places); heights: "sines" (surfaces that cross one another
    in smooth lines), "steps" (whole numbers 0 .. 3 at random) or "half" (each lies on its predecessor
    for x <= 1/2 and above it elsewhere); side: of the square.
    """

    surfaces: int
    quads: int
    plan: str = "own"
    heights: str = "sines"
    side: float = 1.0

    @property
    def triangles(self) -> int:
        """Of one surface."""
        return 2 * self.quads * self.quads

    def make(self) -> list[Surface]:
        """The surfaces, oldest first."""
        return list(self.each())

    def each(self) -> Iterator[Surface]:
        """One surface after another, oldest first."""
        random = np.random.default_rng(1)
        before = None
        for number in range(self.surfaces):
            x, y = _plan(self, random)
            before = _heights(self, number, x, y, random, before)
            yield np.column_stack([x.ravel(), y.ravel(), before.ravel()]), grid_triangles(self.quads)


def grid_triangles(quads: int) -> np.ndarray:
    """(2 quads^2, 3) int32: the triangles of a grid whose nodes count along y first."""
    node = np.arange((quads + 1) ** 2, dtype=np.int32).reshape(quads + 1, quads + 1)
    a, b, c, d = node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def _plan(spec: StackSpec, random) -> tuple[np.ndarray, np.ndarray]:
    node = np.arange(spec.quads + 1, dtype=float)
    x, y = (grid.copy() for grid in np.meshgrid(node, node, indexing="ij"))
    if spec.plan == "own":
        inside = (slice(1, -1), slice(1, -1))
        for grid in (x, y):
            grid[inside] += random.uniform(-0.2, 0.2, grid[inside].shape)
    return (x, y) if spec.plan == "lattice" else (x / spec.quads * spec.side, y / spec.quads * spec.side)


def _heights(spec: StackSpec, number: int, x, y, random, before) -> np.ndarray:
    p, q, r = random.uniform(0, 6, 3)
    if spec.heights == "steps":
        return random.integers(0, 4, x.shape).astype(float)
    if spec.heights == "half" and before is not None:
        return before + 0.1 * np.maximum(0.0, x - 0.5)
    waves = 0.1 * np.sin(3 * x + p) * np.cos(4 * y + q) + 0.03 * np.sin(9 * x + r + 5 * y)
    return 0.05 * number + waves
