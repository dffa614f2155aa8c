# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface that reaches below the base elevation is cut off there, as if it were at the base."""

import numpy as np
import pytest
from realmodel.core import Body, Fault, InputRefused, Project, Rock, Surface, build

SIZE = 100.0
SQUARE = np.array([[0.0, 0.0], [SIZE, 0.0], [SIZE, SIZE], [0.0, SIZE]])
RULES = ("erosional", "conformable", "base", "discontinuous")
FAULT = Fault(
    "F",
    vertices=np.array([[40.0, -50, -100], [60, 150, -100], [70, 150, 100], [50, -50, 100]]),
    triangles=np.array([[0, 1, 2], [0, 2, 3]]),
)


def box(**options):
    corners = np.array([[x, y, z] for z in (-8.0, 6.0) for x, y in ((30, 30), (70, 30), (70, 70), (30, 70))])
    sides = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4]]
    sides += [[1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]]
    return Body("B", vertices=corners, triangles=np.array(sides), after="S0", **options)


def rough(random, number, share):
    """A surface of whole heights, which often are those of the base; a share of its triangles."""
    count = int(random.integers(3, 6))
    x, y = (each.ravel() for each in np.meshgrid(*[np.linspace(0, SIZE, count)] * 2, indexing="ij"))
    at = np.arange(count * count).reshape(count, count)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    z = 4.0 * number + random.integers(-9, 10, len(x))
    return np.column_stack([x, y, z]), triangles[random.random(len(triangles)) < share]


def stack(random, rules, share=1.0):
    meshes = [rough(random, number, share) for number in range(len(rules))]
    return [
        Surface(f"S{number}", vertices=mesh[0], triangles=mesh[1], rule=rule)
        for number, (mesh, rule) in enumerate(zip(meshes, rules, strict=True))
    ]


def built(surfaces, base, cells="columns", region=SQUARE, **options):
    rock = Rock("r", surfaces, region=region, edge_length=10, base_elevation=base)
    return build(Project("p", [rock], **options), cells=cells)


def below_base(model):
    return {warning.surface: warning.text for warning in model.warnings if warning.kind == "below_base"}


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_random_stacks_are_cut_at_the_base(seed, cells):
    random = np.random.default_rng(seed)
    rules = ["erosional"] * 3 if seed % 2 else random.choice(RULES, 4).tolist()
    share = 0.8 if seed % 4 > 1 else 1.0
    options = [{}, {"faults": [FAULT]}, {"bodies": [box()]}, {"bodies": [box(void=True)]}][seed % 4]
    base = float(random.integers(-2, 3))
    model = built(stack(random, rules, share), base, cells, None if seed == 4 else SQUARE, **options)
    assert not [test for test in model.validate(1000).tests if test.failed]
    assert model.vertices[:, 2].min() == pytest.approx(base)
    assert below_base(model)


def test_the_blocks_are_those_of_the_closed_form():
    random = np.random.default_rng(5)
    surfaces = stack(random, ["erosional"] * 3)
    model = built(surfaces, 1.0)
    low = [Surface(each.name, vertices=each.vertices, triangles=each.triangles) for each in surfaces]
    deep = built(low, -50.0)
    names = [block.name for block in model.blocks]
    for x, y in random.uniform(1, 99, (50, 2)):
        met = [(names[each.block], max(each.bottom, 1.0), each.top) for each in deep.borehole(x, y)]
        expected = [(name, bottom, top) for name, bottom, top in met if top > bottom]
        found = [(names[each.block], each.bottom, each.top) for each in model.borehole(x, y)]
        assert [each[0] for each in found] == [each[0] for each in expected]
        assert np.allclose([each[1:] for each in found], [each[1:] for each in expected])


def test_an_interpolated_surface_that_overshoots_is_cut_and_named():
    points = np.array([[x, y, 26 - 0.3 * x] for x in (5.0, 20, 35) for y in (20.0, 50, 80)])
    ground = Surface(
        "ground", vertices=np.column_stack([SQUARE, np.full(4, 40.0)]), triangles=[[0, 1, 2], [0, 2, 3]]
    )
    for method in ("plane", "spline", "universal_kriging"):
        surface = Surface("A", points=points, method=method)
        assert not below_base(built([surface, ground], -4.1))
        assert not below_base(built([surface, ground], -4.0)), "it touches the base"
        model = built([surface, ground], 0.0)
        assert "reaches below base_elevation 0 on 13 % of its area" in below_base(model)["A"]
        assert "lowest at (100, " in below_base(model)["A"]
        assert model.blocks[0].volume == pytest.approx(100 * 26**2 / 0.6, rel=1e-6)


def test_a_base_that_would_take_a_contact_or_all_is_refused():
    points = np.array([[20.0, 20, 5], [80, 20, 15], [50, 80, 25], [50, 50, 12]])
    for base, what, lower in (
        (6.0, "above a contact of surface 'A', which would be lost: the lowest is (20, 20, 5)", 5),
        (80.0, "not below any of the rock mass, whose highest point is", None),
    ):
        with pytest.raises(InputRefused) as raised:
            built([Surface("A", points=points, method="plane")], base)
        assert f"base_elevation {base:g} is {what}" in str(raised.value)
        assert raised.value.place is not None
        if lower is not None:
            assert f"choose one below {lower}" in str(raised.value)
    built([Surface("A", points=points, method="plane")], 5.0)
