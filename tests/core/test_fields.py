# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of series: folds of closed form, folds of known truth, data that contradict one another."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from realmodel.core.base.errors import Cancelled, InputRefused
from realmodel.core.base.work import run
from realmodel.core.fields import Lattice, LevelSetData, solve_field

FOLDS = Path(__file__).resolve().parents[3] / "shared" / "data" / "folds"
LATTICE = Lattice((0.0, 0.0, 0.0), (50.0, 50.0, 50.0), (21, 21, 17))
LEVELS = np.array([-200.0, 0.0, 150.0, 300.0])
NAMES = ("H1", "H2", "H3", "H4")


def _turned(points):
    """Coordinates along a fold axis, across it, and up, inclined so that limbs overturn."""
    moved = np.asarray(points, float) - [500.0, 500.0, 400.0]
    azimuth, tilt = np.radians(25.0), np.radians(40.0)
    along = moved @ [np.sin(azimuth), np.cos(azimuth), 0.0]
    across = moved @ [np.cos(azimuth), -np.sin(azimuth), 0.0]
    return (
        along,
        across * np.cos(tilt) - moved[:, 2] * np.sin(tilt),
        across * np.sin(tilt) + moved[:, 2] * np.cos(tilt),
    )


def overturned(points):
    """A similar fold with an inclined axial plane."""
    _, u, v = _turned(points)
    return v - 140.0 * np.sin(u / 110.0)


def refolded(points):
    """A fold across another one, whose axial plane it bends."""
    x, y, z = (points - [500.0, 500.0, 400.0]).T
    z = z - 70.0 * np.sin(y / 90.0 + 0.4)
    return z - 90.0 * np.sin((0.6 * x + 0.8 * z) / 100.0)


def cylinder(points):
    """A parallel fold about a level axis."""
    x, y, z = points.T
    return np.hypot(0.9 * (x - 450.0) + 0.436 * (y - 500.0), z + 300.0) - 540.0


def dome(points):
    x, y, z = (points - [500.0, 500.0, 350.0]).T
    return z + 0.0009 * (x**2 + 0.6 * y**2) - 60.0


def _gradient(function, points):
    step = 1e-3
    steps = [function(points + step * e) - function(points - step * e) for e in np.eye(3)]
    return np.column_stack(steps) / (2 * step)


def _data(function, seed=1, holes=16, dips=60):
    """Contacts of vertical holes and dips at random places."""
    rng = np.random.default_rng(seed)
    low, high = LATTICE.corners
    contacts, surfaces = [], []
    for x, y in rng.uniform(low[:2] + 20, high[:2] - 20, (holes, 2)):
        z = np.linspace(low[2], high[2], 4001)
        f = function(np.column_stack([np.full_like(z, x), np.full_like(z, y), z]))
        for surface, level in enumerate(LEVELS):
            for n in np.flatnonzero((f[1:] > level) != (f[:-1] > level)):
                share = (level - f[n]) / (f[n + 1] - f[n])
                contacts.append([x, y, z[n] + share * (z[n + 1] - z[n])])
                surfaces.append(surface)
    places = rng.uniform(low + 20, high - 20, (dips, 3))
    gradients = _gradient(function, places)
    normals = gradients / np.linalg.norm(gradients, axis=1)[:, None]
    return LevelSetData(NAMES, np.array(contacts), np.array(surfaces, np.int32), places, normals)


def _share_right(function, field, seed=2):
    low, high = field.lattice.corners
    points = np.random.default_rng(seed).uniform(low, high, (4000, 3))
    right = np.searchsorted(field.levels, field.at(points)) == np.searchsorted(LEVELS, function(points))
    return right.mean()


def _solve(data, lattice=LATTICE, **options):
    return run(lambda work: solve_field(lattice, data, work, **options))


@pytest.mark.parametrize(
    ("function", "least"),
    [(overturned, 0.97), (cylinder, 0.97), (dome, 0.95), (refolded, 0.98)],
    ids=lambda v: str(v)[:20],
)
def test_folds_of_closed_form(function, least):
    field = _solve(_data(function))
    assert _share_right(function, field) > least
    assert (np.diff(field.levels) > 0).all()
    assert not len(field.critical_points)
    assert not len(field.dips_missed)
    assert field.misfit < 1e-3  # a millionth of the lattice


def _with_errors(data, degrees, meters):
    rng = np.random.default_rng(5)
    normals = data.normals + np.radians(degrees) * rng.normal(size=data.normals.shape)
    return replace(
        data,
        contacts=data.contacts + meters * rng.normal(size=data.contacts.shape),
        normals=normals / np.linalg.norm(normals, axis=1)[:, None],
    )


@pytest.mark.parametrize(
    ("function", "holes", "dips", "least"),
    [(overturned, 8, 30, 0.9), (dome, 8, 30, 0.96), (refolded, 16, 60, 0.97)],
)
def test_errors_of_dips_are_not_taken_for_folds(function, holes, dips, least):
    """The search for the kind of field ended at ranges as short as the distances of the data: 0.51 of the
    overturned fold was right."""
    field = _solve(_with_errors(_data(function, holes=holes, dips=dips), 5.0, 0.5))
    assert _share_right(function, field) > least
    assert not len(field.critical_points)


def test_an_overturned_fold_bends_less_along_its_axis_and_in_its_axial_plane():
    data = _data(overturned)
    assert (data.normals[:, 2] < 0).any()
    anisotropy = _solve(data).anisotropy
    azimuth, tilt = np.radians(25.0), np.radians(40.0)
    axis = np.array([np.sin(azimuth), np.cos(azimuth), 0.0])
    up = np.array([np.cos(azimuth) * np.sin(tilt), -np.sin(azimuth) * np.sin(tilt), np.cos(tilt)])
    assert abs(np.cross(axis, up) @ anisotropy.axes[2]) > 0.99
    ratios = np.array(anisotropy.ratios) / anisotropy.ratios[2]
    assert ratios[0] < 0.1
    assert ratios[1] < 0.5


def test_along_dips_the_field_does_not_change():
    data = _data(overturned)
    fine = Lattice((0.0, 0.0, 0.0), (10.0, 10.0, 10.0), (101, 101, 81))
    field = _solve(data, fine)
    gradient = _gradient(field.at, data.dips)
    cosines = (gradient * data.normals).sum(axis=1) / np.linalg.norm(gradient, axis=1)
    assert cosines.min() > 0.99


def test_contacts_alone_and_one_surface_with_dips():
    data = _data(dome, holes=40)
    without = replace(data, dips=np.empty((0, 3)), normals=np.empty((0, 3)))
    assert _share_right(dome, _solve(without)) > 0.9
    one = data.contact_surfaces == 1
    alone = replace(
        data, names=("H2",), contacts=data.contacts[one], contact_surfaces=np.zeros(one.sum(), np.int32)
    )
    field = _solve(alone)
    points = np.random.default_rng(3).uniform(*LATTICE.corners, (2000, 3))
    assert ((field.at(points) > field.levels[0]) == (dome(points) > 0)).mean() > 0.95


def test_bounds_hold_on_the_lattice():
    data = _data(overturned, holes=4, dips=12)
    rng = np.random.default_rng(5)
    points = rng.uniform(*LATTICE.corners, (150, 3))
    block = np.searchsorted(LEVELS, overturned(points))
    bounded = replace(
        data,
        bounds=points,
        bound_below=(block - 1).astype(np.int32),
        bound_above=np.where(block < 4, block, -1).astype(np.int32),
    )
    before, after = _solve(data), _solve(bounded)
    assert (np.searchsorted(before.levels, before.at(points)) != block).sum() > 3
    f = after.at(points)
    around = np.concatenate([[-np.inf], after.levels, [np.inf]])
    slack = 1e-4 * np.ptp(after.levels)
    missed = (f < around[block] - slack) | (f > around[block + 1] + slack)
    assert set(np.flatnonzero(missed)) <= set(after.bounds_missed)
    assert missed.sum() == 0
    assert _share_right(overturned, after) > _share_right(overturned, before)


def test_bounds_that_contradict_other_data_are_left_out():
    data = _data(overturned)
    points = np.random.default_rng(5).uniform(*LATTICE.corners, (150, 3))
    block = np.searchsorted(LEVELS, overturned(points))
    wrong = np.flatnonzero(block == 0)[[3, 8]]
    said = block.copy()
    said[wrong] = 4
    bounded = replace(
        data,
        bounds=points,
        bound_below=(said - 1).astype(np.int32),
        bound_above=np.where(said < 4, said, -1).astype(np.int32),
    )
    field = _solve(bounded)
    assert field.bounds_missed.tolist() == wrong.tolist()
    given = {"contact": data.contacts, "dip": data.dips, "bound": points}
    for row, against in zip(wrong.tolist(), field.contradicted, strict=True):
        assert 1 <= len(against) <= 4
        assert ("bound", row) not in against
        away = np.linalg.norm(given[against[0][0]][against[0][1]] - points[row])
        assert away < 600.0  # of a kilometer: along the fold axis nothing changes
    right = np.searchsorted(field.levels, field.at(points)) == block
    assert right[np.setdiff1d(np.arange(150), wrong)].all()
    assert _share_right(overturned, field) > 0.97


def test_many_contacts_are_met_by_few_of_them():
    rng = np.random.default_rng(6)
    places = rng.uniform(0, 1000, (6000, 2))
    z = 350.0 + 40 * np.sin(places[:, 0] / 130) * np.cos(places[:, 1] / 170)
    surfaces = np.repeat(np.arange(2, dtype=np.int32), 3000)
    data = LevelSetData(("low", "high"), np.column_stack([places, z + 150 * surfaces]), surfaces)
    field = _solve(data, tolerance=0.5)
    assert field.centers < 2500
    assert field.misfit < 1.0
    np.testing.assert_allclose(field.at(data.contacts), field.levels[surfaces], atol=5.0)


def test_the_same_bytes_for_any_number_of_threads():
    data = _data(cylinder)
    one, five = (run(lambda work: solve_field(LATTICE, data, work), threads=n) for n in (1, 5))
    assert one.values.tobytes() == five.values.tobytes()
    assert one.levels.tobytes() == five.levels.tobytes()
    assert one.critical_points.tobytes() == five.critical_points.tobytes()


def test_it_can_be_cancelled_and_reports():
    data = _data(overturned)
    fine = Lattice((0.0, 0.0, 0.0), (5.0, 5.0, 5.0), (201, 201, 161))
    with pytest.raises(Cancelled):
        run(lambda work: solve_field(fine, data, work), cancel=lambda: True)
    seen = []
    run(lambda work: solve_field(LATTICE, data, work), progress=lambda share, text: seen.append(share))
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_a_dip_against_its_neighbors_is_refused():
    data = _data(overturned)
    normals = data.normals.copy()
    wrong = 7
    near = np.argsort(((data.dips - data.dips[wrong]) ** 2).sum(axis=1))[1:4]
    dips = data.dips.copy()
    dips[near] = dips[wrong] + [[5, 0, 0], [0, 5, 0], [0, 0, 5]]
    gradients = _gradient(overturned, dips)
    normals = gradients / np.linalg.norm(gradients, axis=1)[:, None]
    normals[wrong] *= -1
    with pytest.raises(InputRefused, match=r"^dip 7: .*the other way.*1 upright, -1 overturned") as error:
        _solve(replace(data, dips=dips, normals=normals))
    np.testing.assert_array_equal(error.value.place, dips[wrong])


def test_dips_on_the_limbs_of_tight_folds_are_not_refused():
    """The nearest dips may all be on the next limb, which is turned over."""

    def tight(points):
        _, u, v = _turned(points)
        return v - 160.0 * np.sin(u / 30.0)

    data = _data(tight, dips=300)
    apart = ((data.dips[:, None] - data.dips) ** 2).sum(axis=2)
    near = np.argsort(apart, axis=1)[:, 1:4]
    cosines = (data.normals[near] * data.normals[:, None]).sum(axis=2)
    assert (cosines < -0.7).all(axis=1).any()
    assert (np.diff(_solve(data).levels) > 0).all()


def test_surfaces_in_the_wrong_order_are_refused():
    data = _data(overturned)
    exchanged = np.array([0, 2, 1, 3], np.int32)[data.contact_surfaces]
    with pytest.raises(InputRefused, match=r"surface 'H3': .*older side of surface 'H2'"):
        _solve(replace(data, contact_surfaces=exchanged))


def test_polarities_that_contradict_the_order_of_all_surfaces_are_refused():
    data = _data(overturned)
    with pytest.raises(InputRefused, match=r"^surfaces 'H1' to 'H4': at 60 of 60 dips .*the other way"):
        _solve(replace(data, normals=-data.normals))


def test_data_that_cannot_be_used_are_refused():
    data = _data(overturned)

    def refused(match, **changes):
        with pytest.raises(InputRefused, match=match):
            _solve(replace(data, **changes))

    outside = data.contacts.copy()
    outside[3, 2] = 900.0
    refused(r"^contact 3: .*outside the lattice", contacts=outside)
    outside = data.dips.copy()
    outside[5, 0] = -1.0
    refused(r"^row 5 of dips: .*outside", dips=outside, item=lambda kind, row: f"row {row} of {kind}s")
    refused("surface 'H5' *: it has no contacts", names=(*NAMES, "H5"))
    again = np.concatenate([data.contacts, data.contacts[:1]])
    other = np.append(data.contact_surfaces, (data.contact_surfaces[0] + 1) % 4).astype(np.int32)
    refused("have a contact at one place", contacts=again, contact_surfaces=other)
    none = np.empty((0, 3))
    refused(
        "direction to younger rock",
        names=("H1",),
        contact_surfaces=np.zeros(len(data.contacts), np.int32),
        dips=none,
        normals=none,
    )


def _read(path):
    with path.open(newline="") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def noddy(name):
    """The data of a fold made by Noddy, places (N, 3) and the block (N,) at each."""
    points = [
        np.array([[r["x"], r["y"], r["z"]] for r in _read(FOLDS / name / f"s{k}.csv")]) for k in range(5)
    ]
    rows = _read(FOLDS / name / "dips_A.csv")
    dip, azimuth = (np.radians([row[key] for row in rows]) for key in ("dip", "dip_direction"))
    polarity = np.array([row["polarity"] for row in rows])
    normals = np.column_stack([np.sin(dip) * np.sin(azimuth), np.sin(dip) * np.cos(azimuth), np.cos(dip)])
    data = LevelSetData(
        tuple(f"A{k + 1}" for k in range(5)),
        np.concatenate(points),
        np.repeat(np.arange(5, dtype=np.int32), [len(p) for p in points]),
        np.array([[row["x"], row["y"], row["z"]] for row in rows]),
        normals * polarity[:, None],
    )
    with np.load(FOLDS / name / "truth.npz") as truth:
        unit = {f"A unit {k}": k for k in range(6)}
        block = np.array([unit.get(text, -1) for text in truth["block"]])
        return data, truth["points"][block >= 0], block[block >= 0]


def some_of(data, every):
    return replace(
        data,
        contacts=data.contacts[::every],
        contact_surfaces=data.contact_surfaces[::every],
        dips=data.dips[::every],
        normals=data.normals[::every],
    )


@pytest.mark.skipif(not FOLDS.exists(), reason="shared/data/folds is not here")
@pytest.mark.parametrize(
    ("name", "every", "least"),
    [("n_upright", 1, 0.993), ("n_unconformity", 1, 0.993), ("n_upright", 3, 0.975)],
)
def test_folds_of_known_truth(name, every, least):
    """A third of the data is likelier with a field that folds back between them: 0.35 was right."""
    data, places, block = noddy(name)
    data = some_of(data, every)
    field = _solve(data, Lattice((0.0, 0.0, 0.0), (250.0, 250.0, 250.0), (33, 33, 23)))
    found = np.searchsorted(field.levels, field.at(places))
    assert (found == block).mean() > least
    assert not len(field.critical_points)


def test_between_rough_surfaces_the_field_does_not_turn_back():
    rng = np.random.default_rng(8)
    waves = [(rng.uniform(0, 2 * np.pi, 3), length) for length in (900, 500, 300, 180, 110) for _ in range(2)]

    def relief(points):
        heights = [
            0.035 * length * np.sin(2 * np.pi / length * (points[:, :2] @ [np.cos(a), np.sin(a)]) + phase)
            for (a, phase, _), length in waves
        ]
        return np.sum(heights, axis=0)

    plan = rng.uniform(15.0, 985.0, (700, 2))
    surfaces = rng.integers(0, 2, 700).astype(np.int32)
    base, top = 250.0 + relief(plan), 550.0 + 0.3 * relief(plan + 5000.0)
    contacts = np.column_stack([plan, np.where(surfaces == 0, base, top)])
    field = _solve(LevelSetData(NAMES[:2], contacts, surfaces))
    assert field.order == 2
    between = np.column_stack([plan, 0.5 * (base + top)])
    share = (field.at(between) - field.levels[0]) / np.diff(field.levels)
    assert np.abs(share - 0.5).max() < 0.15
    assert len(field.critical_points) <= 4
    smooth = _solve(_data(overturned))
    assert smooth.order == 5
    coarse = _solve(_data(overturned), lattice=Lattice((0.0, 0.0, 0.0), (100.0, 100.0, 100.0), (11, 11, 9)))
    assert coarse.order == 3  # of a live edit, which is not to wait
