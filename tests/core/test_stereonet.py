# SPDX-License-Identifier: GPL-3.0-or-later
"""Stereonets: means, fold axes and densities against closed forms; which dips; drawing and command line."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import Dips, Project, Rock, SpaceDips, Surface, UsageError, build, load_project
from realmodel.core.drawing.drawing import Dots
from realmodel.core.exporters.report import model_report
from realmodel.core.results.orientations.axes import (
    density,
    dip_and_direction,
    downward,
    great_circle,
    principal,
    projected,
    unprojected,
)
from realmodel.core.results.orientations.stereonet import StereonetData, draw_stereonet
from sample_scripts import SAMPLES, coarse_sample
from structure_cases import SQUARE
from test_batch import names, out, refused, run  # noqa: F401 - out is a fixture


def on_the_sphere(random, count):
    axes = random.normal(size=(count, 3))
    return axes / np.linalg.norm(axes, axis=1)[:, None]


def rotation(random):
    return np.linalg.qr(random.normal(size=(3, 3)))[0]


def cylindrical(trend, plunge, spread=60.0, count=25):
    """Poles of a fold around an axis, evenly from -spread to spread degrees."""
    t, p = np.radians([trend, plunge])
    axis = np.array([np.sin(t) * np.cos(p), np.cos(t) * np.cos(p), -np.sin(p)])
    side = np.cross(axis, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side)
    angle = np.radians(np.linspace(-spread, spread, count))[:, None]
    return np.cos(angle) * np.cross(side, axis) + np.sin(angle) * side


def angle_between(one, other):
    """Degrees between two axes."""
    return np.degrees(np.arcsin(min(1.0, np.linalg.norm(np.cross(one, other)))))


@settings(derandomize=True, deadline=None, max_examples=200)
@given(
    st.floats(0.0, 360.0),
    st.floats(0.0, 90.0),
    st.floats(10.0, 180.0),
    st.integers(2, 40),
    st.lists(st.booleans(), min_size=40, max_size=40),
)
def test_the_axis_of_a_cylindrical_fold(trend, plunge, spread, count, is_overturned):
    """Also where limbs are overturned, and beds vertical: a pole has no end."""
    poles = cylindrical(trend, plunge, spread, count)
    axes = principal(poles * np.where(is_overturned[:count], -1.0, 1.0)[:, None])
    t, p = np.radians([trend, plunge])
    axis = [np.sin(t) * np.cos(p), np.cos(t) * np.cos(p), -np.sin(p)]
    if spread > 179.0 and count < 4:  # two limbs of one attitude
        return
    assert angle_between(axes.axis, axis) == pytest.approx(0.0, abs=1e-6)
    assert axes.axis_error is None or axes.axis_error < 1e-3
    assert axes.shares.sum() == pytest.approx(1.0) and axes.shares[2] == pytest.approx(0.0, abs=1e-12)


def test_numbers_of_vertical_dips():
    """Their fold axis is upright; beds that strike to the north dip to the east or to the west."""
    strikes = SpaceDips.from_angles(np.zeros((3, 3)), [90.0] * 3, [70.0, 90.0, 110.0])
    numbers = StereonetData(strikes.normals).numbers
    assert numbers["fold_axis"]["plunge"] == pytest.approx(90.0)
    assert numbers["mean_plane"]["dip"] == pytest.approx(90.0)
    assert numbers["mean_plane"]["dip_direction"] % 180.0 == pytest.approx(90.0)


@pytest.mark.parametrize("count", [1, 2, 7])
def test_equal_dips_have_a_mean_plane_and_no_fold_axis(count, tmp_path):
    dips = StereonetData(SpaceDips.from_angles(np.zeros((count, 3)), [35.0] * count, 120.0).normals, "equal")
    numbers = dips.numbers
    assert numbers["count"] == count and numbers["fold_axis"] is None
    assert (numbers["mean_plane"]["dip"], numbers["mean_plane"]["dip_direction"]) == pytest.approx((35, 120))
    assert "fold axis: not determined" in dips.lines()
    assert "Girdle" not in {item.layer for item in draw_stereonet(dips).items}


def test_poles_without_order_have_neither():
    axes = principal(np.eye(3))
    assert axes.mean is None and axes.axis is None
    assert StereonetData(np.eye(3)).lines()[1] == "mean plane: not determined"


def test_the_mean_of_dips_around_a_plane_is_that_plane():
    around = [
        [np.sin(0.2) * np.cos(a), np.sin(0.2) * np.sin(a), np.cos(0.2)] for a in np.arange(6) * np.pi / 3
    ]
    assert dip_and_direction(principal(np.array(around)).mean)[0] == pytest.approx(0.0, abs=1e-6)
    dips = SpaceDips.from_angles(np.zeros((3, 3)), [30.0, 40.0, 50.0], [75.0] * 3)
    assert dip_and_direction(principal(dips.normals).mean) == pytest.approx((40.0, 75.0))


def test_results_turn_with_the_data_and_do_not_ask_for_ends_or_order():
    random = np.random.default_rng(5)
    for _ in range(20):
        poles = cylindrical(30.0, 20.0) + 0.1 * random.normal(size=(25, 3))
        poles /= np.linalg.norm(poles, axis=1)[:, None]
        turn = rotation(random)
        before, after = principal(poles), principal((poles * random.choice([-1, 1], (25, 1)))[::-1] @ turn.T)
        for one, other in ((before.mean, after.mean), (before.axis, after.axis)):
            assert abs(turn @ one @ other) == pytest.approx(1.0, abs=1e-9)
        assert after.axis_error == pytest.approx(before.axis_error, rel=1e-6)
        assert after.mean_error == pytest.approx(before.mean_error, rel=1e-6)
        place = on_the_sphere(random, 7)
        assert density(poles @ turn.T, place @ turn.T) == pytest.approx(density(poles, place))


def test_cones_of_confidence_hold_what_they_promise():
    """Of 200 samples of a girdle about 190 have the true axis in the cone; its wider half-angle has more."""
    random, inside = np.random.default_rng(7), 0
    for _ in range(200):
        angle = np.radians(random.uniform(-60, 60, 80))
        poles = np.column_stack([np.sin(angle), 0.15 * random.normal(size=80), np.cos(angle)])
        axes = principal(poles / np.linalg.norm(poles, axis=1)[:, None])
        inside += np.degrees(np.arccos(min(1.0, abs(axes.axis[1])))) <= axes.axis_error
    assert 184 <= inside <= 200
    assert axes.axis_error < 10.0


def test_equal_areas_and_equal_angles():
    random = np.random.default_rng(3)
    places = 0.99 * on_the_sphere(random, 200)[:, :2]
    for equal_area in (True, False):
        assert projected(unprojected(places, equal_area), equal_area) == pytest.approx(places)
        step = 1e-5
        for place in places[:50]:
            corners = unprojected(place + step * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), equal_area)
            one, other = corners[1] - corners[0], corners[2] - corners[0]
            if equal_area:  # the half sphere, 2 pi, on a circle of pi
                assert np.linalg.norm(np.cross(one, other)) / step**2 == pytest.approx(2.0, rel=1e-3)
            else:
                assert one @ other / (np.linalg.norm(one) * np.linalg.norm(other)) == pytest.approx(
                    0, abs=1e-3
                )
    assert np.linalg.norm(great_circle(np.array([0.0, 0.0, 1.0])), axis=1) == pytest.approx(1.0)
    pole = downward(on_the_sphere(random, 1))
    assert unprojected(great_circle(pole[0])) @ pole[0] == pytest.approx(np.zeros(181), abs=1e-6)


def test_the_density_of_poles_without_order_is_even():
    random = np.random.default_rng(11)
    values = density(on_the_sphere(random, 20000), on_the_sphere(random, 200))
    assert values.std() < 2.0
    alone = np.array([[0.0, 0.0, 1.0]] * 20)
    assert density(alone, alone[:1])[0] > 5.0 > density(alone, np.array([[1.0, 0.0, 0.0]]))[0]


def project():
    plan = np.arange(8.0).reshape(4, 2)
    of = Dips.from_angles(plan, [10, 20, 30, 40], 90, surfaces=np.array(["top", "", "", ""]))
    of = Dips(
        of.positions, of.gradients, None, of.surfaces, np.array(["", "Sand", "Sand", ""]), np.arange(4) < 3
    )
    surfaces = [
        Surface(
            "top", points=np.array([[1.0, 1.0, 1.0]]), dips=Dips.from_angles(plan[:1], 50, 90), block="Sand"
        )
    ]
    return Project("P", [Rock("rock", surfaces, SQUARE, edge_length=2.0, dips=of)])


def test_dips_are_chosen_by_what_they_are_of():
    def dips(of=None):
        return [round(dip_and_direction(normal)[0]) for normal in project().stereonet(of).normals]

    assert dips() == [10, 20, 30, 50]  # the fourth is switched off
    assert (dips("top"), dips("Sand"), dips("rock")) == ([10, 50], [20, 30], [10, 20, 30, 50])
    with pytest.raises(UsageError, match="no dips of 'clay'; there are dips of rock, top, Sand"):
        dips("clay")


def test_a_project_without_dips_is_refused():
    surface = Surface("top", points=np.array([[1.0, 1.0, 1.0]]))
    empty = Project("P", [Rock("rock", [surface], SQUARE, edge_length=2.0)])
    with pytest.raises(UsageError, match=r"there are no dips$"):
        empty.stereonet()
    empty.rocks[0].dips = Dips.from_angles(np.zeros((2, 2)), 10, 90, used=np.zeros(2, bool))
    with pytest.raises(UsageError, match=r"there are no dips of 'rock'$"):
        empty.stereonet("rock")


def test_dips_of_a_table_need_no_build(tmp_path):
    (tmp_path / "dips.csv").write_text("x,y,dip,dip_direction\n1,1,30,75\n2,2,40,75\n3,3,50,75\n")
    (tmp_path / "points.csv").write_text("x,y,z\n1,1,1\n")
    text = 'format = 1\nname = "p"\n[[rock]]\nname = "r"\nedge_length = 2\n'
    text += 'region = [[0, 0], [9, 0], [9, 9]]\n[[rock.surface]]\nname = "top"\n'
    (tmp_path / "p.toml").write_text(text + 'points = "points.csv"\ndips = "dips.csv"\n')
    plane = load_project(tmp_path / "p.toml").stereonet("top").numbers["mean_plane"]
    assert (plane["dip"], plane["dip_direction"]) == pytest.approx((40.0, 75.0))


def test_the_report_has_the_numbers_of_all_dips_and_of_each_name():
    model = build(coarse_sample("recumbent_fold", 4))
    entries = model_report(model)["dips"]
    assert entries[0]["of"] is None and len(entries) > 1
    for entry in entries:
        assert entry == {"of": entry["of"], **model.stereonet(entry["of"]).numbers}


def test_the_drawing_has_each_pole_in_its_place():
    dips = StereonetData(cylindrical(47.0, 12.0), "fold")
    for net in ("equal_area", "equal_angle"):
        drawing = draw_stereonet(dips, net)
        (poles,) = [item for item in drawing.items if isinstance(item, Dots) and item.layer == "Poles"]
        middle = np.array([24.0 + 160.0, 24.0 + 160.0])
        assert (poles.points - middle) / 160.0 == pytest.approx(projected(dips.normals, net == "equal_area"))
        assert "Density" in {item.layer for item in drawing.items}
    with pytest.raises(UsageError, match="net"):
        draw_stereonet(dips, "wulff")


def test_files_of_the_command_line(out):  # noqa: F811 - the fixture
    sample = SAMPLES / "recumbent_fold/project.toml"
    done = run(sample, "--stereonet", out / "dips.svg", "--net", "equal_angle")
    assert done.returncode == 0, done.stderr
    assert "stereonet dips.svg: " in done.stdout and "fold axis: " in done.stdout
    assert "equal angle (Wulff)" in (out / "dips.svg").read_text()
    assert "no dips of 'x'" in refused(run(sample, "--stereonet", f"x={out / 'x.svg'}"), 2)
    assert names(out) == ["dips.svg"]
