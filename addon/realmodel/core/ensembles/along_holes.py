# SPDX-License-Identifier: GPL-3.0-or-later
"""What the realizations of an ensemble meet along a planned hole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..base.work import Work
from ..model.planned_hole import PlannedHole
from ..proof.closed_form import ClosedForm, blocks_of_all
from ..results.planned_holes import HoleAxis, HoleContact, mean_share
from ..results.volume_uncertainty import missing_deviations
from .realization import Realizer

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
