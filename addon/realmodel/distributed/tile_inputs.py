# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tiles are built from: read, interpolated, and divided into what each tile needs.

Files are read, variograms fitted, and surfaces and points divided, by this process until the workers are up,
and then by the workers: one surface at a time, which comes back as the names of files.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..core import BuildWarning, Rock, SurfaceSet, build_surfaces
from ..core.base.errors import naming
from ..core.base.mapped_arrays import MappedArrays
from ..core.base.sheet import Sheet
from ..core.base.work import Cancel, Reporter, Work, native_module, run
from ..core.heights.ties import tie_data
from ..core.project.project import Project, surface_item
from ..core.surfaces.local_heights import LocalHeights, linked, local_heights, local_surfaces
from ..core.surfaces.rock_input import RockInput
from ..core.surfaces.surface_heights import interpolation_order
from ..core.surfaces.surface_input import ReadSurface, SurfaceInput
from ..core.surfaces.wrong_sides import kept_off
from ..core.tiles.grid import TileGrid, tile_grid
from ..core.tiles.settling import Box
from ..core.tiles.tile_model import (
    PLAN,
    REGION,
    Frame,
    Name,
    without_shapes,
    write_certain_heights,
    write_own_points,
    write_parts,
    write_windows,
)
from .workers import Workers

_TILES_AT_ONCE = 16  # of which a worker makes the heights of a surface
_MADE = 0.9  # of the time: surfaces have their heights


@dataclass(frozen=True)
class PreparedInputs:
    """frame: what tiles share. rocks: as the stack builder takes them, all of them, in files; those that
    tiles interpolate lie at 0. points: of surfaces, by rock mass and number: those that tiles interpolate
    from, and those that they look for on wrong sides. digest: of all that the result depends on."""

    frame: Frame
    rocks: list[tuple]
    near: dict[tuple[int, int], np.ndarray]
    own: dict[tuple[int, int], np.ndarray]
    warnings: list[BuildWarning]
    digest: str

    def let_go(self) -> PreparedInputs:
        """Without what the workers have."""
        return replace(self, rocks=[], near={}, own={})


def prepared(
    project: Project,
    size: tuple[float, float],
    cells: str,
    arrays: MappedArrays,
    workers: Workers,
    report: Reporter,
    cancel: Cancel | None,
) -> PreparedInputs:
    """arrays: where everything is kept. size: of tiles."""
    reader = SurfaceReader(arrays, workers)

    def surfaces_with(flat: Callable[[RockInput], set[int]]) -> SurfaceSet:
        return build_surfaces(
            project,
            progress=lambda share, text: report(_MADE * share, text),
            cancel=cancel,
            keep=arrays.keep,
            reader=reader,
            flat=flat,
        )

    flat: Callable[[RockInput], set[int]] = local_surfaces
    surfaces = surfaces_with(flat)
    joined = _joined(surfaces, arrays, cancel)
    if joined is not None and any(map(flat, surfaces.rock_inputs)):
        flat = _no_surfaces  # borders that are joined change the meshes
        surfaces = surfaces_with(flat)
        joined = _joined(surfaces, arrays, cancel)
    inputs, warnings = surfaces.rock_inputs, list(surfaces.warnings)
    rocks = [entry.native() for entry in inputs]
    if joined is not None:
        rocks, text = joined
        warnings.append(BuildWarning(text, "joined"))
    rocks = [_kept(rock, arrays) for rock in rocks]
    # surfaces on the region's own mesh end where it ends
    clips = tuple(
        region is not None and not all(map(entry.rock.is_interpolated, entry.rock.surfaces))
        for (_, region, _, _), entry in zip(rocks, inputs, strict=True)
    )
    meshes = [vertices for shapes, *_ in rocks for vertices, _ in shapes]
    meshes += [rocks[r][1][0] for r in np.flatnonzero(clips)]
    grid = tile_grid(list({id(mesh): mesh for mesh in meshes}.values()), size)
    local: dict[tuple[int, int], LocalHeights] = {}
    near: dict[tuple[int, int], np.ndarray] = {}
    own: dict[tuple[int, int], np.ndarray] = {}
    for r, entry in enumerate(inputs):
        numbers = flat(entry)
        fitted = _fitted(entry, numbers, arrays, workers, cancel)
        for k in (k for k in interpolation_order(entry.rock) if k in fitted):
            found, near[r, k], texts = fitted[k]
            if entry.rock.surfaces[k].tie:
                found, of_ties = _tied(found, entry, k, near[r, k], cancel)
                texts = [*texts, *of_ties]
            local[r, k] = linked(found, entry.rock, k)
            warnings += [
                BuildWarning(text, "points", entry.rock.name, entry.rock.surfaces[k].name) for text in texts
            ]
        if numbers:
            own |= {
                (r, k): data.known_points
                for k, data in enumerate(entry.data)
                if len(data.known_points) and (k > 0 or 1 in kept_off(entry.rock))
            }
    frame = Frame(
        without_shapes(project, inputs),
        cells,
        grid,
        clips,
        local,
        {key: len(points) for key, points in own.items()},
        tuple(kept_off(entry.rock) for entry in inputs),
    )
    return PreparedInputs(frame, rocks, near, own, warnings, _digest(frame, inputs, reader.digests))


def _no_surfaces(_entry: RockInput) -> set[int]:
    return set()


def _fitted(
    entry: RockInput, numbers: set[int], arrays: MappedArrays, workers: Workers, cancel: Cancel | None
) -> dict[int, tuple[LocalHeights, np.ndarray, list[str]]]:
    """Of the surfaces of a rock mass that tiles interpolate: what local_heights gives."""
    if not numbers:
        return {}
    nodes, _ = entry.planar_mesh()
    extent = np.array([nodes.min(axis=0), nodes.max(axis=0)])
    tasks = []
    for k in sorted(numbers):
        surface = entry.rock.surfaces[k]
        points = arrays.place(arrays.keep(entry.data[k].points))
        stub = replace(surface, points=None)
        tasks.append((k, entry.rock.name, stub, points, extent, len(nodes), *surface.method_options()))
    found = {}
    for (k, *_), (local, points, texts) in workers.in_any_order(
        _fit, arrays.folder, tasks, cancel, here=True
    ):
        found[k] = local, arrays.opened(points), texts
    return found


def _tied(
    found: LocalHeights, entry: RockInput, number: int, points: np.ndarray, cancel: Cancel | None
) -> tuple[LocalHeights, list[str]]:
    """A surface that tiles interpolate, tied to its points and bounds, and warnings."""
    surface, own = entry.rock.surfaces[number], entry.data[number]
    data = tie_data(np.ascontiguousarray(own.tied_points(surface)), own.bounds)
    if not len(data.places):
        return found, []
    mesh = Sheet(*map(np.ascontiguousarray, entry.planar_mesh()))
    points = np.ascontiguousarray(points)
    return run(lambda work: found.tied(work, data, points, mesh), cancel=cancel)


def _fit(folder: Path, task: tuple) -> tuple[LocalHeights, Path | np.ndarray, list[str]]:
    """On a worker: what a surface has once for all tiles."""
    _, rock, surface, points, extent, nodes, method, settings = task
    arrays = MappedArrays(folder)

    def fitted(work: Work) -> tuple:
        given = np.ascontiguousarray(arrays.opened(points))
        found, left, texts = local_heights(work, given, extent, nodes, method, settings, arrays)
        return found, points if left is given else arrays.place(left), texts

    with naming(surface_item(Rock(rock, []), surface), surface.shape_source):
        return run(fitted, threads=1)


class SurfaceReader:
    """Reads the surfaces of a project on workers (surface_input.Reader). digests: of what each of them was
    read to."""

    def __init__(self, arrays: MappedArrays, workers: Workers):
        self._arrays, self._workers = arrays, workers
        self.digests: dict[int, bytes] = {}

    def __call__(self, work: Work, surfaces: list[SurfaceInput]) -> Iterator[tuple[int, ReadSurface]]:
        in_files = []
        for number, surface in enumerate(surfaces):
            if surface.surface.input_file is not None:
                in_files.append((number, surface))
                continue
            found = surface.read(arrays=self._arrays)
            self.digests[number] = _digest_of(found)
            yield number, found
        tasks = self._workers.in_any_order(_read, self._arrays.folder, in_files, work.check, here=True)
        for done, ((number, _), (found, digest)) in enumerate(tasks, 1):
            work.step(done / len(in_files))
            self.digests[number] = digest
            yield number, found.with_arrays(self._arrays.opened)


def _read(folder: Path, task: tuple[int, SurfaceInput]) -> tuple[ReadSurface, bytes]:
    """On a worker: a surface with the places of its arrays instead of them."""
    arrays = MappedArrays(folder)
    found = task[1].read(arrays=arrays)
    return found.with_arrays(arrays.place), _digest_of(found)


def _digest_of(found: ReadSurface) -> bytes:
    digest = hashlib.sha256()

    def add(array: np.ndarray) -> np.ndarray:
        digest.update(np.ascontiguousarray(array))
        return array

    found.with_arrays(add)
    return digest.digest()


def _kept(rock: tuple, arrays: MappedArrays) -> tuple:
    """A rock mass as the stack builder takes it with its arrays in files."""
    shapes, region, *rest = rock
    region = None if region is None else tuple(map(arrays.keep, region))
    return [tuple(map(arrays.keep, shape)) for shape in shapes], region, *rest


def _joined(surfaces: SurfaceSet, arrays: MappedArrays, cancel: Cancel | None) -> Any:
    """The rock masses with their borders joined, in files, and the text of a warning; None where nothing has
    to be. Heights do not matter. Surfaces on one mesh that was made for them have nothing to join."""
    if _have_one_mesh(surfaces.rock_inputs):
        return None
    native, rocks = native_module(), [entry.native() for entry in surfaces.rock_inputs]

    def task(work: Work) -> Any:
        with work.phase(0.0, 1.0, "comparing the borders"):
            try:
                joins = work.native(native.find_joins, rocks)
                return None if joins is None else _with_joins(work, rocks, joins, arrays)
            except native.InputError:
                return None  # the tile there refuses it with the names of the project

    return run(task, cancel=cancel)


def _with_joins(work: Work, rocks: list[tuple], joins: Any, arrays: MappedArrays) -> Any:
    """What _joined gives, made one mesh at a time."""
    found = []
    for shapes, region, *rest in rocks:
        meshes = []
        for mesh in shapes if region is None else [*shapes, region]:
            joined = work.native(joins.mesh, *mesh)
            if joined is None:
                return None
            meshes.append(tuple(map(arrays.keep, joined)))
        found.append((meshes[: len(shapes)], None if region is None else meshes[-1], *rest))
    return found, joins.text


def _have_one_mesh(inputs: list[RockInput]) -> bool:
    """Whether all surfaces are interpolated on the whole mesh of one region."""
    if len(inputs) > 1 or inputs[0].region is None:
        return False
    rock, nodes = inputs[0].rock, len(inputs[0].region.vertices)
    return all(map(rock.is_interpolated, rock.surfaces)) and all(
        len(inputs[0].surface(number).vertices) == nodes for number in range(len(rock.surfaces))
    )


def _digest(frame: Frame, inputs: list[RockInput], of_surfaces: dict[int, bytes]) -> str:
    """Of what was read and how it is used: heights follow from that, in one version."""
    digest = hashlib.sha256(
        repr((native_module().VERSION, frame.cell_kind, frame.clips, frame.grid.x.tolist())).encode()
    )
    digest.update(repr((frame.grid.y.tolist(), frame.project)).encode())
    for entry in inputs:
        for array in entry.region or ():
            digest.update(np.ascontiguousarray(array))
        for surface, data in zip(entry.rock.surfaces, entry.data, strict=True):
            how = None
            if entry.rock.is_interpolated(surface):
                thickness = (surface.minimum_thickness, surface.true_thickness)
                how = (surface.method_options(), thickness, surface.tie)
            digest.update(repr((entry.rock.base_elevation, surface.rule, how)).encode())
            for array in (data.contacts, data.bounds.places, data.bounds.is_lower):
                digest.update(np.ascontiguousarray(array))
    for _, found in sorted(of_surfaces.items()):
        digest.update(found)
    return digest.hexdigest()


def divided(
    found: PreparedInputs,
    arrays: MappedArrays,
    workers: Workers,
    folder_of: Callable[[Name], Path],
    cancel: Cancel | None,
) -> list[Name]:
    """Writes what each tile needs into its folder. Returns the tiles that a surface meets."""
    frame, tasks = found.frame, []
    for r, (shapes, region, _base, _rules) in enumerate(found.rocks):
        meshes = {PLAN if (r, k) in frame.local else k: shape for k, shape in enumerate(shapes)}
        if frame.clips[r]:
            meshes[REGION] = region
        tasks += [(r, k, tuple(map(arrays.place, mesh))) for k, mesh in meshes.items()]
    shared, met, boxes = (arrays.folder, frame.grid, folder_of), set(), {}
    for (r, k, _), there in workers.in_any_order(_divide, shared, tasks, cancel, here=True):
        if k != REGION:
            met.update(there)
        if k == PLAN:
            boxes[r] = there
    of_points: list[tuple] = []
    for (r, k), points in found.near.items():
        local, names = frame.local[r, k], list(boxes[r])
        at_once = _TILES_AT_ONCE if local.border is not None else max(len(names), 1)
        for first in range(0, len(names), at_once):
            some = {name: boxes[r][name] for name in names[first : first + at_once]}
            of_points.append((r, k, arrays.place(points), local, some))
    of_points += [
        (r, k, arrays.place(arrays.keep(points)), None, None) for (r, k), points in found.own.items()
    ]
    for _ in workers.in_any_order(_divide_points, shared, of_points, cancel, here=True):
        pass
    return sorted(met, key=lambda name: name[::-1])


def _divide(shared: tuple[Path, TileGrid, Callable[[Name], Path]], task: tuple) -> dict[Name, Box]:
    folder, grid, folder_of = shared
    rock, surface, places = task
    vertices, triangles = map(MappedArrays(folder).opened, places)
    return write_parts(Sheet(vertices, triangles), rock, surface, grid, folder_of)


def _divide_points(shared: tuple[Path, TileGrid, Callable[[Name], Path]], task: tuple) -> None:
    folder, grid, folder_of = shared
    rock, surface, place, local, boxes = task
    points = MappedArrays(folder).opened(place)
    if boxes is None:
        write_own_points(points, rock, surface, grid, folder_of)
    elif local.border is not None:
        write_certain_heights(points, rock, surface, local, boxes, folder_of)
    elif local.takes_points:
        write_windows(points, rock, surface, local, boxes, folder_of)
