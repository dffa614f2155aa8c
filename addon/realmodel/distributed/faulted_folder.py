# SPDX-License-Identifier: GPL-3.0-or-later
"""A model with faults, bodies or series of fields built tile by tile into a folder (docs/dev/tiles.md)."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..core import BuildFailed, BuildWarning, Project
from ..core.base.atomic import Outputs
from ..core.base.errors import place_text
from ..core.base.mapped_arrays import MappedArrays
from ..core.base.work import Cancel, Reporter, Work, native_module, run
from ..core.cells.assembly import list_blocks
from ..core.cells.cell_complex import CellComplex
from ..core.results.model_fields import rock_fields
from ..core.structures.parts.parts import box_around, divide
from ..core.structures.setup import make_surfaces, mesh_inputs, read_inputs
from ..core.tiles import TiledModel
from ..core.tiles.catalog import CATALOG, Catalog
from ..core.tiles.faulted_tile import Whole, build_faulted_tile
from ..core.tiles.faulted_windows import Window, Windows
from ..core.tiles.owned_cells import Seam
from ..core.tiles.tile_fields import FIELDS, write_rock_fields
from ..core.tiles.tile_model import Frame, Name, read_arrays, without_shapes
from .run_folder import (
    Parts,
    Store,
    blocks_of,
    entry_of,
    finish,
    finished,
    mapped_arrays,
    places_of,
    stem,
    write_tile,
)
from .stored_objects import read_object, write_object
from .tile_inputs import SurfaceReader
from .workers import Workers

_PREPARED, _BUILT = 0.4, 0.97  # of the time
_READ, _MESHED = 0.2, 0.3  # of that until windows are prepared
_ROUNDS = 4  # in which tiles are built again from more around them, at last from everything
_WINDOW = "window"


def build_faulted(
    project: Project,
    folder: Path,
    size: tuple[float, float],
    cells: str,
    workers: Workers,
    report: Reporter,
    cancel: Cancel | None,
) -> TiledModel:
    """tile_folder.build for a project with faults, bodies or fields. size: of tiles."""
    with mapped_arrays(folder) as arrays:
        built = _built(project, folder, size, cells, arrays, workers, report, cancel)
    return built if isinstance(built, TiledModel) else finish(*built)


def _built(
    project: Project,
    folder: Path,
    size: tuple[float, float],
    cells: str,
    arrays: MappedArrays,
    workers: Workers,
    report: Reporter,
    cancel: Cancel | None,
) -> TiledModel | tuple[Store, Catalog]:
    """The files of the run and the table of the whole; or the model, where the folder is finished. arrays:
    where surfaces and their sheets are kept."""
    reader = SurfaceReader(arrays, workers)

    def prepared(work: Work) -> tuple:
        with work.phase(0.0, _READ, "reading"):
            inputs, with_arrays = read_inputs(work, project, reader)
        with work.part(_READ, _MESHED):
            mesh_inputs(work, inputs, arrays.keep)
        with work.part(_MESHED, 1.0):
            structures = make_surfaces(work, with_arrays, inputs, None, arrays.keep, joins=False)
        if not structures.is_divided:  # fields alone
            structures = divide(work, structures, box_around(inputs, structures, has_sheets=True))
        warnings = [warning for entry in inputs for warning in entry.warnings]
        return Windows(work, inputs, structures, arrays.keep), structures, warnings

    windows, structures, warnings = run(prepared, lambda share, text: report(_PREPARED * share, text), cancel)
    inputs = windows.inputs
    frame = Frame(without_shapes(project, inputs), cells, windows.divide(size), ())
    digest = _digest(frame, windows)
    if (folder / CATALOG).exists():
        return finished(folder, digest)
    store = Store(folder, digest)
    if any(entry.fields for entry in inputs):
        write_rock_fields(rock_fields(inputs), folder / FIELDS)
    names = [surface.name for entry in inputs for surface in entry.rock.surfaces]
    whole = Whole(
        list_blocks(inputs, np.zeros(len(names) + len(structures)), CellComplex.empty(cells), structures),
        replace(
            structures,
            faults=[replace(each, vertices=None, triangles=None, points=None) for each in structures.faults],
            bodies=[replace(each, vertices=None, triangles=None) for each in structures.bodies],
        ),
        [*names, *structures.names],
        np.array([0] * len(names) + structures.kinds, np.int32),
    )
    listed = store.listed(frame.grid, lambda: _write_windows(windows, frame, store, cancel))
    waiting = [name for name in listed if not store.has("joined", name)]
    for times in range(_ROUNDS + 1):
        _build_tiles((store, frame, whole), waiting, len(listed), workers, report, cancel)
        asked = _farther(store, listed)
        if not asked:
            break
        if times == _ROUNDS:
            raise BuildFailed(next(iter(asked.values())))
        for name in asked:
            store.record("joined", name).unlink()
            farther = None if times == _ROUNDS - 1 else 2 ** (times + 1) - 1
            _write_window(windows, store, name, cancel, farther)
        waiting = list(asked)
    if windows.snapped is not None:
        warnings.append(BuildWarning(windows.snapped, "joined"))
    return store, _catalog(frame, store, listed, digest, warnings)


def _digest(frame: Frame, windows: Windows) -> str:
    """Of all that the result depends on."""
    lines = frame.grid.x.tolist(), frame.grid.y.tolist()
    digest = hashlib.sha256(repr((native_module().VERSION, frame.cell_kind, lines, frame.project)).encode())
    for entry in windows.inputs:
        digest.update(repr((entry.rock.base_elevation, [s.rule for s in entry.rock.surfaces])).encode())
    structures = windows.structures
    for fault in structures.faults:
        digest.update(repr((fault.name, fault.youngest, list(fault.ends_at), fault.dies_out)).encode())
    digest.update(
        repr((structures.displaced, structures.times, [b.void for b in structures.bodies])).encode()
    )
    for array in windows.arrays():
        digest.update(np.ascontiguousarray(array))
    return digest.hexdigest()


def _write_windows(windows: Windows, frame: Frame, store: Store, cancel: Cancel | None) -> list[Name]:
    names = [name for name in frame.grid if windows.meets(frame.grid.box(*name))]
    for name in names:
        _write_window(windows, store, name, cancel, 0)
    return names


def _write_window(
    windows: Windows, store: Store, name: Name, cancel: Cancel | None, farther: int | None
) -> None:
    window = run(lambda work: windows.window(work, name, farther), cancel=cancel)
    with Outputs() as outputs, outputs.file(store.parts(name) / _WINDOW) as file:
        write_object(window, file)


def _build_tiles(
    shared: Any,
    waiting: list[Name],
    count: int,
    workers: Workers,
    report: Reporter,
    cancel: Cancel | None,
) -> None:
    done = count - len(waiting)
    for _ in workers.in_any_order(_build, shared, waiting, cancel):
        done += 1
        report(_PREPARED + (_BUILT - _PREPARED) * done / count, f"{done} of {count} tiles built")


def _build(shared: tuple[Store, Frame, Whole], name: Name) -> None:
    """On a worker: builds a tile, proves it, and writes it, and what its neighbors have to have, too. Dask
    repeats a task whose worker is lost, also if it was done."""
    store, frame, whole = shared
    if store.has("joined", name):
        return
    window = _window(store.parts(name) / _WINDOW)
    box = frame.grid.box(*name)
    built = run(lambda work: build_faulted_tile(work, frame, whole, window, name), threads=1)
    report = built.around.validate(places_of(frame, box), threads=1)
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


def _window(path: Path) -> Window:
    window = read_object(path)
    if not isinstance(window, Window):
        raise BuildFailed(f"{path}: is not a window of a tile; delete it and start again")
    return window


def _farther(store: Store, names: list[Name]) -> dict[Name, str]:
    """The tiles that have to see more around them, with what is wrong as they are."""
    asked = {
        name: f"cells of tile {name[0]}, {name[1]} reach too far beyond it; make tiles larger"
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


def _catalog(
    frame: Frame, store: Store, names: list[Name], digest: str, warnings: list[BuildWarning]
) -> Catalog:
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
    found = dict.fromkeys(warnings)
    for record in records:
        for each in record["warnings"]:
            found[BuildWarning(**{**each, "items": tuple(each["items"])})] = None
    return Catalog(
        frame.project,
        frame.cell_kind,
        digest,
        frame.grid,
        blocks_of(frame, records, parts, cells),
        [entry_of(name, record) for name, record in zip(names, records, strict=True)],
        faces,
        0,
        list(found),
    )
