# SPDX-License-Identifier: GPL-3.0-or-later
"""An ensemble in a folder: batches of realizations by workers, resumed where a run ended, and the result."""

from __future__ import annotations

import hashlib
import os
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ..core import OutputFailed, UsageError, build
from ..core.base.atomic import Outputs
from ..core.base.work import Cancel, Progress, progress_bar, report_nothing
from ..core.ensembles import Ensemble, Realizer
from ..core.ensembles.ensemble import Places, Sums, added, batches, check_request, places_of, sums_of
from ..core.ensembles.files import write_ensemble
from ..core.project.project import Project
from .workers import require_this_version, workers_of

_BATCHES = "batches"
_BUILT = 0.05  # of the time: the model that all realizations start from


def ensemble(
    project: Project,
    realizations: int,
    folder: str | Path,
    seed: int = 0,
    client: Any = None,
    *,
    correlation: float = 0.0,
    places: Places | None = None,
    also: Callable[[Ensemble, Outputs], None] | None = None,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Ensemble:
    """As core.ensembles.ensemble, by workers of Dask, with the result in a folder: `ensemble.json`,
    `volumes.csv` and `ensemble.npz` (docs/reference/output_files.md).

    client: of distributed; None: a LocalCluster with a process for each processor. Starting an interrupted
    run again with the same project, seed, correlation and places continues it; the number of realizations may
    be larger. The result is the same for any number of workers. also(found, outputs) writes more files, which
    appear with the others.

    Raises as core.ensembles.ensemble; UsageError where Dask is missing or the folder holds another ensemble;
    OutputFailed.
    """
    if progress is True:
        options: dict[str, Any] = {
            "correlation": correlation,
            "places": places,
            "also": also,
            "cancel": cancel,
        }
        with progress_bar() as bar:
            return ensemble(project, realizations, folder, seed, client, progress=bar, **options)
    check_request(realizations, seed, correlation)
    require_this_version(client)
    report = progress or report_nothing
    model = build(
        project,
        cells="blocks",
        progress=lambda share, text: report(_BUILT * share, text),
        cancel=cancel,
    )
    points = places_of(model, places)
    realizer = Realizer(model, seed, correlation)
    store = _Store(Path(folder), _digest(realizer, points))
    todo = [numbers for numbers in batches(realizations) if not store.has(numbers)]
    done = realizations - sum(map(len, todo))
    if todo:
        realizer.prepare()
        with workers_of(client) as workers:
            for numbers, sums in workers.in_any_order(_batch, (realizer, points), todo, cancel):
                store.put(numbers, sums)
                done += len(numbers)
                report(_BUILT + (1 - _BUILT) * done / realizations, f"{done} of {realizations} realizations")
    result = Ensemble.of(realizer, added(map(store.get, batches(realizations))), points)
    write_ensemble(result, folder, also)
    store.remove()
    return result


def _batch(shared: tuple[Realizer, np.ndarray], numbers: range) -> Sums:
    realizer, points = shared
    return added(sums_of(realizer, number, points, threads=1) for number in numbers)


def _digest(realizer: Realizer, points: np.ndarray) -> str:
    """Of all that the sums of a batch depend on."""
    digest = hashlib.sha256(repr((realizer.seed, realizer.correlation)).encode())
    model = realizer.model
    digest.update(np.ascontiguousarray(points))
    for array in (model.surface_vertices, model.surface_triangles, model.vertices, model.face_vertices):
        digest.update(np.ascontiguousarray(array))
    for entry in model.rock_inputs:
        for surface in entry.rock.surfaces:
            digest.update(
                repr(
                    (surface.name, surface.rule, surface.method, surface.options, surface.correlation)
                ).encode()
            )
            if surface.points is not None:
                digest.update(np.ascontiguousarray(surface.points))
    return digest.hexdigest()


class _Store:
    """The sums of batches in a folder, each file whole or not there."""

    def __init__(self, folder: Path, digest: str):
        self._folder = folder / _BATCHES
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            of = self._folder / "digest"
            if of.exists() and of.read_text() != digest:
                raise UsageError(
                    f"{folder}: it holds an unfinished ensemble of another project, seed, correlation or "
                    "places; choose another folder, or delete this one"
                )
            of.write_text(digest)
        except OSError as error:
            raise OutputFailed(f"{folder}: {error.strerror or error}") from error

    def _file(self, numbers: range) -> Path:
        return self._folder / f"{numbers.start:06d}-{numbers.stop:06d}.npz"

    def has(self, numbers: range) -> bool:
        return self._file(numbers).exists()

    def put(self, numbers: range, sums: Sums) -> None:
        arrays: dict[str, Any] = {"volumes": sums.volumes, "counts": sums.counts}  # savez has other keywords
        for name, values in (("heights", sums.heights), ("squares", sums.squares)):
            arrays |= {f"{name}_{k}": array for k, array in enumerate(values) if array is not None}
        file = self._file(numbers)
        part = file.with_suffix(".part")
        try:
            with part.open("wb") as out:
                np.savez(out, surfaces=len(sums.heights), **arrays)
                out.flush()
                os.fsync(out.fileno())
            part.replace(file)
        except OSError as error:
            part.unlink(missing_ok=True)
            raise OutputFailed(f"{file}: {error.strerror or error}") from error

    def get(self, numbers: range) -> Sums:
        file = self._file(numbers)
        try:
            with np.load(file) as arrays:
                surfaces = range(int(arrays["surfaces"]))
                heights, squares = (
                    [arrays[f"{name}_{k}"] if f"{name}_{k}" in arrays else None for k in surfaces]
                    for name in ("heights", "squares")
                )
                return Sums(arrays["volumes"], heights, squares, arrays["counts"])
        except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
            raise OutputFailed(f"{file}: it cannot be read; delete it and start again") from error

    def remove(self) -> None:
        shutil.rmtree(self._folder, ignore_errors=True)
