# SPDX-License-Identifier: GPL-3.0-or-later
"""Hunts for cuts that fail or are refused: python -m tests.core.stacks.cut_hunt CASES [SEED] [FAMILY ...]

Every case has a number: the same number makes the same stack and cutter (--only N runs it alone).
Ends with a table of what was refused, by family and kind of cutter, and the numbers of what failed;
--keep FOLDER writes models and cutters of what failed there, as tests/data/cuts has them. Cuts by planes
are hunted with --kind plane.
"""

import argparse
import collections
import itertools
import random
import sys
import time
from pathlib import Path

import numpy as np

from . import places
from .cutters import random_cutter
from .cutting import cut_failures, native_arrays
from .generate import FAMILIES, random_stack
from .model_view import built


def case(seed, number, families, kind=None):
    """Model and cutter number `number`: (family, kind, model, arguments), or None where there is none."""
    rng = random.Random(f"{seed}/{number}")
    family = families[number % len(families)]
    stack = random_stack(rng, family)
    cells = rng.choice(("columns", "blocks"))
    model = native_arrays(stack, built(stack, cells=cells, threads=1), cells)
    if not len(model["cell_block"]) or (kind == "plane" and not has_room(model)):
        return None
    found = random_cutter(rng, stack, family, model, cells, kind)
    return None if found is None else (family, found[0], model, found[1])


def save(path, kind, model, cutter):
    """Writes model and cutter, so that they stay what they are when building changes."""
    arrays = {}
    for part, values in (("model", model), *((f"cutter_{i}", value) for i, value in enumerate(cutter))):
        for name, value in values.items() if isinstance(values, dict) else [(None, values)]:
            arrays[part if name is None else f"{part}_{name}"] = np.asarray(value)
    np.savez_compressed(path, kind=kind, **{name: a for name, a in arrays.items() if a.dtype != object})


def load(path):
    """(kind, model, cutter) of a file that save() wrote."""
    with np.load(path) as file:
        values = {name: file[name] if file[name].ndim else file[name].item() for name in file.files}

    def part(name):
        below = {key.removeprefix(f"{name}_"): values[key] for key in values if key.startswith(f"{name}_")}
        return values.get(name, below)

    cutter = [part(f"cutter_{i}") for i in range(2)]
    return values["kind"], part("model"), cutter


def _area(section):
    """The area of a section; cells that are too thin for doubles may have none of it."""
    total = 0.0
    for begin, end in itertools.pairwise(section["offsets"]):
        corners = section["vertices"][section["polygon_vertices"][begin:end]]
        spokes = corners[1:] - corners[0]
        total += np.linalg.norm(np.cross(spokes[:-1], spokes[1:]).sum(axis=0)) / 2
    return total


def has_room(model):
    """Whether there is room between any two heights for a part of a cell."""
    return not np.diff(np.unique(model["vertices"][:, 2])).min(initial=1.0) < 1e-300


def _section_failures(model, cut, section):
    """What is wrong with a section alone, beside the one that the cut has found."""
    vertices = model["vertices"]
    if section["polygon_vertices"].max(initial=-1) != len(section["vertices"]) - 1:
        return ["section: vertices that no polygon has"]
    if any(np.diff(np.unique(axis)).min(initial=1.0) < 1e-9 for axis in vertices.T):
        return []  # cells as thin as rounding: the section alone does not look at their parts
    alone, found = _area(section), _area(cut["section"])
    allowed = 1e-9 * found + 1e3 * np.spacing(np.abs(vertices).max()) * np.ptp(vertices, axis=0).max()
    return [f"section: area {alone}, with the cut {found}"] if not abs(alone - found) <= allowed else []


def judged(model, kind, cutter):
    """What is wrong with the cut, and why it was refused."""
    native = places.native()
    function = (
        native.cut_by_plane
        if kind == "plane"
        else native.cut_by_block
        if kind.endswith("block")
        else native.cut_by_surface
    )
    try:
        cut = function(model, *cutter, native.Execution(1))
    except native.InputError as error:
        return [], error.kind
    except RuntimeError as error:
        return [f"defect: {error}"], None
    failures = cut_failures(model, cut)
    if kind == "plane" and not failures:
        failures = _section_failures(model, cut, native.section_by_plane(model, *cutter, native.Execution(2)))
    return failures, None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("cases", type=int)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    parser.add_argument("family", nargs="*", default=sorted(FAMILIES))
    parser.add_argument("--kind")
    parser.add_argument("--only", type=int)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--keep", type=Path)
    options = parser.parse_args()
    numbers = range(options.first, options.cases) if options.only is None else [options.only]
    made, refused, failed, slowest = 0, collections.Counter(), [], (0.0, -1)
    by = collections.defaultdict(list)
    for number in numbers:
        found = case(options.seed, number, options.family, options.kind)
        if found is None:
            continue
        family, kind, model, cutter = found
        made += 1
        began = time.perf_counter()
        failures, why = judged(model, kind, cutter)
        slowest = max(slowest, (time.perf_counter() - began, number))
        if why is not None:
            refused[kind, why] += 1
            by[kind, why].append((number, family))
        if failures:
            failed.append((number, family, kind, failures))
            print(number, family, kind, failures, flush=True)
            if options.keep is not None:
                save(options.keep / f"seed{options.seed}_case{number}.npz", kind, model, cutter)
    for key, count in sorted(refused.items()):
        print(f"{count:6} refused {key}: {by[key][:8]}")
    print(f"{made} cuts, {sum(refused.values())} refused, {len(failed)} failed; slowest {slowest}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
