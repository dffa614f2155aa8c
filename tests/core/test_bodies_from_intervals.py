# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies without a mesh, between their contacts in the intervals of boreholes: veins, sills, lenses."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import Body, Boreholes, InputRefused, Observations, Project, Rock, Surface, build
from realmodel.core.base.triangles import open_edges
from realmodel.core.base.work import run
from realmodel.core.structures.shapes.between_walls import Pierced, body_between_walls, pierced

REGION = [[-100, -100], [200, -100], [200, 200], [-100, 200]]


def body_of(ends, without=(), reach=None):
    """(vertices, triangles), the volume and the warnings."""
    met = Pierced(_ways(ends), _ways(without))
    (vertices, triangles), warnings = run(lambda work: body_between_walls(work, met, reach))
    a, b, c = (vertices[triangles] - vertices[0]).transpose(1, 0, 2)
    assert not len(open_edges(vertices, triangles))
    return vertices, triangles, float((a * np.cross(b, c)).sum() / 6), warnings


def _ways(ways):
    return np.array(ways, float).reshape(-1, 2, 3)


def hole(x, y, top=50.0, bottom=-50.0):
    return [[x, y, top], [x, y, bottom]]


def axes_of(dip, azimuth):
    """Two directions in a plane, and its normal."""
    dip, azimuth = np.radians([dip, azimuth])
    down = np.array([np.cos(dip) * np.sin(azimuth), np.cos(dip) * np.cos(azimuth), -np.sin(dip)])
    along = np.array([np.cos(azimuth), -np.sin(azimuth), 0.0])
    return along, down, np.cross(along, down)


def test_it_ends_halfway_to_holes_without_it():
    without = [hole(10, 0), hole(-10, 0), hole(0, 10), hole(0, -10)]
    vertices, _, volume, warnings = body_of([hole(0, 0, 2, 0)], without, reach=20.0)
    assert np.abs(vertices[:, :2]).max() == pytest.approx(5.0, rel=0.05)
    assert vertices[:, 2].min() == pytest.approx(0.0, abs=1e-12)
    assert vertices[:, 2].max() == pytest.approx(2.0, abs=1e-12)
    assert volume == pytest.approx(50 * 2 / 3, rel=0.05), "a double pyramid over a square with an area of 50"
    assert any("shows no dip" in text for text in warnings)


def test_a_hole_that_ends_before_it_says_nothing():
    ends = [hole(x, y, 2, 0) for x in (0, 20) for y in (0, 20)]
    _, _, volume, _ = body_of(ends)
    assert body_of(ends, [hole(10, 10, 50, 10)])[2] == volume
    assert body_of(ends, [hole(10, 10, 50, -10)])[2] < 0.8 * volume


@settings(max_examples=5, deadline=None, derandomize=True)
@given(
    dip=st.floats(0, 90),
    azimuth=st.floats(0, 360),
    seed=st.integers(0, 10_000),
    oblique=st.floats(0, 0.5),
)
def test_its_walls_pass_through_the_contacts_at_any_attitude(dip, azimuth, seed, oblique):
    """Random sheets pierced at any angle: every contact is on the surface, all is closed and outward, and no
    wall lies on the other side of the other one."""
    rng = np.random.default_rng(seed)
    along, down, normal = axes_of(dip, azimuth)
    places = np.array([[x, y] for x in range(4) for y in range(4)]) * 30.0 + rng.uniform(-8, 8, (16, 2))
    half = rng.uniform(0.5, 3.0, 16)
    bend = 4 * np.sin(places[:, 0] / 40)
    center = places[:, :1] * along + places[:, 1:] * down + bend[:, None] * normal + rng.uniform(-500, 500, 3)
    way = normal + oblique * rng.uniform(-1, 1) * along
    ends = np.stack([center + half[:, None] * way, center - half[:, None] * way], axis=1)
    is_in = rng.random(16) < 0.7
    is_in[[0, 3, 12]] = True
    away = np.stack([center + 60 * way, center - 60 * way], axis=1)
    vertices, triangles, volume, warnings = body_of(ends[is_in], away[~is_in])
    contacts = ends[is_in].reshape(-1, 3)
    off = np.linalg.norm(contacts[:, None] - vertices[None], axis=2).min(axis=1)
    assert off.max() < 1e-6, warnings
    assert 0 < volume < 120.0**2 * 2 * half.max() * (1 + oblique)
    again = body_of(ends[is_in][::-1], away[~is_in][::-1])
    assert np.array_equal(again[0], vertices) and np.array_equal(again[1], triangles)


@settings(max_examples=5, deadline=None, derandomize=True)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 30))
def test_any_logs_make_a_closed_body_or_none(seed, count):
    """Holes at any places, in any arrangement, thin or thick, above one another or in a line."""
    rng = np.random.default_rng(seed)
    places = np.round(rng.uniform(0, 100, (count, 2)), rng.integers(-1, 3))
    if rng.random() < 0.3:
        places[:, 1] = 3.0
    top = rng.normal(0, rng.choice([0.1, 5, 30]), count)
    ends = [
        hole(x, y, z, z - thick)
        for (x, y), z, thick in zip(places, top, rng.exponential(3, count), strict=True)
    ]
    without = [hole(*place) for place in rng.uniform(-50, 150, (rng.integers(0, 20), 2))]
    try:
        _, _, volume, _ = body_of(ends, without, rng.choice([None, 40.0]))
    except InputRefused as error:
        assert re.search("how far it goes|different elevations|same position in plan", str(error))
        return
    assert volume > 0


def vein_tables(folder, dip=60.0, thickness=4.0):
    """25 vertical holes through a vein in a host, which dips east and ends in the north."""
    lean = np.radians(dip)
    collars, intervals = [], []
    for number, (x, y) in enumerate((x, y) for x in range(10, 100, 20) for y in range(10, 100, 20)):
        collars.append(f"H{number},{x},{y},50\n")
        middle = 50 + (x - 50) * np.tan(lean)
        top, bottom = middle - thickness / 2 / np.cos(lean), middle + thickness / 2 / np.cos(lean)
        if y > 80 or top < 0:
            intervals.append(f"H{number},0,150,Host\n")
            continue
        intervals += [f"H{number},0,{top:.6f},Host\n", f"H{number},{top:.6f},{bottom:.6f},V\n"]
        intervals.append(f"H{number},{bottom:.6f},150,Host\n")
    (folder / "collars.csv").write_text("hole,x,y,z\n" + "".join(collars))
    (folder / "intervals.csv").write_text("hole,from,to,block\n" + "".join(intervals))
    return Boreholes(collars=folder / "collars.csv", intervals=folder / "intervals.csv")


def rock_with(holes, names=None):
    level = [
        Surface(name, method="constant", options={"value": z}, block=block)
        for name, z, block in (("base", -150.0, "x"), ("top", 50.0, "Host"))
    ]
    region = [[0, 0], [100, 0], [100, 100], [0, 100]]
    return Rock(
        "r",
        level,
        region=region,
        edge_length=5,
        boreholes=holes,
        names={"V": "Vein"} if names is None else names,
    )


def test_a_vein_is_built_from_its_intervals(tmp_path):
    model = build(Project("v", [rock_with(vein_tables(tmp_path))], bodies=[Body("Vein", after="top")]))
    vertices, _ = model.surface("Vein")
    lean = np.radians(60.0)
    across = (vertices - [50.0, 0.0, 0.0]) @ [np.sin(lean), 0.0, np.cos(lean)]
    assert np.abs(across).max() == pytest.approx(2.0, abs=1e-4)
    assert vertices[:, 1].max() == pytest.approx(80.0, abs=0.1), "halfway to the holes at 90"
    seen = model.project.rocks[0].observed
    inner = seen.goes_on[1:]
    middles = ((seen.places[:-1] + seen.places[1:]) / 2)[inner]
    names = np.array([{"Host": "top"}.get(block.name, block.name) for block in model.blocks])
    assert (names[model.block_at(middles)] == seen.blocks[1:][inner]).all()
    assert model.project.bodies[0].vertices is not None and model.project.bodies[0].reach is None


def test_a_rock_mass_of_ready_meshes_may_have_one(tmp_path):
    corners, two = np.array([[0, 0], [100, 0], [100, 100], [0, 100]]), [[0, 1, 2], [0, 2, 3]]
    rock = rock_with(vein_tables(tmp_path))
    rock.surfaces = [
        Surface(name, np.column_stack([corners, np.full(4, z)]), two, block=block)
        for name, z, block in (("base", -150.0, "x"), ("top", 50.0, "Host"))
    ]
    rock.region = rock.edge_length = None
    volumes = {b.name: b.volume for b in build(Project("v", [rock], bodies=[Body("Vein")])).blocks}
    assert volumes["Vein"] > 3e4 and sum(volumes.values()) == pytest.approx(2e6)


def test_reach_says_how_far_it_goes(tmp_path):
    holes = vein_tables(tmp_path)
    volumes = []
    for reach in (5.0, 10.0, 20.0):
        model = build(Project("v", [rock_with(holes)], bodies=[Body("Vein", reach=reach)]))
        volumes.append({block.name: block.volume for block in model.blocks}["Vein"])
    assert volumes == sorted(volumes) and volumes[0] < 0.9 * volumes[2]


@pytest.mark.parametrize(
    ("body", "said"),
    [
        (Body("Other"), "body 'Other': no interval of a borehole is in it"),
        (Body("Vein", np.eye(3), [[0, 1, 2]], reach=3.0), "'reach' has no effect, as its shape is a mesh"),
        (Body("Vein", reach=-3.0), "reach"),
    ],
)
def test_what_makes_no_body_is_refused(tmp_path, body, said):
    with pytest.raises(InputRefused, match=said):
        build(Project("v", [rock_with(vein_tables(tmp_path), names={})], bodies=[body]))


def test_without_boreholes_it_has_no_shape():
    level = Surface("top", method="constant", options={"value": 5.0})
    rock = Rock("r", [level], region=REGION, edge_length=50, base_elevation=0.0)
    with pytest.raises(InputRefused, match=r"body 'Vein': it has no shape; add mesh = ..., or boreholes"):
        build(Project("v", [rock], bodies=[Body("Vein")]))


def test_what_is_doubtful_is_said():
    places = [[0, 0, 9], [0, 0, 7], [0, 0, 7], [0, 0, 4], [0, 0, 4], [0, 0, 3], [0, 0, 3], [0, 0, 0]]
    blocks = ["a", "a", "Vein", "Vein", "a", "a", "Vein", "Vein"]
    seen = Observations(
        places, blocks, ["H1"] * 8, np.array([0, 2, 2, 5, 5, 6, 6, 9.0]), [1, 1, 2, 2, 3, 3, 4, 4]
    )
    met, warnings = pierced("Vein", [seen])
    assert met.ends.tolist() == [[[0, 0, 7], [0, 0, 4]]]
    assert met.without.tolist() == [[[0, 0, 9], [0, 0, 7]], [[0, 0, 4], [0, 0, 3]]]
    assert warnings[0].startswith("hole 'H1' met it several times")
    assert warnings[1].startswith("hole 'H1' ended in it")
