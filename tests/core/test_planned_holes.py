# SPDX-License-Identifier: GPL-3.0-or-later
"""Planned holes: what they meet, by depth along them, and how certain that is."""

import csv
from pathlib import Path

import numpy as np
import pytest
from conftest import grid_surface
from folded_rocks import folded_project, given_field, recumbent
from hypothesis import given
from hypothesis import strategies as st
from realmodel.core import InputRefused, Project, Rock, Surface, UsageError, build
from realmodel.core.ensembles import Realizer, ensemble
from realmodel.core.results import model_holes
from realmodel.core.results.layer_values import at_places
from sample_scripts import built_sample

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"


def layers(**more):
    heights = [lambda x, y: 0.1 * x, lambda x, y: 3 + 0.2 * x - 0.1 * y, lambda x, y: 2 + 0.4 * y]
    surfaces = [
        Surface(f"S{k}", *grid_surface(4, height, 10.0), block=f"B{k}") for k, height in enumerate(heights)
    ]
    return build(Project("layers", [Rock("rock", surfaces, base_elevation=-5.0, **more)]))


@pytest.fixture(scope="module")
def model():
    return layers()


def test_an_upright_hole_is_what_a_borehole_meets(model):
    hole = model.planned_hole((3.3, 4.4, 9.0), length=30)
    wanted = model.borehole(3.3, 4.4)
    assert [each.block for each in hole.intervals] == [each.block for each in wanted]
    assert np.allclose(
        [(9 - i.begin, 9 - i.end) for i in hole.intervals], [(i.top, i.bottom) for i in wanted]
    )
    assert [contact.surface for contact in hole.contacts] == ["S2", "S1", "S0", ""]
    assert [(c.above, c.below) for c in hole.contacts] == [(-1, 2), (2, 1), (1, 0), (0, -1)]
    assert hole.contacts[-1].depth == pytest.approx(14)


def test_a_borehole_looks_at_the_faces_near_it_alone(model, monkeypatch):
    asked, outlines = [], model_holes._outlines
    monkeypatch.setattr(
        model_holes, "_outlines", lambda model, faces: asked.append(len(faces)) or outlines(model, faces)
    )
    assert len(model.borehole(3.3, 4.4)) == 3
    assert 0 < max(asked) < len(model.face_surface) // 10
    assert model.borehole(50.0, 4.4) == []


@given(
    st.tuples(*(st.floats(-3, 13),) * 2, st.floats(-7, 9)),
    st.floats(0, 360),
    st.floats(-90, 90),
    st.floats(0.5, 30),
)
def test_a_hole_in_any_direction_is_in_the_blocks_of_the_closed_form(model, collar, azimuth, dip, length):
    hole = model.planned_hole(collar, azimuth, dip, length)
    depths = (np.arange(200) + 0.5) / 200 * length
    ends = np.array([end for each in hole.intervals for end in (each.begin, each.end)] or [-9.0])
    depths = depths[np.abs(depths[:, None] - ends).min(axis=1) > 1e-7 * length]
    found = np.full(len(depths), -1)
    for each in hole.intervals:
        found[(depths > each.begin) & (depths < each.end)] = each.block
    places = hole.axis.places(depths)
    inside = ((places[:, :2] > 1e-6) & (places[:, :2] < 10 - 1e-6)).all(
        axis=1
    )  # beside walls a rounding decides
    assert found[inside].tolist() == model.block_at(places[inside]).tolist()
    assert (np.diff([each.begin for each in hole.intervals]) > 0).all()


def test_depths_are_along_the_hole_and_vertical(model):
    hole = model.planned_hole((1, 5, 8), azimuth=90, dip=30, length=40)
    row = hole.rows()[0]
    assert row["vertical_from"] == pytest.approx(row["from"] / 2)
    assert row["length"] == pytest.approx(row["to"] - row["from"])
    place = hole.axis.places([row["from"]])[0]
    assert place[1] == 5 and place[2] == pytest.approx(2 + 0.4 * 5)
    assert row["probability"] is None and row["from_deviation"] is None
    assert hole.table()["name"].tolist() == [each["name"] for each in hole.rows()]


def test_a_hole_beside_the_model_meets_nothing(model, tmp_path):
    hole = model.planned_hole((50, 50, 9), length=5)
    assert (hole.intervals, hole.contacts) == ([], [])
    hole.save(tmp_path / "h.csv")
    assert (tmp_path / "h.csv").read_text().startswith("block,name,property,from,to,length,vertical_from")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (((1, 2), 0, 90, 5), "three finite numbers"),
        (((1, 2, 3), np.nan, 90, 5), "azimuth must be"),
        (((1, 2, 3), 0, 91, 5), "between -90 and 90"),
        (((1, 2, 3), 0, 90, 0), "length must be above 0"),
    ],
)
def test_what_is_no_hole_is_refused(model, arguments, said):
    with pytest.raises(UsageError, match=said):
        model.planned_hole(*arguments)
    with pytest.raises(UsageError, match=r"not written as '\.txt'"):
        model.planned_hole((1, 2, 3)).save("hole.txt")


def kriged():
    """A plane of few points by kriging, over a base; and a ready mesh in the rock below."""
    rng = np.random.default_rng(3)
    plan = rng.uniform(0, 100, (12, 2))
    points = np.column_stack([plan, 20 + 0.3 * plan[:, 0] + rng.normal(0, 1.5, 12)])
    options = {"variogram": {"model": "spherical", "range": 60, "sill": 30, "nugget": 0}}
    top = Surface("top", points=points, method="kriging", options=options)
    floor = Surface("floor", *grid_surface(2, lambda x, y: 0 * x, 100.0))
    square = [[0, 0], [100, 0], [100, 100], [0, 100]]
    rock = Rock("hill", [floor, top], region=square, edge_length=10, base_elevation=-20)
    return Project("hill", [rock])


def test_the_variance_of_kriging_gives_the_deviation_along_the_hole():
    """Of an inclined hole it is that of the height over how fast the hole nears the surface."""
    model = build(kriged())
    upright = model.planned_hole((50, 50, 80), length=120)
    assert [each.surface for each in upright.contacts] == ["top", "floor", ""]
    vertices, triangles = model.surface(1)
    deviation = np.sqrt(model.surface_attributes(1)["variance"])
    there = at_places(np.column_stack([vertices[:, :2], deviation]), triangles, np.array([[50.0, 50.0]]))[0]
    assert upright.contacts[0].deviation == pytest.approx(there)
    assert upright.contacts[1].deviation is None  # a ready mesh
    contact = upright.contacts[0].depth
    tilted = model.planned_hole(
        (50 - contact * 0.75, 50, 80), azimuth=90, dip=np.degrees(np.arctan2(4, 3)), length=150
    )
    assert tilted.contacts[0].depth == pytest.approx(1.25 * contact)
    ahead, behind = (at_places(vertices, triangles, np.array([[50.0 + d, 50.0]]))[0] for d in (1e-4, -1e-4))
    slope = (ahead - behind) / 2e-4
    assert tilted.contacts[0].deviation == pytest.approx(there / abs(-0.8 - 0.6 * slope), rel=1e-4)


def test_an_ensemble_says_how_probable_each_block_is_along_the_hole(tmp_path):
    places = np.column_stack([np.full((60, 2), 30.0), np.linspace(60, -15, 60)])
    found = ensemble(kriged(), realizations=20, seed=4, places=places)
    hole = found.planned_hole((30, 30, 60), length=75)
    of_places = np.array([np.interp(60 - places[:, 2], hole.depths, share) for share in hole.probability.T]).T
    assert np.abs(of_places - found.probability).max() <= 0.1  # a step of one place
    near = [np.abs(hole.depths - (60 - z)).argmin() for z in places[:, 2]]
    assert np.median(np.abs(hole.probability[near] - found.probability)) == 0
    top = hole.contacts[0]
    assert (top.surface, top.share) == ("top", 1.0)
    depths = []
    for number in range(20):
        drawn = Realizer(found.model, 4).realization(number)
        depths.append(drawn.planned_hole((30, 30, 60), length=75).contacts[0].depth)
    assert top.deviation == pytest.approx(np.std(depths, ddof=1), rel=1e-6)
    assert hole.contacts[1].deviation == pytest.approx(0, abs=1e-5)  # the floor is a ready mesh
    assert 0.5 < hole.intervals[0].probability <= 1
    hole.save(tmp_path / "h.csv")
    rows = list(csv.DictReader((tmp_path / "h.csv").read_text().splitlines()))
    assert [row["name"] for row in rows] == [hole.block_names[each.block] for each in hole.intervals]
    assert float(rows[0]["from_deviation"]) == top.deviation
    assert float(rows[0]["probability top block"]) == pytest.approx(hole.intervals[0].probability, rel=1e-8)


def test_an_interval_between_two_looks_has_probabilities_too(tmp_path):
    found = ensemble(kriged(), realizations=2, seed=4)
    top = found.model.planned_hole((30, 30, 60), length=75).contacts[0].depth
    hole = found.planned_hole((30, 30, 60), length=top + 0.01)
    assert not ((hole.depths >= top) & (hole.depths <= top + 0.01)).any()
    hole.save(tmp_path / "h.csv")
    (row,) = csv.DictReader((tmp_path / "h.csv").read_text().splitlines())
    assert float(row["probability top block"]) == pytest.approx(hole.intervals[0].probability)
    assert 0 < float(row["probability top block"]) <= 1


def test_holes_of_a_faulted_model_are_in_its_compartments():
    model = built_sample("fault_blocks")
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    collar = (*(low[:2] + 0.07 * (high - low)[:2]), high[2])
    hole = model.planned_hole(collar, azimuth=60, dip=25, length=1.2 * float(np.linalg.norm(high - low)))
    assert len(hole.contacts) > 4
    depths = np.array([0.5 * (each.begin + each.end) for each in hole.intervals])
    wanted = model.block_at(hole.axis.places(depths)).tolist()
    assert [each.block for each in hole.intervals] == wanted
    names = {each.surface for each in hole.contacts}
    assert names & {fault.name for fault in model.project.faults}
    assert names & {surface.name for surface in model.project.rocks[0].surfaces}


def test_a_model_without_its_project_has_no_ensemble(model, tmp_path):
    found = ensemble(kriged(), realizations=2, seed=1)
    found.model.lacks_project = tmp_path / "old.npz"
    with pytest.raises(InputRefused, match="without its project"):
        found.planned_hole((30, 30, 60))


@pytest.mark.parametrize("cells", ["columns", "blocks"])
def test_a_hole_through_a_recumbent_fold_meets_blocks_again(monkeypatch, cells):
    given_field(monkeypatch, recumbent, (1.5, 2.5, 4.0))
    model = build(folded_project(recumbent, (1.5, 2.5, 4.0)), cells=cells)
    for azimuth, dip in ((0, 90), (30, 60)):
        hole = model.planned_hole((4.5, 3.2, 11.0), azimuth, dip, 12.0)
        blocks = [each.block for each in hole.intervals]
        assert len(blocks) > len(set(blocks))
        depths = np.array([0.5 * (each.begin + each.end) for each in hole.intervals])
        assert blocks == model.block_at(hole.axis.places(depths)).tolist()
        between = [each for each in hole.contacts if min(each.above, each.below) >= 0]
        assert {each.surface for each in between} <= set(model.surface_names)
        assert all(each.deviation is None for each in between)
