# SPDX-License-Identifier: GPL-3.0-or-later
"""The compartments into which faults divide a rock mass: the combinations of sides that there are."""

from __future__ import annotations

import itertools

import numpy as np

from ..errors import InputRefused
from ..work import Work
from .sides import RockFaults, fault_sides
from .triangles import divided

_CELLS = (48, 48, 16)  # of the grid, at most
_MOST = 4096  # compartments
_MINUS, _PLUS, _BOTH = 1, 2, 3  # sides that a cell may have points on


def compartments(
    work: Work, faults: RockFaults, low: np.ndarray, high: np.ndarray, threads: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """The combinations of sides in a box: (C, F) int8 of -1 and +1, 0 where a branch is not there; and (C,)
    bool, whether a point of the box has been seen in it.

    The box is divided into cells. A cell that a fault may pass has points on both sides of it; so nothing is
    missed, but a combination may be listed that no point has. Raises InputRefused for more than 4096.
    """
    count = len(faults)
    if not count:
        return np.zeros((1, 0), np.int8), np.ones(1, bool)
    size = np.maximum(high - low, 1e-9 * np.abs(np.concatenate([low, high])).max() + 1e-300)
    cells = np.maximum(1, np.minimum(_CELLS, np.ceil(size / (size[:2].max() / _CELLS[0])))).astype(int)
    middles = _middles(low, size, cells)
    masks, sides = [], []
    for number, shape in enumerate(faults.shapes):
        work.step(number / count)
        side = fault_sides(work, middles, shape, threads)
        sides.append(side)
        masks.append(_possible(shape, side.reshape(cells), low, size, cells).ravel())
    seen = set(map(tuple, np.unique(faults.without_dropped(np.column_stack(sides)), axis=0).tolist()))
    found = set(seen)
    choice = {_MINUS: (-1,), _PLUS: (1,), _BOTH: (-1, 1)}
    for row in np.unique(np.column_stack(masks), axis=0).tolist():
        options = [choice[mask] for mask in row]
        if np.prod([float(len(each)) for each in options]) > _MOST:
            raise InputRefused(
                f"more than {_MOST} compartments: {sum(mask == _BOTH for mask in row)} faults run together",
                advice="leave out faults that lie on one another, or set 'ends_at'",
            )
        given = np.array(list(itertools.product(*options)), np.int8)
        found.update(map(tuple, faults.without_dropped(given).tolist()))
        if len(found) > _MOST:
            raise InputRefused(f"more than {_MOST} compartments", advice="set 'ends_at', or leave out faults")
    every = sorted(found)
    return np.array(every, np.int8), np.array([row in seen for row in every], bool)


def _middles(low: np.ndarray, size: np.ndarray, cells: np.ndarray) -> np.ndarray:
    axes = [low[k] + size[k] * (np.arange(cells[k]) + 0.5) / cells[k] for k in range(3)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def _possible(shape, side: np.ndarray, low: np.ndarray, size: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """(nx, ny, nz) on which sides of a fault points of each cell may lie. side: of the cells' middles."""
    step = size / cells
    passed = np.zeros(cells, bool)
    pieces = divided(*shape, float(step.max()), low, low + size)
    if len(pieces):
        first = np.clip(np.floor((pieces.min(axis=1) - low) / step - 1e-6), 0, cells - 1).astype(int)
        last = np.clip(np.floor((pieces.max(axis=1) - low) / step + 1e-6), 0, cells - 1).astype(int)
        for move in itertools.product(*(range(int(most) + 1) for most in (last - first).max(axis=0))):
            at = first + move
            passed[tuple(at[(at <= last).all(axis=1)].T)] = True
    # where the fault goes on beyond its border the side changes between cells that it does not pass
    beyond = np.zeros(cells, bool)
    for axis in range(3):
        one, other = (_part(axis, slice(None, -1)), _part(axis, slice(1, None)))
        changes = (side[one] != side[other]) & ~passed[one] & ~passed[other]
        beyond[one] |= changes
        beyond[other] |= changes
    for axis in range(3):
        one, other = (_part(axis, slice(None, -1)), _part(axis, slice(1, None)))
        wider = beyond.copy()
        wider[one] |= beyond[other]
        wider[other] |= beyond[one]
        beyond = wider
    return np.where(passed | beyond, _BOTH, np.where(side > 0, _PLUS, _MINUS)).astype(np.uint8)


def _part(axis: int, part: slice) -> tuple:
    return tuple(part if k == axis else slice(None) for k in range(3))


def compartment_names(faults: RockFaults, rows: np.ndarray) -> list[str]:
    """A name for each combination of sides: "F1 +, F2 -"."""
    signs = {1: "+", -1: "-"}
    return [
        ", ".join(f"{name} {signs[side]}" for name, side in zip(faults.names, row, strict=True) if side)
        for row in rows.tolist()
    ]
