# SPDX-License-Identifier: GPL-3.0-or-later
"""Writing the cells of a model beside writing as many bytes that lie ready, and loading a model (for
process.alone)."""

from __future__ import annotations

import os
import shutil
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np

from .made_stacks import StackSpec
from .process import ROOT, peak_resident, resident


def write_in_turns(spec: dict, endings: list[str], rounds: int, threads: int) -> dict:
    """Of each ending the bytes, the processors' seconds of a file, and medians of seconds: of a file and of
    the same bytes at once, both first without fsync and then with it."""
    from realmodel.core import Project, Rock, Surface, build
    from realmodel.core.base.atomic import os as os_of_outputs

    surfaces = [Surface(f"S{k}", *surface) for k, surface in enumerate(StackSpec(**spec).make())]
    model = build(Project("stack", [Rock("rock", surfaces)]), threads=threads)
    found: dict = {"cells": len(model.cell_block)}
    fsync = os_of_outputs.fsync
    with tempfile.TemporaryDirectory(dir=on_disk()) as folder:
        for ending in endings:
            path, plain = Path(folder, f"m{ending}"), Path(folder, "plain")
            rows = []
            for is_synced in (False, True):
                os_of_outputs.fsync = fsync if is_synced else lambda _: None
                try:
                    for _ in range(rounds):
                        rows.append((is_synced, *_one_round(model, path, plain, is_synced)))
                finally:
                    os_of_outputs.fsync = fsync
            found[ending] = {
                "bytes": rows[0][1],
                "processor": statistics.median(row[2] for row in rows),
                **{
                    name: [statistics.median(row[at] for row in rows if row[0] == is_synced) for at in (3, 4)]
                    for name, is_synced in (("cached", False), ("synced", True))
                },
            }
    return found


def build_and_save(spec: dict, path: str, threads: int) -> dict:
    """Cells, seconds of building a model from arrays and of saving it, and the bytes of its file."""
    from realmodel.core import Project, Rock, Surface, build

    surfaces = [Surface(f"S{k}", *surface) for k, surface in enumerate(StackSpec(**spec).make())]
    began = time.perf_counter()
    model = build(Project("stack", [Rock("rock", surfaces)]), threads=threads)
    built = time.perf_counter()
    model.save(path)
    saved = time.perf_counter()
    size = Path(path).stat().st_size
    return {"cells": len(model.cell_block), "built": built - began, "saved": saved - built, "bytes": size}


def load(path: str) -> dict:
    """Seconds of loading a model, and the bytes that it took at most."""
    from realmodel.core import Model

    before, began = resident(), time.perf_counter()
    Model.load(path)
    seconds = time.perf_counter() - began
    return {"loaded": seconds, "taken": peak_resident() - before}


def _one_round(model, path: Path, plain: Path, is_synced: bool) -> tuple[int, float, float, float]:
    """Bytes, the processors' seconds, and seconds of ours and of the same bytes; both are removed again."""
    began, before = time.perf_counter(), time.process_time()
    model.save(path)
    ours, processor = time.perf_counter() - began, time.process_time() - before
    size = sum(file.stat().st_size for file in (path, *path.rglob("*")) if file.is_file())
    shutil.rmtree(path) if path.is_dir() else path.unlink()
    ready = np.ones(size, np.uint8)
    began = time.perf_counter()
    with plain.open("wb", buffering=0) as file:
        file.write(ready)
        if is_synced:
            os.fsync(file.fileno())
    theirs = time.perf_counter() - began
    plain.unlink()
    return size, processor, ours, theirs


def on_disk() -> Path:
    """A folder on the project's disk: /tmp may lie in memory."""
    folder = ROOT / "build"
    folder.mkdir(exist_ok=True)
    return folder
