# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements of stacks with faults and of cuts, each in a process of its own (process.alone).

Processors' seconds are those of all threads; they hardly depend on what else runs.
"""

from __future__ import annotations

import importlib
import time

import numpy as np

from .booleans import make_sphere
from .made_stacks import StackSpec
from .peers import close_to_solid
from .process import Skipped

_DEPTH = 1.0  # of faults above and below all rock
_THROW = 0.02  # of each fault
_BOTTOM = -1.0  # of the solids that a sphere cuts


def make_faults(count: int) -> list:
    """Planes through the unit square with their own dips; every third strikes along x, the others along y."""
    faults = []
    for number in range(count):
        x = (number // 3 * 2 + (number % 3 > 0) + 0.7) / 4.0
        lean, turns = (0.3, -0.2, 0.1)[number % 3], number % 3 == 2
        high, low = 1.0 + _DEPTH, -0.5 - _DEPTH
        across = [x - lean * low, x - lean * high]
        corners = np.array(
            [[across[0], -1, low], [across[0], 2, low], [across[1], 2, high], [across[1], -1, high]]
        )
        if turns:
            corners = corners[:, [1, 0, 2]]
        faults.append((f"F{number + 1}", corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32)))
    return faults


def build_faulted(spec: dict, cells: str, threads: int, count: int) -> dict:
    """A whole build, from arrays in memory, of a stack with so many faults."""
    from realmodel.core import Fault, Project, Rock, Surface, build
    from realmodel.core.base.work import native_module

    native_module()
    importlib.import_module("numpy.ma")  # NumPy 2 loads it with the first np.unique or np.median
    faults = make_faults(count)
    surfaces = []
    for number, (vertices, triangles) in enumerate(StackSpec(**spec).make()):
        for _, (a, b, c, _), _ in faults:
            vertices[:, 2] += _THROW * ((vertices - a) @ np.cross(b - a, c - a) > 0)
        surfaces.append(Surface(f"S{number}", vertices, triangles))
    project = Project("stack", [Rock("rock", surfaces)], faults=[Fault(*fault) for fault in faults])
    began, before = time.perf_counter(), time.process_time()
    model = build(project, cells=cells, threads=threads)
    return {
        "seconds": time.perf_counter() - began,
        "processor": time.process_time() - before,
        "cells": len(model.cell_block),
        "compartments": len(model.compartment_names),
    }


def _sphere(rings: int) -> tuple[np.ndarray, np.ndarray]:
    return make_sphere(rings, (0.5, 0.5, 0.2), 0.3)


def ours_cut(spec: dict, cells: str, rings: int, threads: int) -> dict:
    """The cells of a stack cut by a sphere of 4 rings (rings - 1) triangles: both halves."""
    from realmodel.core import Project, Rock, Surface, build
    from realmodel.core.model.cutting import cut_by_surface

    surfaces = [
        Surface(f"S{number}", vertices, triangles)
        for number, (vertices, triangles) in enumerate(StackSpec(**spec).make())
    ]
    model = build(Project("stack", [Rock("rock", surfaces, base_elevation=_BOTTOM)]), cells=cells)
    sphere = _sphere(rings)
    began, before = time.perf_counter(), time.process_time()
    halves = cut_by_surface(model, *sphere, threads=threads)
    return {
        "seconds": time.perf_counter() - began,
        "processor": time.process_time() - before,
        "cells": len(model.cell_block),
        "volume": float(sum(block.volume for block in halves.below.blocks)),
    }


def manifold_cut(spec: dict, rings: int) -> dict:
    """Each layer of a stack, as a solid of Manifold's own, split by the sphere."""
    try:
        from manifold3d import Manifold, Mesh64
    except ImportError as missing:
        raise Skipped("manifold3d is not installed") from missing
    rest, layers = None, []
    for surface in reversed(StackSpec(**spec).make()):
        vertices, triangles = close_to_solid(surface, _BOTTOM)
        solid = Manifold(Mesh64(vertices, triangles.astype(np.uint64)))
        if rest is None:
            rest = solid
            continue
        rest, layer = rest.split(solid)
        layers.append(layer)
    layers.append(rest)
    for layer in layers:
        layer.num_tri()
    vertices, triangles = _sphere(rings)
    began, before = time.perf_counter(), time.process_time()
    sphere = Manifold(Mesh64(vertices, triangles.astype(np.uint64)))
    pairs = [layer.split(sphere) for layer in layers]
    for inside, outside in pairs:
        inside.num_tri()
        outside.num_tri()
    return {
        "seconds": time.perf_counter() - began,
        "processor": time.process_time() - before,
        "volume": sum(inside.volume() for inside, _ in pairs),
    }
