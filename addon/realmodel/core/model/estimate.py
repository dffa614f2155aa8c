# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates the triangles, memory and time of a model before it is built."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from ..base.algebra import cube_root
from ..base.errors import NotEnoughMemory
from ..base.named import keyword_only
from ..base.triangles import Sheet
from ..base.work import Cancel, Progress, Work, native_module, run
from ..fields.solve import MOST_CENTERS
from ..project.project import Project
from ..project.project_checks import check_cells, check_project, check_stage
from ..settings.method_options import check_threads
from ..structures.fields import MOST_TOGETHER, lattices
from ..structures.setup import mesh_inputs
from ..surfaces.prepare import read_rocks
from ..surfaces.rock_input import RockInput

BYTES_OF_ANY = 10_000_000  # that any build takes: tables, what threads work in, modules that are loaded
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
# Of fields, measured of a dome and a recumbent fold: a level set has 10 to 22 triangles for each of the nodes
# to the power of two thirds, that are in one layer of a lattice. The bytes are a quarter more than was taken;
# columns as dense as the lattice divide these triangles, sparser ones fewer.
_TRIANGLES_IN_LAYER = 16
_BYTES_OF_LEVEL_SET, _BYTES_OF_DIVIDED = 1000, 6000
# Of a node on each combination of sides of faults: values and numbers; for each fault its side and its
# coordinate, which is there twice while it is made
_BYTES_OF_SIDES, _BYTES_OF_FAULT = 40, 25
_SECONDS_PER_LEVEL_TRIANGLE = {"columns": 1.3e-5, "blocks": 7e-6}
_SECONDS_PER_CUBE = 2.5e-10  # of the data that carry a field: it is solved for in several rounds
_SECONDS_PER_VALUE = 2e-9  # of a datum at a node


@dataclass(frozen=True)
class Estimate:
    """The memory and time that building a project will take.

    cell_kind, threads: as given. triangles: of all surfaces; of level sets of fields in order of magnitude.
    lattice_nodes: of the lattices of all fields. memory: an upper bound, in bytes, of the memory
    that the build adds to the process; mostly it needs a third to all of that. seconds: of the whole build on
    an idle machine, in order of magnitude. available: free memory in bytes.
    """

    cell_kind: str
    threads: int
    triangles: int
    memory: int
    seconds: float
    available: int
    lattice_nodes: int = 0

    @property
    def fits(self) -> bool:
        """Whether the build fits in memory."""
        return self.memory <= self.available

    def rows(self) -> list[tuple[str, str]]:
        """The estimate as names and values, to be read."""
        about = "about " if self.lattice_nodes else ""
        return [
            ("triangles of all surfaces", f"{about}{self.triangles:,}"),
            *([("nodes of lattices", f"{self.lattice_nodes:,}")] if self.lattice_nodes else []),
            (f"memory while building {self.cell_kind}", f"at most {memory_text(self.memory)}"),
            ("memory free", memory_text(self.available)),
            ("time", f"about {_time_text(self.seconds)}"),
        ]

    def table(self) -> str:
        """The estimate as text for a terminal."""
        rows = self.rows()
        width = max(len(name) for name, _ in rows)
        return "\n".join(f"{name.ljust(width)}  {value}" for name, value in rows)


@keyword_only
def estimate(
    project: Project,
    cells: str = "columns",
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
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
    project = check_project(project)
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
                nodes += len(entry.region.vertices) * sum(surface is None for surface in _sheets(entry))
        structures = len(project.faults) + len(project.bodies)
        seconds = _SECONDS_PER_TRIANGLE[cells] * triangles + _SECONDS_PER_NODE * nodes
        fields = [field for entry in inputs for field in _fields(entry, structures)]
        of_level_sets = sum(field.triangles for field in fields)
        seconds = read + seconds * _times(structures) + sum(field.seconds for field in fields)
        seconds += _SECONDS_PER_LEVEL_TRIANGLE[cells] * of_level_sets
        return Estimate(
            cells,
            threads,
            triangles + of_level_sets,
            memory_bound(inputs, cells, structures),
            seconds,
            native_module().available_memory(),
            sum(field.nodes for field in fields),
        )

    return run(task, progress, cancel, threads=threads)


def memory_bound(inputs: list[RockInput], cells: str, structures: int = 0) -> int:
    """An upper bound of the memory, bytes, that building rock masses needs that are read and meshed, by their
    triangles. structures: the number of faults and bodies."""
    bytes_of_stacks = sum(_MOST_BYTES[cells, _on_one_plan(entry)] * _triangles(entry) for entry in inputs)
    fields = [field for entry in inputs for field in _fields(entry, structures)]
    of_level_sets = sum(
        field.triangles * (_BYTES_OF_LEVEL_SET + _BYTES_OF_DIVIDED * field.density * (cells == "columns"))
        for field in fields
    )
    system = sum(field.system for field in fields)
    return BYTES_OF_ANY + bytes_of_stacks * _times(structures) + round(of_level_sets) + system


@dataclass(frozen=True)
class _FieldSize:
    """Of the field of a series. nodes: of its lattice. triangles: of all its level sets, about. density: how
    many columns lie along an edge of the lattice. system: bytes of what is solved, and of what nodes have on
    the sides of faults. seconds: that the solution takes."""

    nodes: int
    triangles: int
    density: float
    system: int
    seconds: float


def _fields(entry: RockInput, structures: int) -> list[_FieldSize]:
    """The fields of the series of a rock mass. structures: the number of faults and bodies, each of which may
    part a field in two."""
    sizes = []
    # as many as lines part a plane in; where there are more, each compartment has a separate field
    combinations = min(1 + structures * (structures + 1) // 2, MOST_TOGETHER) if structures else 0
    of_sides = combinations * (_BYTES_OF_SIDES + _BYTES_OF_FAULT * structures)
    for data, lattice in lattices(entry):
        rows = min(len(data.contacts), MOST_CENTERS) + 2 * len(data.dips)
        in_layer = _TRIANGLES_IN_LAYER * cube_root(float(lattice.nodes)) ** 2
        triangles = round(in_layer * len(data.numbers) * (1 + structures))
        seconds = _SECONDS_PER_CUBE * rows**3 + _SECONDS_PER_VALUE * rows * lattice.nodes
        system = 2 * 8 * rows**2 + of_sides * lattice.nodes
        nx, ny, _ = lattice.counts
        columns = max(len(plan.triangles) for plan in [entry.planar_mesh(), *_plans(entry)]) / 2
        sizes.append(_FieldSize(lattice.nodes, triangles, math.sqrt(columns / (nx * ny)), system, seconds))
    return sizes


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
    triangles += sum(field.triangles for entry in inputs for field in _fields(entry, structures))
    room = max(free - BYTES_OF_ANY, 0.01 * free)
    share = room / (needed - BYTES_OF_ANY)
    fitting = float(f"{0.9 * triangles * share:.1e}")
    coarser = f"use surfaces of {fitting:,.0f} triangles in all instead of {triangles:,}"
    times = f"{(0.9 * share) ** -0.5:.1f} times as long"
    if any(_fields(entry, structures) for entry in inputs):
        coarser += f", or a resolution of series {times}"
    elif any(entry.rock.interpolates for entry in inputs):
        coarser += f", or an edge length {times}"
    advice.append(coarser)
    advice.append("build fewer surfaces at a time (stage)" if len(inputs) == 1 else "build fewer rock masses")
    whose = "are free" if limit is None else "are allowed"
    raise NotEnoughMemory(
        f"building takes up to {memory_text(needed)} of memory and {memory_text(free)} {whose}",
        needed=needed,
        available=free,
        advice=", or ".join(advice),
    )


def _sheets(entry: RockInput) -> list[Sheet | None]:
    """The surfaces that are no level sets; None where one is not interpolated yet."""
    pairs = zip(entry.rock.surfaces, entry.surfaces, strict=True)
    return [shape for surface, shape in pairs if not entry.rock.is_level_set(surface)]


def _plans(entry: RockInput) -> list[Sheet]:
    """The triangulation of each of them; of one that is not interpolated yet, the region's."""
    return [entry.planar_mesh() if surface is None else surface for surface in _sheets(entry)]


def _triangles(entry: RockInput) -> int:
    return sum(len(triangles) for _, triangles in _plans(entry))


def _on_one_plan(entry: RockInput) -> bool:
    """Whether all surfaces have the same triangles in plan."""
    plans = _plans(entry)
    return all(other.has_plan_of(plans[0]) for other in plans)


def memory_text(size: float) -> str:
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{max(1, round(size / 1e6))} MB"


def _time_text(seconds: float) -> str:
    """To one digit: the estimate is not more precise."""
    for unit, size in (("h", 3600), ("min", 60)):
        if seconds >= 2 * size:
            return f"{float(f'{seconds / size:.0e}'):g} {unit}"
    return f"{float(f'{max(seconds, 0.01):.0e}'):g} s"
