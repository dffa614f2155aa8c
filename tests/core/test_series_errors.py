# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors, ranges and measured thicknesses of the field of a series."""

import numpy as np
import pytest
from realmodel.core import (
    InputRefused,
    Project,
    Rock,
    Series,
    SpaceDips,
    Surface,
    build,
    from_gempy,
    from_loop,
)
from realmodel.core.fields import rises
from realmodel.core.fields.given_kind import Kind, with_variance
from realmodel.core.project.project_checks import check_project
from realmodel.core.readers.tables.observations import Observations, read_observed_places
from realmodel.core.readers.tables.unit_names import UnitNames
from realmodel.core.settings.data_files import ObservationFile

VALUES = 1e-3  # variance of errors
NOTHING_KNOWN = Kind(((), ()), 3, 0.0, 0.0, 0.0, [], 1.0, [], [], [], [], 0.0)
SQUARE = [[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0], [0.0, 1000.0]]
LID = Surface("lid", vertices=[[*corner, 400.0] for corner in SQUARE], triangles=[[0, 1, 2], [0, 2, 3]])


def places(count, seed, low=0.0):
    """(count, 3) places on a wave, and the normals there."""
    x, y = np.random.default_rng(seed).uniform(low, 1000 - low, (2, count))
    normals = np.column_stack([-0.27 * np.cos(x / 150), np.zeros(count), np.ones(count)])
    normals /= np.sqrt((normals**2).sum(axis=1))[:, None]
    return np.column_stack([x, y, 100 + 40 * np.sin(x / 150)]), normals


def model(surfaces, observations=None, **of_series):
    dips = SpaceDips(*places(12, 7))
    for surface in surfaces:
        surface.series = "s"
    series = Series("s", dips=dips, resolution=60.0, **of_series)
    rock = Rock("r", [*surfaces, LID], SQUARE, edge_length=200.0, base_elevation=-200.0, series=[series])
    rock.observations = observations
    return build(Project("p", [rock]), cells="blocks")


def off(built, level, at):
    """How far the surface with the number `level` of a field is from places (N, 3), nearly."""
    field = built.field("s")
    rise, far = rises(field, at)
    return (field.at(at) - field.levels[level]) / np.sqrt(((rise / far) ** 2).sum(axis=1))


def noisy():
    points, _ = places(40, 1)
    return points + [0, 0, 1] * np.random.default_rng(2).normal(0, 8, 40)[:, None]


@pytest.mark.parametrize("given", [{"error": 8.0}, {"range": 2000.0}])
def test_given_errors_and_ranges_smooth_a_field(given):
    true, _ = places(200, 3, low=50)
    plain, smooth = (
        np.sqrt((off(model([Surface("a", points=noisy(), tie=False)], **more), 0, true) ** 2).mean())
        for more in ({"range": 200.0}, given)
    )
    assert smooth < 0.7 * plain


def test_a_surface_that_is_not_tied_misses_its_contacts_by_their_errors():
    for tie in (True, False):
        missed = np.abs(off(model([Surface("a", points=noisy(), tie=tie)], error=8.0), 0, noisy())).max()
        assert missed > 5.0 if not tie else missed < 1e-6


@pytest.mark.parametrize("given", [{"range": 300.0}, {"dip_error": 10.0}, {"error": 8.0, "range": 300.0}])
@pytest.mark.parametrize("slope", [0.0, 0.1])
def test_data_on_a_plane_give_the_plane(given, slope):
    points, _ = places(20, 1)
    points[:, 2] = 100 + slope * points[:, 0]
    dips = SpaceDips(places(8, 3)[0], np.tile([-slope, 0, 1.0], (8, 1)))
    series = Series("s", dips=dips, resolution=60.0, **given)
    surfaces = [Surface("a", points=points, series="s"), LID]
    rock = Rock("r", surfaces, SQUARE, edge_length=200.0, base_elevation=-200.0, series=[series])
    assert abs(off(build(Project("p", [rock]), cells="blocks"), 0, points)).max() < 1e-6


@pytest.mark.parametrize("draws", [0.3, 0.9, 0.99])
def test_the_variance_on_which_errors_depend_is_found(draws):
    """Also where a round draws little nearer to it."""

    def solve(kind):
        scale = VALUES / kind.value_error
        return {"kind": tuple(kind._replace(scale=0.01 * (scale / 0.01) ** draws))}

    _, kind = with_variance(NOTHING_KNOWN, VALUES, 0.0, solve)
    assert abs(kind.scale - 0.01) < 0.02 * 0.01


def test_where_errors_explain_all_data_nothing_else_is_left():
    kind = NOTHING_KNOWN
    _, kind = with_variance(
        kind, VALUES, 0.0, lambda kind: {"kind": tuple(kind._replace(scale=0.3 * VALUES / kind.value_error))}
    )
    assert kind.scale < 1e-6 * VALUES


def test_dips_that_are_off_count_less():
    points, _ = places(40, 1)
    right = places(12, 7)
    wrong = SpaceDips(np.vstack([right[0], [500.0, 500, 90]]), np.vstack([right[1], [1.0, 0, 1]]))
    steep = []
    for error in (0.0, 30.0):
        series = Series("s", dips=wrong, resolution=60.0, dip_error=error)
        surfaces = [Surface("a", points=points, series="s"), LID]
        rock = Rock("r", surfaces, SQUARE, edge_length=200.0, base_elevation=-200.0, series=[series])
        rise, _ = rises(build(Project("p", [rock]), cells="blocks").field("s"), np.array([[500.0, 500, 90]]))
        steep.append(rise[0, 0] / rise[0, 2])
    assert abs(steep[1] - 0.27) < abs(steep[0] - 0.27)


def test_measured_thicknesses_hold():
    base, normals = places(40, 1)
    thick = 60 + 0.04 * base[:, 0]
    top = base + thick[:, None] * normals
    west, east = base[:, 0] < 300, np.flatnonzero(base[:, 0] > 300)[::2]
    seen = Observations(base[east] + normals[east], ["b"] * len(east), thicknesses=thick[east])
    true, of_true = places(100, 3, low=100)
    true += (60 + 0.04 * true[:, :1]) * of_true
    missed = []
    for observations in (Observations(seen.places, seen.blocks), seen):
        surfaces = [Surface("a", points=base), Surface("b", points=top[west], rule="conformable")]
        missed.append(np.abs(off(model(surfaces, observations), 1, true)).mean())
    assert missed[1] < 0.2 * missed[0]


def test_a_thickness_outside_a_field_has_no_effect():
    base, normals = places(40, 1)
    seen = Observations(base[:3] + normals[:3], ["a", "b", "b"], thicknesses=[60.0, 60.0, np.nan])
    surfaces = [Surface("a", points=base), Surface("b", points=base + 60 * normals, rule="conformable")]
    found = [str(warning) for warning in model(surfaces, seen).warnings if "has no effect" in str(warning)]
    assert len(found) == 1 and "of 1 observation has" in found[0]


def test_a_thickness_is_of_the_table_and_stays(tmp_path):
    table = tmp_path / "seen.csv"
    table.write_text("x,y,z,block,thickness (ft)\n0,0,10,b,100\n0,0,20,b,\n")
    seen, _ = read_observed_places(ObservationFile(table), UnitNames(["b"], ["b block"], [], {}))
    np.testing.assert_allclose(seen.thicknesses, [30.48, np.nan])
    np.testing.assert_array_equal(
        Observations.joined([seen, seen]).thicknesses[[0, 2]], seen.thicknesses[[0, 0]]
    )
    table.write_text("x,y,z,block,thickness\n0,0,10,b,-1\n")
    with pytest.raises(InputRefused, match="not above 0"):
        read_observed_places(ObservationFile(table), UnitNames(["b"], ["b block"], [], {}))


def test_sheets_have_the_errors_of_their_variogram():
    surfaces = [Surface("a", points=places(9, 1)[0], series="s")]
    rock = Rock("r", surfaces, SQUARE, edge_length=200.0, series=[Series("s", kind="sheets", error=1.0)])
    with pytest.raises(InputRefused, match="variogram"):
        check_project(Project("p", [rock]))


POINTS = {"X": [0, 9, 0, 9], "Y": [0, 9, 9, 0], "Z": [4, 4, 4, 4], "surface": ["sand"] * 4}


def test_groups_of_other_programs_have_settings():
    settings = {"beds": {"error": 2.0, "range": 50.0, "tie": False}}
    box = (0, 9, 0, 9, 0, 9)
    rock = from_gempy(POINTS, None, stack={"beds": ["sand"]}, extent=box, settings=settings).rocks[0]
    assert (rock.series[0].error, rock.series[0].range, rock.surfaces[0].tie) == (2.0, 50.0, False)
    data = {**POINTS, "val": [0] * 4, "feature_name": POINTS["surface"]}
    rock = from_loop(
        data, [["sand"]], bounds=((0, 0, 0), (9, 9, 9)), settings={"sand": {"dip_error": 5}}
    ).rocks[0]
    assert rock.series[0].dip_error == 5


@pytest.mark.parametrize(
    ("settings", "what"), [({"bed": {}}, "no group"), ({"beds": {"nugget": 1}}, "no setting 'nugget'")]
)
def test_settings_of_groups_have_names_that_are_there(settings, what):
    with pytest.raises(InputRefused, match=what):
        from_gempy(POINTS, None, stack={"beds": ["sand"]}, extent=(0, 9, 0, 9, 0, 9), settings=settings)
