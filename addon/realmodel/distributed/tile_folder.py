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
from ..core.project.build_options import check_cells
from ..core.project.project import Project
from ..core.surfaces.local_heights import PartHeights
from ..core.surfaces.rock_input import RockInput
from ..core.surfaces.wrong_sides import WrongPoints
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
from ..core.tiles.tile_model import (
    Frame,
    Name,
    build_tile,
    model_of,
    read_arrays,
    tile_arrays,
)
from .faulted_folder import build_faulted
from .run_folder import (
    Parts,
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
from .tile_inputs import PreparedInputs, divided, prepared
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
    with no_workers() if is_finished else workers_of(client, workers) as done_by:
        if project.faults or project.bodies or any(rock.has_fields for rock in project.rocks):
            return build_faulted(project, folder, size, cells, done_by, report, cancel)
        with mapped_arrays(folder) as arrays:
            found = prepared(
                project,
                size,
                cells,
                arrays,
                done_by,
                lambda share, text: report(_PREPARED * share, text),
                cancel,
            )
            if is_finished:
                return finished(folder, found.digest)
            store = Store(folder, found.digest)
            names = store.listed(
                found.frame.grid, lambda: divided(found, arrays, done_by, store.parts, cancel)
            )
            found = found.let_go()
        _build_all(store, found.frame, names, done_by, report, cancel)
    return finish(store, _catalog(found, store, names))


def _build_all(
    store: Store,
    frame: Frame,
    names: list[Name],
    workers: Workers,
    report: Reporter,
    cancel: Cancel | None,
) -> None:
    """Builds all tiles, and joins each as soon as those around it are built."""
    everywhere = frozenset(names)
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
    shared = (store, frame, everywhere)
    for (kind, name), _ in workers.in_any_order(_step, shared, tasks, cancel, following=following):
        (built if kind == "built" else joined).add(name)
        done = (_BUILT * len(built) + (1 - _BUILT) * len(joined)) / len(names)
        text = f"{len(built)} of {len(names)} tiles built, {len(joined)} joined"
        report(_PREPARED + (_JOINED - _PREPARED) * done, text)


def _step(shared: tuple[Store, Frame, frozenset], task: tuple[str, Name]) -> None:
    """On a worker. Dask repeats a task whose worker is lost, also if it was done."""
    kind, name = task
    if not shared[0].has(kind, name):
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


def _build(shared: tuple[Store, Frame, frozenset], name: Name) -> None:
    """On a worker: builds a tile, and writes what its neighbors have to know of it."""
    store, frame, names = shared
    box = frame.grid.box(*name)
    built = run(lambda work: build_tile(work, frame, box, store.parts(name)), threads=1)
    model, sides = built.model, built.borders
    numbers = sides["numbers"]
    edges = BorderEdges.of(model, numbers)
    sides["faces"] = np.unique(edges.face)
    for side, _ in _neighbors(frame, name, names):
        found = interfaces_on(model, edges.on(model, side))
        ends = np.searchsorted(numbers, found.ends)
        sides |= {f"{side.name}_on": found.on, f"{side.name}_ends": ends}
    with Outputs() as outputs, outputs.file(store.file("built", name)) as file:
        write_mapped(tile_arrays(model), file)
    store.write(store.file("sides", name), sides)
    store.done(
        "built",
        name,
        warnings=[asdict(warning) for warning in model.warnings],
        below=[[*key, asdict(wrong)] for key, wrong in built.wrong.items()],
        above=[[*key, asdict(wrong)] for key, wrong in built.above.items()],
        heights=[[*key, asdict(of)] for key, of in built.heights.items()],
    )


def _join(shared: tuple[Store, Frame, frozenset], name: Name) -> None:
    """On a worker: gives a tile its neighbors' vertices, proves it, and writes it."""
    store, frame, names = shared
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
    numbers, own = borders[name].numbers, len(model.vertices)
    model = with_vertices_of(model, BorderEdges.of(model, numbers, faces), neighbors)
    numbers = np.concatenate([numbers, np.arange(own, len(model.vertices), dtype=numbers.dtype)])
    report = model.validate(places_of(frame, box), threads=1)
    if not report.passed:
        raise BuildFailed(f"tile {name[0]}, {name[1]} is wrong: {report.failure()}")
    patches: dict[str, np.ndarray] = {}
    border = BorderEdges.of(model, numbers, faces)
    for side, theirs, their_places in neighbors:
        edges = border.on(model, side)
        found = patches_on(model, side, edges, positions_on(model, side, edges, theirs, their_places))
        part = model.cell_component[found.cell]
        patches |= {
            f"{side.name}_shape": found.shape,
            f"{side.name}_block": found.block,
            f"{side.name}_part": part,
            f"{side.name}_open": np.array(found.open),
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


def _catalog(found: PreparedInputs, store: Store, names: list[Name]) -> Catalog:
    """The table of the whole."""
    frame = found.frame
    parts, compared, unequal, warnings = Parts(), 0, 0, list(found.warnings)
    for name in names:
        arrays = read_arrays(store.file("patches", name))
        for part, block in zip(arrays["parts"].tolist(), arrays["block_of_part"].tolist(), strict=True):
            parts.add((*name, part), block)
    for name in names:
        own = read_arrays(store.file("patches", name))
        for side, other in _neighbors(frame, name, names):
            if side.name not in ("east", "north"):
                continue
            theirs = read_arrays(store.file("patches", other))
            match = matched(_patches(own, side.name), _patches(theirs, OPPOSITE[side.name]), side)
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
        found.digest,
        frame.grid,
        blocks_of(frame, records, parts, parts),
        [entry_of(name, record) for name, record in zip(names, records, strict=True)],
        compared,
        unequal,
        [*warnings, *_warnings(frame, store, names)],
    )


def _warnings(frame: Frame, store: Store, names: list[Name]) -> list[BuildWarning]:
    """Those of all tiles; what they say of triangles and points as one."""
    items: dict[tuple, set] = {}
    wrong: dict[tuple[str, int, int], WrongPoints] = {}
    heights: dict[tuple[int, int], PartHeights] = {}
    for name in names:
        record = store.read_record("built", name)
        for warning in record["warnings"]:
            key: tuple = (warning["kind"], warning["rock"], warning["surface"])
            if warning["kind"] != "no_area":
                key = (*key, warning["text"])
            items.setdefault(key, set()).update(warning["items"])
        for side in ("below", "above"):
            _join_each(wrong, [((side, r, k), WrongPoints(**own)) for r, k, own in record[side]])
        _join_each(heights, [((r, k), PartHeights(**own)) for r, k, own in record["heights"]])
    found = []
    for (r, k), of in sorted(heights.items()):
        found += frame.local[r, k].warnings(of, frame.project.rocks[r], k)
    for (side, r, k), own in sorted(wrong.items()):
        found.append(own.warning(RockInput(frame.project.rocks[r], []), k, frame.sought[r, k], side))
    for (kind, rock, surface, *text), numbers in items.items():
        if kind == "no_area":
            what = "triangle" if len(numbers) == 1 else "triangles"
            text = [f"{len(numbers)} {what} without area left out"]
        found.append(BuildWarning(text[0], kind, rock, surface, tuple(sorted(numbers))))
    return found


def _join_each(found: dict, parts: list[tuple]) -> None:
    """Adds parts to what others had of the same."""
    for key, part in parts:
        found[key] = found[key].joined(part) if key in found else part
