# SPDX-License-Identifier: GPL-3.0-or-later
"""What a model will take before it is built: triangles, cells, memory and time, from counts and a sample."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np

from .build_options import check_cells, check_stage
from .coarse_blocks import coarse_blocks
from .errors import InputRefused, NotEnoughMemory
from .expected_costs import on_one_plan
from .measured_costs import COSTS
from .method_options import check_threads
from .project import Project, check_project, surface_item
from .rock_input import RockInput, mesh_rock, read_rocks
from .sample_windows import Counts, Plan, Window, counted, cut_out, sample_windows, triangles_in
from .stack_refusals import refused_stack
from .surface_heights import rough_heights, where_known
from .work import Cancel, Progress, Work, native_module, run

_TOUCHING = 0.05  # a larger share of vertices in common makes a stack one of many ties
_FEW_NODES = 16
_SHAPE_NODES = 20_000  # show the shape of a surface without points


@dataclass(frozen=True)
class Estimate:
    """What building a project will take; within a factor of 1.5 for surfaces like the benchmark's.

    cell_kind, threads: as asked. triangles: of all surfaces. cells, faces, vertices: of the model. memory:
    bytes that building takes beyond what the process had; model_memory: bytes of the finished arrays, of
    it. seconds: of the whole build on this machine as busy as it is now. available: bytes that were free.
    """

    cell_kind: str
    threads: int
    triangles: int
    cells: int
    faces: int
    vertices: int
    memory: int
    model_memory: int
    seconds: float
    available: int

    @property
    def fits(self) -> bool:
        """Whether building takes no more memory than there is."""
        return self.memory <= self.available

    def table(self) -> str:
        """For people to read on a terminal."""
        rows = [
            ("triangles of all surfaces", f"{self.triangles:,}"),
            (f"cells ({self.cell_kind})", f"about {_rounded(self.cells):,}"),
            ("faces", f"about {_rounded(self.faces):,}"),
            ("vertices", f"about {_rounded(self.vertices):,}"),
            ("memory while building", f"about {memory_text(self.memory)}"),
            ("memory of the model", f"about {memory_text(self.model_memory)}"),
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
    """Tells what build() with the same arguments would take, without building it.

    Files are read and regions meshed in full; of the rest a few small windows are interpolated and built,
    and what was counted and timed in them is scaled (sample_windows) by constants that
    `scripts/benchmark.sh --fit` measures. A small project is its own sample.

    Raises InputRefused for what build() would refuse and the sample shows, UsageError, Cancelled.
    """
    check_cells(cells)
    threads = check_threads(threads)
    check_project(project)
    if stage is not None:
        check_stage(project, stage)
    native_module()

    def task(work: Work) -> Estimate:
        began = time.perf_counter()
        with work.phase(0.0, 0.4, "reading"):
            inputs = read_rocks(work, project)
        if stage is not None:
            inputs = [entry.stage(stage) for entry in inputs]
        with work.phase(0.4, 0.5, "meshing"):
            for entry in inputs:
                mesh_rock(work, entry)
        read = time.perf_counter() - began
        with work.phase(0.5, 1.0, "building a sample"):
            return estimate_of_inputs(work, inputs, cells, threads, read)

    return run(task, progress, cancel)


def estimate_of_inputs(
    work: Work, inputs: list[RockInput], cells: str, threads: int, seconds_before: float = 0.0
) -> Estimate:
    """The estimate of rock masses that are read and meshed, but not interpolated."""
    total = Sample()
    for number, entry in enumerate(inputs):
        total = total + sampled(work, entry, cells, threads)
        work.step((number + 1) / len(inputs))
    return total.estimate(cells, threads, seconds_before)


def memory_bound(inputs: list[RockInput], cells: str) -> float:
    """Bytes that building takes at most, by the number of triangles alone; far more than it mostly is."""
    triangles = sum(len(plan[1]) for entry in inputs for plan in _plans(entry))
    return COSTS[cells]["most_bytes_per_triangle"] * triangles


def require_memory(work: Work, inputs: list[RockInput], cells: str, threads: int, limit: int | None) -> None:
    """Raises NotEnoughMemory, with what to do, where the build would take more than `limit` bytes (None: than
    are free). Only where the bound allows no answer a sample is taken."""
    free = native_module().available_memory() if limit is None else limit
    if memory_bound(inputs, cells) <= free:
        return
    needed = estimate_of_inputs(work, inputs, cells, threads)
    if needed.memory <= free:
        return
    advice = []
    if cells == "columns":
        blocks = estimate_of_inputs(work, inputs, "blocks", threads)
        if blocks.memory <= free:
            advice.append(f'ask for cells="blocks" (about {memory_text(blocks.memory)})')
    triangles = _rounded(0.9 * needed.triangles * free / needed.memory, 2)
    coarser = f"use surfaces of {triangles:,} triangles in all instead of {needed.triangles:,}"
    if any(entry.rock.interpolates for entry in inputs):
        coarser += f", or an edge length {(needed.memory / (0.9 * free)) ** 0.5:.1f} times as long"
    advice.append(coarser)
    advice.append("build fewer surfaces at a time (stage)" if len(inputs) == 1 else "build fewer rock masses")
    whose = "are free" if limit is None else "are allowed"
    raise NotEnoughMemory(
        f"building takes about {memory_text(needed.memory)} of memory and {memory_text(free)} {whose}",
        needed=needed.memory,
        available=free,
        advice=", or ".join(advice),
    )


@dataclass(frozen=True)
class Sample:
    """What sampling found, for all rock masses sampled so far.

    triangles: of the input. counts: expected of the whole. memory: bytes that building it takes. touching:
    the share of the sample's vertices that stand where one of another surface does. built: corners of faces
    that the sample has, its torn edges included. seconds: of the stack builder; interpolating: of giving
    heights.
    """

    triangles: int = 0
    counts: Counts = field(default_factory=Counts)
    memory: float = 0.0
    touching: float = 0.0
    built: int = 0
    seconds: float = 0.0
    interpolating: float = 0.0

    def __add__(self, other: Sample) -> Sample:
        return Sample(
            self.triangles + other.triangles,
            self.counts + other.counts,
            self.memory + other.memory,
            max(self.touching, other.touching),
            self.built + other.built,
            self.seconds + other.seconds,
            self.interpolating + other.interpolating,
        )

    def estimate(self, cells: str, threads: int, seconds_before: float) -> Estimate:
        cell_count, faces, corners, vertices = self.counts.values()
        arrays = 24 * vertices + 20 * faces + 4 * corners + 8 * cell_count + 24 * self.triangles
        return Estimate(
            cells,
            threads,
            self.triangles,
            round(cell_count),
            round(faces),
            round(vertices),
            max(round(self.memory), round(arrays)),
            round(arrays),
            seconds_before + self.interpolating + self.seconds,
            native_module().available_memory(),
        )


def sampled(work: Work, entry: RockInput, cells: str, threads: int, scaled: bool = True) -> Sample:
    """Samples one rock mass that is read and meshed. Not scaled: the seconds are those of the sample."""
    rock = entry.rock
    plans = _plans(entry)
    rings = None if rock.region is None else rock.rings()
    windows, used = sample_windows(plans, rings, cells)
    found, in_windows, built_corners, seconds = Counts(), 0, 0, 0.0
    touching = np.zeros(2, np.int64)
    interpolating = _Interpolating(work, entry, threads)
    for window in windows:
        work.check()
        given, numbers = _given(entry, plans, window, interpolating)
        if not given[0]:
            continue
        try:
            if not built_corners and len(windows) > 1:
                _built(work, given, cells, threads)  # the first is slower: threads start, memory is got
            built, taken = _built(work, given, cells, threads)
        except native_module().InputError as error:
            raise _refused(error, entry, numbers) from error
        seconds += taken
        built_corners += len(built["face_vertices"])
        touching += touching_vertices([vertices for vertices, _ in given[0]])
        found = found + counted(built, window, cells)
        in_windows += sum(triangles_in(window, plan, rings) for plan in plans)
    found = found.times(used / in_windows if in_windows else 0.0)
    kind = stack_kind(on_one_plan(plans), touching[0] / max(1, touching[1]))
    if len(windows) > 1 and built_corners:
        if scaled:
            scale = COSTS[cells][f"scale_{kind}"]
            seconds *= scale["pace"] * (found.corners / built_corners) ** scale["growth"]
        if cells == "blocks":
            coarse = coarse_blocks(entry.rock, [interpolating.places(k) for k in range(len(plans))])
            found = Counts(max(found.cells, coarse), *found.values()[1:])
    triangles = sum(len(plan[1]) for plan in plans)
    return Sample(
        triangles,
        found,
        _memory(cells, kind, triangles, found),
        touching[0] / max(1, touching[1]),
        built_corners,
        seconds,
        interpolating.seconds_of_all(),
    )


def stack_kind(one_plan: bool, touching: float) -> str:
    """What a stack costs as: "own" triangulations, one "shared" plan, or one on which surfaces are "touching"
    often, so that ties have to be decided exactly and blocks fall into many parts.

    touching: the share of vertices that stand where one of another surface does."""
    if not one_plan:
        return "own"
    return "touching" if touching > _TOUCHING else "shared"


def touching_vertices(surfaces: list[np.ndarray]) -> np.ndarray:
    """[how many vertices stand exactly where one before them does, how many there are], of all surfaces'
    vertices (V, 3)."""
    places = np.concatenate(surfaces)
    places = places[np.lexsort(places.T)]
    return np.array([(places[1:] == places[:-1]).all(axis=1).sum(), len(places)], np.int64)


def _memory(cells: str, kind: str, triangles: int, found: Counts) -> float:
    """Bytes that building takes, by the counts of the whole."""
    _, faces, corners, vertices = found.values()
    counted = {"triangles": triangles, "vertices": vertices, "faces": faces, "corners": corners}
    return sum(size * counted[name] for name, size in COSTS[cells][f"bytes_{kind}"].items())


def _built(work: Work, given, cells: str, threads: int) -> tuple[dict, float]:
    """The native result of a window and its seconds."""
    began = time.perf_counter()
    built = work.native(native_module().build_rock_masses, [given], cells=cells, threads=threads)
    return built, time.perf_counter() - began


def _plans(entry: RockInput) -> list[Plan]:
    """The triangulation of each surface; of one that is not interpolated yet, the region's."""
    return [entry.region if surface is None else surface for surface in entry.surfaces]


def _given(entry: RockInput, plans: list[Plan], window: Window, interpolating: _Interpolating):
    """What the stack builder takes for a window, and for each surface there the numbers of its triangles."""
    surfaces, rules, numbers = [], [], []
    for k, plan in enumerate(plans):
        chosen = window.overlapping(plan)
        if not len(chosen):
            continue
        vertices, triangles = cut_out(plan, chosen)
        if entry.surfaces[k] is None:
            z = interpolating.at(k, vertices)
            if not np.isfinite(z)[triangles].all(axis=1).any():
                continue
            vertices, triangles = where_known(vertices, triangles, z)
        surfaces.append((vertices, triangles))
        rules.append(entry.rock.surfaces[k].rule)
        numbers.append((k, chosen))
    region = entry.region
    if region is not None and entry.rock.interpolates:  # fine as the surfaces are: its part will do
        region = cut_out(region, window.overlapping(region))
    return (surfaces, region, entry.rock.base_elevation, rules), numbers


def _refused(error, entry: RockInput, numbers) -> Exception:
    """What the sample was refused for, with the numbers that the user's triangles have."""
    if 0 <= error.surface < len(numbers):
        error.surface, chosen = numbers[error.surface]
        if error.kind in ("vertical_triangle", "double_valued"):
            error.items = [int(chosen[item]) for item in error.items]
    return refused_stack(error, [entry])


class _Interpolating:
    """Heights of the surfaces that have points, at a few of their nodes, and what all of them will cost."""

    def __init__(self, work: Work, entry: RockInput, threads: int):
        self.work, self.entry, self.threads = work, entry, threads
        self._once: dict[int, float] = {}  # seconds of each surface however few nodes it has
        self._per_node: list[float] = []

    def at(self, number: int, nodes: np.ndarray) -> np.ndarray:
        """(N,) heights of a surface at nodes (N, 2). Raises InputRefused."""
        surface = self.entry.rock.surfaces[number]
        try:
            if number not in self._once:
                self._once[number] = self._timed(number, nodes[:_FEW_NODES])[1]
            z, seconds = self._timed(number, nodes)
        except InputRefused as error:
            file, line = surface.shape_source()
            raise error.within(surface_item(self.entry.rock, surface), file=file, line=line) from error
        self._per_node.append(max(0.0, seconds - self._once[number]) / len(nodes))
        return z

    def _timed(self, number: int, nodes: np.ndarray) -> tuple[np.ndarray, float]:
        began = time.perf_counter()
        z = rough_heights(self.work, self.entry, number, nodes, self.threads)
        return z, time.perf_counter() - began

    def places(self, number: int) -> np.ndarray:
        """(N, 3) places that show a surface's shape: its vertices, or its points."""
        given = self.entry.surfaces[number]
        if given is not None:
            return given[0]
        points = self.entry.rock.surfaces[number].points
        if len(points):
            return points
        nodes = np.ascontiguousarray(self.entry.region[0][:: 1 + len(self.entry.region[0]) // _SHAPE_NODES])
        return np.column_stack([nodes, rough_heights(self.work, self.entry, number, nodes, self.threads)])

    def seconds_of_all(self) -> float:
        """Seconds that all nodes of all surfaces that have points will take."""
        if not self._per_node:
            return 0.0
        nodes = len(self._once) * len(self.entry.region[0])
        return sum(self._once.values()) + nodes * float(np.mean(self._per_node))


def _rounded(value: float, digits: int = 3) -> int:
    """To a few significant digits: an estimate has no more."""
    if value < 10**digits:
        return round(value)
    return int(float(f"{value:.{digits - 1}e}"))


def memory_text(size: float) -> str:
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{max(1, round(size / 1e6))} MB"


def _time_text(seconds: float) -> str:
    if seconds >= 3600:
        return f"{seconds / 3600:.1f} h"
    return f"{seconds / 60:.1f} min" if seconds >= 120 else f"{seconds:.2g} s"
