# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes of blocks: what each surface eroded and each body took, and the uncertainty that follows from
interpolated heights."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from ..base.work import Cancel, Progress, Work, native_module, run
from ..cells.built_cells import native_rocks
from ..cells.joining import build_joined
from ..cells.model_data import ModelData
from ..notebook import ShortRepr
from ..settings.rules import RULES
from ..settings.variogram import lacks_deviation
from ..structures.parts.parts import Structures

_RELATIVE = 1e-12  # how far sums of cells may be off


@dataclass(frozen=True, eq=False, repr=False)
class Erosion(ShortRepr):
    """Eroded volumes, model units cubed.

    volume: (S, B) float64, what surface k (global index) removed of block j: the volume of the block just
    before the surface came, minus the volume just after. remaining: (B,) the present volumes of the model.
    taken: (N, B) float64, the volume of block j that body n (from 0) replaced; this is no erosion.
    """

    volume: np.ndarray
    remaining: np.ndarray
    taken: np.ndarray

    @property
    def by_surface(self) -> np.ndarray:
        """(S,) the total volume that each surface eroded."""
        return self.volume.sum(axis=1)

    @property
    def by_block(self) -> np.ndarray:
        """(B,) the total volume of each block that was eroded."""
        return self.volume.sum(axis=0)

    @property
    def deposited(self) -> np.ndarray:
        """(B,) the deposited volume of each block: the remaining volume, and all volumes eroded or taken
        since."""
        return self.remaining + self.by_block + self.taken.sum(axis=0)

    @property
    def total(self) -> float:
        """The volume of everything that was eroded, model units cubed."""
        return float(self.volume.sum())


def eroded(
    model: ModelData, threads: int = 0, progress: Progress | None = None, cancel: Cancel | None = None
) -> Erosion:
    """Model.eroded."""
    model.require_project("what was eroded")
    return run(lambda work: _eroded(work, model), progress, cancel, threads=threads)


def _eroded(work: Work, model: ModelData) -> Erosion:
    """Computes it backward in time, from the model itself to just before each surface that cuts anything."""
    stages = [m for m in range(_most_surfaces(model) - 1) if any(_cut_at(model, m + 1))]
    arrivals = _arrivals_of_bodies(model)
    names = [body.name for body in model.structures.bodies] if arrivals else []
    remaining = np.array([block.volume for block in model.blocks], np.float64)
    volume = np.zeros((len(model.surface_names), len(model.blocks)))
    after, done, total = remaining, 0, sum(m + 1 for m in stages) + sum(m + 1 for m, _ in arrivals)
    for m in reversed(stages):
        with work.phase(done / total, (done + m + 1) / total, f"building stage {m}"):
            before = _stage_volumes(work, model, m)
        done += m + 1
        # volumes taken by later bodies are no erosion
        came = any(time > m for time, _ in arrivals)
        left = _stage_volumes(work, model, m + 1, (m + 1, 0)) if came else after
        for surface, older in _cut_at(model, m + 1):
            removed = before[older] - left[older]
            volume[surface, older] = np.where(removed > _rounding(model, before[older]), removed, 0.0)
        # back to the next stage nothing cuts, so these are also the volumes just after it
        after = np.where(np.isnan(before), after, before)
    taken = np.zeros((len(names), len(model.blocks)))
    for m, group in itertools.groupby(arrivals, lambda arrival: arrival[0]):
        bodies = [body for _, body in group]
        states = []
        for body in bodies:
            with work.phase(done / total, (done + m + 1) / total, f"building without '{names[body]}'"):
                states.append(_stage_volumes(work, model, m, (m, body)))
            done += m + 1
        last = m == _most_surfaces(model) - 1
        states.append(remaining if last else _stage_volumes(work, model, m))
        for body, before, left in zip(bodies, states, states[1:], strict=False):
            gone = np.nan_to_num(before - left)
            taken[body] += np.where(gone > _rounding(model, np.nan_to_num(before)), gone, 0.0)
    return Erosion(volume, remaining, taken)


def _arrivals_of_bodies(model: ModelData) -> list[tuple[int, int]]:
    """(m, body): that a body came after surface m of some rock mass, oldest first."""
    return sorted({(m, n) for n, times in enumerate(model.structures.times) for m in times.values()})


def _most_surfaces(model: ModelData) -> int:
    return max(len(rock.surfaces) for rock in model.project.rocks)


def _first_surfaces(model: ModelData) -> np.ndarray:
    """(R + 1,) the global index of each rock mass's oldest surface."""
    return np.cumsum([0, *(len(rock.surfaces) for rock in model.project.rocks)])


def _cut_at(model: ModelData, k: int) -> list[tuple[int, np.ndarray]]:
    """For each rock mass whose surface k cuts older rock: its global index, and the older blocks."""
    cuts = []
    first_surfaces = _first_surfaces(model)
    for number, (rock, first) in enumerate(zip(model.project.rocks, first_surfaces[:-1], strict=True)):
        if k < len(rock.surfaces) and RULES[rock.surfaces[k].rule].cuts:
            older = [b for b, block in enumerate(model.blocks) if first <= block.surface < first + k]
            older += _bodies_before(model, number, k)
            if older:
                cuts.append((int(first + k), np.array(older)))
    return cuts


def _bodies_before(model: ModelData, rock: int, k: int) -> list[int]:
    """The blocks of bodies that were in a rock mass before its surface k."""
    first, times = _first_surfaces(model)[-1] + len(model.structures.faults), model.structures.times
    return [
        b
        for b, block in enumerate(model.blocks)
        if block.surface >= first and block.rock == rock and times[block.surface - first].get(rock, k) < k
    ]


def _stage_volumes(work: Work, model: ModelData, m: int, until: tuple[int, int] | None = None) -> np.ndarray:
    """(B,) volumes of the blocks just after surface m; NaN for those that come later. until: with those
    bodies alone that came, as (surface, body), before it; None: all until surface m."""
    first = _first_surfaces(model)
    structures = model.structures
    is_joined = not model.is_stack or any(entry.reaches_base for entry in model.rock_inputs)
    bodies = _with_bodies(structures, until or (m + 1, 0)) if is_joined else None
    counts = [min(len(rock.surfaces), m + 1) for rock in model.project.rocks]
    first_kept = np.cumsum([0, *counts])
    volumes = np.full(len(model.blocks), np.nan)
    if bodies is None:
        volume = work.native(
            native_module().build_rock_masses,
            native_rocks(model, m),
            cells="blocks",
        )["volumes"]
    else:
        inputs = [entry.stage(m) for entry in model.rock_inputs]
        with work.part(*work.stretch):
            volume = build_joined(work, inputs, bodies, "blocks").volumes
    for b, block in enumerate(model.blocks):
        surface = block.surface - first[block.rock]
        body = block.surface - first[-1]
        if body >= 0:
            if bodies is not None and bodies.has_block(body):
                volumes[b] = volume[first_kept[-1] + body]
        elif surface < counts[block.rock]:
            volumes[b] = volume[first_kept[block.rock] + surface]
    return volumes


def _with_bodies(structures: Structures, until: tuple[int, int]) -> Structures:
    """The structures with those bodies alone that came, as (surface, body), before `until`."""
    times = [
        {rock: after for rock, after in times.items() if (after, body) < until}
        for body, times in enumerate(structures.times)
    ]
    return replace(structures, times=times)


def _rounding(model: ModelData, volumes: np.ndarray) -> np.ndarray:
    """The rounding error of volumes: of the sums, and of the coordinates of the corners, each a few units in
    the last place."""
    vertices = model.surface_vertices
    bases = [rock.base_elevation for rock in model.project.rocks if rock.base_elevation is not None]
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    low[2] = min(low[2], *bases) if bases else low[2]
    step = 16 * np.spacing(np.maximum(np.abs(low), np.abs(high)))
    x, y, z = high - low
    return _RELATIVE * volumes + step[0] * y * z + step[1] * x * z + step[2] * x * y


def volume_deviations(model: ModelData) -> np.ndarray:
    """(B,) float64: what the standard deviation of each block's volume is at most, model units cubed; NaN
    where no surface of known variance bounds the block, or one whose data show no variogram.

    The error of a volume is the sum of the errors of heights over the block's contacts. Its standard
    deviation is largest where all these errors are alike: then it is the integral of the standard deviation
    over the contacts (Cauchy and Schwarz), which is what is summed here; errors that differ from place to
    place cancel out in part. Assumed: variances are right (the variogram holds), and errors are small enough
    that the same contacts remain. Ready meshes and walls count as exact.
    """
    deviations = np.full(len(model.blocks), np.nan)
    if not len(model.face_vertices):
        return deviations
    area, middle = plan_areas(model), _middles(model)
    sides = model.face_blocks
    for number in range(len(model.surface_names)):
        variance = model.surface_attributes(number)["variance"]
        faces = np.flatnonzero((model.face_surface == number) & (sides[:, 0] != sides[:, 1]))
        if not np.isfinite(variance).any() or not len(faces):
            continue
        vertices, _ = model.surface(number)
        deviation = np.sqrt(np.maximum(np.nan_to_num(variance), 0.0))
        shape = np.column_stack([vertices[:, :2], deviation])
        places = np.ascontiguousarray(middle[faces])
        sheets = [
            np.nan_to_num(native_module().surface_heights(shape, triangles, places))
            for triangles in model.sheet_triangles(number)
        ]
        here = np.max(sheets, axis=0)  # of the sheets of a surface that faults displace
        for side in sides[faces].T:
            inside = side >= 0
            blocks = side[inside]
            deviations[np.unique(blocks)] = np.nan_to_num(deviations[np.unique(blocks)])
            deviations += np.bincount(blocks, (here * area[faces])[inside], len(deviations))
    deviations[without_deviation(model)] = np.nan
    return deviations


def without_deviation(model: ModelData) -> np.ndarray:
    """(B,) bool: the blocks that a surface bounds whose data show no variogram, so that the variation of
    their volumes is not known."""
    missing = missing_deviations(model)
    lacking = [number for number, name in enumerate(model.surface_names) if name in missing]
    sides = model.face_blocks[np.isin(model.face_surface, lacking)]
    sides = sides[sides[:, 0] != sides[:, 1]]
    return np.isin(np.arange(len(model.blocks)), sides)


def missing_deviations(model: ModelData) -> dict[str, str]:
    """By the names of the surfaces whose data show no variogram (in some compartment): what is missing."""
    return {
        note.surface: note.text for note in model.warnings if note.surface and lacks_deviation([note.text])
    }


def plan_areas(model: ModelData, faces: np.ndarray | None = None) -> np.ndarray:
    """(F,) float64: the areas of a model's faces, or of some of them by their numbers, seen from above."""
    offsets, corners = model.face_offsets, model.face_vertices
    if faces is not None:
        offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    if not len(corners):
        return np.zeros(0)
    x, y = _plan(model, corners)
    first, last = offsets[:-1], offsets[1:] - 1
    doubled = x * _next(y, first, last) - y * _next(x, first, last)
    return np.abs(np.add.reduceat(doubled, first)) / 2


def _middles(model: ModelData) -> np.ndarray:
    """(F, 2) float64: the mean of the corners of each face in plan."""
    first, counts = model.face_offsets[:-1], np.diff(model.face_offsets)
    x, y = (np.add.reduceat(values, first) / counts for values in _plan(model, model.face_vertices))
    return np.column_stack([x, y]) + model.vertices[0, :2]


def _plan(model: ModelData, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x and y of corners, relative to the first vertex."""
    plan = model.vertices[:, :2] - model.vertices[:1, :2]
    x, y = (np.ascontiguousarray(plan[:, axis])[corners] for axis in range(2))
    return x, y


def _next(values: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """For each corner of polygons the value at the next corner."""
    following = np.empty_like(values)
    following[:-1] = values[1:]
    following[last] = values[first]
    return following
