# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with the model that is built of a case: every oracle in one place.

A failure is "kind: sentence"; the kinds are what the minimizer holds on to.
"""

import numpy as np

from . import places
from .face_checks import surface_failures, wall_failures
from .model_view import block_surfaces, built, checked_complex, checker_rocks, digest, rocks_of
from .rational import block_volumes

ASKED_AGAIN = ("wall sides", "not on surface", "not vertical")
KINDS = (
    "equal vertices",
    "unused vertices",
    "repeat a vertex",
    "not closed",
    "negative volume",
    "flat cells",
    "columns differ",
    "not on surface",
    "lie off surface",
    "not vertical",
    "wall sides",
    "no faces",
    "without faces",
)


def exact_volumes(case):
    """Exact volumes of the blocks beneath all surfaces of all rock masses, a list of fractions."""
    return [
        volume
        for stack in rocks_of(case)
        for volume in block_volumes(stack.surfaces, stack.rules, stack.region, stack.base_elevation)
    ]


def volume_allowance(case, exact):
    """How far each block volume may be off: 1e-9 of it, and the rounding of the coordinates themselves."""
    corners = [v[np.unique(t)] for stack in rocks_of(case) for v, t in stack.surfaces if len(t)]
    corners = np.concatenate(corners) if corners else np.zeros((1, 3))
    bases = [stack.base_elevation for stack in rocks_of(case) if stack.base_elevation is not None]
    low, high = corners.min(axis=0), corners.max(axis=0)
    low[2] = min([low[2], *bases])
    extent = high - low
    step = np.spacing(np.maximum(np.abs(low), np.abs(high)))
    area = extent[0] * extent[1]
    around = (step[0] * extent[1] + step[1] * extent[0]) * extent[2]
    rounding = 64 * (step[2] * area + around)
    return [1e-9 * abs(float(v)) + rounding for v in exact]


def were_borders_joined(result):
    """Whether the builder made borders one that differ by rounding: what lay between them is gone then."""
    return any(kind == "joined" for kind, *_ in result["warnings"])


def kind_of(sentence):
    """Which test of the outside check a sentence comes from."""
    return next((words for words in KINDS if words in sentence), "shape")


def _volume_failures(case, result, exact, allowed, cells):
    volumes = np.asarray(result["volumes"])
    if volumes.shape != (len(exact),):
        return [f"{cells} volumes: shape {volumes.shape} for {len(exact)} surfaces"]
    present = np.bincount(np.asarray(result["cell_block"]), minlength=len(exact))
    possible = set(block_surfaces(case).tolist())
    exactly = not were_borders_joined(result)
    failures = []
    for k in range(len(exact)):
        if k in possible and abs(volumes[k] - float(exact[k])) > allowed[k]:
            failures.append(f"{cells} volume: block {k} has {volumes[k]!r}, exactly {float(exact[k])!r}")
        if present[k] and not exact[k] and (exactly or k not in possible):
            failures.append(f"{cells} sliver: block {k} has {present[k]} cells, its exact volume is zero")
    return failures


def _sum_failures(case, result, m, allowed, cells):
    """The reported volumes are those of the cells, computed independently by the divergence theorem."""
    own = places.checker().cell_volumes(m)
    summed = np.bincount(result["cell_block"], weights=own, minlength=len(allowed))
    for k in block_surfaces(case):
        if abs(summed[k] - result["volumes"][k]) > allowed[k]:
            yield f"{cells} sum: block {k} has {result['volumes'][k]!r}, its cells sum to {summed[k]!r}"


def _outside_failures(m, rocks, samples):
    """What check_model.py finds; its samples beside walls and on faces are asked again more finely."""
    with np.errstate(all="ignore"):
        found = places.checker().check_all(m, rocks, samples)
        coarse = [sentence for sentence in found if kind_of(sentence) in ASKED_AGAIN]
        if coarse:
            found = [sentence for sentence in found if sentence not in coarse]
            found += surface_failures(m)
            # walls of block cells are those of the columns, which were asked; slivers are part of large cells
            found += [] if m.cells_are_blocks else wall_failures(m, rocks)
    return found


def _parts(result):
    """Number of connected parts (through shared faces) of each block of a columns model."""
    cells, block = np.asarray(result["face_cells"]), np.asarray(result["cell_block"])
    parent = np.arange(len(block))

    def root(i):
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for a, b in cells:
        if b >= 0 and block[a] == block[b]:
            parent[root(a)] = root(b)
    roots = [i for i in range(len(block)) if root(i) == i]
    return np.bincount(block[roots], minlength=1)


def _difference(columns, blocks, allowed):
    """Columns and blocks are the same model: volumes, and one block cell for each connected part."""
    for k, (a, b) in enumerate(zip(columns["volumes"], blocks["volumes"], strict=True)):
        if abs(a - b) > allowed[k]:
            yield f"kinds volume: block {k} has {a!r} as columns, {b!r} as a block"
    parts = _parts(columns)
    cells = np.bincount(np.asarray(blocks["cell_block"]), minlength=len(parts))
    if len(cells) != len(parts) or (cells != parts).any():
        yield f"kinds parts: the columns make {parts.tolist()} connected parts, the blocks {cells.tolist()}"


def _bytes_of(case):
    arrays = [a for stack in rocks_of(case) for surface in stack.surfaces for a in surface]
    arrays += [a for stack in rocks_of(case) for a in stack.region or ()]
    return [array.tobytes() for array in arrays]


def failures_of(case, samples=1200, kinds=("columns", "blocks")):
    """All failures of one case; an empty list where every oracle agrees."""
    before = _bytes_of(case)
    exact = exact_volumes(case)
    allowed = volume_allowance(case, exact)
    failures, results = [], {}
    for cells in kinds:
        try:
            result = built(case, cells=cells, threads=1)
        except Exception as error:
            failures.append(f"{cells} refused: {type(error).__name__}: {error}")
            continue
        results[cells] = result
        failures += _volume_failures(case, result, exact, allowed, cells)
        if places.checker() is not None:
            m = checked_complex(case, result, cells)
            found = _outside_failures(m, checker_rocks(case), samples)
            failures += [f"{cells} {kind_of(sentence)}: {sentence}" for sentence in found]
            if not found:
                failures += _sum_failures(case, result, m, allowed, cells)
        if cells == "columns" and digest(result) != digest(built(case, threads=2)):
            failures.append(f"{cells} threads: 1 and 2 threads give different bytes")
    if len(results) == 2 and not failures:
        failures += _difference(results["columns"], results["blocks"], allowed)
    if _bytes_of(case) != before:
        failures.append("input changed: an array given to the builder")
    return failures


def kinds_of(failures):
    """The kinds of a list of failures."""
    return {failure.split(":", 1)[0] for failure in failures}
