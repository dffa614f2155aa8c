# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes of models, Booleans and cuts beside exact rationals and Manifold."""

from __future__ import annotations

import itertools
import time
from fractions import Fraction
from random import Random

import manifold3d
import numpy as np
import solids
import test_booleans
from benchmarks import structures
from realmodel.core import intersect
from realmodel.core.base.errors import RealModelError
from stacks.generate import FAMILIES, random_stack
from stacks.judge import exact_volumes, volume_allowance, were_borders_joined
from stacks.model_view import built

STACKS = 20  # of each family
POSITIONS = 6  # of each pair of scans
CUTS = ({"surfaces": 3, "quads": 12}, {"surfaces": 5, "quads": 40}, {"surfaces": 8, "quads": 80})
RINGS = 24  # of the sphere that cuts


def exact() -> dict:
    began = time.process_time()
    stacks = _stacks()
    print(stacks, flush=True)
    booleans = _booleans()
    print(booleans, flush=True)
    cuts = _cuts()
    print(cuts, flush=True)
    return {
        "stacks": stacks,
        "booleans": booleans,
        "cuts": cuts,
        "seconds": round(time.process_time() - began, 1),
    }


def _stacks() -> dict:
    """Random stacks of triangulated surfaces: the volume of each block beside that of
    tests/core/stacks/rational.py. median: of the largest deviations of stacks, in shares of the largest
    block; beyond: blocks that are off by more than the rounding of coordinates explains; wrong: that are
    there though their exact volume is 0, or the other way round; joined: stacks whose borders were made one,
    which are not compared."""
    worst, blocks, wrong, beyond, joined, refused, made = [], 0, 0, 0, 0, 0, 0
    for family in sorted(FAMILIES):
        for seed in range(STACKS):
            stack = random_stack(Random(f"{family} {seed}"), family)
            try:
                result = built(stack, threads=1)
            except (ValueError, RealModelError):
                refused += 1
                continue
            truth = exact_volumes(stack)
            made += 1
            if were_borders_joined(result):
                joined += 1
                continue
            size = float(max(truth, default=0))
            present = np.bincount(np.asarray(result["cell_block"], int), minlength=len(truth)) > 0
            blocks += sum(volume > 0 for volume in truth)
            wrong += sum(bool(here) != (volume > 0) for here, volume in zip(present, truth, strict=True))
            if size:
                off = [abs(Fraction(float(v)) - t) for v, t in zip(result["volumes"], truth, strict=True)]
                allowed = volume_allowance(stack, truth)
                beyond += sum(far > most for far, most in zip(off, allowed, strict=True))
                worst.append(float(max(off)) / size)
    return {
        "families": len(FAMILIES),
        "stacks": made,
        "blocks": int(blocks),
        "wrong": int(wrong),
        "beyond": int(beyond),
        "median": float(np.median(worst)),
        "joined": joined,
        "refused": refused,
    }


def _manifold(a, b) -> dict:
    one, two = (
        manifold3d.Manifold(manifold3d.Mesh64(np.ascontiguousarray(v), np.ascontiguousarray(t, np.uint64)))
        for v, t in (a, b)
    )
    meshes = {}
    for name, solid in {"union": one + two, "intersection": one ^ two, "difference": one - two}.items():
        mesh = solid.to_mesh64()
        meshes[name] = (np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts).astype(np.int64))
    return meshes


def _volume(mesh) -> Fraction:
    if not len(mesh[1]):
        return Fraction(0)
    parts, unit = solids.exact_volumes(*mesh)
    return parts.sum() * unit


def _booleans() -> dict:
    """Pairs of scanned solids in random positions. gap: by how much union and intersection together differ
    from both solids, in exact rationals, of the larger solid; beside: the largest difference of a volume from
    Manifold's; open: edges that are not used as often in one direction as in the other."""
    tools = {"RealModel": _ours, "Manifold": _manifold}
    rows = {name: {"gap": 0.0, "open": 0, "seconds": 0.0} for name in tools}
    beside, pairs = 0.0, 0
    for first, second in itertools.combinations_with_replacement(test_booleans.SCANS, 2):
        random = np.random.default_rng([test_booleans.SCANS.index(first), test_booleans.SCANS.index(second)])
        for _ in range(POSITIONS):
            a, b = (
                solids.moved(test_booleans.scan(name), 0.2 * random.normal(size=3), solids.rotation(random))
                for name in (first, second)
            )
            both = _volume(a), _volume(b)
            size, volumes = max(map(abs, both)), {}
            for name, tool in tools.items():
                began = time.process_time()
                meshes = tool(a, b)
                rows[name]["seconds"] += time.process_time() - began
                v = {operation: _volume(mesh) for operation, mesh in meshes.items()}
                gaps = (
                    v["union"] + v["intersection"] - sum(both),
                    v["difference"] + v["intersection"] - both[0],
                )
                rows[name]["gap"] = max(rows[name]["gap"], *(float(abs(gap) / size) for gap in gaps))
                rows[name]["open"] += sum(solids.open_edges(mesh[1]) for mesh in meshes.values())
                volumes[name] = v
            off = (
                abs(volumes["RealModel"][name] - volumes["Manifold"][name]) for name in volumes["Manifold"]
            )
            beside = max(beside, float(max(off) / size))
            pairs += 1
    for row in rows.values():
        row["seconds"] = round(row["seconds"] / pairs, 3)
    return {"pairs": pairs, "beside": beside, "programs": rows}


def _ours(a, b) -> dict:
    made = intersect(a, b)
    return {name: getattr(made, name)() for name in ("union", "intersection", "difference")}


def _cuts() -> list:
    """Layers cut by a sphere: the volume inside it, and by how much Manifold's differs."""
    rows = []
    for spec in CUTS:
        ours = structures.ours_cut(spec, "columns", RINGS, 1)
        theirs = structures.manifold_cut(spec, RINGS)
        rows.append(
            {
                "layers": spec["surfaces"],
                "triangles": 2 * spec["quads"] ** 2 * spec["surfaces"],
                "beside": abs(ours["volume"] - theirs["volume"]) / abs(theirs["volume"]),
                "seconds": {
                    "RealModel": round(ours["processor"], 2),
                    "Manifold": round(theirs["processor"], 2),
                },
            }
        )
    return rows
