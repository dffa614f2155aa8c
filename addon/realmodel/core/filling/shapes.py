# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes of rock to begin with: closed meshes with a level base, random by their seed."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..base.algebra import atan2, cos, hypot, norm, sin
from ..base.errors import UsageError
from ..base.work import Work
from .erosion import Mesh, cubic_lattice, meshed
from .noise import chance, fractal

_ACROSS = 72  # nodes of the lattice along the longest side
_PAD = 2  # nodes beyond each side
_GROUND = 0.07  # of the width: rock beneath the ground of a shape, which erosion lowers

Field = Callable[[np.ndarray, np.ndarray, np.ndarray, int], np.ndarray]  # of x, y, z and a seed


def rock_shape(kind: str, size: float = 1.0, seed: int = 0) -> Mesh:
    """A closed mesh of rock to fill with strata: vertices (V, 3) and triangles (T, 3).

    kind: cliff, canyon, boulder, arch, island or terrain. size: how wide it is at most, model units; its base
    is at elevation 0, its middle above the origin. seed: another shape of this kind. Raises UsageError.

    >>> vertices, triangles = rock_shape("arch", size=20.0, seed=4)
    >>> round(float(vertices[:, 0].max() - vertices[:, 0].min()))
    20
    """
    if kind not in SHAPES:
        raise UsageError(f"kind must be one of {', '.join(SHAPES)}, not {kind!r}")
    if not 0 < size < math.inf:
        raise UsageError(f"size must be above 0, not {size!r}")
    box, field = SHAPES[kind]
    spacing = 1.0 / _ACROSS
    sides = np.array([box[0], box[1], box[2] + _GROUND])
    counts = np.round(sides / spacing).astype(int) + 2 * _PAD + 1
    origin = -spacing * np.array([0.5 * (counts[0] - 1), 0.5 * (counts[1] - 1), _PAD])
    lattice = cubic_lattice(origin, spacing, counts)
    x, y, z = np.ix_(*(origin[axis] + spacing * np.arange(counts[axis]) for axis in range(3)))
    bounds = np.minimum(0.5 * box[0] - np.abs(x), 0.5 * box[1] - np.abs(y))
    inside = np.minimum(field(x, y, z - _GROUND, seed), np.minimum(bounds, z))
    vertices, triangles = meshed(Work(), lattice, -inside)
    vertices[:, 2] -= vertices[:, 2].min()
    return vertices * size, triangles


def _step(value: np.ndarray) -> np.ndarray:
    """From 0 to 1, smooth at both ends."""
    share = np.clip(value, 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


def _noise(seed: int, octaves: int, *coordinates: np.ndarray) -> np.ndarray:
    """Noise from -1 to 1 at coordinates that are broadcast."""
    places = np.stack(np.broadcast_arrays(*coordinates), axis=-1)
    return 2.0 * fractal(places.reshape(-1, 3), seed, octaves).reshape(places.shape[:-1]) - 1.0


def _plan(x: np.ndarray, y: np.ndarray, scale: float, seed: int, octaves: int = 4) -> np.ndarray:
    """The same at all elevations."""
    return _noise(seed, octaves, scale * x + 40.0, scale * y + 40.0, np.full((1, 1, 1), 40.0))


def _cliff(x: np.ndarray, y: np.ndarray, z: np.ndarray, seed: int) -> np.ndarray:
    """A plateau that ends in bays and ribs, above a slope."""
    edge = 0.22 * _plan(x, 0.4 * y, 2.4, seed)
    rise = _step((y - edge + 0.06) / 0.09)
    foot = 0.05 + 0.06 * _step((y + 0.3) / 0.4) + 0.02 * _plan(x, y, 5.0, seed + 7)
    return foot + (0.36 + 0.04 * _plan(x, y, 3.0, seed + 9) - foot) * rise - z


def _canyon(x: np.ndarray, y: np.ndarray, z: np.ndarray, seed: int) -> np.ndarray:
    """A plateau with a river canyon that winds, and side canyons."""
    line = 0.16 * sin(5.0 * x + 6.0 * chance(seed)) + 0.12 * _plan(x, y, 2.0, seed)
    away = np.abs(y - line)
    wall = _step((away - 0.05) / 0.17) ** 0.6
    side = _step((np.abs(_plan(x, y, 2.6, seed + 5)) - 0.04) / 0.16)
    rise = wall * (0.45 + 0.55 * np.maximum(side, 1.0 - _step((away - 0.1) / 0.12)))
    return 0.05 + 0.34 * rise + 0.015 * _plan(x, y, 6.0, seed + 9) - z


def _boulder(x: np.ndarray, y: np.ndarray, z: np.ndarray, seed: int) -> np.ndarray:
    """A lump with broken faces."""
    z = z - 0.27
    rough = _noise(seed, 4, 3.0 * x + 9.0, 3.0 * y + 9.0, 3.0 * z + 9.0)
    inside = 0.44 + 0.1 * rough - np.sqrt(x * x + 1.3 * y * y + 1.8 * z * z)
    random = np.random.default_rng(seed)
    for _ in range(7):
        along = random.normal(size=3)
        along /= norm(along)
        distance = 0.27 + 0.08 * random.random()
        inside = np.minimum(inside, distance - (x * along[0] + y * along[1] + z * along[2]))
    return inside


def _arch(x: np.ndarray, y: np.ndarray, z: np.ndarray, seed: int) -> np.ndarray:
    """A wall of rock with an opening through it, on a low ground."""
    rough = _noise(seed, 4, 4.0 * x + 5.0, 4.0 * y + 5.0, 4.0 * z + 5.0)
    top = 0.46 - 0.35 * x * x + 0.05 * _plan(x, y, 3.0, seed + 3)
    fin = np.minimum(0.115 + 0.05 * rough + 0.05 * (0.5 - z) - np.abs(y - 0.05 * sin(4.0 * x)), top - z)
    fin = np.minimum(fin, 0.43 + 0.05 * rough - np.abs(x))
    opening = hypot(x / 0.21, (z - 0.04) / 0.3) - 1.0 + 0.25 * rough
    ground = 0.035 + 0.03 * _plan(x, y, 4.0, seed + 8) - z
    return np.maximum(np.minimum(fin, 0.2 * opening), ground)


def _island(x: np.ndarray, y: np.ndarray, z: np.ndarray, seed: int) -> np.ndarray:
    """An island with a steep coast, and stacks before it."""
    turn = atan2(y, x)
    coast = 0.33 + 0.11 * _noise(
        seed, 4, 1.4 * cos(turn) + 20.0, 1.4 * sin(turn) + 20.0, np.full((1, 1, 1), 20.0)
    )
    away = coast - hypot(x, y)
    stacks = _step((_plan(x, y, 7.0, seed + 4) - 0.42) / 0.06) * _step((away + 0.1) / 0.06)
    height = 0.15 * _step(away / 0.035) + 0.2 * _step(away / 0.3) * (0.7 + 0.5 * _plan(x, y, 3.0, seed + 6))
    return 0.03 + np.maximum(height, 0.12 * stacks) - z


def _terrain(x: np.ndarray, y: np.ndarray, z: np.ndarray, seed: int) -> np.ndarray:
    """Ridges and valleys."""
    ridges = 1.0 - np.abs(_plan(x, y, 2.2, seed, 5)) * 2.0
    hills = 0.5 + 0.5 * _plan(x, y, 1.3, seed + 11, 3)
    return 0.06 + 0.24 * hills + 0.14 * ridges * hills - z


# of each the sides of its box, of which the longest is 1, and what is inside: above 0
SHAPES: dict[str, tuple[tuple[float, float, float], Field]] = {
    "cliff": ((1.0, 0.7, 0.46), _cliff),
    "canyon": ((1.0, 0.9, 0.45), _canyon),
    "boulder": ((1.0, 1.0, 0.65), _boulder),
    "arch": ((1.0, 0.6, 0.6), _arch),
    "island": ((1.0, 1.0, 0.45), _island),
    "terrain": ((1.0, 1.0, 0.5), _terrain),
}
