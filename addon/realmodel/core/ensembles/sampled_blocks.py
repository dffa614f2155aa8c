# SPDX-License-Identifier: GPL-3.0-or-later
"""The blocks that the realizations of an ensemble have at samples: the centers of cells of a section, a
fence, a borehole or a regular grid, and along a planned hole."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ..base.algebra import dot
from ..base.errors import UsageError
from ..base.text import no_step
from ..base.work import Work
from ..cells.model_data import ModelData
from ..exporters import SAMPLES
from ..model.cutting import Fence, Section
from ..model.planned_hole import PlannedHole
from ..results.model_holes import HoleAxis, HoleContact, mean_share
from ..results.samples import (
    BoreholeSamples,
    GridSamples,
    HoleSamples,
    Probabilities,
    Samples,
    SectionSamples,
    checked_size,
    frame_of,
)
from ..results.sections.section_drawing import directions, flattened, is_vertical, plane_of
from ..results.volumes import missing_deviations
from ..validation.closed_form import ClosedForm, blocks_of_all
from .realization import Realizer

MOST_PLACES = 20_000_000  # times blocks
_COLUMNS, _ROWS = 200, 100  # of a section, where no size is given
_BEYOND = 0.05  # of the height of a section: heights that are drawn leave those of the model


def section_samples(
    model: ModelData, section: Section, size: float | Sequence[float] | None = None
) -> SectionSamples:
    """Samples of a section of the model by a plane, or of a fence. size: of cells, in plan and in height (of
    a level plane along x and y); None: 200 columns and 100 rows. Raises UsageError where the section is
    empty."""
    if not len(section):
        raise UsageError("the section does not meet the model: choose another one")
    flat = flattened(section)
    low, high = flat.min(axis=0), flat.max(axis=0)
    if isinstance(section, Fence):
        low[0], high[0] = 0.0, section.length
    if is_vertical(section):
        beyond = _BEYOND * (high[1] - low[1])
        low[1], high[1] = low[1] - beyond, high[1] + beyond
    extent = np.maximum(high - low, 1e-9 * max(np.abs(flat).max(), 1.0))
    if size is None:
        steps = extent / (_COLUMNS, _ROWS)
    else:
        sizes = checked_size(model, size)
        steps = sizes[[0, 2]] if is_vertical(section) else sizes[:2]
    rows = _bounds(low[1], high[1], steps[1])
    if isinstance(section, Fence):
        pieces = [_bounds(*ends, steps[0]) for ends in itertools.pairwise(section.bends.tolist())]
        panels = np.repeat(np.arange(len(pieces)), [len(piece) - 1 for piece in pieces])
        left, right = (np.concatenate([piece[cut] for piece in pieces]) for cut in (np.s_[:-1], np.s_[1:]))
    else:
        columns = _bounds(low[0], high[0], steps[0])
        left, right = columns[:-1], columns[1:]
        panels = np.zeros(len(left), int)
    _check(model, len(left) * (len(rows) - 1))
    u = np.tile(np.stack([left, right, right, left], axis=1), (len(rows) - 1, 1))
    v = np.repeat(np.stack([rows[:-1], rows[:-1], rows[1:], rows[1:]], axis=1), len(left), axis=0)
    cells = np.stack([u, v], axis=2)
    corners = _in_space(section, cells, np.tile(panels, len(rows) - 1))
    return SectionSamples(corners.mean(axis=1), section, corners, cells, len(left))


def borehole_samples(model: ModelData, x: float, y: float, height: float | None = None) -> BoreholeSamples:
    """Samples of the vertical line at (x, y) through the whole height of the model. height: of cells; None: a
    hundredth. Raises UsageError."""
    low, high = float(model.vertices[:, 2].min()), float(model.vertices[:, 2].max())
    beyond = _BEYOND * (high - low)
    bounds = _bounds(low - beyond, high + beyond, height or (high - low + 2 * beyond) / _ROWS)
    _check(model, len(bounds) - 1)
    middle = (bounds[1:] + bounds[:-1])[::-1] / 2
    return BoreholeSamples(
        np.column_stack([np.full((len(middle), 2), (x, y)), middle]), float(bounds[1] - bounds[0])
    )


def hole_samples(model: ModelData, axis: HoleAxis, step: float | None = None) -> HoleSamples:
    """Samples along a planned hole of a model. axis: the hole. step: the length of cells; None: a hundredth
    of the hole. Raises UsageError."""
    bounds = _bounds(0.0, axis.length, step or axis.length / _ROWS)
    _check(model, len(bounds) - 1)
    depths = (bounds[1:] + bounds[:-1]) / 2
    return HoleSamples(axis.places(depths), depths)


def grid_samples(model: ModelData, size: float | Sequence[float] | None = None) -> GridSamples:
    """Samples at the cells of a regular grid that covers the model, with some more above and below. size: of
    the cells, as the cell_size of Model.save. Raises UsageError."""
    cell = checked_size(model, size)
    lowest, (nx, ny, nz) = frame_of(model, cell)
    beyond = math.ceil(_BEYOND * nz)
    origin, counts = lowest - np.array([0.0, 0.0, beyond * cell[2]]), (nx, ny, nz + 2 * beyond)
    _check(model, math.prod(counts))
    z, y, x = np.indices(counts[::-1]).reshape(3, -1)
    places = origin + (np.column_stack([x, y, z]) + 0.5) * cell
    return GridSamples(places, origin, cell, counts)


def _check(model: ModelData, places: int) -> None:
    blocks = max(len(model.blocks), 1)
    if places * blocks > MOST_PLACES:
        raise UsageError(
            f"{places} places for {blocks} blocks are more than the {MOST_PLACES // blocks} that an ensemble "
            "takes; choose larger cells"
        )


def _bounds(low: float, high: float, step: float) -> np.ndarray:
    """The bounds of cells of equal size from low to high, about a step long."""
    return np.linspace(low, high, max(1, round(min((high - low) / step, MOST_PLACES))) + 1)


def _in_space(section: Section, flat: np.ndarray, panels: np.ndarray) -> np.ndarray:
    """(N, 4, 3) of positions (N, 4, 2) in the drawing of a section; panels: (N,), of a fence."""
    u, v = flat[:, :, 0], flat[:, :, 1]
    if isinstance(section, Fence):
        starts, ends = section.polyline[:-1], section.polyline[1:]
        bends = section.bends
        share = (u - bends[panels][:, None]) / np.diff(bends)[panels][:, None]
        plan = starts[panels][:, None] + share[:, :, None] * (ends - starts)[panels][:, None]
        return np.concatenate([plan, v[:, :, None]], axis=2)
    right, up = directions(section)
    point, _ = plane_of(section)
    if right is None or up is None:
        return np.stack([u, v, np.full(u.shape, point[2])], axis=2)
    # drawings begin at the lowest coordinate
    u = u + (dot(section.vertices - point, right)).min()
    v = v + (-point[2] if is_vertical(section) else (dot(section.vertices - point, up)).min())
    return point + u[:, :, None] * right + v[:, :, None] * up


def sample_writer(path: str | Path, kind: str, exaggeration: float = 1.0) -> Callable[..., None]:
    """The function (samples, probabilities, file) for files of this ending. kind: "section", "borehole" or
    "grid". exaggeration: of heights in drawings. Raises UsageError."""
    exporter = SAMPLES[kind]
    file_format = exporter.format(path)

    def write(samples: Samples, probabilities: Probabilities, file: BinaryIO) -> None:
        content = exporter.view(file_format, (samples, probabilities), {"exaggeration": exaggeration})
        file_format.write(content, file, no_step)

    return write


_STEPS = 500  # places along a hole
_HALVINGS = 24  # of the step between two places, to find a contact

Contacts = dict[tuple[int, int], list[float]]  # depths, rising, by the blocks above and below


def hole_of_realizations(work: Work, realizer: Realizer, count: int, hole: PlannedHole) -> PlannedHole:
    """A hole of the model with what `count` realizations say of it."""
    axis, names = hole.axis, hole.block_names
    depths = (np.arange(_STEPS) + 0.5) / _STEPS * axis.length
    counts = np.zeros((_STEPS, len(names)))
    contacts: list[Contacts] = []
    steps = np.linspace(0.0, 1.0, count + 1)
    for number in range(count):
        with work.part(*steps[number : number + 2]):
            forms = realizer.closed_forms(work, number)
        blocks = blocks_of_all(work, forms, axis.places(depths))
        counts += blocks[:, None] == np.arange(len(names))
        contacts.append(_contacts(work, forms, axis, depths, blocks))
    shares = counts / count
    intervals = [
        replace(piece, probability=mean_share(shares[:, piece.block], depths, piece.begin, piece.end))
        for piece in hole.intervals
    ]
    spread = [_spread(contact, hole.contacts, contacts) for contact in hole.contacts]
    lacking = missing_deviations(realizer.model)
    spread = [
        replace(contact, deviation=None) if old.deviation is None and old.surface in lacking else contact
        for contact, old in zip(spread, hole.contacts, strict=True)
    ]
    return replace(hole, intervals=intervals, contacts=spread, depths=depths, probability=shares)


def _contacts(
    work: Work, forms: list[ClosedForm], axis: HoleAxis, depths: np.ndarray, blocks: np.ndarray
) -> Contacts:
    """The contacts of a realization, by halving the steps in which the block changes."""
    at = np.flatnonzero(blocks[1:] != blocks[:-1])
    low, high = depths[at], depths[at + 1]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        is_above = blocks_of_all(work, forms, axis.places(middle)) == blocks[at]
        low, high = np.where(is_above, middle, low), np.where(is_above, high, middle)
    contacts: Contacts = {}
    for row, depth in zip(at.tolist(), (0.5 * (low + high)).tolist(), strict=True):
        contacts.setdefault((int(blocks[row]), int(blocks[row + 1])), []).append(depth)
    return contacts


def _spread(contact: HoleContact, every: Sequence[HoleContact], draws: Sequence[Contacts]) -> HoleContact:
    """A contact with the standard deviation of its depth in the realizations that have it. Where the model
    has several between the same blocks, the nearest of a realization counts."""
    pair = contact.above, contact.below
    rivals = [other.depth for other in every if (other.above, other.below) == pair]
    depths = []
    for contacts in draws:
        near = [
            depth
            for depth in contacts.get(pair, ())
            if min(rivals, key=lambda rival: abs(rival - depth)) == contact.depth
        ]
        if near:
            depths.append(min(near, key=lambda depth: abs(depth - contact.depth)))
    deviation = float(np.std(depths, ddof=1)) if len(depths) > 1 else None
    return replace(contact, deviation=deviation, share=len(depths) / len(draws))
