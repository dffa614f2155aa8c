# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user would take instead: Manifold, CGAL's corefinement with exact numbers, Blender's Boolean."""

from __future__ import annotations

import json
import tempfile
import time
from pathlib import Path

import numpy as np

from .made_stacks import StackSpec, Surface
from .process import ROOT, Skipped, run_apart

CGAL_PROGRAM = ROOT / "build" / "release" / "native" / "cgal_corefinement"
_BLENDER_SCRIPT = Path(__file__).with_name("blender_boolean.py")


def close_to_solid(surface: Surface, bottom: float) -> Surface:
    """The surface of a grid with walls down to a level bottom: a closed solid, outward counter-clockwise."""
    vertices, triangles = surface
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(
        np.int64
    )
    key = edges.min(axis=1) * len(vertices) + edges.max(axis=1)
    _, first, count = np.unique(key, return_index=True, return_counts=True)
    border = edges[first[count == 1]]  # as the triangle beside it runs
    below = np.full(len(vertices), -1)
    rim = np.unique(border)
    below[rim] = len(vertices) + np.arange(len(rim))
    middle = len(vertices) + len(rim)
    foot = vertices[rim].copy()
    foot[:, 2] = bottom
    center = [[*vertices[:, :2].mean(axis=0), bottom]]
    a, b = border.T
    walls = [np.stack([b, a, below[a]], axis=1), np.stack([b, below[a], below[b]], axis=1)]
    floor = np.stack([np.full(len(a), middle), below[b], below[a]], axis=1)
    closed = np.concatenate([triangles, *walls, floor])
    return np.concatenate([vertices, foot, center]), closed.astype(np.int32)


def manifold(spec: dict) -> dict:
    """Closes each surface to a solid, makes Manifold's own solids of them, and splits the youngest by each
    older one: what lies above is a block, what lies below is split on."""
    try:
        from manifold3d import Manifold, Mesh64
    except ImportError as error:
        raise Skipped(f"manifold3d is not there: {error}") from error

    surfaces = StackSpec(**spec).make()
    bottom = min(float(vertices[:, 2].min()) for vertices, _ in surfaces) - 1.0
    began = time.perf_counter()
    solids = []
    for surface in surfaces:
        vertices, triangles = close_to_solid(surface, bottom)
        solids.append(Manifold(Mesh64(vertices, triangles.astype(np.uint64))))
        solids[-1].num_tri()  # made when it is asked for
    constructed = time.perf_counter() - began
    rest, blocks = solids[-1], []
    for older in reversed(solids[:-1]):
        rest, block = rest.split(older)
        blocks.append(block)
        rest.num_tri()
        block.num_tri()
    seconds = time.perf_counter() - began
    return {
        "seconds": seconds,
        "constructed": constructed,
        "triangles": sum(block.num_tri() for block in blocks),
        "volume": sum(block.volume() for block in blocks),
    }


def cgal(spec: StackSpec, seconds: float, memory: float) -> dict:
    """All pairs of surfaces cut along one another by cgal_corefinement, in its own process."""
    if not CGAL_PROGRAM.is_file():
        raise Skipped("cgal_corefinement was not built (libmpfr-dev)")
    with tempfile.NamedTemporaryFile(suffix=".stack") as file:
        surfaces = spec.make()
        np.int64(len(surfaces)).tofile(file)
        for vertices, triangles in surfaces:
            np.array([len(vertices), len(triangles)], np.int64).tofile(file)
            vertices.tofile(file)
            triangles.tofile(file)
        file.flush()
        out, _, peak = run_apart([CGAL_PROGRAM, file.name], seconds, int(memory))
    return {**json.loads(out), "peak": peak}


def blender(spec: StackSpec, solver: str, seconds: float, memory: float) -> dict:
    """The younger of two solids less the older one by Blender's Boolean modifier, in background Blender."""
    command = ["blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P", _BLENDER_SCRIPT, "--"]
    with tempfile.NamedTemporaryFile(suffix=".npz") as file:
        surfaces = spec.make()
        bottom = min(float(vertices[:, 2].min()) for vertices, _ in surfaces) - 1.0
        arrays = {}
        for name, surface in zip(("older", "younger"), surfaces, strict=True):
            arrays[f"{name}_vertices"], arrays[f"{name}_triangles"] = close_to_solid(surface, bottom)
        np.savez(file, **arrays)
        file.flush()
        try:
            out, _, peak = run_apart([*command, file.name, solver], seconds, int(memory))
        except FileNotFoundError as error:
            raise Skipped("blender is not there") from error
    told = [line for line in out.splitlines() if line.startswith("{")]
    if not told:
        raise Skipped("Blender did not tell its time")
    return {**json.loads(told[-1]), "peak": peak}
