# SPDX-License-Identifier: GPL-3.0-or-later
"""Models for the tests of Model.validate, and what the outside check says of them."""

import io

import numpy as np
from realmodel.core import Block, Model, Project, Rock, Surface
from realmodel.core.base.triangles import Sheet
from realmodel.core.cells.cell_complex import CellComplex
from realmodel.core.exporters.model_arrays import write_npz
from realmodel.core.surfaces.rock_input import RockInput
from realmodel.core.surfaces.surface_input import SurfaceArrays
from stacks import places
from stacks.model_view import built, exported_arrays, rocks_of


def as_model(case, cells="columns"):
    """The model of a Stack, or of several beside each other, whose regions are triangulations."""
    result = built(case, cells=cells, threads=1)
    arrays = exported_arrays(case, result, cells)
    inputs = []
    for number, stack in enumerate(rocks_of(case)):
        surfaces = [
            Surface(f"S{k}", vertices=v, triangles=t, rule=rule)
            for k, ((v, t), rule) in enumerate(zip(stack.surfaces, stack.all_rules(), strict=True))
        ]
        rock = Rock(f"rock {number}", surfaces, base_elevation=stack.base_elevation)
        region = None if stack.region is None else Sheet(*stack.region)
        inputs.append(RockInput(rock, [Sheet(*shape) for shape in stack.surfaces], region))
    counts = np.bincount(arrays["cell_block"], minlength=len(arrays["block_surface"]))
    blocks = [
        Block(f"block {b}", int(rock), int(s), 0, float(result["volumes"][s]), int(counts[b]), 0)
        for b, (s, rock) in enumerate(zip(arrays["block_surface"], arrays["block_rock"], strict=True))
    ]
    return Model(
        CellComplex.of(arrays, cells),
        blocks,
        SurfaceArrays.of_arrays(arrays),
        surface_names=[s.name for entry in inputs for s in entry.rock.surfaces],
        project=Project("stack", [entry.rock for entry in inputs]),
        rock_inputs=inputs,
    )


def outside_failures(model):
    """What the outside check says of a model of one rock mass without a region."""
    checker = places.checker()
    file = io.BytesIO()
    write_npz(model, file, lambda _share: None)
    file.seek(0)
    rock = model.project.rocks[0]
    block_of = {block.surface: number for number, block in enumerate(model.blocks)}
    members = list(range(len(rock.surfaces)))
    rules = [surface.rule for surface in rock.surfaces]
    rows = [(members, rules, rock.base_elevation, [block_of.get(s, -1) for s in members], [])]
    return checker.check_all(checker.Complex(file), rows, 4000)
