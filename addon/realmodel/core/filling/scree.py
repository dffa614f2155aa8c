# SPDX-License-Identifier: GPL-3.0-or-later
"""Scree at the foot of the cliffs of a rock: aprons at the angle of repose, which lean against the walls."""

from __future__ import annotations

import math

import numpy as np

from ..base.algebra import hypot
from ..base.errors import InputRefused
from ..base.work import Work
from .erosion import Mesh, greatest_around, lattice_around, meshed, winding
from .noise import fractal

REPOSE = 34.0  # degrees: of angular stones (Carson 1977, "Angles of repose, angles of shearing resistance and
# angles of talus slopes")
_STEEP = 1.5  # a step of the ground by so many times the spacing is a wall
_SHARE = 0.35  # of the height of a wall: that of the scree at its foot
_AROUND = 3  # spacings: within them the ground rises by the height of the wall that supplies scree
_BEFORE = 0.07  # of the width of the rock: that of the ground before a wall at which scree can lie
_MOST = 0.09  # of the width of the rock: the height of scree at amount 1
_THIN = 0.4  # spacings: thinner scree is not seen


def scree_within(
    work: Work, mesh: Mesh, amount: float, angle: float, seed: int, faces: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The scree of a closed mesh that stands upright, as a job: a closed mesh, its lower side in the rock,
    and (V,) how far down its slope each vertex is, from 0 at the wall to 1.

    amount: 1 covers about a third of the height of walls. angle: of its surface, degrees. faces: about how
    many triangles the rock would have at the same spacing. Raises InputRefused where there is no wall,
    Cancelled."""
    vertices, triangles = mesh
    corners = np.ascontiguousarray(vertices[triangles])
    with work.phase(0.0, 0.5, "finding the ground"):
        lattice = lattice_around(vertices, corners, faces)
        inside = winding(lattice, corners) != 0
    spacing, levels = lattice.spacing[0], np.arange(lattice.counts[2])
    top = np.where(inside, levels, -1).max(axis=2)
    is_ground = top >= 0
    ground = lattice.origin[2] + spacing * (top + 0.5)
    ground[~is_ground] = lattice.origin[2] - spacing
    with work.phase(0.5, 0.8, "heaping up"):
        surface = _heaped(work, ground, is_ground, spacing, amount, math.tan(math.radians(angle)), seed)
    if not (surface > ground + _THIN * spacing)[is_ground].any():
        raise InputRefused(
            "it has no wall at whose foot scree could lie", advice="choose more scree, or a steeper shape"
        )
    z = lattice.origin[2] + spacing * levels
    # It goes on a little into the walls, and its lower side lies in the rock.
    upper = np.where(is_ground & np.isneginf(surface), greatest_around(surface, 1), surface)
    lower = -greatest_around(np.where(is_ground, -ground, -math.inf), 1) - 2.0 * spacing
    field = np.maximum(z - upper[:, :, None], lower[:, :, None] - z)
    with work.phase(0.8, 1.0, "meshing"):
        vertices, triangles = meshed(work, lattice, np.clip(field, -2.0 * spacing, 2.0 * spacing))
    node = np.rint((vertices - np.array(lattice.origin)) / spacing).astype(int)
    return vertices, triangles, _down(surface)[node[:, 0], node[:, 1]]


def _down(surface: np.ndarray) -> np.ndarray:
    """(nx, ny) from 0, the highest scree around, to 1, the lowest."""
    by = max(round(2.0 * _BEFORE * max(surface.shape)), 2)
    highest = greatest_around(surface, by)
    lowest = -greatest_around(np.where(np.isneginf(surface), surface, -surface), by)
    is_known = highest - lowest > 0
    share = np.zeros(surface.shape)
    np.divide(highest - np.maximum(surface, lowest), highest - lowest, out=share, where=is_known)
    return share


def _heaped(
    work: Work,
    ground: np.ndarray,
    is_ground: np.ndarray,
    spacing: float,
    amount: float,
    slope: float,
    seed: int,
) -> np.ndarray:
    """The surface (nx, ny) of scree on the ground: the cones of what lies at the foot of walls, without
    what falls off the end of the rock."""
    before = max(round(_BEFORE * max(ground.shape)), 2)
    highest = greatest_around(ground, _AROUND)
    lowest = -greatest_around(
        np.where(is_ground, -ground, math.inf), before
    )  # none beside the end of the rock
    is_wall = greatest_around(ground, 1) - ground > _STEEP * spacing
    is_foot = is_wall & is_ground & (ground - lowest < before * slope * spacing)  # no ledge high in a wall
    places = np.stack(np.meshgrid(*map(np.arange, ground.shape), indexing="ij"), axis=-1).reshape(-1, 2)
    places = np.column_stack([places * (6.0 / max(ground.shape)), np.zeros(len(places))])
    uneven = 0.4 + 1.2 * fractal(places, seed + 31).reshape(ground.shape)
    height = np.minimum(_SHARE * (highest - ground), _MOST * spacing * max(ground.shape))
    heap = np.where(is_foot, ground + amount * uneven * height, -math.inf)
    heap = _cones(work, heap, slope * spacing, np.where(is_ground, ground - spacing, math.inf))
    # beside the end of the rock nothing holds it
    is_end = is_ground & (greatest_around(np.where(is_ground, 0.0, 1.0), 1) > 0)
    lost = _cones(work, np.where(is_end, -ground, -math.inf), slope * spacing)
    surface = np.minimum(heap, -lost)
    return np.where(surface > ground - spacing, surface, -math.inf)


def _cones(work: Work, tops: np.ndarray, fall: float, lowest: float | np.ndarray = -math.inf) -> np.ndarray:
    """The surface (nx, ny) of the cones below all tops, nearly round, where it is above the lowest."""
    surface = tops
    while True:
        work.check()
        wider = _fallen(surface, fall)
        wider[wider <= lowest] = -math.inf
        if np.array_equal(wider, surface):
            return surface
        surface = wider


def _fallen(field: np.ndarray, fall: float) -> np.ndarray:
    """The greatest value of each node and those within two nodes, less a fall by their distance."""
    wide = np.pad(field, 2, constant_values=-math.inf)
    result = field
    for i, j in np.ndindex(5, 5):
        there = wide[i : i + field.shape[0], j : j + field.shape[1]]
        result = np.maximum(result, there - fall * float(hypot(i - 2.0, j - 2.0)))
    return result
