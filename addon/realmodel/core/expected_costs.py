# SPDX-License-Identifier: GPL-3.0-or-later
"""What the steps of a build will cost in proportion to one another: what its progress is divided by."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .measured_costs import COSTS
from .project import Project
from .rock_input import RockInput

_BYTES_PER_TRIANGLE = 40  # of a mesh as text
_MERGE = 0.01  # of the stack builder's time


@dataclass
class Costs:
    """Rough seconds of what comes after reading, of one rock mass."""

    mesh: float = 0.0
    interpolate: float = 0.0
    intersect: float = 0.0

    @property
    def total(self) -> float:
        return self.mesh + self.interpolate + self.intersect


def expected_costs(inputs: Sequence[RockInput], cells: str) -> list[Costs]:
    """For each rock mass what the steps after reading will cost, as `scripts/benchmark.sh --fit` measured."""
    costs = []
    for entry in inputs:
        rock = entry.rock
        triangles = sum(len(shape[1]) for shape in entry.surfaces if shape is not None)
        cost = Costs()
        if rock.interpolates:
            extent = np.ptp(np.concatenate([rock.region, *rock.holes]), axis=0)
            per_surface = min(float(extent[0] * extent[1]) / (0.433 * rock.edge_length**2), 1e9)
            interpolated = sum(surface.interpolated for surface in rock.surfaces)
            cost.mesh = 1e-2 + COSTS["mesh"] * per_surface
            cost.interpolate = interpolated * (1e-2 + COSTS["interpolate"] * per_surface)
            triangles += interpolated * per_surface
        cost.intersect = 0.01 + COSTS[cells]["seconds_per_triangle"] * triangles
        costs.append(cost)
    return costs


@dataclass(frozen=True)
class Shares:
    """Where reading, and intersecting and cutting, end in the progress of a whole build."""

    read: float
    intersect: float


def expected_shares(project: Project, cells: str) -> Shares:
    """From the sizes of files and arrays, before anything is read."""
    size = sum(file.stat().st_size for file in project.input_files() if file.is_file())
    triangles = size / _BYTES_PER_TRIANGLE + sum(
        len(surface.triangles)
        for rock in project.rocks
        for surface in rock.surfaces
        if surface.triangles is not None
    )
    read = 1e-3 + COSTS["read"] * size
    rest = 0.01 + COSTS[cells]["seconds_per_triangle"] * triangles
    return Shares(read / (read + rest), 1.0 - _MERGE * rest / (read + rest))


def stack_pace(inputs: Sequence[RockInput], cells: str) -> Callable[[float], float]:
    """From the fraction that the stack builder counts to the share of its time."""
    shared = all(_on_one_plan(entry) for entry in inputs)
    counted, passed = zip(*COSTS[cells]["pace_shared" if shared else "pace_own"], strict=True)

    def pace(fraction: float) -> float:
        at = min(max(bisect_right(counted, fraction), 1), len(counted) - 1)
        run = counted[at] - counted[at - 1]
        share = (fraction - counted[at - 1]) / run if run > 0 else 1.0
        return passed[at - 1] + (passed[at] - passed[at - 1]) * min(max(share, 0.0), 1.0)

    return pace


def _on_one_plan(entry: RockInput) -> bool:
    """Whether all surfaces of a rock mass stand on one plan mesh."""
    (vertices, triangles), *others = entry.surfaces
    return all(
        (other[1] is triangles or np.array_equal(other[1], triangles))
        and np.array_equal(other[0][:, :2], vertices[:, :2])
        for other in others
    )
