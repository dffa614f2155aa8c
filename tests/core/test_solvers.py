# SPDX-License-Identifier: GPL-3.0-or-later
"""Solvers take the meshes: checkMesh finds no fault, two solvers that share nothing find one flux, and
CalculiX finds the settlement that is known."""

import functools
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from realmodel.core import Project, Rock, Surface, build, load_project
from realmodel.core.exporters import save_mesh
from realmodel.core.simulation.elements import ElementFaces
from sample_scripts import built_sample
from solver_meshes import check_solver_mesh, least_angles
from solvers import (
    foam_heat,
    foam_program,
    ogs_heat,
    ogs_program,
    run_calculix,
    run_foam,
    run_ogs,
    write_ogs_nodes,
)
from stacks import places, project_files, real_data

SAMPLES = Path(__file__).parents[2] / "blend_samples"
MEDIA = (1.0, 0.1)  # of the blocks of two_layers

foam_only = pytest.mark.skipif(
    foam_program("checkMesh") is None,
    reason="OpenFOAM is absent: scripts/install_dependencies.sh solvers",
)
ogs_only = pytest.mark.skipif(ogs_program() is None, reason="OpenGeoSys is absent: pip install ogs")
calculix_only = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="CalculiX is absent: scripts/install_dependencies.sh solvers"
)
data_only = pytest.mark.skipif(not places.REAL_DATA.is_dir(), reason=places.DATA_ABSENT)


def of_meshes(name, meshes, **more):
    surfaces = [Surface(name=surface, vertices=v, triangles=t) for surface, (v, t) in meshes.items()]
    return build(Project(name=name, rocks=[Rock(name=name, surfaces=surfaces, **more)]))


def model_of(name, folder):
    if name == "drogon":
        return of_meshes(name, real_data.drogon())
    if name == "pleasant":
        return of_meshes(name, real_data.pleasant(), base_elevation=100.0)
    if name == "claudius":
        points = real_data.claudius_points()
        return build(
            load_project(project_files.points_project(folder, name, points, real_data.CLAUDIUS_REGION, 150.0))
        )
    return built_sample(name)


@foam_only
@pytest.mark.parametrize(
    ("name", "edge", "thickness", "layer"),
    [
        ("two_layers", 4, 0.7, 2),
        ("gravel_plain", 12, 2, 6),
        ("castle_hill", 40, 6, 18),
        ("haut_barr", 4, 0.8, 2),
        pytest.param("claudius", 150, 25, 75, marks=data_only),
        pytest.param("drogon", 80, 16, 32, marks=data_only),
        pytest.param("pleasant", 150, 12, 30, marks=data_only),
    ],
)
def test_check_mesh_finds_no_fault(tmp_path, name, edge, thickness, layer):
    mesh = model_of(name, tmp_path).simulation_mesh(edge, thickness, layer_thickness=layer)
    save_mesh(mesh, tmp_path / "case.foam")
    output = run_foam("checkMesh", tmp_path / "case.foam", "-allGeometry", "-allTopology")
    assert "Mesh OK." in output, "\n".join(line for line in output.splitlines() if "***" in line)
    found = re.search(r"non-orthogonality Max: ([0-9.]+)", output)
    assert float(found[1]) < 70
    assert least_angles(mesh.plan.vertices, mesh.plan.triangles).min() > 20


@functools.cache
def overturned_fold(base=-8.0):
    """A section with overturned limbs, given as points. As heights they are steep, and cross one another."""
    rng = np.random.default_rng(0)
    along = np.linspace(0.0, 16.0, 160)
    surfaces = []
    for number in range(7):
        z = 1.3 * np.sin(1.6 * along + 1.0)
        x = along + 1.1 * z
        kept = (rng.random(len(x)) < 0.35) & (x > 0) & (x < 16)
        points = np.column_stack([x, rng.uniform(-0.5, 0.5, len(x)), z + 0.5 * number])[kept]
        surfaces.append(Surface(f"S{number}", points=points, method="natural_neighbour", tie=False))
    return section_model(surfaces, base)


@functools.cache
def hecho_fold():
    """The section of shared/data/folds/hecho_sparse, its points taken as heights."""
    folder = places.REAL_DATA / "folds" / "hecho_sparse"
    points = [np.loadtxt(folder / f"s{n}.csv", delimiter=",", skiprows=1) for n in range(6)]
    surfaces = [
        Surface(f"S{n}", points=p, method="natural_neighbour", tie=False) for n, p in enumerate(points)
    ]
    return section_model([*surfaces, Surface("top", mesh=folder / "top.off")], -2.0)


def section_model(surfaces, base):
    region = [[0.0, -0.5], [16.0, -0.5], [16.0, 0.5], [0.0, 0.5]]
    rock = Rock("r", surfaces, region=region, base_elevation=base, edge_length=0.3)
    return build(Project("section", [rock]))


def skew_faces(output):
    """How many faces checkMesh finds too skew, and the largest skewness."""
    found = re.search(r"Max skewness = ([0-9.]+)(?:, ([0-9]+) highly skew)?", output)
    return int(found[2] or 0), float(found[1])


@foam_only
@pytest.mark.parametrize("elements", ["prisms", "tetrahedra"])
@pytest.mark.parametrize(
    ("model", "edge", "thickness", "layer"),
    [
        (overturned_fold, 0.32, 0.032, None),
        (overturned_fold, 0.533, 0.0533, 0.266),
        (overturned_fold, 0.64, 0.016, 1.6),
        pytest.param(hecho_fold, 0.32, 0.032, 0.107, marks=data_only),
        pytest.param(hecho_fold, 0.229, 0.0457, 0.16, marks=data_only),
    ],
)
def test_check_mesh_takes_steep_crossing_surfaces(tmp_path, model, edge, thickness, layer, elements):
    mesh = model().simulation_mesh(edge, thickness, layer_thickness=layer, elements=elements)
    check_solver_mesh(mesh)
    save_mesh(mesh, tmp_path / "case.foam")
    output = run_foam("checkMesh", tmp_path / "case.foam")
    assert "Mesh OK." in output, "\n".join(line for line in output.splitlines() if "***" in line)
    assert not [warning for warning in mesh.warnings if warning.kind == "mesh_skewness"]


def thin_zigzag(slope):
    """Two sheets, 0.4 m high, on slopes up and down, and nothing below."""
    x = np.linspace(0.0, 10.0, 41)
    z = slope * np.abs((x + 1) % 4 - 2)
    first = 2 * np.arange(40)[:, None]
    triangles = np.add(first, [0, 2, 3, 0, 3, 1]).reshape(-1, 3)
    plan = np.column_stack([np.repeat(x, 2), np.tile([0.0, 3.0], 41)])
    heights = [np.repeat(z, 2) + 0.4 * k for k in range(3)]
    return [Surface(f"S{k}", np.column_stack([plan, h]), triangles) for k, h in enumerate(heights)]


@foam_only
@pytest.mark.parametrize("elements", ["prisms", "tetrahedra"])
def test_faces_that_stay_skew_are_told(tmp_path, elements):
    """One element in a column, thin and steep: there is nothing that it could become one with."""
    model = build(Project("z", [Rock("r", thin_zigzag(30))]))
    mesh = model.simulation_mesh(0.5, 0.05, elements=elements)
    save_mesh(mesh, tmp_path / "case.foam")
    count, most = skew_faces(run_foam("checkMesh", tmp_path / "case.foam"))
    (told,) = (warning.text for warning in mesh.warnings if warning.kind == "mesh_skewness")
    assert told.startswith(f"{count} faces have a skewness above 4, up to {most:.1f} near (")
    assert "use a shorter edge length, or a base_elevation farther below" in told


@pytest.fixture(scope="module")
def two_layers():
    return built_sample("two_layers")


@pytest.fixture(scope="module")
def foam_flux(two_layers, tmp_path_factory):
    """The heat that flows in on top of the prisms, by laplacianFoam."""
    mesh = two_layers.simulation_mesh(3.0, 0.48, layer_thickness=1.2)
    return foam_heat(mesh, tmp_path_factory.mktemp("foam"), MEDIA)


@foam_only
def test_laplacian_foam_converges(foam_flux):
    """Heat flows through clay and sand in series: between what either would let through alone."""
    area = 100.0 * 60.0
    assert MEDIA[1] * area / 26 < foam_flux < MEDIA[0] * area / 15


@foam_only
@ogs_only
def test_open_geo_sys_and_open_foam_agree(two_layers, foam_flux, tmp_path):
    mesh = two_layers.simulation_mesh(3.0, 0.48, layer_thickness=1.2, elements="tetrahedra")
    assert ogs_heat(mesh, tmp_path, MEDIA) == pytest.approx(foam_flux, rel=0.01)


def ogs_boundaries(mesh, folder):
    """Writes the faces of the groups top and base; returns the numbers of their points."""
    nodes = []
    for group in ("top", "base"):
        corners = [found.corners["triangle"] for found in ElementFaces(mesh).sets() if found.group == group]
        write_ogs_nodes(folder / f"{group}.vtu", mesh.points, np.concatenate(corners))
        nodes.append(np.unique(np.concatenate(corners)))
    return nodes


def residuals(mesh, diffusion, values):
    """(P,) what flows out of each point of tetrahedra, by linear elements. diffusion: of each block."""
    elements = mesh.elements["tetrahedron"]
    points = mesh.points[elements]
    edges = points[:, 1:] - points[:, :1]
    slopes = np.linalg.inv(edges).transpose(0, 2, 1)  # of the functions that are 1 at a corner
    slopes = np.concatenate([-slopes.sum(axis=1, keepdims=True), slopes], axis=1)
    gradient = np.einsum("eij,ei->ej", slopes, values[elements])
    weight = np.asarray(diffusion)[mesh.element_block["tetrahedron"]] * np.linalg.det(edges) / 6
    out = np.zeros(len(mesh.points))
    np.add.at(out, elements, weight[:, None] * np.einsum("eij,ej->ei", slopes, gradient))
    return out


@ogs_only
def test_open_geo_sys_takes_tetrahedra_with_a_material_for_each_block(tmp_path):
    """Of a model without columns. Its solution solves our own equations with these materials, and no other:
    so it has read our elements, and for each the number of its block."""
    model = built_sample("fault_blocks")
    mesh = model.simulation_mesh(166.7, 33.33, elements="tetrahedra")
    save_mesh(mesh, tmp_path / "mesh.vtu")
    media = 10.0 ** -np.arange(len(mesh.block_names))
    assert len(media) > 2
    assert set(np.unique(mesh.element_block["tetrahedron"])) == set(range(len(media)))
    top, base = ogs_boundaries(mesh, tmp_path)
    pressure = run_ogs(tmp_path, "mesh", media, "base", "top")
    assert pressure[top] == pytest.approx(1, abs=1e-12)
    assert pressure[base] == pytest.approx(0, abs=1e-12)
    assert pressure.min() >= -0.01
    assert pressure.max() <= 1.01
    inside = np.ones(len(mesh.points), bool)
    inside[top] = inside[base] = False
    out = residuals(mesh, media, pressure)
    flux = out[top].sum()
    assert flux > 0
    assert out[base].sum() == pytest.approx(-flux, rel=1e-6)
    assert np.abs(out[inside]).max() < 1e-8 * flux
    other = residuals(mesh, media[::-1], pressure)
    assert np.abs(other[inside]).max() > 1e-3 * flux


GRAVITY = 9.81
COLUMN = {"clay": (6.0, 20e6, 1900.0), "sand": (4.0, 60e6, 1700.0)}  # height, Young's modulus, density


def column(layers):
    """A model of flat layers of 3 x 2."""
    corners = np.array([[0, 0], [3, 0], [3, 2], [0, 2]], float)
    heights = np.cumsum([height for height, _, _ in layers.values()])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    surfaces = [
        Surface(name, np.column_stack([corners, np.full(4, height)]), triangles, block=name)
        for name, height in zip(layers, heights, strict=True)
    ]
    return build(Project(name="column", rocks=[Rock(name="column", surfaces=surfaces, base_elevation=0.0)]))


def settlement(layers):
    """Of the top of a column whose sides do not move outwards: each layer carries what lies above it."""
    total, load = 0.0, 0.0
    for height, stiffness, density in reversed(layers.values()):
        total += (load + density * GRAVITY * height / 2) * height / stiffness
        load += density * GRAVITY * height
    return total


@calculix_only
@pytest.mark.parametrize(("elements", "within"), [("prisms", 1e-6), ("tetrahedra", 0.04)])
@pytest.mark.parametrize("names", [["clay"], ["clay", "sand"]])
def test_calculix_finds_the_settlement_under_own_weight(tmp_path, names, elements, within):
    """Of one layer rho g H^2 / 2 E, where Poisson's ratio is 0. Columns of prisms are exact at nodes; the
    load of tetrahedra is not spread evenly over theirs."""
    layers = {name: COLUMN[name] for name in names}
    (height, stiffness, density) = COLUMN["clay"]
    assert settlement({"clay": COLUMN["clay"]}) == pytest.approx(
        density * GRAVITY * height**2 / (2 * stiffness)
    )
    mesh = column(layers).simulation_mesh(1.0, 0.1, layer_thickness=1.0, elements=elements)
    save_mesh(mesh, tmp_path / "mesh.inp")
    moved = run_calculix(tmp_path, "mesh.inp", {name: layer[1:] for name, layer in layers.items()}, GRAVITY)
    top = mesh.points[:, 2] == sum(layer[0] for layer in layers.values())
    assert top.sum() > 10
    assert -moved[top, 2] == pytest.approx(np.full(top.sum(), settlement(layers)), rel=within)
    base = mesh.points[:, 2] == 0
    assert not moved[base].any()
