# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements of models in tiles and of the same undivided, from mesh files to files, each in a process of
its own (process.alone).

Processors' seconds are those of all processes; they depend less on what else runs.
"""

from __future__ import annotations

import resource
import threading
import time
from contextlib import suppress
from pathlib import Path

import numpy as np

from .made_stacks import StackSpec
from .process import peak_resident

_DEPTH = -1.0  # of the base
_VALIDATED = 4000  # positions, as a model in tiles has them
_SEEN = 0.2  # seconds between looks for files that are done


def write_project(spec: dict, folder: str) -> dict:
    """A project of a stack with a PLY for each surface; one of them is in memory at a time."""
    made = StackSpec(**spec)
    lines = ["format = 1", 'name = "Stack"', "", "[[rock]]", 'name = "rock"', f"base_elevation = {_DEPTH}"]
    for number, (vertices, triangles) in enumerate(made.each()):
        _write_ply(Path(folder) / f"S{number}.ply", vertices, triangles)
        lines += ["", "[[rock.surface]]", f'name = "S{number}"', f'mesh = "S{number}.ply"']
    project = Path(folder) / "project.toml"
    project.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return {"project": str(project)}


def _write_ply(file: Path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    head += [f"property double {axis}" for axis in "xyz"]
    head += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header", ""]
    faces = np.empty(len(triangles), [("corners", "u1"), ("vertices", "<i4", 3)])
    faces["corners"], faces["vertices"] = 3, triangles
    with file.open("wb") as out:
        out.write("\n".join(head).encode())
        out.write(vertices.astype("<f8", copy=False))
        out.write(faces)


def undivided(project: str, folder: str, threads: int) -> dict:
    """The model as a whole: read, built, validated, written."""
    began, before = time.perf_counter(), time.process_time()
    from realmodel.core import build, load_project

    model = build(load_project(project), threads=threads)
    if not model.validate(_VALIDATED, threads=threads).passed:
        raise ValueError("the model is wrong")
    for ending in ("npz", "vtu"):
        model.save(Path(folder) / f"model.{ending}")
    return {
        "seconds": time.perf_counter() - began,
        "processor": time.process_time() - before,
        "cells": len(model.cell_block),
    }


def in_tiles(project: str, folder: str, size: float, workers: int, keeps_vtu: bool) -> dict:
    """The model in tiles. keeps_vtu: else each .vtu is deleted once it is written, to spare the disk."""
    began, before = time.perf_counter(), time.process_time()
    from realmodel.core import load_project
    from realmodel.distributed import build

    watch = _Watch(None if keeps_vtu else Path(folder) / "tiles")
    with watch:
        tiled = build(load_project(project), folder, (size, size), workers=workers)
    if tiled.unequal:
        raise ValueError(f"{tiled.unequal} places on borders differ")
    lead, ended = time.process_time() - before, resource.getrusage(resource.RUSAGE_CHILDREN)
    return {
        "seconds": time.perf_counter() - began,
        "processor": lead + ended.ru_utime + ended.ru_stime,
        "lead": lead,
        "worker": max(watch.peaks.values()),
        "all": peak_resident() + sum(watch.peaks.values()),
        "cells": sum(tile.cells for tile in tiled.tiles),
        "tiles": len(tiled.tiles),
    }


class _Watch:
    """While it lasts: peaks, of each process that this one started the memory at most; and deletes each .vtu
    in a folder, where there is one."""

    def __init__(self, folder: Path | None):
        self._folder = folder
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)
        self.peaks: dict[int, int] = {}

    def __enter__(self) -> None:
        self._thread.start()

    def __exit__(self, *_) -> None:
        self._ended.set()
        self._thread.join()

    def _look(self) -> None:
        while not self._ended.wait(_SEEN):
            for children in Path("/proc/self/task").glob("*/children"):
                for process in map(int, children.read_text(encoding="ascii").split()):
                    with suppress(OSError):  # it has ended
                        self.peaks[process] = peak_resident(process)
            for file in self._folder.glob("*.vtu") if self._folder else ():
                file.unlink()
