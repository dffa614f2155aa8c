# SPDX-License-Identifier: GPL-3.0-or-later
"""A model with faults, bodies or series of fields built tile by tile into a folder (docs/dev/tiles.md)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict

import numpy as np

from ..core import BuildFailed, BuildWarning
from ..core.base.errors import place_text
from ..core.base.work import Cancel, Reporter, run
from ..core.tiles.catalog import Catalog
from ..core.tiles.faulted_tile import build_faulted_tile
from ..core.tiles.owned_cells import Seam
from ..core.tiles.tile_model import Name, read_arrays
from .run_folder import Parts, Shared, Store, blocks_of, entry_of, places_of, stem, write_tile
from .workers import Workers

_ROUNDS = 4  # in which tiles are built again from more around them, at last from everything


def build_windows(
    shared: Shared,
    names: list[Name],
    digest: str,
    warnings: list[BuildWarning],
    workers: Workers,
    report: Reporter,
    cancel: Cancel | None,
) -> Catalog:
    """Builds all tiles of a project with faults, bodies or fields. Returns the table of the whole."""
    store = shared.store
    waiting: list[tuple[Name, int | None]]
    waiting = [(name, 0) for name in names if not store.has("joined", name)]
    for times in range(_ROUNDS + 1):
        done = len(names) - len(waiting)
        for _ in workers.in_any_order(_build, shared, waiting, cancel):
            done += 1
            report(done / len(names), f"{done} of {len(names)} tiles built")
        asked = _farther(store, names)
        if not asked:
            break
        if times == _ROUNDS:
            raise BuildFailed(next(iter(asked.values())))
        farther = None if times == _ROUNDS - 1 else 2 ** (times + 1) - 1
        waiting = [(name, farther) for name in asked]
        for name in asked:
            store.record("joined", name).unlink()
    return _catalog(shared, names, digest, warnings)


def _build(shared: Shared, task: tuple[Name, int | None]) -> None:
    """On a worker: builds a tile, validates it, and writes it with the data for its neighbors. Dask
    repeats a task whose worker is lost, also if it was done."""
    store, frame, (name, farther) = shared.store, shared.frame, task
    if store.has("joined", name):
        return
    window = run(lambda work: shared.window(work, name, farther), threads=1)
    built = run(lambda work: build_faulted_tile(work, frame, window, name), threads=1)
    report = built.around.validate(places_of(frame, frame.grid.box(*name)), threads=1)
    if not report.passed:
        raise BuildFailed(f"tile {name[0]}, {name[1]} is wrong: {report.failure()}")
    model = built.model
    arrays: dict[str, np.ndarray] = {"others": np.array(sorted(built.seams), np.int64).reshape(-1, 2)}
    for key, part in (("parts", model.cell_component), ("cells", built.part)):
        roots = np.flatnonzero(part == np.arange(len(part)))
        arrays |= {key: roots, f"block_of_{key}": model.cell_block[roots]}
    for other, seam in built.seams.items():
        arrays |= seam.arrays(stem(other))
    store.write(store.file("patches", name), arrays)
    safe, reach = window.safe, built.reach
    is_within = reach is None or (
        reach[0] >= safe[0] and reach[1] >= safe[1] and reach[2] <= safe[2] and reach[3] <= safe[3]
    )
    warnings = [asdict(warning) for warning in built.around.warnings]
    write_tile(store, name, model, warnings=warnings, is_within=is_within)


def _farther(store: Store, names: list[Name]) -> dict[Name, str]:
    """The tiles that need larger windows, with the reason."""
    asked = {
        name: f"cells of tile {name[0]}, {name[1]} extend too far beyond it; use larger tiles"
        for name in names
        if not store.read_record("joined", name)["is_within"]
    }
    for one, other, ours, theirs in _seams(store, names):
        if not ours.matches(theirs):
            place = place_text(ours.first_difference(theirs))
            text = f"tiles {one} and {other} differ on their border near {place}; make tiles larger"
            asked |= {one: text, other: text}
    return asked


def _seams(store: Store, names: list[Name]) -> Iterator[tuple[Name, Name, Seam, Seam]]:
    """All pairs of tiles that have faces in common, and what each has of them."""
    pairs = set()
    for name in names:
        for other in read_arrays(store.file("patches", name))["others"].tolist():
            pairs.add(tuple(sorted([name, tuple(other)])))
    read: dict[Name, dict] = {}
    for one, other in sorted(pairs):
        read = {name: read.get(name) or _read(store, name, names) for name in (one, other)}
        ours, theirs = (Seam.of_arrays(read[a], stem(b)) for a, b in ((one, other), (other, one)))
        yield one, other, ours, theirs


def _read(store: Store, name: Name, names: list[Name]) -> dict[str, np.ndarray]:
    return read_arrays(store.file("patches", name)) if name in names else {"others": np.empty((0, 2))}


def _catalog(shared: Shared, names: list[Name], digest: str, warnings: list[BuildWarning]) -> Catalog:
    store, frame = shared.store, shared.frame
    parts, cells, faces = Parts(), Parts(), 0
    kinds = [("parts", parts)] if frame.cell_kind == "columns" else [("parts", parts), ("cells", cells)]
    for name in names:
        arrays = read_arrays(store.file("patches", name))
        for key, into in kinds:
            blocks = arrays[f"block_of_{key}"].tolist()
            for root, block in zip(arrays[key].tolist(), blocks, strict=True):
                into.add((*name, root), block)
    for one, other, ours, theirs in _seams(store, names):
        faces += len(ours.key)
        same = ours.block[:, 0] == ours.block[:, 1]
        for column, (key, into) in enumerate(kinds):
            which = same if key == "parts" else same & ours.is_one
            both = np.column_stack([ours.part[which, column], theirs.part[which, column]])
            for a, b in np.unique(both, axis=0).tolist():
                into.join((*one, a), (*other, b))
    records = [store.read_record("joined", name) for name in names]
    distinct = dict.fromkeys(warnings)
    for record in records:
        for warning in record["warnings"]:
            distinct[BuildWarning(**{**warning, "items": tuple(warning["items"])})] = None
    return Catalog(
        frame.project,
        frame.cell_kind,
        digest,
        frame.grid,
        blocks_of(frame, records, parts, cells),
        [entry_of(name, record) for name, record in zip(names, records, strict=True)],
        faces,
        0,
        list(distinct),
    )
