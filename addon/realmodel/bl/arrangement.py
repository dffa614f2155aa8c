# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways to open a model so that the layers inside can be seen in a picture."""

import math
from dataclasses import dataclass, replace

import bpy
import numpy as np

from . import cutaway, meshes

# A model flatter than this (height over width) is drawn with its heights exaggerated.
FLATTEST = 0.12
PEELED = 0.32  # part of the model's width over which the layers are peeled off
LEAST_LEFT = 45.0  # percent of a block's vertices that peeling leaves behind the cut
GAPS = (0.25, 0.5, 1.0, 2.0)  # between the blocks of an exploded view, in heights of the model


@dataclass
class Body:
    """A block as triangles (T, 3, 3) float64, its material, and how many blocks lie below it in its
    rock mass."""

    name: str
    triangles: np.ndarray
    material: bpy.types.Material
    rank: int = 0

    @classmethod
    def of(cls, block_object, rank=0):
        """The body of a block object as it stands in its scene."""
        mesh = block_object.data
        mesh.calc_loop_triangles()
        corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("vertices", corners)
        matrix = np.array(block_object.matrix_world, np.float64)
        placed = meshes.mesh_coordinates(mesh) @ matrix[:3, :3].T + matrix[:3, 3]
        return cls(block_object.name, placed[corners].reshape(-1, 3, 3), mesh.materials[0], rank)

    def with_triangles(self, triangles):
        return replace(self, triangles=triangles)


@dataclass
class Layout:
    """Bodies as they are to be drawn, and what was done to them, in words."""

    name: str
    bodies: list

    def points(self):
        """(N, 3) float64, all corners of all bodies."""
        return np.concatenate([body.triangles.reshape(-1, 3) for body in self.bodies])


def centred(bodies):
    """The bodies around the middle of the model, and the factor by which heights were exaggerated.

    Returns (bodies, factor); the factor is 1, 2, 5, 10, 20, 50, ...
    """
    points = np.concatenate([body.triangles.reshape(-1, 3) for body in bodies])
    low, high = points.min(axis=0), points.max(axis=0)
    width, height = (high - low)[:2].max(), (high - low)[2]
    factor = 1.0
    if 0.0 < height < FLATTEST * width:
        wanted = FLATTEST * width / height
        decade = 10.0 ** math.floor(math.log10(wanted))
        factor = next(decade * step for step in (1.0, 2.0, 5.0, 10.0) if decade * step >= wanted)
    scale = np.array([1.0, 1.0, factor])
    middle = 0.5 * (low + high)
    return [body.with_triangles((body.triangles - middle) * scale) for body in bodies], factor


def peeled(bodies, towards):
    """Each block cut by an upright plane, the younger the farther back: steps that bare the beds.

    towards: (3,) horizontal unit vector, the side to open.
    """
    towards = np.asarray(towards, np.float64)
    front = max(_reach(body, towards).max() for body in bodies)
    depth = PEELED * (front - min(_reach(body, towards).min() for body in bodies))
    steps = max(1, max(body.rank for body in bodies))
    cut_at, nearest = {}, -math.inf
    for body in sorted(bodies, key=lambda body: -body.rank):
        left = float(np.percentile(_reach(body, towards), LEAST_LEFT))
        nearest = max(front - depth * body.rank / steps, left, nearest)
        cut_at[body.rank] = nearest
    return Layout("cut away", [_cut(body, towards, cut_at[body.rank]) for body in bodies])


def section_through(bodies, towards, name):
    """All blocks cut by one upright plane through the middle of the block of this name."""
    towards = np.asarray(towards, np.float64)
    body = next(body for body in bodies if body.name == name)
    middle = float(np.median(_reach(body, towards)))
    return Layout(f"section through {name}", [_cut(body, towards, middle) for body in bodies])


def exploded(bodies, gap):
    """Blocks lifted off each other, the younger the higher. gap: in heights of the model."""
    heights = np.concatenate([body.triangles[:, :, 2].ravel() for body in bodies])
    lift = gap * float(heights.max() - heights.min())
    lifted = [body.with_triangles(body.triangles + np.array([0.0, 0.0, lift * body.rank])) for body in bodies]
    return Layout(f"exploded by {gap:g} of its height", lifted)


def _reach(body, towards):
    return body.triangles.reshape(-1, 3) @ towards


def _cut(body, towards, offset):
    reach = _reach(body, towards)
    if reach.max() <= offset:
        return body
    return body.with_triangles(cutaway.keep_behind(body.triangles, towards, offset))
