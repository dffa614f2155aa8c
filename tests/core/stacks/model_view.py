# SPDX-License-Identifier: GPL-3.0-or-later
"""Building test cases, and a built model as the outside checker reads it: arrays with blocks and rock masses.

A case is one Stack, or a list of Stacks: rock masses that share borders at most.
"""

import hashlib
import io

import numpy as np

from . import places
from .case import Stack

ARRAYS = ("vertices", "face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block")


def rocks_of(case):
    """The rock masses of a case."""
    return [case] if isinstance(case, Stack) else list(case)


def built(case, threads=0, **options):
    """What the native builder makes of a case; options: cells."""
    native = places.native()
    options["execution"] = native.Execution(threads)
    if isinstance(case, Stack):
        rules = list(case.rules)
        return native.build_stack(case.surfaces, case.region, case.base_elevation, rules=rules, **options)
    rocks = [(stack.surfaces, stack.region, stack.base_elevation, list(stack.rules)) for stack in case]
    return native.build_rock_masses(rocks, **options)


def digest(result):
    """One digest of all arrays of a result."""
    total = hashlib.sha256()
    for name in (*ARRAYS, "volumes"):
        array = np.ascontiguousarray(result[name])
        total.update(f"{name} {array.dtype} {array.shape}".encode())
        total.update(array.tobytes())
    return total.hexdigest()


def block_surfaces(case):
    """(B,) the surface, counted through all rock masses, that each possible block lies beneath."""
    numbers, first = [], 0
    for stack in rocks_of(case):
        lowest = 0 if stack.base_elevation is not None else 1
        numbers += range(first + lowest, first + len(stack.surfaces))
        first += len(stack.surfaces)
    return np.array(numbers, np.int32)


def exported_arrays(case, result, cells):
    """The arrays that an .npz of the model would hold."""
    surfaces = [surface for stack in rocks_of(case) for surface in stack.surfaces]
    members = block_surfaces(case)
    block_of = np.full(len(surfaces), -1, np.int32)
    block_of[members] = np.arange(len(members))
    rock_of = np.repeat(np.arange(len(rocks_of(case))), [len(stack.surfaces) for stack in rocks_of(case)])
    return {
        **{name: np.asarray(result[name]) for name in ARRAYS},
        "cell_block": block_of[np.asarray(result["cell_block"])],
        "cell_kind": np.array(cells),
        "block_names": np.array([f"block {k}" for k in members], dtype="U16"),
        "block_property": np.zeros(len(members), np.int32),
        "block_surface": members,
        "block_rock": rock_of[members].astype(np.int32),
        "surface_vertices": np.concatenate([v for v, _ in surfaces]),
        "surface_triangles": np.concatenate([t for _, t in surfaces]),
        "surface_vertex_offsets": np.cumsum([0] + [len(v) for v, _ in surfaces]).astype(np.int64),
        "surface_triangle_offsets": np.cumsum([0] + [len(t) for _, t in surfaces]).astype(np.int64),
    }


def checked_complex(case, result, cells):
    """The outside checker's view of a result."""
    buffer = io.BytesIO()
    np.savez(buffer, **exported_arrays(case, result, cells))
    buffer.seek(0)
    return places.checker().Complex(buffer)


def checker_rocks(case):
    """The rows that the outside checker wants for the rock masses."""
    block_of = {int(surface): block for block, surface in enumerate(block_surfaces(case))}
    rows, first = [], 0
    for stack in rocks_of(case):
        members = list(range(first, first + len(stack.surfaces)))
        blocks = [block_of.get(s, -1) for s in members]
        rows.append((members, stack.all_rules(), stack.base_elevation, blocks, stack.region_rings()))
        first += len(stack.surfaces)
    return rows
