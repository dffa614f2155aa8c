# SPDX-License-Identifier: GPL-3.0-or-later
"""From the faults and bodies of a project to the compartments of its rock masses."""

from __future__ import annotations

import numpy as np

from ..errors import InputRefused
from ..project import rock_item
from ..work import Work
from .branches import faults_of_rock
from .compartments import compartment_names, compartments
from .entries import Body, Fault
from .history import body_times
from .rock_structure import RockStructure

_BEYOND = 0.25  # of the range of heights of the data: how far above and below there may be rock


def add_structures(
    work: Work, project, faults: list[Fault], bodies: list[Body], inputs: list, threads: int = 0
) -> None:
    """Gives each rock mass (RockInput, read but not interpolated) with faults or bodies its compartments.

    faults, bodies: those of the project, with arrays. Raises InputRefused.
    """
    for number, entry in enumerate(inputs):
        here = faults_of_rock(work, project, faults, number, threads)
        its_bodies = [
            (body, times[number])
            for body, times in enumerate(body_times(project, each) for each in bodies)
            if number in times
        ]
        if not len(here) and not its_bodies:
            continue
        try:
            low, high = _box(entry, here)
            rows, seen = compartments(work, here, low, high, threads)
        except InputRefused as error:
            raise error.within(rock_item(entry.rock)) from error
        names = compartment_names(here, rows)
        sheets = [[None] * len(entry.surfaces) for _ in rows]
        entry.structure = RockStructure(here, rows, seen, names, sheets, its_bodies)


def _box(entry, faults) -> tuple[np.ndarray, np.ndarray]:
    """Two corners (3,) of a box around all rock that there may be."""
    plan, heights = [], []
    if entry.region is not None:
        plan.append(entry.region[0])
    for surface, shape in zip(entry.rock.surfaces, entry.surfaces, strict=True):
        given = shape[0] if shape is not None else np.asarray(surface.points, np.float64).reshape(-1, 3)
        heights.append(given[:, 2])
        if entry.region is None:
            plan.append(given[:, :2])
    if entry.rock.base_elevation is not None:
        heights.append(np.array([entry.rock.base_elevation]))
    if not any(map(len, heights)):
        heights = [vertices[:, 2] for vertices, _ in faults.shapes]
    places, z = np.concatenate(plan), np.concatenate(heights)
    low, high = (np.append(corner(places, axis=0), corner(z)) for corner in (np.min, np.max))
    margin = np.array([0.0, 0.0, _BEYOND * (high[2] - low[2])])
    return low - margin, high + margin
