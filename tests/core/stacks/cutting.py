# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with the halves of a cut model, by the outside check's tests of topology and by volumes."""

import io

import numpy as np

from . import places
from .model_view import exported_arrays

ARRAYS = ("vertices", "face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block")


def native_arrays(case, result, cells):
    """A built case as the native cutters take it."""
    arrays = exported_arrays(case, result, cells)
    return arrays | {"blocks": len(arrays["block_names"]), "cell_kind": cells}


def complex_of(model, half=None, touches=False):
    """The outside checker's view of a model, or of a half of it."""
    arrays = dict(model)
    if half is not None:
        arrays |= {name: np.asarray(half[name]) for name in ARRAYS}
        arrays["cell_kind"] = "blocks" if touches else arrays["cell_kind"]
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    buffer.seek(0)
    return places.checker().Complex(buffer)


def topology_failures(m):
    """Cells closed, vertices distinct and used, volumes positive up to rounding."""
    checker = places.checker()
    failures = list(checker.check_shapes(m))
    if not failures and len(m.cell_block):
        for check in (checker.check_vertices, checker.check_closed, checker.check_volumes):
            failures += check(m)
    return failures


def volume_allowance(model, volumes):
    """1e-9 of each volume, and the rounding of coordinates."""
    if not len(model["vertices"]):
        return np.zeros(len(volumes))
    extent = np.ptp(model["vertices"], axis=0)
    step = np.spacing(np.abs(model["vertices"]).max(axis=0))
    rounding = 64 * (step * np.roll(extent, 1) * np.roll(extent, 2)).sum()
    return 1e-9 * np.abs(volumes) + rounding


def proof_failures(model, half, touches):
    """What Model.validate finds wrong with the cells of a half."""
    blocks = model["cell_kind"] == "blocks" or touches
    bases = np.full(model["blocks"], np.nan)  # of the blocks that stand on one
    level = np.flatnonzero(model["face_surface"] == -2)
    corners = model["vertices"][model["face_vertices"][model["face_offsets"][level]]]
    bases[model["cell_block"][model["face_cells"][level, 0]]] = corners[:, 2]
    arrays = {name: half[name] for name in ARRAYS} | {
        "block_volume": np.asarray(half["volumes"]),
        "block_base": bases,
        "surfaces": len(model["surface_vertex_offsets"]) - 1,
        "cells_are_blocks": bool(blocks),
    }
    return [
        f"{test['name']}: {test['failed']} failed, {[o['text'] for o in test['offenders'][:2]]}"
        for test in places.native().check_topology(arrays, places.native().Execution(1))
        if test["failed"]
    ]


def caps_of(half):
    """The caps as sorted tuples of positions, each turned so that its least corner comes first."""
    caps = []
    offsets = half["face_offsets"]
    for f in np.flatnonzero((half["face_surface"] == -3) & (half["face_cells"][:, 1] < 0)):
        corners = half["vertices"][half["face_vertices"][offsets[f] : offsets[f + 1]]].tolist()
        caps.append([tuple(corner) for corner in corners])
    return caps


def _normal(cap):
    """Of one cap, as long as its area."""
    spokes = np.array(cap[1:]) - cap[0]
    return np.cross(spokes[:-1], spokes[1:]).sum(axis=0) / 2


def _vector_area(half):
    """The sum of the normals of all caps."""
    return sum((_normal(cap) for cap in caps_of(half)), np.zeros(3))


def _from_least(corners):
    at = corners.index(min(corners))
    return tuple(corners[at:] + corners[:at])


def cut_failures(model, cut, inside="below", outside="above"):
    """Everything that is wrong with both halves together."""
    failures = []
    for name in (inside, outside):
        failures += [
            f"{name} {text}"
            for text in topology_failures(complex_of(model, cut[name], cut[f"{name}_touches"]))
        ]
    if failures:
        return failures
    for name in (inside, outside):
        failures += [f"{name} {text}" for text in proof_failures(model, cut[name], cut[f"{name}_touches"])]
    whole = np.zeros(model["blocks"])
    if len(model["cell_block"]):
        own = places.checker().cell_volumes(complex_of(model))
        whole = np.bincount(model["cell_block"], weights=own, minlength=model["blocks"])
    off = np.abs(cut[inside]["volumes"] + cut[outside]["volumes"] - whole)
    if (off > volume_allowance(model, whole)).any():
        failures.append(f"volumes: {cut[inside]['volumes']} and {cut[outside]['volumes']} of {whole}")
    for name in (inside, outside):
        half = cut[name]
        if (model["cell_block"][half["cells"]] != half["cell_block"]).any():
            failures.append(f"{name} blocks: a part has another block than its cell")
    caps = [caps_of(cut[name]) for name in (inside, outside)]
    ours = {_from_least(cap) for cap in caps[0]}
    theirs = {_from_least(cap[::-1]) for cap in caps[1]}
    # where cells overlap by rounding, caps that lie on each other become inner faces in one half; where
    # parts are as thin as rounding, their caps may be divided in another way in either half
    gap = np.abs(_vector_area(cut[inside]) + _vector_area(cut[outside])).max()
    step = np.spacing(np.abs(model["vertices"]).max())
    allowed = 1e3 * step * np.ptp(model["vertices"], axis=0).max()
    differing = sum(np.linalg.norm(_normal(cap)) for cap in ours ^ theirs)
    if (len(ours ^ theirs) > 4 and differing > allowed) or gap > allowed:
        failures.append(f"caps: {len(caps[0])} and {len(caps[1])}, not the same turned over")
    return failures
