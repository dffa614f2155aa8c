# SPDX-License-Identifier: GPL-3.0-or-later
"""The samples with bodies: their scripts write them, and their models are what they were made of."""

import math

import numpy as np
import pytest
from sample_scripts import built_sample, generator, written_again


@pytest.mark.parametrize(("name", "count"), [("intrusion", 7), ("tunnel", 7)])
def test_their_files_are_those_of_their_scripts(name, count, tmp_path):
    assert len(written_again(name, tmp_path)) == count


def volume(vertices, triangles):
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    return abs(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def test_the_rock_that_a_tunnel_takes():
    made, model = generator("tunnel"), built_sample("tunnel")
    assert model.warnings == [] and model.validate(6000).passed
    taken = model.eroded().taken
    names = [block.name for block in model.blocks]
    # slices of the profile of the tunnel, column by column, as high as the ground lets them be
    step, expected = 1.0, dict.fromkeys(names, 0.0)
    tops = [*made.HORIZONS.items(), ("limestone", 150.0)]
    for x in np.arange(0.5, made.WIDTH, step):
        for y in np.arange(-made.RADIUS + 0.25, made.RADIUS, 0.5):
            low = made.floor(x)
            high = min(low + made.WALL + math.sqrt(made.RADIUS**2 - y * y), made.ground(x, made.AXIS + y))
            below = -80.0
            for name, mean in tops:
                top = 150.0 if name == "limestone" else made.horizon(mean, x, made.AXIS + y)
                part = min(high, top) - max(low, below)
                expected[name.capitalize()] += 0.5 * step * max(0.0, part)
                below = top
    for name, found in zip(names, taken[0], strict=True):
        assert found == pytest.approx(expected[name], rel=0.08, abs=30.0), name
    assert 0 < taken[1].sum() < math.pi * 3**2 * 80


def test_an_intrusion_that_erosion_has_laid_bare():
    model = built_sample("intrusion")
    assert [str(warning) for warning in model.warnings if warning.kind != "joined"] == []
    assert model.validate(6000).passed
    blocks = {block.name: number for number, block in enumerate(model.blocks)}
    erosion = model.eroded()
    for body, name in enumerate(("Granite", "Dike")):
        number = blocks[name]
        shape = model.surface(model.blocks[number].surface)
        # below the base there is none of it
        assert 0 < erosion.deposited[number] < volume(*shape)
        assert erosion.by_block[number] > 0  # it came out at the surface
        assert erosion.taken[body, blocks["Slate"]] > 0
    assert erosion.taken[1, blocks["Granite"]] > 0  # the dike is younger
    assert model.blocks[blocks["Alluvium"]].volume > 0
