# SPDX-License-Identifier: GPL-3.0-or-later
"""What the native module builds of rock masses, and how it takes them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..surfaces.planar_mesh import triangulate_rings
from .cell_complex import CellComplex
from .model_data import ModelData


class NativeWarning(NamedTuple):
    """surface: its global index, below 0 where there is none. items: of that surface, by `kind`."""

    kind: str
    surface: int
    items: tuple[int, ...]
    text: str


@dataclass(frozen=True, eq=False)
class CellParts:
    """Where cells are. part: (C,) int32, the part of space of each cell.
    own_block: (C,) int32, its block with those of bodies as body_block numbers them. rock: (B,) int32, the
    rock mass of these blocks. divided: (S, B) uint8, whether a structure divides such a block."""

    part: np.ndarray
    own_block: np.ndarray
    rock: np.ndarray
    divided: np.ndarray


@dataclass(frozen=True, eq=False)
class BuiltCells:
    """The cells of all rock masses. Blocks have the numbers of the surfaces above them, those of bodies the
    numbers of their structures, counted after all surfaces; so have faces. volumes: (S,) float64 of these
    blocks."""

    complex: CellComplex
    volumes: np.ndarray
    parts: CellParts
    warnings: list[NativeWarning]


def native_rocks(model: ModelData, stage: int | None = None) -> list[tuple]:
    """For each rock mass (surfaces, region, base elevation, rules), the surfaces up to `stage` only where it
    is given; regions as triangulations. Models that were put together from arrays know their project only."""
    rocks, first = [], 0
    for number, rock in enumerate(model.project.rocks):
        count = len(rock.surfaces)
        end = count if stage is None else min(count, stage + 1)
        surfaces = [model.surface(first + k) for k in range(end)]
        if model.rock_inputs:
            meshed = model.rock_inputs[number].region
            region = None if meshed is None else meshed.arrays
        else:
            region = triangulate_rings(rock.rings()) if rock.region is not None else None
        rules = [surface.rule for surface in rock.surfaces[:end]]
        rocks.append((surfaces, region, rock.base_elevation, rules))
        first += count
    return rocks
