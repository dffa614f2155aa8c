# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults and bodies in projects and project files: what is read, and what is refused with which line."""

import numpy as np
import pytest
from realmodel.core import Body, Fault, InputRefused, Project, Rock, Surface, load_project
from realmodel.core.base.work import run
from realmodel.core.project.project_checks import check_project
from realmodel.core.project.project_writer import save_project
from realmodel.core.readers import read_mesh
from realmodel.core.structures.shapes.reading import read_structures
from structure_cases import plane_fault

HEAD = """\
format = 1
name = "x"
[[rock]]
name = "basin"
[[rock.surface]]
name = "S0"
mesh = "s0.off"
[[rock.surface]]
name = "S1"
mesh = "s0.off"
"""
CUBE = "OFF\n8 6 0\n" + "".join(f"{x} {y} {z}\n" for z in (0, 1) for y in (0, 1) for x in (0, 1))
CUBE += "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n"


@pytest.fixture
def project(write):
    """project(text) writes a project file with a rock mass of two surfaces, and this text behind it."""
    write("s0.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    write("f.ts", "GOCAD TSurf 1\nTFACE\nVRTX 1 0 0 0\nVRTX 2 0 1 0\nVRTX 3 0 1 1\nTRGL 1 2 3\nEND\n")
    write("f.pol", "0 0 1\n0 0 2\n999 999 999\n0 1 1\n0 1 2\n")
    write("cube.off", CUBE)
    write("open.off", CUBE.replace("8 6 0", "8 5 0").replace("4 0 2 3 1\n", ""))
    return lambda text: write("p.toml", HEAD + text)


def refused(path):
    with pytest.raises(InputRefused) as raised:
        run(lambda work: read_structures(work, load_project(path)))
    message = str(raised.value)
    assert "\n" not in message
    return message


def test_everything_that_a_file_may_say(project, tmp_path):
    read = load_project(
        project(
            """
[[fault]]
name = "F1"
mesh = "f.ts"
units = "ft"
youngest = "S0"
rocks = ["basin"]
[[fault]]
name = "F2"
points = "f.pol"
z_axis = "down"
extend = 2.5
ends_at = ["F1"]
youngest = "S0"
dies_out = true
[[body]]
name = "salt"
mesh = "cube.off"
after = "S0"
property = 7
rock = "basin"
[[body]]
name = "tunnel"
mesh = "cube.off"
void = true
"""
        )
    )
    first, second = read.faults
    assert (first.youngest, first.rocks, first.dies_out, first.mesh.units) == ("S0", ("basin",), False, "ft")
    assert (second.extend, second.ends_at, second.dies_out) == (2.5, ("F1",), True)
    assert second.points.z_axis == "down" and second.input_file == tmp_path / "f.pol"
    salt, tunnel = read.bodies
    assert (salt.after, salt.property, salt.void, salt.rock) == ("S0", 7, False, "basin")
    assert (tunnel.after, tunnel.void) == (None, True)
    assert {path.name for path in read.input_files()} >= {"f.ts", "f.pol", "cube.off"}
    faults, bodies, warnings = run(lambda work: read_structures(work, read))
    assert np.allclose(faults[0].vertices.max(axis=0), [0, 0.3048, 0.3048])
    assert faults[1].vertices[:, 2].min() == pytest.approx(-4.5)
    assert len(bodies[0].triangles) == 12 and warnings == []


F1 = '[[fault]]\nname = "F1"\nmesh = "f.ts"\n'
BODY = '[[body]]\nname = "B"\nmesh = "cube.off"\n'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (F1 + "young = 1", "p.toml:14: fault 'F1': unknown key 'young'; did you mean 'youngest'?"),
        (
            F1 + 'youngest = "S7"',
            "p.toml:14: fault 'F1': 'youngest' names surface 'S7', which does not exist",
        ),
        (F1 + 'ends_at = ["F9"]', "p.toml:14: fault 'F1': 'ends_at' names fault 'F9', which does not exist"),
        (F1 + 'ends_at = ["F1"]', "it cannot end at itself"),
        (F1 + 'ends_at = "F1"', "'ends_at' must be a list of names"),
        (
            F1 + 'rocks = ["hill"]',
            "p.toml:14: fault 'F1': 'rocks' names rock mass 'hill', which does not exist",
        ),
        (F1 + "dies_out = 1", "p.toml:14: fault 'F1': 'dies_out' must be true or false, not 1"),
        (F1 + "extend = -3", "p.toml:14: fault 'F1': 'extend' must be at least 0, not -3"),
        (F1 + 'points = "f.pol"', "it has both points and mesh"),
        ('[[fault]]\nname = "F1"\n', "fault 'F1': it has no shape; add mesh = ... or points = ..."),
        ('[[fault]]\nname = "F1"\nmesh = "no.ts"\n', "p.toml:13: fault 'F1': file not found"),
        ('[[fault]]\nname = "F1"\npoints = "f.pol"\nextend = -1', "'extend' must be at least 0, not -1"),
        (F1 + F1, "another fault has this name"),
        (
            F1 + 'youngest = "S0"\n[[fault]]\nname = "F2"\nmesh = "f.ts"\nends_at = ["F1"]\n',
            "fault 'F2': it displaces 'S1', but fault 'F1', at which it ends, does not",
        ),
        (
            F1 + 'ends_at = ["F2"]\n[[fault]]\nname = "F2"\nmesh = "f.ts"\nends_at = ["F1"]\n',
            "p.toml:14: fault 'F1': it ends at 'F2' at 'F1'",
        ),
        (BODY + 'after = "top"', "p.toml:14: body 'B': 'after' names surface 'top', which does not exist"),
        (BODY + 'rock = "hill"', "p.toml:14: body 'B': 'rock' names rock mass 'hill'"),
        (BODY + "void = true\nproperty = 3", "body 'B': a void has no rock, so 'property' has no effect"),
        (BODY + 'property = "x"', "'property' must be a whole number"),
        (BODY + BODY, "another body has this name"),
        (BODY.replace("cube", "open"), "body 'B': it is not closed: it has 4 open edges, one at (0.5, 0, 0)"),
    ],
)
def test_refused_with_the_line(project, text, said):
    assert said in refused(project(text))


def level(z):
    return np.array([[0, 0, z], [1, 0, z], [0, 1, z]], float), np.array([[0, 1, 2]])


def a_project(**structures):
    surfaces = [Surface("S0", *level(0)), Surface("S1", *level(1), property=2)]
    return Project("p", [Rock("r", surfaces)], **structures)


def test_arrays():
    vertices, triangles = plane_fault()
    fault = Fault("F", vertices, triangles[:, ::-1], "S0", ("G",), True)
    assert (fault.youngest, fault.ends_at, fault.dies_out) == ("S0", ("G",), True)
    body = Body("B", *level(0), "S0", 3, False)
    assert (body.after, body.property, body.void) == ("S0", 3, False)
    check_project(a_project(faults=[Fault("F", vertices, triangles)]))
    with pytest.raises(InputRefused, match="body 'B': it is not closed"):
        run(lambda work: read_structures(work, a_project(bodies=[body])))


def test_triangles_are_turned_to_go_on_from_their_neighbors():
    vertices, triangles = plane_fault()
    triangles = np.array([triangles[0], triangles[1][::-1]])
    faults, _, _ = run(
        lambda work: read_structures(work, a_project(faults=[Fault("F", vertices, triangles)]))
    )
    assert faults[0].triangles.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_a_surface_with_one_side_is_refused():
    """A Moebius strip."""
    angles = np.linspace(0, 2 * np.pi, 13)[:-1]
    edges = [
        [(4 + s * np.cos(a / 2)) * np.cos(a), (4 + s * np.cos(a / 2)) * np.sin(a), s * np.sin(a / 2)]
        for a in angles
        for s in (-1, 1)
    ]
    triangles = []
    for k in range(12):
        a, b = 2 * k, 2 * k + 1
        c, d = (a + 2, b + 2) if k < 11 else (1, 0)
        triangles += [[a, b, c], [c, b, d]]
    with pytest.raises(InputRefused, match="fault 'M': it has no two sides"):
        run(
            lambda work: read_structures(
                work, a_project(faults=[Fault("M", np.array(edges), np.array(triangles))])
            )
        )


def test_a_project_that_is_written_says_the_same(tmp_path):
    fault = Fault("F", *plane_fault(), youngest="S0", dies_out=True, rocks=("r",))
    other = Fault("G", *plane_fault(x=1.0), youngest="S0", ends_at=("F",))
    cube = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1.1)])
    faces = np.array([[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4]])
    sides = np.array([[2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]])
    bodies = [Body("B", cube, np.concatenate([faces, sides]), after="S0", property=4, rock="r")]
    bodies.append(Body("V", cube, bodies[0].triangles, void=True))
    project = a_project(faults=[fault, other], bodies=bodies)
    save_project(project, tmp_path / "p.toml")
    faults, read, _ = run(lambda work: read_structures(work, load_project(tmp_path / "p.toml")))
    for given, found in zip([*project.faults, *bodies], [*faults, *read], strict=True):
        assert np.array_equal(given.vertices, found.vertices)
        assert np.array_equal(given.triangles, found.triangles)
        for key in ("name", "youngest", "ends_at", "dies_out", "rocks", "after", "property", "void", "rock"):
            assert getattr(given, key, None) == getattr(found, key, None), key


def test_sticks_as_arrays():
    sticks = [np.array([[0, y, 0], [1, y, -5.0]]) for y in range(4)]
    project = a_project(
        faults=[Fault("F", points=sticks, extend=1.0), Fault("G", points=np.concatenate(sticks))]
    )
    faults, _, _ = run(lambda work: read_structures(work, project))
    assert len(faults[0].triangles) == 5 * 6
    assert np.ptp(faults[1].vertices[:, 1]) == pytest.approx(3.0)
    assert all(fault.points is None and fault.extend == 0 for fault in faults)
    check_project(a_project(faults=faults))


def test_a_mesh_with_depths(write):
    vertices = read_mesh(write("c.off", CUBE)).vertices
    body = Body("B", mesh=write("d.off", CUBE))
    _, bodies, _ = run(lambda work: read_structures(work, a_project(bodies=[body])))
    assert np.array_equal(bodies[0].vertices, vertices)
