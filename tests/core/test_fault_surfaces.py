# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults from sticks and scattered points: how they are read, and the surfaces fitted through them."""

import numpy as np
import pytest
from realmodel.core import Fault, InputRefused, PointFile, Project, Rock, Surface, build
from realmodel.core.base.work import run
from realmodel.core.readers.fault_input import read_fault_points
from realmodel.core.structures.shapes.fitted import convex_hull, fit_points, fit_sticks


def listric_sticks(count=6, points=9):
    """Along y, curving from steep to flat with depth; the sticks of one shape."""
    s = np.linspace(0.0, 1.0, points)
    shape = np.column_stack([100 * s**2, np.zeros(points), -80 * s])
    return [shape + np.array([0.0, 10.0 * number, 0.0]) for number in range(count)]


def test_sticks_keep_their_shape():
    sticks = listric_sticks()
    vertices, triangles = fit_sticks(sticks)
    assert np.array_equal(vertices, np.concatenate(sticks))
    assert len(triangles) == 5 * 8 * 2
    y = vertices[triangles, 1]
    assert (np.ptp(y, axis=1) == 10.0).all()  # between neighbors only
    first, second, third = vertices[triangles].transpose(1, 0, 2)
    normals = np.cross(second - first, third - first)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    assert (np.abs(normals[:, 1]) < 1e-12).all()  # a cylinder: no twist


def test_order_and_direction_of_sticks_do_not_matter():
    sticks = listric_sticks()
    shuffled = [sticks[k][:: -1 if k % 2 else 1] for k in (3, 0, 5, 1, 4, 2)]
    vertices, triangles = fit_sticks(sticks)
    again, other = fit_sticks(shuffled)

    def corners(points, of):
        return {frozenset(map(tuple, points[triangle])) for triangle in of}

    assert corners(vertices, triangles) == corners(again, other)


@pytest.mark.parametrize("seed", range(12))
def test_order_of_points_does_not_matter(seed):
    """Rough and curved sticks, their points and they themselves shuffled, some twice: the same surface."""
    draw = np.random.default_rng(seed)
    sticks = [stick + draw.normal(0, 2, stick.shape) * [1, 0, 0] for stick in listric_sticks(points=7)]
    vertices, triangles = fit_sticks(sticks)
    shuffled = [draw.permutation(sticks[k]) for k in draw.permutation(6)]
    shuffled += [draw.permutation(np.concatenate([shuffled[2], shuffled[2][:2]]))]
    again, other = fit_sticks(shuffled)
    assert np.array_equal(vertices, again)
    assert np.array_equal(triangles, other)
    points = np.concatenate(sticks)
    fitted = [
        run(lambda work, given=given: fit_points(work, given)) for given in (points, draw.permutation(points))
    ]
    assert np.array_equal(*(sheet.vertices for sheet in fitted))


def test_sticks_that_cross_are_refused():
    first, second, third, fourth = listric_sticks(count=4)
    crossed = np.concatenate([second[:4], third[4:]]), np.concatenate([third[:4], second[4:]])
    rock = Rock("r", [Surface("S", vertices=100 * np.eye(3), triangles=[[0, 1, 2]])])
    project = Project("p", [rock], faults=[Fault("F", points=[first, *crossed, fourth])])
    with pytest.raises(
        InputRefused, match=r"fault 'F': .* crosses itself at .*sticks of number .*2.*3"
    ) as refused:
        build(project)
    assert refused.value.place is not None


def test_a_curved_fault_is_followed():
    """Sticks around three quarters of a circle: by their position along one axis they would be mixed up."""
    angles = np.radians(np.arange(0, 271, 15))
    sticks = [
        np.array([[9 * np.cos(a), 9 * np.sin(a), 0], [9 * np.cos(a), 9 * np.sin(a), -5]]) for a in angles
    ]
    order = np.random.default_rng(3).permutation(len(sticks))
    vertices, triangles = fit_sticks([sticks[k] for k in order])
    longest = max(np.linalg.norm(vertices[t] - vertices[np.roll(t, 1)], axis=1).max() for t in triangles)
    assert longest < 6.0
    assert len(triangles) == 2 * (len(sticks) - 1)


def test_sticks_of_different_lengths():
    sticks = [np.array([[0, 0, 0], [0, 0, -9]]), np.array([[0, 5, 0], [0, 5, -2], [0, 5, -5], [0, 5, -9]])]
    vertices, triangles = fit_sticks(sticks)
    first, second, third = vertices[triangles].transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(second - first, third - first), axis=1).sum() / 2
    assert area == pytest.approx(45.0)


def test_extended_sticks():
    vertices, _ = fit_sticks(listric_sticks(), extend=7.0)
    assert np.ptp(vertices[:, 1]) == pytest.approx(50 + 14)
    assert vertices[:, 2].max() > 6
    vertices, _ = fit_sticks(listric_sticks(), extend=7.0, extend_sideways=False)
    assert np.ptp(vertices[:, 1]) == pytest.approx(50)
    assert vertices[:, 2].max() > 6


@pytest.mark.parametrize("sticks", [[], [np.zeros((5, 3))], [np.eye(3), np.zeros((1, 3))]])
def test_too_few_sticks(sticks):
    with pytest.raises(InputRefused, match="needs two sticks"):
        fit_sticks(sticks)


def fitted(points, threads=0, **options):
    return run(lambda work: fit_points(work, points, **options), threads=threads)


def test_scattered_points_of_a_vertical_bent_fault():
    """x = 3 sin(y / 20): no function of x and y."""
    random = np.random.default_rng(5)
    y, z = random.uniform(0, 100, 400), random.uniform(-50, 0, 400)
    points = np.column_stack([3 * np.sin(y / 20), y, z])
    vertices, triangles = fitted(points)
    error = np.abs(vertices[:, 0] - 3 * np.sin(vertices[:, 1] / 20))
    assert error.max() < 0.3 and np.median(error) < 0.02
    assert np.ptp(vertices[:, 2]) == pytest.approx(np.ptp(z), rel=0.02)
    assert triangles.dtype == np.int32
    again, same = fitted(points, threads=1)
    assert np.array_equal(vertices, again) and np.array_equal(triangles, same)


def test_extended_points_lie_on_the_plane_of_all():
    random = np.random.default_rng(6)
    u, v = random.uniform(0, 100, 200), random.uniform(0, 40, 200)
    points = np.column_stack([0.6 * v, u, -0.8 * v])
    wide, _ = fitted(points, extend=25.0)
    assert np.abs(0.8 * wide[:, 0] + 0.6 * wide[:, 2]).max() < 1e-6
    assert np.ptp(wide[:, 1]) == pytest.approx(np.ptp(u) + 50, rel=0.02)
    down, _ = fitted(points, extend=25.0, extend_sideways=False)
    assert np.ptp(down[:, 1]) == pytest.approx(np.ptp(u), rel=0.01)
    assert np.ptp(down[:, 2]) > 0.8 * (np.ptp(v) + 45)


def test_points_in_one_line_show_no_surface():
    with pytest.raises(InputRefused, match="one line"):
        fitted(np.outer(np.arange(9.0), [1, 2, 3]))


def test_convex_hull():
    inside = np.random.default_rng(1).uniform(0.1, 0.9, (50, 2))
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    assert convex_hull(np.concatenate([inside, corners])).tolist() == corners.tolist()


def test_a_file_of_sticks(write):
    file = write("f.pol", "1 2 3\n1 2 5\n999.000 999.000 999.000\n4 5 6\n4 5 7\n4 5 9\n999 999 999\n")
    sticks, warnings = read_fault_points(PointFile(file, z_axis="down", units={"z": "ft"}), model_unit="ft")
    assert [stick.tolist() for stick in sticks] != [] and warnings == []
    assert sticks[1][:, 2].tolist() == [-6, -7, -9]
    assert len(sticks) == 2
    as_text = write("f.txt", file.read_text())  # detected from its content
    assert len(read_fault_points(PointFile(as_text))[0]) == 2


def test_sticks_of_charisma(write):
    """Names may have blanks, and the marks stand before one number or both, or are one with it."""
    rows = [("F 1", 1, (1, 2, -3.5)), ("F 1", 1, (1, 2, -5)), ("F 1", 2, (4, 5, -6)), ("7", 1, (8, 9, -1))]
    for mark in ("INLINE-  1650 1702", "INLINE-1650  1702", "INLINE : 1650  1702"):
        lines = [f"{mark}  {x} {y} {z}  {name} {stick}" for name, stick, (x, y, z) in rows]
        file = write("f.dat", "\n".join(lines))
        sticks, _ = read_fault_points(PointFile(file, layer="F 1"))
        assert [stick.tolist() for stick in sticks] == [[[1, 2, -3.5], [1, 2, -5]], [[4, 5, -6]]]
        with pytest.raises(InputRefused, match="F 1, 7"):
            read_fault_points(PointFile(file))
    with pytest.raises(InputRefused, match=r"f.dat:2: 'INLINE- 3' is no point of a stick"):
        read_fault_points(PointFile(write("f.dat", lines[0] + "\nINLINE- 3\n")))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("1 2 3\n1 2\n", ":2: 3 values"),
        ("a b c\n", ":1: 'a b c'"),
        ("", "no points"),
        ("1 2 inf\n", ":1: a coordinate"),
    ],
)
def test_damaged_sticks(write, text, said):
    with pytest.raises(InputRefused, match=said):
        read_fault_points(PointFile(write("f.pol", text)))


def test_a_table_of_sticks(write):
    file = write("f.csv", "stick,x,y,z\nA,1,2,3\nA,1,2,4\n7,5,2,5\n7,5,2,6\n7,5,2,7\n")
    sticks, _ = read_fault_points(PointFile(file))
    assert [len(stick) for stick in sticks] == [2, 3]
    other = write("g.csv", file.read_text().replace("stick", "line"))
    assert isinstance(read_fault_points(PointFile(other))[0], np.ndarray)
    for column in ("line", 1):
        assert [len(stick) for stick in read_fault_points(PointFile(other), column)[0]] == [2, 3]
    with pytest.raises(InputRefused, match="nothing"):
        read_fault_points(PointFile(other), "nothing")
