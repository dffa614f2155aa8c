# SPDX-License-Identifier: GPL-3.0-or-later
"""The samples of the gallery: their scripts write them, and their models are what they were made of."""

import numpy as np
import pytest
from sample_scripts import SAMPLES, built_sample, generator, written_again


def built(name):
    model = built_sample(name, cells="blocks")
    assert model.validate(2000).passed
    return model, {block.name: block for block in model.blocks}


@pytest.mark.parametrize(
    ("name", "count"),
    [("canyon", 3), ("quarry", 7), ("sculpted_island", 3), ("block_diagram", 3), ("rift_basin", 13)],
)
def test_their_files_are_those_of_their_scripts(name, count, tmp_path):
    assert len(written_again(name, tmp_path)) == count


def test_forty_beds_in_the_walls_of_the_canyon():
    made, (_, blocks) = generator("canyon"), built("canyon")
    beds = list(made.beds())
    assert len(beds) == 40
    rows = (SAMPLES / "canyon" / "ground.asc").read_text().splitlines()[6:]
    terrain = np.array([row.split() for row in rows], float)[::-1]
    x, y = np.meshgrid(np.arange(terrain.shape[1]) * made.CELL, np.arange(terrain.shape[0]) * made.CELL)
    base = np.vectorize(made.datum)(x, y)
    for name, kind, thickness, _ in beds:
        left = np.clip(terrain - base, 0.0, thickness).mean() * made.LENGTH * made.WIDTH
        assert blocks[name].property == kind
        assert blocks[name].volume == pytest.approx(left, rel=0.06), name
        base = base + thickness
    assert blocks["River"].volume > 0
    assert blocks["Red limestone 1"].components >= 2  # the river has divided it


def test_the_rock_that_a_quarry_takes():
    made, (model, blocks) = generator("quarry"), built("quarry")
    assert model.warnings == []
    taken = model.eroded().taken
    x, y = (a.ravel() for a in np.meshgrid(np.arange(1.0, made.WIDTH, 2), np.arange(1.0, made.LENGTH, 2)))
    away = np.full(len(x), -np.inf)  # from the floor, which is convex
    for k, corner in enumerate(made.FLOOR):
        normal = made.outward(corner, made.FLOOR[(k + 1) % len(made.FLOOR)])
        away = np.maximum(away, (x - corner[0]) * normal[0] + (y - corner[1]) * normal[1])
    rings = list(made.levels())
    bottom = np.interp(away, [ring[0] for ring in rings], [ring[1] for ring in rings], right=np.inf)
    ground = np.vectorize(made.ground)(x, y)
    below, tops = np.full(len(x), 36.0), {}
    for name, mean in made.HORIZONS.items():
        tops[name.replace("_", " ").capitalize()] = np.vectorize(made.horizon)(mean, x, y)
    tops |= {"Bedded limestone": ground - 2.5, "Loam": ground}
    for number, (name, top) in enumerate(tops.items()):
        top = np.minimum(top, ground - 2.5) if name != "Loam" else top
        expected = 4.0 * np.maximum(0.0, top - np.maximum(below, bottom)).sum()
        assert blocks[name].name == model.blocks[number].name
        assert taken[0, number] == pytest.approx(expected, rel=0.03, abs=100.0), name
        below = top
    assert taken[1].sum() == pytest.approx(3 * made.RAMP * made.BENCH * 80 / 2, rel=0.35)


def test_strata_below_a_sculpted_ground():
    made, (_, blocks) = generator("sculpted_island"), built("sculpted_island")
    x, y = (a.ravel() for a in np.meshgrid(np.arange(-60, 60, 0.5), np.arange(-60, 60, 0.5)))
    inside = np.hypot(x, y) < made.RADIUS
    x, y = x[inside], y[inside]
    ground = np.vectorize(made.ground)(x, y)
    strata = sum(block.volume for block in blocks.values() if block.name != "Water")
    assert strata == pytest.approx(0.25 * (ground + 34.0).sum(), rel=0.01)
    assert blocks["Water"].volume == pytest.approx(0.25 * np.maximum(0.0, 9.4 - ground).sum(), rel=0.1)
    lowest = 0.25 * np.minimum(ground + 34.0, np.vectorize(made.fold)(x, y) + 34.0).sum()
    assert blocks["Stratum 1"].volume == pytest.approx(lowest, rel=0.02)


def test_folds_below_an_unconformity():
    made, (model, blocks) = generator("block_diagram"), built("block_diagram")
    assert model.warnings == []
    x, y = (a.ravel() for a in np.meshgrid(np.arange(25, 9000, 50), np.arange(25, 6000, 50)))
    folded, flat, ground = (np.vectorize(f)(x, y) for f in (made.fold, made.unconformity, made.ground))
    cut = np.minimum(flat, ground)
    expected = {
        "Slate": np.minimum(folded, cut) + 1100,
        "Limestone": np.clip(cut - folded - 160, 0, 260),
        "Conglomerate": np.clip(ground - flat, 0, 35),
        "Basalt": np.clip(ground - flat - 130, 0, 270),
        "Alluvium": np.maximum(0, 122 - ground),
    }
    for name, thickness in expected.items():
        assert blocks[name].volume == pytest.approx(2500.0 * thickness.sum(), rel=0.05), name


def test_tilted_blocks_of_a_rift():
    """Points away from faults and horizons are in the block that the formulas say."""
    made, (model, blocks) = generator("rift_basin"), built("rift_basin")
    assert len(model.compartment_names) == 6  # five blocks, and the cover
    assert blocks["Limestone"].components == 5
    random = np.random.default_rng(4)
    points = random.uniform([0, 0, -2400], [made.WIDTH, made.LENGTH, 100], (3000, 3))
    names = ["Basement", "Red beds", "Evaporite", "Limestone", "Shale", "Basin fill"]
    cover = ["Mudstone", "Chalk", "Sand"]
    expected, kept = [], []
    for x, y, z in points.tolist():
        for lower, west, east in made.blocks():
            if (west is None or x > west(y, z)) and (east is None or x < east(y, z)):
                tops = [made.undisturbed(x, y, mean) - lower(x) for mean in made.DISPLACED.values()]
        beside = [abs(x - of(y, z)) for _, of, _ in made.blocks() if of is not None]
        young = [made.undisturbed(x, y, mean) for mean in made.COVER.values()]
        heights = [*tops, made.unconformity(x, y), *young, made.ground(x, y)]
        kept.append(min(beside) > 60 and min(abs(z - height) for height in heights) > 20)
        above = heights[5:]
        if z > above[0]:
            expected.append(next((n for n, top in zip(cover, above[1:], strict=True) if z < top), None))
        else:
            expected.append(next((n for n, top in zip(names, tops, strict=False) if z < top), names[-1]))
    found = model.block_at(points)
    found = [model.blocks[number].name if number >= 0 else None for number in found]
    wrong = [n for n in np.flatnonzero(kept) if found[n] != expected[n]]
    assert sum(kept) > 2000
    assert len(wrong) < 10, [(points[n].round(), found[n], expected[n]) for n in wrong[:5]]
