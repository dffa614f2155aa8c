# SPDX-License-Identifier: GPL-3.0-or-later
"""A model built tile by tile into a folder (docs/dev/tiles.md): resumed where a run ended."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from ..core import BuildFailed, BuildWarning
from ..core.base.atomic import Outputs
from ..core.base.errors import place_text
from ..core.base.mapped_arrays import read_mapped, write_mapped
from ..core.base.work import Cancel, Progress, Reporter, progress_bar, report_nothing, run
from ..core.project.project import Project
from ..core.project.project_checks import check_cells, check_project
from ..core.results.layer_values import rock_fields
from ..core.tiles import TiledModel
from ..core.tiles.borders import (
    OPPOSITE,
    BorderEdges,
    Interfaces,
    Patches,
    interfaces_on,
    matched,
    patches_on,
    positions_on,
    sides_of,
    with_vertices_of,
)
from ..core.tiles.catalog import CATALOG, Catalog
from ..core.tiles.grid import checked_size
from ..core.tiles.settling import BorderVertices, settled
from ..core.tiles.tile_fields import FIELDS, write_rock_fields
from ..core.tiles.tile_model import (
    Frame,
    Name,
    build_tile,
    model_of,
    read_arrays,
    tile_arrays,
)
from .faulted_folder import build_windows
from .packing import packed
from .run_folder import (
    Parts,
    Shared,
    Store,
    blocks_of,
    entry_of,
    finish,
    finished,
    mapped_arrays,
    places_of,
    require_own,
    write_tile,
)
from .tile_inputs import digest_of, frame_of, prepared
from .workers import Workers, no_workers, require_this_version, workers_of

_PREPARED, _JOINED = 0.25, 0.97  # of the time
_BUILT = 0.6  # of the time of a tile


def build(
    project: Project,
    folder: str | Path,
    tile_size: tuple[float, float],
    client: Any = None,
    *,
    workers: int | None = None,
    cells: str = "columns",
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> TiledModel:
    """Builds a model in tiles on workers of Dask, and leaves it in a folder that core.open_tiles opens.

    tile_size: width and height in plan, model units; a line between tiles may shift by a sixteenth of this.
    client: of distributed; None: a LocalCluster of so many `workers`, None: one for each processor. All
    workers have to see the folder under the same path. cells: as of core.build. A run that was stopped goes
    on where it was when it is started again with the same arguments; a folder that is finished is opened.

    Each tile is validated, and its borders compared with its neighbors', before the result is there. Raises
    as core.build; UsageError where Dask is missing, or the folder holds another model; OutputFailed.
    """
    if progress is True:
        with progress_bar() as bar:
            return build(
                project, folder, tile_size, client, workers=workers, cells=cells, progress=bar, cancel=cancel
            )
    check_cells(cells)
    size = checked_size(tile_size)
    folder = Path(folder)
    report = progress or report_nothing
    require_own(folder)
    is_finished = (folder / CATALOG).exists()
    if not is_finished:
        require_this_version(client)
    project = check_project(project)
    with (
        no_workers() if is_finished else workers_of(client, workers) as done_by,
        mapped_arrays(folder) as arrays,
    ):
        windows, warnings = run(
            lambda work: prepared(work, project, arrays, done_by),
            lambda share, text: report(_PREPARED * share, text),
            cancel,
        )
        frame = frame_of(project, windows, size, cells)
        digest = digest_of(frame, windows)
        if is_finished:
            return finished(folder, digest)
        store = Store(folder, digest)
        if any(entry.fields for entry in windows.inputs):
            write_rock_fields(rock_fields(windows.inputs), folder / FIELDS)
        names = [name for name in frame.grid if windows.meets(frame.grid.box(*name))]
        is_cut = not windows.structures.is_divided
        shared = Shared(store, frame, arrays.folder, packed(windows.for_workers(), arrays), frozenset(names))
        del windows

        def reported(share: float, text: str) -> None:
            report(_PREPARED + (_JOINED - _PREPARED) * share, text)

        build_all = _build_all if is_cut else build_windows
        catalog = build_all(shared, names, digest, warnings, done_by, reported, cancel)
    return finish(store, catalog)


def _build_all(
    shared: Shared,
    names: list[Name],
    digest: str,
    warnings: list[BuildWarning],
    workers: Workers,
    report: Reporter,
    cancel: Cancel | None,
) -> Catalog:
    """Builds all tiles, and joins each as soon as those around it are built. Returns the table of the
    whole."""
    store, everywhere = shared.store, shared.names
    built = {name for name in names if store.has("built", name)}
    joined = {name for name in names if store.has("joined", name)}

    def following(task: tuple[str, Name]) -> list[tuple[str, Name]]:
        kind, name = task
        if kind == "joined":
            return []
        near = _around(name, everywhere)
        return [("joined", other) for other in near if built.issuperset(_around(other, everywhere))]

    tasks = [("built", name) for name in names if name not in built]
    tasks += [
        ("joined", name)
        for name in names
        if name not in joined and built.issuperset(_around(name, everywhere))
    ]
    for (kind, name), _ in workers.in_any_order(_step, shared, tasks, cancel, following=following):
        (built if kind == "built" else joined).add(name)
        done = (_BUILT * len(built) + (1 - _BUILT) * len(joined)) / len(names)
        report(done, f"{len(built)} of {len(names)} tiles built, {len(joined)} joined")
    return _catalog(shared, names, digest, warnings)


def _step(shared: Shared, task: tuple[str, Name]) -> None:
    """On a worker. Dask repeats a task whose worker is lost, also if it was done."""
    kind, name = task
    if not shared.store.has(kind, name):
        (_build if kind == "built" else _join)(shared, name)


def _neighbors(frame: Frame, name: Name, names: Iterable[Name]) -> list[tuple]:
    """The sides of a tile that it shares: (side, the other tile)."""
    shared = []
    for side in sides_of(frame.grid.box(*name)):
        other = (name[0] + side.step[0], name[1] + side.step[1])
        if other in names:
            shared.append((side, other))
    return shared


def _around(name: Name, names: frozenset) -> list[Name]:
    """A tile, then those that share its sides or corners."""
    near = ((name[0] + column, name[1] + row) for column in (-1, 0, 1) for row in (-1, 0, 1))
    return [name, *(other for other in near if other in names and other != name)]


def _build(shared: Shared, name: Name) -> None:
    """On a worker: builds a tile, and writes what its neighbors have to know of it."""
    store, frame, names = shared.store, shared.frame, shared.names
    box = frame.grid.box(*name)
    inputs = run(lambda work: shared.window(work, name), threads=1).inputs
    built = run(lambda work: build_tile(work, frame, inputs, box), threads=1)
    model, sides = built.model, built.borders
    numbers = sides["numbers"]
    edges = BorderEdges.of(model, numbers)
    sides["faces"] = np.unique(edges.face)
    for side, _ in _neighbors(frame, name, names):
        interfaces = interfaces_on(model, edges.on(model, side))
        ends = np.searchsorted(numbers, interfaces.ends)
        sides |= {f"{side.name}_on": interfaces.on, f"{side.name}_ends": ends}
    with Outputs() as outputs, outputs.file(store.file("built", name)) as file:
        write_mapped(tile_arrays(model), file)
    store.write(store.file("sides", name), sides)
    store.done("built", name, warnings=[asdict(warning) for warning in model.warnings])


def _join(shared: Shared, name: Name) -> None:
    """On a worker: gives a tile its neighbors' vertices, validates it, and writes it."""
    store, frame, names = shared.store, shared.frame, shared.names
    model = model_of(frame.project, read_mapped(store.file("built", name)))
    around, box = _around(name, names), frame.grid.box(*name)
    sides = {other: read_arrays(store.file("sides", other)) for other in around}
    faces = sides[name]["faces"]
    borders = {other: BorderVertices.of_arrays(arrays, box) for other, arrays in sides.items()}
    places = dict(zip(around, settled(box, borders.values()), strict=True))
    model.vertices[borders[name].numbers] = places[name]
    neighbors = []
    for side, other in _neighbors(frame, name, names):
        keys = (f"{OPPOSITE[side.name]}_{key}" for key in ("on", "ends"))
        neighbors.append((side, Interfaces(*(sides[other][key] for key in keys)), places[other]))
    numbers, count = borders[name].numbers, len(model.vertices)
    model = with_vertices_of(model, BorderEdges.of(model, numbers, faces), neighbors)
    numbers = np.concatenate([numbers, np.arange(count, len(model.vertices), dtype=numbers.dtype)])
    report = model.validate(places_of(frame, box), threads=1)
    if not report.passed:
        raise BuildFailed(f"tile {name[0]}, {name[1]} is wrong: {report.failure()}")
    patches: dict[str, np.ndarray] = {}
    border = BorderEdges.of(model, numbers, faces)
    for side, theirs, their_places in neighbors:
        edges = border.on(model, side)
        side_patches = patches_on(model, side, edges, positions_on(model, side, edges, theirs, their_places))
        part = model.cell_component[side_patches.cell]
        patches |= {
            f"{side.name}_shape": side_patches.shape,
            f"{side.name}_block": side_patches.block,
            f"{side.name}_part": part,
            f"{side.name}_open": np.array(side_patches.open),
        }
    parts = np.flatnonzero(model.cell_component == np.arange(len(model.cell_block)))  # their first cells
    patches |= {"parts": parts, "block_of_part": model.cell_block[parts]}
    store.write(store.file("patches", name), patches)
    write_tile(store, name, model)
    del model  # what is mapped
    with suppress(OSError):  # on Windows as long as anything maps it; the folder goes at the end
        store.file("built", name).unlink()


def _patches(arrays: dict, side: str) -> Patches:
    shape, block, part = (arrays[f"{side}_{key}"] for key in ("shape", "block", "part"))
    return Patches(shape, block, part, int(arrays[f"{side}_open"]))


def _catalog(shared: Shared, names: list[Name], digest: str, warnings: list[BuildWarning]) -> Catalog:
    """The table of the whole. warnings: about all of it."""
    store, frame = shared.store, shared.frame
    parts, compared, unequal, warnings = Parts(), 0, 0, list(warnings)
    for name in names:
        arrays = read_arrays(store.file("patches", name))
        for part, block in zip(arrays["parts"].tolist(), arrays["block_of_part"].tolist(), strict=True):
            parts.add((*name, part), block)
    for name in names:
        ours = read_arrays(store.file("patches", name))
        for side, other in _neighbors(frame, name, names):
            if side.name not in ("east", "north"):
                continue
            theirs = read_arrays(store.file("patches", other))
            match = matched(_patches(ours, side.name), _patches(theirs, OPPOSITE[side.name]), side)
            if match.unequal:
                near = "" if match.place is None else f" near {place_text(match.place)}"
                text = (
                    f"tiles {name} and {other} differ at {match.unequal} places on their border"
                    f"{near}; the parts of blocks were joined by their areas there"
                )
                warnings.append(BuildWarning(text, "borders"))
            compared += match.patches
            unequal += match.unequal
            for one, another in match.cells.tolist():
                parts.join((*name, one), (*other, another))
    records = [store.read_record("joined", name) for name in names]
    return Catalog(
        frame.project,
        frame.cell_kind,
        digest,
        frame.grid,
        blocks_of(frame, records, parts, parts),
        [entry_of(name, record) for name, record in zip(names, records, strict=True)],
        compared,
        unequal,
        [*warnings, *_warnings(store, names)],
    )


def _warnings(store: Store, names: list[Name]) -> list[BuildWarning]:
    """Those of all tiles; what they say of triangles as one."""
    items: dict[tuple, set] = {}
    for name in names:
        for warning in store.read_record("built", name)["warnings"]:
            key: tuple = (warning["kind"], warning["rock"], warning["surface"])
            if warning["kind"] != "no_area":
                key = (*key, warning["text"])
            items.setdefault(key, set()).update(warning["items"])
    warnings = []
    for (kind, rock, surface, *text), numbers in items.items():
        if kind == "no_area":
            what = "triangle" if len(numbers) == 1 else "triangles"
            text = [f"{len(numbers)} {what} without area left out"]
        warnings.append(BuildWarning(text[0], kind, rock, surface, tuple(sorted(numbers))))
    return warnings
