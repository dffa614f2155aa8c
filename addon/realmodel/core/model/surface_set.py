# SPDX-License-Identifier: GPL-3.0-or-later
"""The surfaces of a project with their heights, before anything is intersected."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..base.device import check_device, on_device
from ..base.errors import BuildWarning, UsageError
from ..base.named import NamedList, keyword_only, number_of
from ..base.triangles import Triangulation
from ..base.work import Cancel, Progress, Work, native_module, run
from ..exporters import SURFACES
from ..heights import Interpolation
from ..notebook import ShortRepr
from ..project.project import Project
from ..project.project_checks import check_project, check_stage
from ..settings.method_options import check_threads
from ..structures.parts.parts import Structures
from ..structures.setup import make_surfaces, mesh_inputs, read_inputs
from ..surfaces.rock_input import RockInput
from ..surfaces.surface_input import triangle_sheets, vertex_attributes
from .notebook_view import surfaces_to_pyvista

if TYPE_CHECKING:
    import pyvista

_READ, _MESHED = 0.2, 0.4  # shares of the time


@dataclass(eq=False, repr=False)
class SurfaceSet(ShortRepr):
    """Surfaces as input of the model: interpolated ones on the mesh of their region, ready meshes unchanged
    and unclipped; of surfaces that faults displace all sheets, one after another. `surface_names` and all
    numbers go through the rock masses in order, oldest first, then through the faults and the bodies.
    `project` holds the arrays instead of files. `surface_kind` is that of a Model. `warnings`: of reading and
    interpolation. `rock_inputs`, `structures`: the input of the later steps of a build.
    """

    project: Project
    rock_inputs: list[RockInput] = field(repr=False)
    surface_names: list[str]
    surface_kind: np.ndarray
    warnings: list[BuildWarning]
    structures: Structures = field(repr=False)

    @property
    def interpolations(self) -> list[Interpolation | None]:
        """The interpolation of each surface; None for ready meshes."""
        return [result for entry in self.rock_inputs for result in entry.interpolations]

    @property
    def surfaces(self) -> NamedList[Triangulation]:
        """The surfaces, by their names or numbers."""
        interfaces = [entry.surface(k) for entry in self.rock_inputs for k in range(len(entry.surfaces))]
        shapes = (shape.arrays for shape in [*interfaces, *self.structures.shapes])
        return NamedList(shapes, self.surface_names, "surface")

    def surface(self, key: int | str) -> Triangulation:
        """One of `surfaces`. key: its name or number. Raises UsageError."""
        return self.surfaces[number_of(key, self.surface_names, "surface")]

    @property
    def surface_triangle_sheet(self) -> np.ndarray:
        """As Model.surface_triangle_sheet."""
        count = sum(len(triangles) for _, triangles in self.structures.shapes)
        return np.append(triangle_sheets(self.rock_inputs), np.zeros(count, np.int32))

    def surface_attributes(self, key: int | str) -> dict[str, np.ndarray]:
        """As Model.surface_attributes."""
        number = number_of(key, self.surface_names, "surface")
        return vertex_attributes(self.rock_inputs, number, self.surfaces[number].vertices)

    def to_pyvista(self) -> pyvista.MultiBlock:
        """As Model.surfaces_to_pyvista."""
        return surfaces_to_pyvista(self)

    def save(self, path: str | Path) -> None:
        """Writes the surfaces to a file, by its ending (.obj, .ply, .stl, .glb, .dxf, .ts with a
        part for each, .npz, .vtu). It appears whole or not at all.

        Raises UsageError for an unknown extension, OutputFailed if it cannot be written.
        """
        SURFACES.save(self, path)


@keyword_only
def build_surfaces(
    project: Project,
    *,
    threads: int = 0,
    device: str = "cpu",
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    stage: int | None = None,
) -> SurfaceSet:
    """Reads, meshes and interpolates the surfaces of a project, fits those of its faults, and stops there.

    Arguments as `build` (device, too); stage: only the surfaces up to this one (from 0) of each rock mass.
    Raises InputRefused, UsageError, Cancelled.
    """
    threads = check_threads(threads)
    check_device(device)
    project = check_project(project)
    if stage is not None:
        check_stage(project, stage)
    if not any(rock.surfaces for rock in project.rocks):
        raise UsageError("the project has no surfaces")
    native_module()

    def task(work: Work) -> SurfaceSet:
        with on_device(work, device) as warnings:
            surfaces = _build(work, project, stage)
        surfaces.warnings.extend(warnings)
        return surfaces

    return run(task, progress, cancel, threads=threads)


def _build(work: Work, project: Project, stage: int | None) -> SurfaceSet:
    with work.phase(0.0, _READ, "reading"):
        inputs, with_arrays = read_inputs(work, project)
    with work.part(_READ, _MESHED):
        mesh_inputs(work, inputs)
    with work.part(_MESHED, 1.0):
        structures = make_surfaces(work, with_arrays, inputs, stage)
    if stage is not None:
        inputs = [entry.stage(stage) for entry in inputs]
    names = [surface.name for entry in inputs for surface in entry.rock.surfaces]
    return SurfaceSet(
        project,
        inputs,
        [*names, *structures.names],
        np.array([0] * len(names) + structures.kinds, np.int32),
        [warning for entry in inputs for warning in entry.warnings],
        structures,
    )
