# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of prisms for solvers: valid, conforming, no thinner than asked, with the volumes of the model."""

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from realmodel.core import (
    Body,
    Cancelled,
    Fault,
    InputRefused,
    Project,
    Rock,
    Surface,
    UsageError,
    build,
    load_project,
)
from realmodel.core.simulation.elements import ElementFaces
from sample_scripts import built_sample
from solver_meshes import block_volumes, check_solver_mesh, least_angles, outside_volume
from stacks import places, real_data
from stacks.generate import random_stack
from stacks.model_view import rocks_of
from stacks.project_files import stack_project
from stacks.rock_masses import random_rock_masses
from structure_cases import plane_fault

SAMPLES = Path(__file__).parents[2] / "blend_samples"
SQUARE = [[0.0, 0.0], [100.0, 0.0], [100.0, 60.0], [0.0, 60.0]]


def plane(name, height, corners=SQUARE, **more):
    """A surface of two triangles over a rectangle; height: a number, or one for each corner."""
    heights = np.broadcast_to(np.asarray(height, float), 4)
    vertices = np.column_stack([np.asarray(corners, float), heights])
    return Surface(name=name, vertices=vertices, triangles=[[0, 1, 2], [0, 2, 3]], **more)


def checked(mesh):
    outside = check_solver_mesh(mesh)
    volumes = block_volumes(mesh)
    assert mesh.volumes == pytest.approx(volumes, rel=1e-9)
    assert outside_volume(mesh, outside) == pytest.approx(volumes.sum(), rel=1e-9)
    return mesh


def thicknesses(mesh):
    """The heights of all upright edges, from point to point upward."""
    order = np.lexsort(mesh.points.T[::-1])
    points = mesh.points[order]
    same = (points[1:, :2] == points[:-1, :2]).all(axis=1)
    return (points[1:, 2] - points[:-1, 2])[same]


@pytest.mark.parametrize(
    ("sample", "edge", "thickness", "deviation", "elements"),
    [
        ("two_layers", 4.0, 0.2, 0.003, "prisms"),
        ("two_layers", 4.0, 0.2, 0.003, "tetrahedra"),
        ("gravel_plain", 15.0, 0.5, 0.03, "prisms"),
        ("gravel_plain", 15.0, 0.5, 0.03, "tetrahedra"),
        ("castle_hill", 20.0, 0.8, 0.04, "tetrahedra"),  # made of prisms
    ],
)
def test_samples(sample, edge, thickness, deviation, elements):
    model = built_sample(sample)
    mesh = checked(model.simulation_mesh(edge, thickness, layers=2, elements=elements))
    assert (set(mesh.elements) == {"tetrahedron"}) == (elements == "tetrahedra")
    assert mesh.exact_volumes.tolist() == [block.volume for block in model.blocks]
    assert mesh.volumes == pytest.approx(mesh.exact_volumes, rel=deviation)
    assert mesh.volumes.sum() == pytest.approx(mesh.exact_volumes.sum(), rel=0.001)
    assert thicknesses(mesh).min() >= 0.999 * thickness
    assert least_angles(mesh.plan.vertices, mesh.plan.triangles).min() > 19.5


@pytest.mark.skipif(not places.REAL_DATA.is_dir(), reason=places.DATA_ABSENT)
@pytest.mark.parametrize(
    ("data", "edge", "thickness", "more"),
    [
        ("drogon", 150.0, 1.0, {}),
        ("pleasant", 200.0, 0.5, {"base_elevation": 100.0}),
        ("shellmound", 1600.0, 2.0, {}),
    ],
)
def test_real_data(data, edge, thickness, more):
    meshes = getattr(real_data, data)()
    surfaces = [Surface(name=name, vertices=v, triangles=t) for name, (v, t) in meshes.items()]
    model = build(Project(name=data, rocks=[Rock(name=data, surfaces=surfaces, **more)]))
    mesh = checked(model.simulation_mesh(edge, thickness, layers=2))
    assert mesh.volumes == pytest.approx(mesh.exact_volumes, rel=0.01)
    assert mesh.volumes.sum() == pytest.approx(mesh.exact_volumes.sum(), rel=0.001)


@settings(
    derandomize=True,
    deadline=None,
    database=None,
    max_examples=40,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate],
)
@given(
    st.sampled_from(
        ["partial", "jumps", "regions", "rules", "T-junctions", "coinciding", "utm", *["rock masses"] * 4]
    ),
    st.sampled_from([2, 4, 8, 16]),
    st.sampled_from([10, 40, 200]),
    st.sampled_from([1, 2, 3]),
    st.randoms(use_true_random=True),
)
def test_random_stacks(tmp_path_factory, family, fineness, thinness, layers, rng):
    """Steps, walls between rock masses, holes, and regions that touch themselves: conforming all the same."""
    case = random_rock_masses(rng) if family == "rock masses" else random_stack(rng, family)
    path = stack_project(tmp_path_factory.mktemp("stack"), rocks_of(case))
    assume(path is not None)
    model = build(load_project(path))
    assume(len(model.cell_block))
    extent = np.ptp(model.vertices, axis=0)
    thickness = max(extent[2] / thinness, 1e-9 * np.abs(model.vertices).max())
    try:
        mesh = model.simulation_mesh(extent[:2].max() / fineness, thickness, layers=layers)
    except InputRefused as error:
        assert "smaller in plan" in str(error)
        return
    check_solver_mesh(mesh)
    assert mesh.volumes == pytest.approx(block_volumes(mesh), rel=1e-6)
    if len(mesh.points):
        assert thicknesses(mesh).min() >= 0.99 * thickness


@pytest.mark.parametrize("thickness", [4.5, 5.5, 7.0])
@pytest.mark.parametrize("share", [None, 0.5])
def test_a_model_of_one_element_is_not_eroded(thickness, share):
    """A wedge from 4 to 16 m, alone or of two layers: only what is thinner than asked is given up, though
    every element of a column of one is under-determined."""
    top = np.array([4.0, 16.0, 16.0, 4.0])
    middle = [] if share is None else [plane("S1", share * top)]
    surfaces = [plane("S0", 0.0), *middle, plane("S2", top)]
    model = build(Project(name="wedge", rocks=[Rock(name="r", surfaces=surfaces)]))
    mesh = checked(model.simulation_mesh(5.0, thickness))
    thinner = (thickness - 4.0) / 12.0  # share of the length where the model is
    lost = 6000.0 * thinner * (4.0 + thickness) / 2
    assert mesh.exact_volumes.sum() - mesh.volumes.sum() == pytest.approx(lost, abs=0.01 * 60_000)


def thin_layer(length, width, thickness):
    """A layer on waves, of a thickness that is a function of x and y, between thicker ones."""
    step = 100.0
    columns, rows = round(length / step) + 1, round(width / step) + 1
    x, y = (a.ravel() for a in np.meshgrid(np.arange(columns) * step, np.arange(rows) * step))
    low = -100 + 20 * np.sin(x / 300) * np.cos(y / 250)
    high = low + thickness(x, y)
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    others = corner + columns
    triangles = np.concatenate(
        [
            np.column_stack([corner, corner + 1, others + 1]),
            np.column_stack([corner, others + 1, others]),
        ]
    )
    surfaces = [
        Surface(name, vertices=np.column_stack([x, y, z]), triangles=triangles)
        for name, z in (("Low", low), ("Thin", high), ("Top", high + 20))
    ]
    return surfaces, triangles


@pytest.mark.parametrize("base", [None, -130.0])
@pytest.mark.parametrize("more", [{}, {"layer_thickness": 10.0}])
def test_a_hole_in_a_thin_layer_does_not_grow(base, more):
    """Ends of a thin layer are given up as solvers do badly with them, but where the next ones are no better
    the hole would take all of the layer, ring by ring."""

    def thickness(x, y):
        return 8 - 5 * np.exp(-((x - 4100) ** 2 + (y - 3600) ** 2) / 300**2)

    surfaces, _ = thin_layer(8000.0, 7000.0, thickness)
    model = build(Project("p", [Rock("r", surfaces, base_elevation=base)]))
    mesh = checked(model.simulation_mesh(200.0, 4.0, **more))
    assert mesh.volumes == pytest.approx(mesh.exact_volumes, rel=0.002)
    assert {warning.kind for warning in mesh.warnings} == {"mesh_thin_ends"}


@pytest.mark.parametrize("more", [{}, {"layer_thickness": 10.0}])
@pytest.mark.parametrize(("edge", "thickness"), [(200.0, 4.0), (400.0, 4.0), (300.0, 3.9)])
def test_holes_all_over_a_thin_layer_leave_what_is_thicker(edge, thickness, more):
    """No more is lost than where the layer is thinner than asked, within an edge length."""

    def of_layer(x, y):
        return 5 + 1.3 * np.sin(x / 300 + y / 370)

    surfaces, triangles = thin_layer(4000.0, 3000.0, of_layer)
    model = build(Project("p", [Rock("r", surfaces, base_elevation=-130.0)]))
    mesh = checked(model.simulation_mesh(edge, thickness, **more))
    thin = mesh.block_names.index("Thin block")
    x, y = surfaces[0].vertices[:, 0], surfaces[0].vertices[:, 1]
    heights = of_layer(x, y)[triangles].mean(axis=1)
    near = heights < thickness + 1.3 * edge / 300
    assert mesh.volumes[thin] > 0.98 * mesh.exact_volumes[thin] - 5_000 * heights[near].sum()
    assert any("'Thin block' keeps thin ends" in warning.text for warning in mesh.warnings)


def test_a_layer_ends_where_its_thickness_does():
    """A wedge from 0 to 6 m: prisms, then pyramids and tetrahedra, on a line of the planar mesh."""
    project = Project(
        name="wedge",
        rocks=[
            Rock(
                name="r",
                surfaces=[
                    plane("bottom", 0),
                    plane("low", [10, 10, 10, 10]),
                    plane("top", [4, 16, 16, 4]),
                ],
            )
        ],
    )
    model = build(project)
    mesh = checked(model.simulation_mesh(8.0, 0.01))
    # ends at the border that solvers could not compute with went to the layer below
    assert mesh.volumes == pytest.approx(mesh.exact_volumes, rel=0.05)
    assert mesh.volumes.sum() == pytest.approx(mesh.exact_volumes.sum(), rel=1e-9)
    line = np.isclose(mesh.points[:, 0], 50.0, atol=1e-9)
    assert line.sum() >= 16
    wedge = np.flatnonzero(np.array(mesh.block_names) == "top block")[0]
    in_wedge = np.concatenate(
        [e[mesh.element_block[kind] == wedge].ravel() for kind, e in mesh.elements.items()]
    )
    assert mesh.points[in_wedge, 0].min() == pytest.approx(50.0, abs=1e-9)
    # thicker than 1.5 m only: it ends where it has that, and nothing takes its place but the layer below
    thin = checked(model.simulation_mesh(8.0, 1.5))
    assert thicknesses(thin).min() >= 1.499
    assert thin.volumes.sum() == pytest.approx(mesh.volumes.sum(), rel=1e-9)
    assert thin.volumes[wedge] < mesh.volumes[wedge]
    assert mesh.warnings == []
    half = checked(model.simulation_mesh(8.0, 4.0))
    volume = f"{half.volumes[wedge]:.6g}"
    assert [str(warning) for warning in half.warnings] == [
        f"rock 'r': block 'top block' has a volume of {volume} in the mesh, and of 9000 in the model; a "
        "shorter edge length or a smaller minimum thickness changes less"
    ]


def test_rock_masses_of_other_layers_share_their_wall():
    """Surfaces of two rock masses cross on the wall between them; heights of one are nodes of the other."""
    left = [[0, 0], [50, 0], [50, 60], [0, 60]]
    right = [[50, 0], [100, 0], [100, 60], [50, 60]]
    project = Project(
        name="two",
        rocks=[
            Rock(
                name="a",
                surfaces=[plane("a0", 0, left), plane("a1", [8, 8, 14, 14], left), plane("a2", 30, left)],
            ),
            Rock(
                name="b",
                surfaces=[plane("b0", -5, right), plane("b1", [14, 14, 6, 6], right), plane("b2", 25, right)],
            ),
        ],
    )
    mesh = checked(build(project).simulation_mesh(6.0, 0.2, layers={"a2 block": 3}))
    assert mesh.volumes == pytest.approx(mesh.exact_volumes, rel=0.02)
    # the wall is whole: outside only above 25 on the left side and below 0 on the right one
    upright = []
    for kind, faces in mesh.faces.items():
        corners = mesh.points[faces[mesh.face_surface[kind] == -1]]
        upright += list(corners[np.isclose(corners[:, :, 0], 50).all(axis=1)])
    heights = np.array([corners[:, 2].mean() for corners in upright])
    assert len(heights)
    assert ((heights > 24.5) | (heights < 0.5)).all()


def test_a_step_within_a_surface():
    """A throw of 6 m along a line across the region: both sides keep their heights at it."""
    x, z = np.array([0, 50, 50, 100.0]), np.array([10, 10, 16, 16.0])
    vertices = np.array([[a, y, h] for a, h in zip(x, z, strict=True) for y in (0.0, 60.0)])
    triangles = [[0, 2, 3], [0, 3, 1], [4, 6, 7], [4, 7, 5]]
    step = Surface(name="step", vertices=vertices, triangles=triangles)
    model = build(Project(name="s", rocks=[Rock(name="r", surfaces=[plane("s0", 0), step, plane("s2", 30)])]))
    mesh = checked(model.simulation_mesh(7.0, 0.5))
    assert mesh.volumes == pytest.approx(mesh.exact_volumes, rel=1e-9)
    at_step = mesh.points[np.isclose(mesh.points[:, 0], 50)]
    assert set(np.round(at_step[:, 2], 6)) == {0.0, 10.0, 16.0, 30.0}


def test_division_into_layers():
    model = build(
        Project(name="b", rocks=[Rock(name="r", surfaces=[plane("s0", 0), plane("s1", 6), plane("s2", 30)])])
    )
    by_number = checked(model.simulation_mesh(10.0, 0.1, layers=[2, 3]))
    columns = len(by_number.plan.triangles)
    assert len(by_number.elements["prism"]) == 5 * columns
    assert by_number.plan.layers == 5
    by_thickness = checked(model.simulation_mesh(10.0, 0.1, layer_thickness=4.0))
    assert len(by_thickness.elements["prism"]) == 8 * columns  # 2 of 3 m and 6 of 4 m
    assert thicknesses(by_thickness).max() == pytest.approx(4.0)
    both = checked(model.simulation_mesh(10.0, 0.1, layers=3, layer_thickness=4.0))
    assert len(both.elements["prism"]) == 5 * columns
    layer, block = by_number.plan.layer["prism"], by_number.element_block["prism"]
    assert block[layer == 0].tolist() == [1] * columns  # the highest layer is the youngest


def test_thick_blocks_with_a_steep_top_are_divided():
    """Unless layers are given: then they are as asked, and faces that are too skew are told."""
    model = build(
        Project(name="b", rocks=[Rock(name="r", surfaces=[plane("s0", 0), plane("s1", [40, 340, 340, 40])])])
    )
    mesh = checked(model.simulation_mesh(5.0, 0.5))
    layers = mesh.plan.layers
    assert layers > 1 and mesh.volumes == pytest.approx(mesh.exact_volumes, rel=1e-9)
    assert [str(warning) for warning in mesh.warnings] == [
        f"rock 'r': block 's1 block' is divided into {layers} layers: as one it is too thick for how steep "
        "its top or base is; give the layers, or their thickness, for others"
    ]
    for one in (1, [1], {"s1 block": 1}):
        asked = checked(model.simulation_mesh(5.0, 0.5, layers=one))
        assert asked.plan.layers == 1
        (warning,) = asked.warnings
        assert re.match(r"\d+ faces have a skewness above 4, up to [0-9.]+ near \(", warning.text)
        assert warning.text.endswith("checkMesh fails them; use thinner layers in 's1 block'")
    thin = checked(model.simulation_mesh(5.0, 0.5, layer_thickness=8.0))
    assert not thin.warnings and thin.plan.layers == 43
    level = build(Project(name="b", rocks=[Rock(name="r", surfaces=[plane("s0", 0), plane("s1", 160)])]))
    assert level.simulation_mesh(5.0, 0.5).plan.layers == 1


def test_edges_are_shorter_where_asked():
    model = build(Project(name="b", rocks=[Rock(name="r", surfaces=[plane("s0", 0), plane("s1", 6)])]))
    plain = model.simulation_mesh(12.0, 0.1)
    graded = checked(
        model.simulation_mesh(12.0, 0.1, size=[{"at": [50, 30], "length": 2.0, "distance": 5.0}])
    )
    centers = graded.plan.vertices[graded.plan.triangles].mean(axis=1)
    near = np.hypot(*(centers - [50, 30]).T) < 5
    assert near.sum() > 30
    assert len(graded.plan.triangles) > 1.5 * len(plain.plan.triangles)
    outline = checked(
        model.simulation_mesh(12.0, 0.1, size=[{"at": "outline", "length": 3.0, "distance": 0.0}])
    )
    assert len(outline.faces["quadrilateral"]) > 2.5 * len(plain.faces["quadrilateral"])
    lines = model.simulation_mesh(12.0, 0.1, size=[{"at": "constraints", "length": 3.0, "distance": 0.0}])
    assert lines.points.tobytes() == outline.points.tobytes()  # both mean all lines


def test_edges_are_shorter_along_lines_inside():
    walls = [[0, 0], [60, 0], [60, 60], [0, 60.0]]
    rocks = [
        Rock(name="r", surfaces=[plane("s0", 0, walls), plane("s1", 6, walls)]),
        Rock(
            name="q",
            surfaces=[plane("s0", 0, np.add(walls, [60, 0])), plane("s1", 9, np.add(walls, [60, 0]))],
        ),
    ]
    model = build(Project(name="b", rocks=rocks))
    plain = model.simulation_mesh(12.0, 0.1)
    for word in ("outline", "constraints"):
        size = [{"at": word, "length": 3.0, "distance": 6.0}]
        mesh = checked(model.simulation_mesh(12.0, 0.1, size=size))
        within = [
            np.abs(m.plan.vertices[m.plan.triangles].mean(axis=1) - [60, 30]).max(axis=1) < 6
            for m in (mesh, plain)
        ]
        assert within[0].sum() > 4 * max(within[1].sum(), 1)


@pytest.mark.parametrize("elements", ["prisms", "tetrahedra"])
def test_a_mesh_of_no_elements(elements):
    """The model is nowhere as thick as asked."""
    model = build(Project(name="b", rocks=[Rock(name="r", surfaces=[plane("s0", 0), plane("s1", 6)])]))
    mesh = model.simulation_mesh(12.0, 1000.0, elements=elements)
    assert (mesh.elements, mesh.faces, mesh.volumes.tolist()) == ({}, {}, [0.0])
    assert any("s1" in str(warning) for warning in mesh.warnings)


def test_the_same_for_any_number_of_threads():
    model = built_sample("gravel_plain")
    one, two = (model.simulation_mesh(20.0, 0.5, threads=threads) for threads in (1, 2))
    assert one.points.tobytes() == two.points.tobytes()
    assert all(one.elements[kind].tobytes() == two.elements[kind].tobytes() for kind in one.elements)
    assert all(one.faces[kind].tobytes() == two.faces[kind].tobytes() for kind in one.faces)


def test_faces_name_their_surfaces():
    model = built_sample("two_layers")
    mesh = model.simulation_mesh(5.0, 0.2)
    corners, surface = mesh.faces["triangle"], mesh.face_surface["triangle"]
    assert set(surface.tolist()) <= {-2, -1, *range(len(mesh.surface_names))}
    for number in set(surface.tolist()) - {-1, -2}:
        vertices, _ = model.surface(number)
        heights = mesh.points[corners[surface == number], 2]
        assert heights.min() >= vertices[:, 2].min() - 0.21
        assert heights.max() <= vertices[:, 2].max() + 0.21


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"edge_length": 0}, "edge_length"),
        ({"minimum_thickness": -1}, "minimum_thickness"),
        ({"minimum_thickness": 1e-12}, "too small"),
        ({"elements": "cubes"}, "elements"),
        ({"layers": 0}, "layers"),
        ({"layers": {"nothing": 2}}, "no block"),
        ({"layers": [1, 2, 3]}, "3 numbers"),
        ({"layer_thickness": float("nan")}, "layer_thickness"),
        ({"mesher": "unknown"}, "mesher"),
    ],
)
def test_wrong_arguments(wrong, message):
    model = build(Project(name="b", rocks=[Rock(name="r", surfaces=[plane("s0", 0), plane("s1", 6)])]))
    with pytest.raises(UsageError, match=message):
        model.simulation_mesh(**{"edge_length": 10.0, "minimum_thickness": 0.1, **wrong})


def test_prisms_of_what_has_no_columns_are_refused():
    surfaces = [plane("s0", 0), plane("s1", 20)]
    rocks = [Rock(name="r", region=SQUARE, surfaces=surfaces)]
    inclined = Fault(
        name="F",
        vertices=[[30, -10, -10], [30, 70, -10], [70, 70, 40], [70, -10, 40.0]],
        triangles=[[0, 1, 2], [0, 2, 3]],
    )
    faulted = build(Project(name="b", rocks=rocks, faults=[inclined]))
    with pytest.raises(InputRefused, match="not vertical \\('F'\\)"):
        faulted.simulation_mesh(10.0, 0.1)
    half = build(Project(name="b", rocks=rocks)).cut_by_plane((50, 0, 0), (1, 0, 0)).above
    with pytest.raises(InputRefused, match="cut model"):
        half.simulation_mesh(10.0, 0.1)
    tetrahedron = (
        [[40, 20, 5], [60, 20, 5], [50, 40, 5], [50, 30, 15.0]],
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    )
    body = Body(name="B", vertices=tetrahedron[0], triangles=tetrahedron[1])
    with pytest.raises(InputRefused, match="bodies"):
        build(Project(name="b", rocks=rocks, bodies=[body])).simulation_mesh(10.0, 0.1)
    with pytest.raises(InputRefused, match="smaller in plan"):
        build(Project(name="b", rocks=rocks)).simulation_mesh(1e4, 0.1)


def test_a_vertical_fault_is_a_step():
    vertical = Fault(
        name="F",
        vertices=[[50, -10, -10], [50, 70, -10], [50, 70, 40], [50, -10, 40.0]],
        triangles=[[0, 1, 2], [0, 2, 3]],
    )
    points = [[x, y, 10.0 if x < 50 else 15.0] for x in range(5, 100, 10) for y in range(5, 60, 10)]
    top = Surface(name="s1", points=np.array(points), method="idw")
    rock = Rock(name="r", region=SQUARE, edge_length=10, surfaces=[plane("s0", 0), top, plane("s2", 30)])
    model = build(Project(name="b", rocks=[rock], faults=[vertical]))
    mesh = checked(model.simulation_mesh(7.0, 0.5))
    assert mesh.volumes == pytest.approx(mesh.exact_volumes, rel=1e-6)
    at_fault = mesh.points[np.isclose(mesh.points[:, 0], 50)]
    assert set(np.round(at_fault[:, 2], 6)) == {0.0, 10.0, 15.0, 30.0}
    assert fault_area(mesh, 3) == pytest.approx(60 * 30)


def fault_area(mesh, number):
    area = 0.0
    for kind, corners in mesh.faces.items():
        on = mesh.points[corners[mesh.face_surface[kind] == number]]
        spans = on[:, 1:] - on[:, :1]
        area += np.linalg.norm(np.cross(spans[:, :-1], spans[:, 1:]).sum(axis=1), axis=1).sum() / 2
    return area


@pytest.mark.parametrize("elements", ["prisms", "tetrahedra"])
@pytest.mark.parametrize("turn", [0.0, 20.0])
def test_faces_on_a_fault_have_its_number(turn, elements):
    """A fault that the youngest surface does not know has faces in the rock; without that surface, a scarp
    on top as well: a patch. The walls of the region have none."""

    def points(east, west, lift=0.0):
        x, y = np.random.default_rng(1).uniform(0.0, 10.0, (300, 2)).T
        side = x - 5 + (y - 5) * np.tan(np.radians(turn)) < 0
        return np.column_stack([x, y, np.where(side, west, east) + 0.1 * y + lift])

    surfaces = [Surface("S0", points=points(0.0, -1.0)), Surface("S1", points=points(2.2, 1.0))]
    square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]
    fault = Fault("F", *plane_fault(turn=turn), youngest="S1")
    for young in ([], [Surface("S2", points=points(4.0, 4.0))]):
        rock = Rock("r", [*surfaces, *young], region=square, edge_length=1.0, base_elevation=-5.0)
        model = build(Project("p", [rock], faults=[fault]))
        number = len(surfaces) + len(young)
        mesh = checked(model.simulation_mesh(1.0, 0.1, elements=elements))
        exact = 0.0
        for face in np.flatnonzero(model.face_surface == number):
            corners = model.vertices[
                model.face_vertices[model.face_offsets[face] : model.face_offsets[face + 1]]
            ]
            spans = corners[1:] - corners[0]
            exact += np.linalg.norm(np.cross(spans[:-1], spans[1:]).sum(axis=0)) / 2
        assert fault_area(mesh, number) == pytest.approx(exact, rel=0.005)
        sets = {found.name: found for found in ElementFaces(mesh).sets()}
        groups = {found.name for found in sets.values() if found.group}
        assert groups >= {"top", "base", "sides"}
        assert any(name.startswith("F") for name in sets)
        assert ("F" in {found.group for found in sets.values()}) == (not young)


def test_cancelled():
    model = built_sample("two_layers")
    with pytest.raises(Cancelled):
        model.simulation_mesh(0.2, 0.1, cancel=lambda: True)
