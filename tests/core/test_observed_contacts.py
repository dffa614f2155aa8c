# SPDX-License-Identifier: GPL-3.0-or-later
"""No younger surface cuts below contacts that were observed, and outcrops are on the ground."""

import numpy as np
import pytest
from realmodel.core import Boreholes, InputRefused, Project, Rock, Series, SpaceDips, Surface, build
from realmodel.core.base.triangles import Sheet
from realmodel.core.base.work import run
from realmodel.core.surfaces.wrong_sides import heights_at

SIZE = 1000.0
SQUARE = np.array([[0.0, 0.0], [SIZE, 0.0], [SIZE, SIZE], [0.0, SIZE]])
# known in the west only, dipping east: it falls below the contacts in the east
WEST = np.array([[x, y, 320 - 0.24 * x] for x in (50.0, 150, 300) for y in (200.0, 500, 800)])
HOLES = [(x, y) for x in (700.0, 800, 900) for y in (250.0, 750)]
LEVELS = {"A": 100.0, "B": 160.0}


def flat(name, z, **options):
    vertices = np.column_stack([SQUARE, np.full(4, float(z))])
    return Surface(name, vertices=vertices, triangles=np.array([[0, 1, 2], [0, 2, 3]]), **options)


def contacts(name):
    return np.array([[x, y, LEVELS[name]] for x, y in (*HOLES, (100.0, 500.0), (250.0, 250.0))])


def built(surfaces, **options):
    rock = Rock("r", surfaces, region=SQUARE, edge_length=100, base_elevation=0.0, **options)
    return build(Project("p", [rock]))


def lost(model):
    """Of the holes the number in which B is not met at its contact."""
    tops = []
    for x, y in HOLES:
        met = [each.top for each in model.borehole(x, y) if model.blocks[each.block].name == "B block"]
        tops.append(max(met, default=0.0))
    return int((np.abs(np.array(tops) - LEVELS["B"]) > 1e-6).sum())


def eroded(model):
    """The warnings by the names of the surfaces whose contacts are removed."""
    found = [warning for warning in model.warnings if warning.kind == "eroded"]
    return {warning.text.split("contacts of '")[1].split("'")[0]: warning for warning in found}


def unconformity(**options):
    return Surface("U", points=WEST, method="universal_kriging", **options)


@pytest.mark.parametrize("kind", [None, "sheets", "field"])
@pytest.mark.parametrize("source", ["points", "picks"])
def test_an_extrapolated_surface_removes_no_observed_contact(kind, source, tmp_path):
    named = {"series": "s"} if kind else {}
    options = {"series": [Series("s", kind=kind)]} if kind else {}
    if source == "points":
        observed = {} if kind else {"observed": True}
        older = [Surface(name, points=contacts(name), **named, **observed) for name in LEVELS]
    else:
        older = [Surface(name, **named) for name in LEVELS]
        rows = [(name, *place) for name in LEVELS for place in contacts(name).tolist()]
        picks = "".join(f"h{x:g}_{y:g},{name},{x},{y},{z}\n" for name, x, y, z in rows)
        (tmp_path / "picks.csv").write_text("hole,surface,x,y,z\n" + picks)
        options["boreholes"] = Boreholes(picks=tmp_path / "picks.csv")
    model = built([*older, unconformity(), flat("ground", 400)], **options)
    assert lost(model) == 0
    assert not eroded(model)
    assert not [each for each in model.misfits() if each.kind in ("point", "bound")]


def test_what_is_not_observed_is_counted():
    older = [Surface(name, points=contacts(name)) for name in LEVELS]
    model = built([*older, unconformity(), flat("ground", 400)])
    assert lost(model) == 6
    warning = eroded(model)["B"]
    assert warning.items == (0, 1, 2, 3, 4, 5)
    assert "it erodes 6 of the 8 contacts of 'B'" in warning.text and "observed = true" in warning.text


def test_a_ready_mesh_stays_and_what_it_removes_is_counted():
    above = np.array([[100.0, 100.0, 390.0], [900.0, 900.0, 410.0], [500.0, 100.0, 380.0]])
    model = built([Surface("A", points=above, observed=True), flat("ground", 400)])
    assert eroded(model)["A"].items == (1,)
    model = built([Surface("A", points=above), flat("ground", 400)])
    assert not eroded(model), "surfaces are often given as they were before erosion"


def test_a_level_set_removes_no_observed_contact():
    """The field of a younger series falls toward the contacts of an older sheet."""
    up = np.tile([0.24, 0.0, 1.0], (len(WEST), 1))
    for observed in (False, True):
        older = [Surface(name, points=contacts(name), observed=observed) for name in LEVELS]
        younger = Surface("U", points=WEST, series="young")
        series = [Series("young", dips=SpaceDips(WEST, up))]
        model = built([*older, younger, flat("ground", 400)], series=series)
        assert lost(model) == (0 if observed else 6)
        assert ("B" in eroded(model)) != observed


@pytest.mark.parametrize("spacing", [100, 200])
@pytest.mark.parametrize("method", ["kriging", "natural_neighbour"])
def test_a_contact_on_the_ground_lies_on_the_built_surface(spacing, method):
    """Outcrops on a hilly ground that is known every 100 or 200 m: at first they lie in the air above it."""

    def ground(x, y):
        return 300 + 40 * np.sin(x / 130) * np.cos(y / 170)

    place = np.random.default_rng(3).uniform(30, 970, (24, 2))
    outcrops = np.column_stack([place, ground(*place.T)])
    x, y = (each.ravel() for each in np.meshgrid(*[np.arange(0.0, SIZE + 1, spacing)] * 2))
    sheet = 0.05 * outcrops[:, 0] + 260
    beds = [
        Surface("A", points=outcrops[outcrops[:, 2] < sheet], series="s"),
        Surface("B", points=outcrops[outcrops[:, 2] >= sheet], series="s"),
    ]
    known = Surface("ground", points=np.column_stack([x, y, ground(x, y)]), method=method)
    model = built([*beds, known], series=[Series("s", kind="sheets")])
    assert not eroded(model)
    points = np.ascontiguousarray(outcrops)
    vertices, triangles = model.surface(2)
    z = run(lambda work: heights_at(work, Sheet(vertices, triangles), points[:, :2]))
    assert (z >= points[:, 2]).all(), "the ground is at the outcrops or above"


def test_observed_has_an_effect_on_points_alone():
    with pytest.raises(InputRefused, match="'observed' has no effect, as a mesh is not interpolated"):
        built([flat("A", 100, observed=True), flat("ground", 400)])
