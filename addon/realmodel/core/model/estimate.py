# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates the triangles, memory and time of a model before it is built."""

from __future__ import annotations

import time
from dataclasses import dataclass

from ..base.errors import NotEnoughMemory
from ..base.sheet import Sheet
from ..base.work import Cancel, Progress, Work, native_module, run
from ..project.build_options import check_cells, check_stage
from ..project.project import Project, check_project
from ..settings.method_options import check_threads
from ..structures.setup import mesh_inputs
from ..surfaces.prepare import read_rocks
from ..surfaces.rock_input import RockInput

# Bytes for each triangle of the surfaces: a little more than the dearest benchmark took, by cells
# and by whether all surfaces stand on one plan mesh.
_MOST_BYTES = {
    ("columns", False): 1000,
    ("columns", True): 520,
    ("blocks", False): 350,
    ("blocks", True): 720,
}
# Seconds on two processors of 2023, of stacks like the benchmark's
_SECONDS_PER_TRIANGLE = {"columns": 2e-6, "blocks": 5e-7}
_STRUCTURED = 4  # times as much as without, and once more for each fault or body
_SECONDS_PER_NODE = 5e-7  # that a surface is interpolated at, and its points are fitted with


@dataclass(frozen=True)
class Estimate:
    """What building a project will take.

    cell_kind, threads: as given. triangles: of all surfaces. memory: an upper bound, in bytes, of the memory
    that the build adds to the process; mostly it needs a third to all of that. seconds: of the whole build on
    an idle machine, in order of magnitude. available: free memory in bytes.
    """

    cell_kind: str
    threads: int
    triangles: int
    memory: int
    seconds: float
    available: int

    @property
    def fits(self) -> bool:
        """Whether building takes no more memory than there is."""
        return self.memory <= self.available

    def table(self) -> str:
        """The estimate as text for a terminal."""
        rows = [
            ("triangles of all surfaces", f"{self.triangles:,}"),
            (f"memory while building {self.cell_kind}", f"at most {memory_text(self.memory)}"),
            ("memory free", memory_text(self.available)),
            ("time", f"about {_time_text(self.seconds)}"),
        ]
        width = max(len(name) for name, _ in rows)
        return "\n".join(f"{name.ljust(width)}  {value}" for name, value in rows)


def estimate(
    project: Project,
    cells: str = "columns",
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    *,
    stage: int | None = None,
) -> Estimate:
    """Estimates the memory and the time that build() with the same arguments needs. It reads the files and
    meshes the regions; nothing is interpolated or intersected.

    Raises InputRefused as build() does while it reads and meshes, UsageError, Cancelled.

    >>> expected = estimate(model.project)
    >>> expected.triangles, expected.fits
    (6, True)
    """
    check_cells(cells)
    threads = check_threads(threads)
    check_project(project)
    if stage is not None:
        check_stage(project, stage)
    native_module()

    def task(work: Work) -> Estimate:
        began = time.perf_counter()
        with work.phase(0.0, 0.7, "reading"):
            inputs = read_rocks(work, project)
        with work.part(0.7, 1.0):
            mesh_inputs(work, inputs)
        read = time.perf_counter() - began
        if stage is not None:
            inputs = [entry.stage(stage) for entry in inputs]
        triangles = sum(map(_triangles, inputs))
        nodes = 0
        for entry in inputs:
            if entry.region is not None:
                nodes += len(entry.region.vertices) * sum(surface is None for surface in entry.surfaces)
        structures = len(project.faults) + len(project.bodies)
        seconds = _SECONDS_PER_TRIANGLE[cells] * triangles + _SECONDS_PER_NODE * nodes
        seconds = read + seconds * _times(structures)
        available = native_module().available_memory()
        return Estimate(
            cells, threads, triangles, memory_bound(inputs, cells, structures), seconds, available
        )

    return run(task, progress, cancel, threads=threads)


def memory_bound(inputs: list[RockInput], cells: str, structures: int = 0) -> int:
    """An upper bound of the memory, bytes, that building rock masses needs that are read and meshed, by their
    triangles. structures: the number of faults and bodies."""
    bytes_of_stacks = sum(_MOST_BYTES[cells, _on_one_plan(entry)] * _triangles(entry) for entry in inputs)
    return bytes_of_stacks * _times(structures)


def _times(structures: int) -> int:
    """The factor by which faults and bodies increase the work: stacks are built in parts, cut and joined."""
    return _STRUCTURED + structures if structures else 1


def require_memory(inputs: list[RockInput], cells: str, limit: int | None, structures: int = 0) -> None:
    """Raises NotEnoughMemory, with what to do, where the build may take more than `limit` bytes (None: than
    are free)."""
    free = native_module().available_memory() if limit is None else limit
    needed = memory_bound(inputs, cells, structures)
    if needed <= free:
        return
    advice = []
    if cells == "columns" and (blocks := memory_bound(inputs, "blocks", structures)) <= free:
        advice.append(f'ask for cells="blocks" (at most {memory_text(blocks)})')
    triangles = sum(map(_triangles, inputs))
    fitting = float(f"{0.9 * triangles * free / needed:.1e}")
    coarser = f"use surfaces of {fitting:,.0f} triangles in all instead of {triangles:,}"
    if any(entry.rock.interpolates for entry in inputs):
        coarser += f", or an edge length {(needed / (0.9 * free)) ** 0.5:.1f} times as long"
    advice.append(coarser)
    advice.append("build fewer surfaces at a time (stage)" if len(inputs) == 1 else "build fewer rock masses")
    whose = "are free" if limit is None else "are allowed"
    raise NotEnoughMemory(
        f"building takes up to {memory_text(needed)} of memory and {memory_text(free)} {whose}",
        needed=needed,
        available=free,
        advice=", or ".join(advice),
    )


def _plans(entry: RockInput) -> list[Sheet]:
    """The triangulation of each surface; of one that is not interpolated yet, the region's."""
    return [entry.planar_mesh() if surface is None else surface for surface in entry.surfaces]


def _triangles(entry: RockInput) -> int:
    return sum(len(triangles) for _, triangles in _plans(entry))


def _on_one_plan(entry: RockInput) -> bool:
    """Whether all surfaces have the same triangles in plan."""
    first, *others = _plans(entry)
    return all(other.has_plan_of(first) for other in others)


def memory_text(size: float) -> str:
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{max(1, round(size / 1e6))} MB"


def _time_text(seconds: float) -> str:
    """To one digit: the estimate is not more precise."""
    for unit, size in (("h", 3600), ("min", 60)):
        if seconds >= 2 * size:
            return f"{float(f'{seconds / size:.0e}'):g} {unit}"
    return f"{float(f'{max(seconds, 0.01):.0e}'):g} s"
