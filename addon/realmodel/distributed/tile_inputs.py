# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tiles are built from: read, interpolated, and divided into what each tile needs.

Files are read, and surfaces divided, by this process until the workers are up, and then by the workers: one
surface at a time, which comes back as the names of files.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..core import BuildWarning, build_surfaces
from ..core.mapped_arrays import MappedArrays
from ..core.rock_input import RockInput
from ..core.surface_input import ReadSurface, SurfaceInput
from ..core.tiles.grid import TileGrid, tile_grid
from ..core.tiles.tile_model import REGION, Frame, Name, without_shapes, write_parts
from ..core.work import Work, native_module, run
from .workers import Workers

_MADE = 0.9  # of the time: surfaces have their heights


@dataclass(frozen=True)
class Prepared:
    """frame: what tiles share. rocks: as the stack builder takes them, all of them, in files. digest: of all
    that the result depends on."""

    frame: Frame
    rocks: list[tuple]
    warnings: list[BuildWarning]
    digest: str


def prepared(project, size, cells: str, arrays: MappedArrays, workers: Workers, progress, cancel) -> Prepared:
    """arrays: where everything is kept. size: of tiles."""
    reader = _Reader(arrays, workers)
    surfaces = build_surfaces(
        project,
        progress=lambda share, text: progress(_MADE * share, text),
        cancel=cancel,
        keep=arrays.keep,
        reader=reader,
    )
    inputs, warnings = surfaces.rock_inputs, list(surfaces.warnings)
    rocks = [entry.native() for entry in inputs]
    joined = run(lambda work: _joined(work, rocks), cancel=cancel)
    if joined is not None:
        rocks, text = joined
        warnings.append(BuildWarning(text, "joined"))
    rocks = [_kept(rock, arrays) for rock in rocks]
    # surfaces on the region's own mesh end where it ends
    clips = tuple(
        region is not None and not all(surface.interpolated for surface in entry.rock.surfaces)
        for (_, region, _, _), entry in zip(rocks, inputs, strict=True)
    )
    meshes = [vertices for shapes, *_ in rocks for vertices, _ in shapes]
    meshes += [rocks[r][1][0] for r in np.flatnonzero(clips)]
    grid = tile_grid(meshes, size)
    frame = Frame(without_shapes(project, inputs), cells, grid, clips)
    return Prepared(frame, rocks, warnings, _digest(frame, inputs, reader.digests))


class _Reader:
    """Reads the surfaces of a project (surface_input.Reader). digests: of what each of them was read to."""

    def __init__(self, arrays: MappedArrays, workers: Workers):
        self._arrays, self._workers = arrays, workers
        self.digests: dict[int, bytes] = {}

    def __call__(self, work: Work, surfaces: list[SurfaceInput]) -> Iterator[tuple[int, ReadSurface]]:
        in_files = []
        for number, surface in enumerate(surfaces):
            if surface.surface.input_file is not None:
                in_files.append((number, surface))
                continue
            found = surface.read()
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
    found = task[1].read()
    return found.with_arrays(arrays.place), _digest_of(found)


def _digest_of(found: ReadSurface) -> bytes:
    digest = hashlib.sha256()
    found.with_arrays(lambda array: [digest.update(np.ascontiguousarray(array)), array][1])
    return digest.digest()


def _kept(rock: tuple, arrays: MappedArrays) -> tuple:
    """A rock mass as the stack builder takes it with its arrays in files."""
    shapes, region, *rest = rock
    region = None if region is None else tuple(map(arrays.keep, region))
    return [tuple(map(arrays.keep, shape)) for shape in shapes], region, *rest


def _joined(work: Work, rocks: list[tuple]):
    native = native_module()
    with work.phase(0.0, 1.0, "comparing the borders"):
        try:
            return work.native(native.join_rock_masses, rocks)
        except native.InputError:
            return None  # the tile where it is tells of it in the user's names


def _digest(frame: Frame, inputs: list[RockInput], of_surfaces: dict[int, bytes]) -> str:
    """Of what was read and how it is used: heights follow from that."""
    digest = hashlib.sha256(repr((frame.cell_kind, frame.clips, frame.grid.x.tolist())).encode())
    digest.update(repr((frame.grid.y.tolist(), frame.project)).encode())
    for entry in inputs:
        for array in entry.region or ():
            digest.update(np.ascontiguousarray(array))
        for surface in entry.rock.surfaces:
            how = (surface.method_options(), surface.minimum_thickness) if surface.interpolated else None
            digest.update(repr((entry.rock.base_elevation, surface.rule, how)).encode())
    for _, found in sorted(of_surfaces.items()):
        digest.update(found)
    return digest.hexdigest()


def divided(
    prepared: Prepared, arrays: MappedArrays, workers: Workers, folder_of: Callable[[Name], Path], cancel
) -> list[Name]:
    """Writes what each tile needs into its folder. Returns the tiles that a surface meets."""
    tasks = []
    for r, (shapes, region, _base, _rules) in enumerate(prepared.rocks):
        meshes = dict(enumerate(shapes)) | ({REGION: region} if prepared.frame.clips[r] else {})
        tasks += [(r, k, tuple(map(arrays.place, mesh))) for k, mesh in meshes.items()]
    met = set()
    shared = (arrays.folder, prepared.frame.grid, folder_of)
    for (_, k, _), names in workers.in_any_order(_divide, shared, tasks, cancel, here=True):
        if k != REGION:
            met.update(names)
    return sorted(met, key=lambda name: name[::-1])


def _divide(shared: tuple[Path, TileGrid, Callable[[Name], Path]], task: tuple) -> list[Name]:
    folder, grid, folder_of = shared
    rock, surface, places = task
    mesh = tuple(map(MappedArrays(folder).opened, places))
    return write_parts(mesh, rock, surface, grid, folder_of)
