# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tiles are built from: a project, read and interpolated, and its windows.

Files are read by this process until the workers are up, and then by the workers: one surface at a time,
which comes back as the names of files. Surfaces are interpolated here, as in a model that is not divided.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..core import BuildWarning, Project
from ..core.base.mapped_arrays import MappedArrays
from ..core.base.triangles import Sheet
from ..core.base.work import Work, native_module
from ..core.cells.assembly import are_joined, list_blocks
from ..core.cells.cell_complex import CellComplex
from ..core.structures.parts.parts import box_around, divide
from ..core.structures.setup import make_surfaces, mesh_inputs, read_inputs
from ..core.surfaces.surface_input import ReadSurface, SurfaceInput
from ..core.tiles.tile_model import Frame, without_shapes
from ..core.tiles.windows import Windows
from ..core.validation.closed_form import surface_forms
from ..core.validation.cut_bases import check_bases
from .workers import Workers

_READ, _MESHED = 0.2, 0.3  # of the time


def prepared(
    work: Work, project: Project, arrays: MappedArrays, workers: Workers
) -> tuple[Windows, list[BuildWarning]]:
    """The windows of a project, and the warnings about all of it. arrays: where surfaces and their sheets are
    kept. Raises InputRefused."""
    with work.phase(0.0, _READ, "reading"):
        inputs, with_arrays = read_inputs(work, project, SurfaceReader(arrays, workers))
    with work.part(_READ, _MESHED):
        mesh_inputs(work, inputs, arrays.keep)
    with work.part(_MESHED, 1.0):
        structures = make_surfaces(work, with_arrays, inputs, None, arrays.keep, joins=False)
    if are_joined(inputs, structures) and not structures.is_divided:
        check_bases(work, inputs, surface_forms(inputs, structures))
        structures = divide(work, structures, box_around(inputs, structures, has_sheets=True))
    for entry in inputs:
        entry.surfaces = [
            sheet and Sheet(arrays.keep(sheet.vertices), arrays.keep(sheet.triangles), sheet.numbers)
            for sheet in entry.surfaces
        ]
    windows = Windows(work, inputs, structures, arrays.keep)
    warnings = [warning for entry in inputs for warning in entry.warnings]
    if windows.joined is not None:
        warnings.append(BuildWarning(windows.joined, "joined"))
    return windows, warnings


def frame_of(project: Project, windows: Windows, size: tuple[float, float], cells: str) -> Frame:
    """What the tiles have in common. size: of tiles; cells: as of core.build. Raises UsageError."""
    inputs, structures = windows.inputs, windows.structures
    names = [surface.name for entry in inputs for surface in entry.rock.surfaces]
    return Frame(
        without_shapes(project, inputs),
        cells,
        windows.divide(size),
        list_blocks(inputs, np.zeros(len(names) + len(structures)), CellComplex.empty(cells), structures),
        replace(
            structures,
            faults=[
                replace(fault, vertices=None, triangles=None, points=None) for fault in structures.faults
            ],
            bodies=[replace(body, vertices=None, triangles=None) for body in structures.bodies],
        ),
        [*names, *structures.names],
        np.array([0] * len(names) + structures.kinds, np.int32),
    )


def digest_of(frame: Frame, windows: Windows) -> str:
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


class SurfaceReader:
    """Reads the surfaces of a project on workers (surface_input.Reader)."""

    def __init__(self, arrays: MappedArrays, workers: Workers):
        self._arrays, self._workers = arrays, workers

    def __call__(self, work: Work, surfaces: list[SurfaceInput]) -> Iterator[tuple[int, ReadSurface]]:
        in_files = []
        for number, surface in enumerate(surfaces):
            if surface.surface.input_file is None:
                yield number, surface.read(arrays=self._arrays)
            else:
                in_files.append((number, surface))
        tasks = self._workers.in_any_order(_read, self._arrays.folder, in_files, work.check, here=True)
        for done, ((number, _), result) in enumerate(tasks, 1):
            work.step(done / len(in_files))
            yield number, result.with_arrays(self._arrays.opened)


def _read(folder: Path, task: tuple[int, SurfaceInput]) -> ReadSurface:
    """On a worker: a surface with the places of its arrays instead of them."""
    arrays = MappedArrays(folder)
    return task[1].read(arrays=arrays).with_arrays(arrays.place)
