# SPDX-License-Identifier: GPL-3.0-or-later
"""The sample of a geological map: its script writes it, and its model is what it was made of."""

import numpy as np
import pytest
from realmodel.core import build, load_project
from sample_scripts import SAMPLES, generator, written_again
from structure_cases import cells_at

SAMPLE = SAMPLES / "mapped_valley"


@pytest.fixture(scope="module")
def made():
    """The module that made the sample."""
    return generator("mapped_valley")


@pytest.fixture(scope="module")
def model():
    return build(load_project(SAMPLE / "project.toml"))


def test_its_files_are_those_of_its_script(tmp_path):
    dips = [f"dips_{name}.csv" for name in ("limestone", "sandstone", "shale")]
    assert written_again("mapped_valley", tmp_path) == [*dips, "ground.asc", "map.geojson"]
    assert sum(len((SAMPLE / name).read_text().splitlines()) - 1 for name in dips) == 20


def test_contacts_lie_on_the_surfaces_that_the_ground_cuts(made, model):
    heights = [lambda x, y, bed=bed: made.top(bed, x, y) for bed in range(3)] + [made.basalt_base]
    entry = model.rock_inputs[0]
    for surface, data, height in zip(entry.rock.surfaces, entry.data, heights, strict=False):
        contacts = data.contacts
        assert len(contacts) > 15, surface.name
        off = [z - height(x, y) for x, y, z in contacts.tolist()]
        assert np.abs(off).max() < 1.0, surface.name  # the raster is bilinear
    seen = model.observed()
    assert seen.share == 1.0
    assert max(abs(each.residual) for each in seen.contacts) < 0.5
    assert not seen.left_out


def test_random_points_are_in_the_right_block(made, model):
    draw = np.random.default_rng(1)
    points = draw.uniform([0, 0, 0], [made.LENGTH, made.WIDTH, 420], (6000, 3))
    points = points[[z < made.ground(x, y) for x, y, z in points.tolist()]]
    cells = cells_at(model, points)
    names = [block.name for block in model.blocks]
    found = [names[block] for block in model.cell_block[cells]]
    true = [_block(made, *point) for point in points.tolist()]
    assert np.mean([a == b for a, b in zip(found, true, strict=True)]) > 0.95


def _block(made, x, y, z):
    if z > made.basalt_base(x, y):
        return "Basalt"
    beds = zip(("Sandstone", "Shale", "Limestone"), range(3), strict=True)
    return next((name for name, bed in beds if z < made.top(bed, x, y)), "Marl")
