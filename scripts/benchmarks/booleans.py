# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements of Booleans, ours and the peers', each in a process of its own (process.alone).

Seconds go from arrays to arrays; the processors' seconds beside hardly depend on what else runs.
"""

from __future__ import annotations

import json
import resource
import subprocess
import tempfile
import time

import numpy as np

from .process import ROOT, Skipped

_GEOGRAM = ROOT / "build" / "booleans_environment" / "geogram_arrangement"
_FAULTS = "shared/data/california_faults"  # beside the project, or farther up, of those who have it


def make_sphere(
    rings: int, middle: tuple[float, float, float], radius: float
) -> tuple[np.ndarray, np.ndarray]:
    """A sphere of 4 rings (rings - 1) triangles, which have all shapes."""
    around = 2 * rings
    latitude = np.repeat(np.pi * (np.arange(1, rings) / rings - 0.5), around)
    longitude = np.tile(2 * np.pi * np.arange(around) / around, rings - 1)
    ring = np.column_stack(
        [np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)]
    )
    vertices = np.vstack([[0, 0, -1], ring, [0, 0, 1]]) * radius + middle
    here = 1 + np.arange(rings - 1)[:, None] * around + np.arange(around)
    right = np.roll(here, -1, axis=1)
    south = np.column_stack([np.zeros(around, int), right[0], here[0]])
    north = np.column_stack([np.full(around, len(vertices) - 1), here[-1], right[-1]])
    low, low_right, high, high_right = here[:-1], right[:-1], here[1:], right[1:]
    between = np.stack([low, low_right, high, low_right, high_right, high], axis=-1).reshape(-1, 3)
    return vertices, np.vstack([south, between, north]).astype(np.int32)


def _spheres(rings: int):
    return make_sphere(rings, (0, 0, 0), 1.0), make_sphere(rings, (0.31, 0.22, 0.13), 0.93)


def _faults() -> tuple[np.ndarray, np.ndarray]:
    from realmodel.core.readers import read_mesh

    folders = (folder / _FAULTS for folder in ROOT.parents)
    files = next((sorted(folder.glob("*.ts")) for folder in folders if folder.is_dir()), [])
    if not files:
        raise Skipped(f"{_FAULTS} is not there")
    vertices, triangles, count = [], [], 0
    for file in files:
        mesh = read_mesh(file)
        vertices.append(mesh.vertices)
        triangles.append(mesh.triangles + count)
        count += len(mesh.vertices)
    return np.vstack(vertices), np.vstack(triangles).astype(np.int32)


def _timed(work) -> dict:
    def processor() -> float:
        used = resource.getrusage(resource.RUSAGE_SELF)
        return used.ru_utime + used.ru_stime

    began, before = time.perf_counter(), processor()
    triangles = work()
    return {
        "seconds": time.perf_counter() - began,
        "processor": processor() - before,
        "triangles": int(triangles),
    }


def ours_spheres(rings: int) -> dict:
    from realmodel.core import intersect

    a, b = _spheres(rings)
    return _timed(lambda: len(intersect(a, b).union()[1]))


def manifold_spheres(rings: int) -> dict:
    try:
        import manifold3d
    except ImportError as missing:
        raise Skipped("manifold3d is not installed") from missing
    pair = _spheres(rings)

    def solid(mesh):
        vertices, triangles = mesh
        return manifold3d.Manifold(
            manifold3d.Mesh64(vert_properties=vertices, tri_verts=triangles.astype(np.uint64))
        )

    return _timed(lambda: len((solid(pair[0]) + solid(pair[1])).to_mesh64().tri_verts))


def ours_faults() -> dict:
    from realmodel.core import intersect

    vertices, triangles = _faults()
    far = np.array([[9e5, 9e6, 9e4], [9e5 + 1, 9e6, 9e4], [9e5, 9e6 + 1, 9e4]])
    one = np.array([[0, 1, 2]], np.int32)
    return _timed(lambda: len(intersect((vertices, triangles), (far, one)).triangles) - 1)


def trueform_faults() -> dict:
    try:
        import trueform
    except ImportError as missing:
        raise Skipped("trueform is not installed") from missing
    vertices, triangles = _faults()
    return _timed(lambda: len(trueform.polygon_arrangements(trueform.Mesh(triangles, vertices))[0][0]))


def geogram_faults() -> dict:
    if not _GEOGRAM.is_file():
        raise Skipped("geogram_arrangement was not built")
    vertices, triangles = _faults()
    with tempfile.NamedTemporaryFile(suffix=".mesh") as file:
        np.array([len(vertices), len(triangles)], np.int64).tofile(file)
        np.ascontiguousarray(vertices, np.float64).tofile(file)
        np.ascontiguousarray(triangles, np.int32).tofile(file)
        file.flush()
        told = subprocess.run([_GEOGRAM, file.name], check=True, capture_output=True, text=True)
    return json.loads(told.stdout)
