# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults given by their trace, a line on the ground, and their dip."""

import json
import math
import sqlite3
import struct

import numpy as np
import pytest
from conftest import ROOT
from realmodel.core import (
    BuildFailed,
    Fault,
    InputRefused,
    PointFile,
    Project,
    Rock,
    Surface,
    build,
    build_surfaces,
    load_project,
)
from realmodel.core.base.packages import vendored
from realmodel.core.base.work import run
from realmodel.core.project.project_writer import save_project
from realmodel.core.readers import read_point_file
from realmodel.core.results.displacements import displacements
from realmodel.core.structures.shapes.reading import read_structures
from realmodel.core.surfaces.prepare import read_rocks
from structure_cases import SQUARE, plane_fault

try:
    shapefile = vendored("shapefile", "pyshp", "this test")
except BuildFailed:
    shapefile = None
needs_pyshp = pytest.mark.skipif(shapefile is None, reason="addon/realmodel/vendor has no pyshp")

THROW = 1.0
NORTHWARD = np.array([[5.0, 2.0], [5.0, 8.0]])


def horizons(offset=(0.0, 0.0)):
    """Points of two level surfaces, lower by THROW east of what is between x = 2 and 8."""
    plan = [(x, y) for x in (0.5, 1, 1.5, 2, 8, 8.5, 9, 9.5) for y in np.linspace(0.25, 9.75, 6)]
    return [
        Surface(
            name, points=np.array([(x + offset[0], y + offset[1], z - THROW * (x > 5)) for x, y in plan]),
            method="natural_neighbour", options={"extrapolate": "nearest"},
        )
        for name, z in (("a", 0.0), ("b", 2.0))
    ]  # fmt: skip


def project(*faults, surfaces=None, **keys):
    rock = Rock("r", surfaces or horizons(), region=SQUARE, edge_length=1.0, base_elevation=-3.0, **keys)
    return Project("p", [rock], faults=list(faults))


def fault_of(*faults, **keys):
    """Vertices and triangles of the first fault as it was made, and all warnings."""
    found = build_surfaces(project(*faults, **keys))
    return *found.structures.shapes[0], [warning.text for warning in found.warnings]


def volumes(model):
    return [block.volume for block in model.blocks]


def attitude(vertices, triangles):
    """Dip and dip direction, in degrees, of each triangle."""
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    normal *= np.where(normal[:, 2:] < 0, -1.0, 1.0)
    level = np.hypot(normal[:, 0], normal[:, 1])
    return np.degrees(np.arctan2(level, normal[:, 2])), np.degrees(np.arctan2(*normal[:, :2].T)) % 360


@pytest.mark.parametrize("dip", [30.0, 45.0, 60.0, 75.5])
@pytest.mark.parametrize("side", [1, -1])
def test_a_straight_trace_is_the_plane(dip, side):
    """Blocks are those of the same plane given as a mesh, to rounding, and so is the throw."""
    lean = side / math.tan(math.radians(dip))
    trace = Fault("F", trace=NORTHWARD, dip=dip, dip_direction=90.0 * side, elevation=0.5)
    one = build(project(trace))
    other = build(project(Fault("F", *plane_fault(x=5.0 + 0.5 * lean, lean=lean, y=(-30.0, 40.0)))))
    assert volumes(one) == pytest.approx(volumes(other), rel=1e-12)
    assert [b.volume for b in one.blocks] != pytest.approx([300.0, 200.0], rel=1e-3)
    thrown = [each for each in displacements(one) if each.throw.size]
    assert len(thrown) == 2
    for each in thrown:
        # above F is the hanging wall: it is lower in the east
        assert each.throw == pytest.approx(np.full(len(each.throw), side * THROW), rel=1e-9)


def test_a_vertical_one_needs_no_direction():
    one = build(project(Fault("F", trace=NORTHWARD, dip=90)))
    other = build(project(Fault("F", *plane_fault(y=(-30.0, 40.0)))))
    assert volumes(one) == pytest.approx(volumes(other), rel=1e-12)


@pytest.mark.parametrize("turn", [0.0, 17.0, 90.0, 200.0])
def test_dip_and_direction_in_any_position(turn):
    """The side alone: the dip is at right angles to the trace."""
    along = np.array([math.sin(math.radians(turn)), math.cos(math.radians(turn))])
    trace = 5.0 + np.array([-4.0, 4.0])[:, None] * along
    words = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")
    word = words[round((turn + 90.0) / 45.0) % 8]
    vertices, triangles, warnings = fault_of(
        Fault("F", trace=trace, dip=50, dip_direction=word.lower(), elevation=0)
    )
    dips, directions = attitude(vertices, triangles)
    assert dips == pytest.approx(np.full(len(dips), 50.0))
    assert directions == pytest.approx(np.full(len(dips), (turn + 90.0) % 360))
    assert not warnings


def test_it_passes_through_its_line_and_through_all_rock():
    """A bent line in space: all rulings go toward the dip direction, and reach beyond the rock all around."""
    line = np.array([[4.5, 1, 0.3], [5.2, 4, 0.6], [4.9, 6, 0.1], [5.4, 9, 0.2]])
    vertices, _triangles, warnings = fault_of(Fault("F", trace=line, dip=60, dip_direction=100.0))
    assert not warnings
    down = np.array([math.sin(math.radians(100)), math.cos(math.radians(100))]) / math.tan(math.radians(60))
    at_zero = vertices[:, :2] + vertices[:, 2:] * down
    for x, y, z in line:
        assert np.linalg.norm(at_zero - (x, y) - z * down, axis=1).min() < 1e-9
    assert vertices[:, 2].min() < -3.0 and vertices[:, 2].max() > 2.0
    assert vertices[:, 1].min() < -1.0 and vertices[:, 1].max() > 11.0
    model = build(project(Fault("F", trace=line, dip=60, dip_direction=100.0)))
    assert model.compartment_names == ["below F", "above F"]


def ground_mesh(height, n=41):
    x, y = (each.ravel() for each in np.meshgrid(*[np.linspace(-2.0, 12.0, n)] * 2, indexing="ij"))
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return np.column_stack([x, y, height(x, y)]), triangles


def beside_a_corner(seed):
    """A region, one of its corners, and a trace from there that goes along the outline or leaves the region
    beside it, with a dip and its direction."""
    rng = np.random.default_rng(seed)
    region = np.array([[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0], [0.0, 1000.0]])
    if seed % 4:
        count = int(rng.integers(3, 7))
        angles = 2 * np.pi * (np.arange(count) + rng.uniform(0.1, 0.6, count)) / count
        region = 600 * np.column_stack([np.cos(angles), np.sin(angles)])
    if seed % 4 == 1:
        region = np.round(region)
    if seed % 4 == 2:
        region += [412345.25, 5412345.5]
    at = int(rng.integers(len(region)))
    before, corner, after = (region[(at + step) % len(region)] for step in (-1, 0, 1))
    ways = [way / np.hypot(*way) for way in (corner - before, after - corner)]
    way = [ways[0] + ways[1], *ways][int(rng.integers(3))]
    way = way / np.hypot(*way)
    trace = np.array([corner, corner + rng.choice([-1, 1]) * way * rng.uniform(50, 300)])
    across = np.array([way[1], -way[0]]) * rng.choice([-1, 1])
    direction = float(np.degrees(np.arctan2(*across)) % 360)
    return region, corner, trace, rng.choice([30.0, 45.0, 60.0, rng.uniform(20, 85)]), direction


def corner_model(region, trace, dip, direction, **options):
    """Two surfaces of points below a level ground at 400 that the trace is on."""
    rng = np.random.default_rng(0)
    low, high = region.min(axis=0), region.max(axis=0)
    surfaces = []
    for name, height in (("A", 150.0), ("B", 250.0)):
        plan = rng.uniform(low, high, (30, 2))
        surfaces.append(
            Surface(name, points=np.column_stack([plan, height + 10 * np.sin((plan[:, 0] - low[0]) / 200)]))
        )
    corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
    ground = Surface("ground", np.column_stack([corners, np.full(4, 400.0)]), [[0, 1, 2], [0, 2, 3]])
    rock = Rock("r", [*surfaces, ground], region=region, edge_length=150.0, base_elevation=0.0)
    fault = Fault(
        "F", trace=trace, dip=dip, dip_direction=direction, elevation=400.0, youngest="B", **options
    )
    return build(Project("p", [rock], faults=[fault]))


def require_no_slivers(model):
    """It passes validation, and no two vertices are as near to each other as rounding."""
    assert not [(test.name, test.failed) for test in model.validate(100).tests if test.failed]
    vertices = model.vertices
    away = np.abs(vertices[:, None] - vertices).max(axis=2)
    np.fill_diagonal(away, np.inf)
    assert away.min() > 4 * np.spacing(np.abs(vertices).max())


@pytest.mark.parametrize("seed", [None, *range(8), 60])
def test_a_trace_from_a_corner_of_the_region_leaves_no_sliver_there(seed):
    """The surface has the corner itself, and not a point beside it by rounding, with a sliver between."""
    if seed is None:
        region = np.array([[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0], [0.0, 1000.0]])
        corner, trace, dip, direction = region[0], np.array([[0.0, 0.0], [-100.0, 100.0]]), 60.0, 225.0
    else:
        region, corner, trace, dip, direction = beside_a_corner(seed)
    model = corner_model(region, trace, float(dip), direction)
    assert not [(test.name, test.failed) for test in model.validate(100).tests if test.failed]
    away = np.abs(model.vertices - [*corner, 400.0]).max(axis=1)
    assert (away < 1e-6).sum() == 1


WHOLE = [[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0], [0.0, 1000.0]]
OBLIQUE = [
    [233.13210604436847, 197.00084449687765],
    [-287.1597529089942, 164.86738282161244],
    [-63.92747179774037, -442.66062748396286],
    [303.5187955982292, -151.48739306358263],
]


@pytest.mark.parametrize(
    ("region", "trace", "dip", "direction"),
    [
        (WHOLE, [[0.0, 0.0], [-111.87750418976714, 0.0]], 45.0, 180.0),
        (WHOLE, [[0.0, 0.0], [175.39889940424223, 0.0]], 45.0, 180.0),
        (WHOLE, [[729.5141327590196, 0.0], [1000.0, 0.0]], 60.0, 180.0),
        (OBLIQUE, [[221.0, 255.0], [262.43288745300055, 51.93111985206485]], 90.0, None),
    ],
)
def test_a_fault_that_dies_out_at_a_wall_leaves_no_sliver_beside_it(region, trace, dip, direction):
    """Where the surface goes on beyond its tip it runs along the wall, or there is less than rounding between
    the tip and the wall."""
    model = corner_model(np.array(region), np.array(trace), dip, direction, dies_out=True)
    assert not [(test.name, test.failed) for test in model.validate(100).tests if test.failed]


@pytest.mark.parametrize(
    ("region", "trace", "dip", "direction"),
    [
        (
            [[159.0, 579.0], [-511.0, -314.0], [553.0, -232.0]],
            [[553.0, -232.0], [465.6604777344208, -238.7310534076856]],
            60.0,
            175.5930589429607,
        ),
        (
            [[505.0, 324.0], [-421.0, 428.0], [154.0, -580.0]],
            [[154.0, -580.0], [226.7494065803234, -392.6340069840103]],
            45.0,
            111.2199134979131,
        ),
    ],
)
def test_a_trace_on_the_outline_leaves_no_vertices_that_only_rounding_keeps_apart(
    region, trace, dip, direction
):
    """The part of the rock beyond the fault is a point but for rounding."""
    require_no_slivers(corner_model(np.array(region), np.array(trace), dip, direction))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("dies_out", [False, True])
def test_traces_beside_the_outline_leave_no_slivers(seed, dies_out):
    region, _, trace, dip, direction = beside_a_corner(seed)
    require_no_slivers(corner_model(region, trace, float(dip), direction, dies_out=dies_out))


def test_a_side_gives_the_plane_through_the_line_back():
    """A trace across a slope is oblique to the dip direction; with the side alone it is the same plane."""
    lean = 1 / math.tan(math.radians(35))
    line = np.array([[5.0 - lean * z, y, z] for y, z in ((1, 0.5), (4, 0.9), (5, 0.2), (9, 2.5))])
    vertices, _, _ = fault_of(Fault("F", trace=line, dip=35, dip_direction="SE"))
    assert np.abs(vertices[:, 0] - 5.0 + lean * vertices[:, 2]).max() < 1e-9
    steep = Fault("F", trace=line, dip=5, dip_direction="SE")
    with pytest.raises(
        InputRefused, match="between the ends of its trace is about as steep as its dip, 5 deg"
    ):
        fault_of(steep)


def test_a_trace_on_a_hilly_ground_gives_the_plane_back():
    """The line in which a plane cuts the ground, without elevations, bends with the valleys; on the ground it
    is the plane again. On a surface below, by name, it is another one."""

    def height(x, y):
        return 4.0 + 0.5 * np.sin(1.3 * y)

    lean = 1 / math.tan(math.radians(40))
    y = np.linspace(0.5, 9.5, 300)
    line = np.column_stack(
        [5.0 - lean * (height(None, y) - 4.0), y]
    )  # where x = 5 - lean (z - 4) is the ground
    ground = Surface("ground", *ground_mesh(height, 281))
    given = Fault("F", trace=line, dip=40, dip_direction=90.0, youngest="b")
    vertices, _, warnings = fault_of(given, surfaces=[*horizons(), ground])
    off = vertices[:, 0] - 5.0 + lean * (vertices[:, 2] - 4.0)
    assert np.abs(off).max() < 0.01  # half a unit without the ground
    assert not warnings
    given.elevation = "b"
    vertices, _triangles, _ = fault_of(given, surfaces=[*horizons(), ground])
    off = vertices[:, 0] - 5.0 + lean * (vertices[:, 2] - 4.0)
    assert 1.0 < np.median(np.abs(off)) < 6.0  # lower than the ground by about 3


def test_two_points_on_a_hilly_ground_follow_it_between_them():
    """A straight line in plan over a ridge: between its ends the surface bends."""
    ground = Surface("ground", *ground_mesh(lambda x, y: 4.0 - 0.5 * np.abs(y - 5.0)))
    given = Fault("F", trace=[[5.0, 0.0], [5.0, 10.0]], dip=45, dip_direction="E", extend=2.0)
    vertices, _, _ = fault_of(given, surfaces=[*horizons(), ground])
    flat = vertices[:, 0] + vertices[:, 2]  # x where z is 0
    middle = np.abs(vertices[:, 1] - 5.0).argmin()
    assert flat[middle] == pytest.approx(9.0, abs=0.02)
    end = np.abs(vertices[:, 1]).argmin()
    assert flat[end] == pytest.approx(5.0 + 1.5, abs=0.02)
    assert len(vertices) == 15  # straight pieces need no more: five rulings, with the line itself


def test_dies_out_and_extend():
    """It ends with its line, or so far beyond it, and goes through the rock otherwise."""

    def ends(**keys):
        vertices, _, _ = fault_of(Fault("F", trace=NORTHWARD, dip=90, **keys))
        return vertices[:, 1].min(), vertices[:, 1].max()

    assert ends(dies_out=True) == (2.0, 8.0)
    assert ends(dies_out=True, extend=0.5) == (1.5, 8.5)
    assert ends(extend=4.0) == (-2.0, 12.0)
    low, high = ends()
    assert low < -2.0 and high > 12.0
    with pytest.raises(InputRefused, match=r"fault 'F'.*inside the rock"):
        build(project(Fault("F", trace=NORTHWARD, dip=90, extend=0.5)))
    build(project(Fault("F", trace=NORTHWARD, dip=90, dies_out=True, extend=0.5)))


def test_pieces_are_joined():
    """Lines that go on from one another, in any order and direction, one over a gap."""
    pieces = [np.array([[5, 6], [5, 7.5]]), np.array([[5, 4], [5, 2.0]]), np.array([[5, 4], [5, 5.5]])]
    vertices, _triangles, warnings = fault_of(Fault("F", trace=pieces, dip=70, dip_direction=90))
    whole, _, _ = fault_of(Fault("F", trace=[[5.0, 2], [5, 7.5]], dip=70, dip_direction=90))
    assert vertices.min(axis=0) == pytest.approx(whole.min(axis=0))
    assert vertices.max(axis=0) == pytest.approx(whole.max(axis=0))
    assert warnings == [
        "fault 'F': gaps of 0.5 between the 3 lines of its trace are bridged by straight lines"
    ]


def test_a_fault_in_one_rock_mass_of_two():
    """It goes through what it displaces, wherever the other one lies."""
    away = np.array([500.0, 0.0])
    far = Rock("far", horizons(away), region=SQUARE + away, edge_length=1.0)
    given = project(Fault("F", trace=NORTHWARD, dip=60, dip_direction="E", rocks=["r"]))
    alone = build(given)
    given.rocks.append(far)
    assert volumes(build(given))[:2] == pytest.approx(volumes(alone), rel=1e-12)


def faults_geojson(**more):
    def feature(properties, places):
        geometry = {"type": "LineString", "coordinates": places}
        return {"type": "Feature", "properties": properties, "geometry": geometry}

    return json.dumps(
        {
            "type": "FeatureCollection",
            "features": [
                feature({"NAME": "F1", "Dip": 60, "DIP_DIR": "E", **more}, [[5, 2], [5, 8]]),
                feature({"NAME": "F2", "Dip": "-999", "DIP_DIR": None}, [[2, 2], [2, 8]]),
                feature({"NAME": "F3", "Dip": 80, "strike": 180}, [[3, 2], [3, 8]]),
            ],
        }
    )


def test_attributes_of_a_file(write):
    """Dip and direction of the line's own feature; keys of the fault take precedence."""
    file = write("faults.geojson", faults_geojson())

    def of(name, **keys):
        return fault_of(Fault(name, trace=PointFile(file, where={"name": name}), elevation=1, **keys))[:2]

    for given, dip, direction in (
        (of("F1"), 60, 90),
        (of("F1", dip=75), 75, 90),
        (of("F1", dip_direction=270.0), 60, 270),
        (of("F2", dip=40, dip_direction="W"), 40, 270),
        (of("F3"), 80, 270),
    ):
        dips, directions = attitude(*given)
        assert dips == pytest.approx(np.full(len(dips), dip))
        assert directions == pytest.approx(np.full(len(dips), direction))
    with pytest.raises(InputRefused, match=r"fault 'F2': it has no dip.*set dip"):
        of("F2")
    with pytest.raises(InputRefused, match="no dip direction; set dip_direction = 90 or 270"):
        of("F2", dip=60)
    with pytest.raises(
        InputRefused, match=r"faults.geojson: fault 'F': the lines of its trace are not connected"
    ):
        fault_of(Fault("F", trace=file))
    file.write_text(faults_geojson(Dip=95))
    with pytest.raises(
        InputRefused, match=r"feature 1: its attribute of the dip is 95.0; it must be above 0"
    ):
        of("F1")
    pieces = json.loads(faults_geojson())
    pieces["features"][2]["geometry"]["coordinates"] = [[5, 8], [5, 9]]
    file.write_text(json.dumps(pieces))
    both = PointFile(file, where={"NAME": ["F1", "F3"]})
    with pytest.raises(InputRefused, match=r"differ in 'dip': it is 60.0 in feature 1 and 80.0 in feature 3"):
        fault_of(Fault("F", trace=both))
    fault_of(Fault("F", trace=both, dip=90))


def packed(line, z=None):
    code, rows = (2, line) if z is None else (1002, [(*place, z) for place in line])
    body = struct.pack("<BII", 1, code, len(rows)) + b"".join(struct.pack(f"<{len(r)}d", *r) for r in rows)
    return b"GP" + struct.pack("<BBi", 0, 1, 0) + body


@needs_pyshp
def test_files_of_lines(write, tmp_path):
    """The same trace from each format, with z and without, and in feet."""
    line = [[5.0, 2.0], [5.0, 8.0]]
    write("a.wkt", "LINESTRING (5 2, 5 8)")
    write("z.wkt", "LINESTRING Z (5 2 0.5, 5 8 0.5)")
    write("a.geojson", faults_geojson())
    with shapefile.Writer(str(tmp_path / "a.shp"), shapeType=shapefile.POLYLINEZ) as writer:
        writer.field("DIP_DIRECT", "N")
        writer.field("DIP", "N")
        writer.linez([[[*place, 0.5] for place in line]])
        writer.record(90, 60)
    base = sqlite3.connect(tmp_path / "a.gpkg")
    base.execute("CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT)")
    for layer, at in (("faults", line), ("other", [[1.0, 2.0], [2.0, 2.0]])):
        base.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom')", (layer,))
        base.execute(f"CREATE TABLE {layer} (geom BLOB, dip REAL, strike REAL)")
        base.execute(f"INSERT INTO {layer} VALUES (?, 60, 0)", (packed(at, 0.5),))
    base.commit()
    base.close()
    given = {"dip": 60, "dip_direction": "E"}
    wanted, _, _ = fault_of(Fault("F", trace=np.array(line), **given, elevation=0.5))
    for fault in (
        Fault("F", trace=tmp_path / "a.wkt", **given, elevation=0.5),
        Fault("F", trace=tmp_path / "z.wkt", **given),
        Fault("F", trace="LINESTRING Z (5 2 0.5, 5 8 0.5)", **given),
        Fault("F", trace=PointFile(tmp_path / "a.geojson", where={"NAME": "F1"}), elevation=0.5),
        Fault("F", trace=tmp_path / "a.shp"),
        Fault("F", trace=PointFile(tmp_path / "a.gpkg", layer="faults")),
    ):
        assert fault_of(fault)[0] == pytest.approx(wanted), fault.trace
    files = {path.name for path in project(Fault("F", trace=tmp_path / "a.shp")).input_files()}
    assert files == {"a.shp", "a.shx", "a.dbf"}
    feet = (np.array(line) / 0.3048).tolist()
    write("feet.wkt", f"LINESTRING ({feet[0][0]!r} {feet[0][1]!r}, {feet[1][0]!r} {feet[1][1]!r})")
    in_feet = Fault("F", trace=PointFile(tmp_path / "feet.wkt", units="ft"), **given, elevation=0.5)
    assert fault_of(in_feet)[0] == pytest.approx(wanted)
    write("zero.wkt", "LINESTRING Z (5 2 0, 5 8 0)")
    _, _, warnings = fault_of(Fault("F", trace=tmp_path / "zero.wkt", **given))
    assert warnings == [
        "fault 'F': its line has elevation 0 everywhere; if that is no elevation, set elevation = ..."
    ]


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
mesh = "s1.off"
[[fault]]
name = "F1"
"""
LINE = "trace = [[0.5, 0], [0.5, 1]]\n"


@pytest.fixture
def written(write):
    """written(text) writes a project file with a rock mass of two surfaces and a fault that says so."""
    for n in (0, 1):
        write(f"s{n}.off", f"OFF\n4 2 0\n0 0 {n}\n1 0 {n}\n1 1 {n}\n0 1 {n}\n3 0 1 2\n3 0 2 3\n")
    write("points.geojson", '{"type": "Point", "coordinates": [1, 2]}')
    write("line.wkt", "LINESTRING (0 0, 1 1)")
    write("ring.wkt", "LINESTRING (0 0, 1 1, 0 1, 0 0)")
    write("table.csv", "x,y\n0,0\n1,1\n")
    return lambda text: write("p.toml", HEAD + text)


def test_a_project_file(written, tmp_path):
    """Everything that a file may say of a trace, and that it is written again."""
    path = written(
        LINE + 'dip = 60\ndip_direction = 80\nelevation = "S0"\nextend = 2.0\n[[fault]]\nname = "F2"\n'
        "trace = [[[0.2, 0, 0.5], [0.2, 0.5]], [[0.2, 0.5], [0.2, 1, 1]]]\ndip = 90\ndies_out = true\n"
        '[[fault]]\nname = "F3"\ntrace = "line.wkt"\nunits = "ft"\nz_axis = "down"\ndip = 80\n'
        'dip_direction = "NW"\n'
    )
    read = load_project(path)
    first, second, third = read.faults
    assert (first.dip, first.dip_direction, first.elevation, first.extend) == (60, 80, "S0", 2)
    assert np.array_equal(first.trace[:, :2], [[0.5, 0], [0.5, 1]]) and np.isnan(first.trace[:, 2]).all()
    assert np.array_equal(second.trace[1], [[0.2, 0.5, np.nan], [0.2, 1, 1]], equal_nan=True)
    assert (third.trace.units, third.trace.z_axis, third.dip_direction) == ("ft", "down", "NW")
    read.faults.pop()
    for surface in read.rocks[0].surfaces:
        surface.vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
        surface.triangles, surface.mesh = np.array([[0, 1, 2]]), None
    save_project(read, tmp_path / "again.toml")
    again = load_project(tmp_path / "again.toml")
    for one, other in zip(read.faults, again.faults, strict=True):
        assert np.array_equal(np.concatenate([*one.trace]), np.concatenate([*other.trace]), equal_nan=True)
        for key in ("name", "dip", "dip_direction", "elevation", "extend", "dies_out"):
            assert getattr(one, key) == getattr(other, key), key


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (LINE, "p.toml:13: fault 'F1': a trace needs a dip; add dip = ... (90 where the fault is vertical)"),
        (LINE + "dip = 0", "p.toml:14: fault 'F1': 'dip' must be more than 0, not 0"),
        (LINE + "dip = 91", "p.toml:14: fault 'F1': 'dip' must be at most 90, not 91"),
        (LINE + "dip = 60", "fault 'F1': it has a dip, but no dip direction; set dip_direction = 90 or 270"),
        (
            LINE + 'dip = 60\ndip_direction = "up"',
            "p.toml:15: fault 'F1': 'dip_direction' must be a direction",
        ),
        (
            LINE + "dip = 60\ndip_direction = true",
            "p.toml:15: fault 'F1': 'dip_direction' must be a direction",
        ),
        (
            LINE + 'dip = 60\ndip_direction = "N"',
            "fault 'F1': its dip direction, N, is along its trace, which runs at right angles to 90 and 270",
        ),
        (
            LINE + "dip = 60\ndip_direction = 10",
            "p.toml:11: fault 'F1': its dip direction is along its trace",
        ),
        (
            LINE + 'dip = 60\ndip_direction = "E"\nelevation = "S7"',
            "p.toml:16: fault 'F1': 'elevation' names surface 'S7', which the rock that it displaces lacks",
        ),
        (LINE + 'dip = 90\nmesh = "s0.off"', "it has both trace and mesh"),
        (
            LINE + "dip = 90\nstick = 1",
            "p.toml:15: fault 'F1': 'stick' has no effect, as its shape is a trace",
        ),
        (LINE + "dip = 90\nextend = -1", "p.toml:15: fault 'F1': 'extend' must be at least 0, not -1"),
        (LINE + 'dip = 90\nlayer = "x"', "p.toml:15: fault 'F1': 'layer' needs a file"),
        ('mesh = "s0.off"\ndip = 90', "p.toml:14: fault 'F1': 'dip' has no effect, as its shape is no trace"),
        ("trace = 3\ndip = 90", "p.toml:13: fault 'F1': 'trace' must be a file or a list of points"),
        (
            "trace = [[0, 0],\n[1]]\ndip = 90",
            "p.toml:14: fault 'F1': trace: a point must be two or three numbers",
        ),
        (
            "trace = [[0, 0]]\ndip = 90",
            "fault 'F1': its trace has no length in plan; give two points or more",
        ),
        ("trace = []\ndip = 90", "fault 'F1': its trace has no length in plan"),
        ('trace = "no.shp"\ndip = 90', "p.toml:13: fault 'F1': file not found"),
        ('trace = "line.wkt"', "fault 'F1': it has no dip, and its file has no attribute 'dip'; set dip"),
        ('trace = "points.geojson"\ndip = 90', "there are no lines in it (it has points)"),
        ('trace = "table.csv"\ndip = 90', "table.csv: fault 'F1': neither GeoJSON, well-known text"),
        ('trace = "line.wkt"\ndip = 90\ndecimal = ","', "it has lines, so 'decimal' has no effect"),
        ('trace = "ring.wkt"\ndip = 90', "its trace returns to where it begins, (0, 0); cut it open"),
        (
            "trace = [[0, 0], [1, 0], [1, 1], [0.5, -1]]\ndip = 90",
            "fault 'F1': its surface crosses itself",
        ),
        ("trace = [[0, 0], [1, 0], [0.5, 0]]\ndip = 90", "its surface crosses itself"),
        (
            "trace = [[[0, 0], [1, 0]], [[0, 0.2], [1, 0.2]]]\ndip = 90",
            "the lines of its trace are not connected",
        ),
        (
            "trace = [[[0, 0], [1, 0]], [[9, 0], [10, 0]]]\ndip = 90",
            "the lines of its trace are not connected",
        ),
        (
            "trace = [[0, 0, 0], [0.1, 0, -0.1]]\ndip = 45\ndip_direction = 90",
            "its trace runs down its dip: it shows no surface",
        ),
    ],
)
def test_refused_with_the_line(written, text, said):
    with pytest.raises(InputRefused) as raised:
        build_surfaces(load_project(written(text)))
    assert said in str(raised.value) and "\n" not in str(raised.value)


def test_arrays_that_are_no_lines():
    for trace, said in (
        (np.zeros(4), "must be an array"),
        (np.zeros((3, 4)), "must be an array"),
        ([[0, 0], [np.inf, 0]], "point 1 of the trace is .*, not finite"),
        ([[[0, 0], [1, 1]], [[0, 0], ["x", 1]]], "line 2 of the trace must be an array"),
    ):
        with pytest.raises(InputRefused, match=f"fault 'F': .*{said}"):
            build_surfaces(project(Fault("F", trace=trace, dip=90)))


def test_numbers_of_numpy():
    given = Fault("F", trace=NORTHWARD, dip=np.int64(60), dip_direction=np.float32(90), elevation=np.int32(1))
    wanted, _, _ = fault_of(Fault("F", trace=NORTHWARD, dip=60.0, dip_direction="E", elevation=1.0))
    assert fault_of(given)[0] == pytest.approx(wanted)
    given.elevation = np.ones(3)
    with pytest.raises(InputRefused, match="'elevation' must be a number or the name of a surface"):
        fault_of(given)


def test_an_oblique_direction_is_warned_of():
    """Exactly the direction given, with what the dip becomes then."""
    vertices, triangles, warnings = fault_of(
        Fault("F", trace=NORTHWARD, dip=45, dip_direction=140, elevation=0)
    )
    dips, directions = attitude(vertices, triangles)
    steeper = math.degrees(math.atan(1 / math.cos(math.radians(50))))
    assert dips == pytest.approx(np.full(len(dips), steeper))
    assert directions == pytest.approx(np.full(len(dips), 90.0))
    assert warnings == [
        "fault 'F': its dip direction is oblique to its trace, so that it dips 57 degrees toward 90, not 45; "
        "check the dip direction"
    ]


def test_the_elevation_is_needed_where_nothing_says_it():
    surfaces = [*horizons(), Surface("top", method="parallel", options={"to": "b", "thickness": 3.0})]
    given = Fault("F", trace=NORTHWARD, dip=60, dip_direction="E")
    with pytest.raises(
        InputRefused, match=r"fault 'F': the elevation of its trace is not known: .*'top' has no"
    ):
        fault_of(given, surfaces=surfaces)
    given.elevation = 2.5
    vertices, _, _ = fault_of(given, surfaces=surfaces)
    assert vertices[:, 2].max() > 5.0
    surfaces = [*horizons(), Surface("top", method="constant", options={"value": 7.0})]
    given.elevation = None
    vertices, _, _ = fault_of(given, surfaces=surfaces)
    wanted, _, _ = fault_of(
        Fault("F", trace=NORTHWARD, dip=60, dip_direction="E", elevation=7.0), surfaces=surfaces
    )
    assert np.allclose(vertices.min(axis=0), wanted.min(axis=0))


MAP = ROOT.parent / "shared" / "data" / "field" / "hamersley_map_dips"


@pytest.mark.skipif(not MAP.is_dir(), reason="../shared/data/field/hamersley_map_dips is not there")
def test_faults_of_a_real_map():
    """Each on the relief of the ground: vertical as its attributes say, and with a dip of 30 to its side."""
    ground = read_point_file(PointFile(MAP / "dtm.tif"))[0][::5]
    low, high = ground.min(axis=0), ground.max(axis=0)
    region = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
    surfaces = [
        Surface(name, points=ground + np.array([0, 0, z])) for name, z in (("base", -3000), ("ground", 0))
    ]
    given = Project("map", [Rock("r", surfaces, np.array(region), edge_length=2000.0)])
    features = json.loads((MAP / "faults.geojson").read_text())["features"][::4]
    for feature in features:
        trace = PointFile(MAP / "faults.geojson", where={"objectid": feature["properties"]["objectid"]})
        (line,) = feature["geometry"]["coordinates"]
        (dx, dy) = np.subtract(line[-1], line[0])
        side = math.degrees(math.atan2(dy, -dx)) % 360  # to the left of it
        word = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")[round(side / 45) % 8]
        given.faults.append(Fault(f"{len(given.faults)} as it is", trace=trace))
        given.faults.append(
            Fault(f"{len(given.faults)} {side}", trace=trace, dip=30, dip_direction=word, dies_out=True)
        )
    faults, _, warnings = run(lambda work: read_structures(work, given, inputs=read_rocks(work, given)))
    assert warnings == []
    for plain, dipping in zip(faults[::2], faults[1::2], strict=True):
        assert np.allclose(attitude(plain.vertices, plain.triangles)[0], 90)
        assert attitude(dipping.vertices, dipping.triangles)[0].min() > 30 - 1e-6
        a, b, c = dipping.vertices[dipping.triangles].transpose(1, 0, 2)
        normal = np.cross(b - a, c - a).sum(axis=0)
        normal *= np.sign(normal[2])
        assert math.degrees(math.acos(normal[2] / np.linalg.norm(normal))) == pytest.approx(30, abs=1e-6)
        wanted = float(dipping.name.split()[1])
        assert (math.degrees(math.atan2(*normal[:2])) - wanted + 180) % 360 - 180 == pytest.approx(0, abs=45)
