# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps of a build: read, mesh, interpolate, intersect."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from ..base.device import check_device, on_device
from ..base.named import keyword_only
from ..base.work import Cancel, Progress, Work, native_module, run
from ..cells.assembly import assemble, intersect
from ..project.project import Project
from ..project.project_checks import CELL_KINDS, check_cells, check_memory, check_project, check_stage
from ..settings.method_options import check_threads
from ..structures.setup import make_surfaces, mesh_inputs, read_inputs
from ..surfaces.rock_input import RockInput
from ..validation.closed_form import surface_forms
from ..validation.cut_bases import check_bases, warn_of_eroded_contacts
from .estimate import require_memory
from .model import Model

# Shares of the time of a build, roughly; phases that a project does not have are left out
_SHARES = {"read": 0.1, "mesh": 0.05, "interpolate": 0.45, "intersect": 0.38, "merge": 0.02}

__all__ = ["CELL_KINDS", "build"]


@keyword_only
def build(
    project: Project,
    cells: str = "columns",
    *,
    threads: int = 0,
    device: str = "cpu",
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    stage: int | None = None,
    memory: int | None = None,
) -> Model:
    """Builds the model of a project.

    cells: "columns", each under one facet of the surface above it, or "blocks", one for each connected
    component of a block. threads: 0 for all; the result is the same for any number. device: "cpu", or "cuda"
    for a GPU (docs/dev/gpu.md), with the same result; where it cannot be used, a warning says why. stage:
    build only up to this surface (from 0) of each rock mass. memory: limit of the build in bytes; None: the
    free memory. A build that is expected to need more (estimate) is refused before it begins.
    progress(fraction, text) and cancel() are called from this thread every 40 ms while another works; the
    fraction never falls. cancel() returning True ends it with Cancelled.

    Raises InputRefused (what, where, what to do), NotEnoughMemory, BuildFailed, UsageError, Cancelled.

    >>> square = [[0, 0], [4, 0], [4, 4], [0, 4]]
    >>> points = [[0, 0, 1], [4, 0, 5], [4, 4, 5], [0, 4, 1]]
    >>> ground = Surface("ground", points=points, method="tin", block="soil")
    >>> rock = Rock("hill", [ground], region=square, edge_length=1, base_elevation=0)
    >>> round(build(Project("ramp", [rock])).volume, 9)
    48.0
    """
    check_cells(cells)
    check_memory(memory)
    threads = check_threads(threads)
    check_device(device)
    project = check_project(project)
    if stage is not None:
        check_stage(project, stage)
    native_module()

    def task(work: Work) -> Model:
        with on_device(work, device) as warnings:
            model = _build(work, project, cells, stage, memory)
        model.warnings.extend(warnings)
        return model

    return run(task, progress, cancel, threads=threads)


def _build(work: Work, project: Project, cells: str, stage: int | None, memory: int | None) -> Model:
    timings = {"read": 0.0, "mesh": 0.0, "interpolate": 0.0, "intersect": 0.0}
    ends = _phase_ends(project)

    @contextmanager
    def timed(name: str) -> Iterator[None]:
        began = time.perf_counter()
        yield
        timings[name] += time.perf_counter() - began

    with timed("read"), work.phase(0.0, ends["read"], "reading"):
        inputs, project = read_inputs(work, project)
    with timed("mesh"), work.part(ends["read"], ends["mesh"]):
        mesh_inputs(work, inputs)

    def taken() -> list[RockInput]:
        return inputs if stage is None else [entry.stage(stage) for entry in inputs]

    require_memory(taken(), cells, memory, len(project.faults) + len(project.bodies))
    with timed("interpolate"), work.part(ends["mesh"], ends["interpolate"]):
        structures = make_surfaces(work, project, inputs, stage)
    inputs = taken()
    structures = structures if stage is None else structures.stage(stage)
    with timed("intersect"), work.part(ends["interpolate"], ends["intersect"]):
        built = intersect(work, inputs, cells, structures)
    forms = surface_forms(inputs, structures)
    check_bases(work, inputs, forms)
    warn_of_eroded_contacts(work, inputs, forms)
    built_project = replace(project, rocks=[entry.rock for entry in inputs])
    with work.part(ends["intersect"], 1.0):
        return Model.of(assemble(work, built_project, inputs, built, timings, structures))


def _phase_ends(project: Project) -> dict[str, float]:
    """The progress at the end of each phase: fixed shares of the phases that this project has."""
    has_files = bool(project.input_files())
    interpolates = bool(project.faults) or any(rock.interpolates or rock.series for rock in project.rocks)
    shares = _SHARES | {
        "read": _SHARES["read"] * has_files,
        "mesh": _SHARES["mesh"] * interpolates,
        "interpolate": _SHARES["interpolate"] * interpolates,
    }
    ends = np.cumsum(list(shares.values())) / sum(shares.values())
    return dict(zip(shares, ends.tolist(), strict=True))
