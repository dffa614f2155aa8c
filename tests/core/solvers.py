# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenFOAM, OpenGeoSys, CalculiX and MODFLOW 6, where this machine has them."""

import contextlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from realmodel.core.exporters import save_mesh
from realmodel.core.simulation.elements import ElementFaces

# Debian's folder of OpenFOAM's settings, which its programs do not find alone
_FOAM_SETTINGS = Path("/usr/share/openfoam")
_SCALAR = "FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n"


def foam_program(name):
    """The path of a program of OpenFOAM, or None."""
    return shutil.which(name)


def ogs_program():
    """The path of OpenGeoSys, beside this Python (package `ogs`) or on PATH; or None."""
    beside = Path(sys.executable).with_name("ogs")
    return str(beside) if beside.is_file() else shutil.which("ogs")


def run_foam(program, case, *options):
    """What a program of OpenFOAM prints about a case."""
    environment = {"WM_PROJECT_DIR": str(_FOAM_SETTINGS), **os.environ}
    done = subprocess.run(
        [foam_program(program), "-case", case, *options],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    return done.stdout


def write_foam_fields(case, diffusivity):
    """T from 0 at the base to 1 on top, and a diffusivity of each cell."""
    (case / "0").mkdir()
    patches = (
        "top { type fixedValue; value uniform 1; } base { type fixedValue; value uniform 0; } "
        "sides { type zeroGradient; }"
    )
    (case / "0" / "T").write_text(
        _SCALAR.format(kind="volScalarField", name="T")
        + "dimensions [0 0 0 1 0 0 0];\ninternalField uniform 0;\n"
        + f"boundaryField {{ {patches} }}\n"
    )
    (case / "0" / "DT").write_text(
        _SCALAR.format(kind="volScalarField", name="DT")
        + "dimensions [0 2 -1 0 0 0 0];\n"
        + f"internalField nonuniform List<scalar> {len(diffusivity)}\n(\n"
        + "\n".join(f"{value:g}" for value in diffusivity)
        + '\n);\nboundaryField { ".*" { type zeroGradient; } }\n'
    )
    (case / "constant" / "transportProperties").write_text(
        _SCALAR.format(kind="dictionary", name="transportProperties") + "DT DT [0 2 -1 0 0 0 0] 1;\n"
    )


def scalar_field(path):
    """(C,) of a volScalarField that is not uniform."""
    text = path.read_text()
    count, values = re.search(r"internalField\s+nonuniform List<scalar>\s*(\d+)\s*\(([^)]*)\)", text).groups()
    field = np.array(values.split(), float)
    assert len(field) == int(count)
    return field


def run_ogs(folder, mesh_file, media, base, top):
    """Steady flow: pressure 0 on the mesh file `base` and 1 on `top`; media: permeability by MaterialID.
    Returns the pressure at each point."""
    media_text = "".join(
        f'<medium id="{number}"><properties>'
        f"<property><name>diffusion</name><type>Constant</type><value>{value:g}</value></property>"
        "<property><name>reference_temperature</name><type>Constant</type><value>293</value></property>"
        "</properties></medium>"
        for number, value in enumerate(media)
    )
    conditions = "".join(
        f"<boundary_condition><mesh>{name}</mesh><type>Dirichlet</type><parameter>p_{name}</parameter>"
        "</boundary_condition>"
        for name in (base, top)
    )
    (folder / "flow.prj").write_text(
        f"""<?xml version="1.0" encoding="ISO-8859-1"?>
<OpenGeoSysProject>
<meshes><mesh>{mesh_file}.vtu</mesh><mesh>{base}.vtu</mesh><mesh>{top}.vtu</mesh></meshes>
<processes><process><name>flow</name><type>STEADY_STATE_DIFFUSION</type><integration_order>2</integration_order>
<process_variables><process_variable>pressure</process_variable></process_variables>
<secondary_variables/></process></processes>
<media>{media_text}</media>
<time_loop><processes><process ref="flow"><nonlinear_solver>basic_picard</nonlinear_solver>
<convergence_criterion><type>DeltaX</type><norm_type>NORM2</norm_type><abstol>1e-10</abstol></convergence_criterion>
<time_discretization><type>BackwardEuler</type></time_discretization>
<time_stepping><type>SingleStep</type></time_stepping></process></processes>
<output><type>VTK</type><prefix>out</prefix><data_mode>Ascii</data_mode><compress_output>false</compress_output>
<variables><variable>pressure</variable></variables></output></time_loop>
<parameters><parameter><name>p0</name><type>Constant</type><value>0</value></parameter>
<parameter><name>p_{base}</name><type>Constant</type><value>0</value></parameter>
<parameter><name>p_{top}</name><type>Constant</type><value>1</value></parameter></parameters>
<process_variables><process_variable><name>pressure</name><components>1</components><order>1</order>
<initial_condition>p0</initial_condition><boundary_conditions>{conditions}</boundary_conditions>
</process_variable></process_variables>
<nonlinear_solvers><nonlinear_solver><name>basic_picard</name><type>Picard</type><max_iter>10</max_iter>
<linear_solver>linear</linear_solver></nonlinear_solver></nonlinear_solvers>
<linear_solvers><linear_solver><name>linear</name><eigen><solver_type>CG</solver_type>
<precon_type>DIAGONAL</precon_type><max_iteration_step>10000</max_iteration_step>
<error_tolerance>1e-14</error_tolerance></eigen></linear_solver></linear_solvers>
</OpenGeoSysProject>
"""
    )
    done = subprocess.run(
        [ogs_program(), "flow.prj"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-1000:]
    result = sorted(folder.glob("out_ts_1_*.vtu"))
    assert len(result) == 1, [path.name for path in folder.iterdir()]
    text = result[0].read_text()
    values = re.search(r'<DataArray[^>]*Name="pressure"[^>]*>([^<]*)<', text).group(1)
    return np.array(values.split(), float)


def foam_heat(mesh, folder, media):
    """The heat that flows in on top of a mesh, by laplacianFoam, from 0 at the base to 1 on top. media: the
    diffusivity of each block."""
    case = folder / "case.foam"
    save_mesh(mesh, case)
    cells = ElementFaces(mesh).polyhedral()
    write_foam_fields(case, np.asarray(media)[cells.cell_block])
    settings = case / "system" / "fvSolution"
    settings.write_text(settings.read_text().replace("Correctors 5", "Correctors 20"))
    control = case / "system" / "controlDict"
    control.write_text(control.read_text().replace("binary", "ascii"))
    output = run_foam("laplacianFoam", case)
    last = [line for line in output.splitlines() if "Solving for T" in line][-1]
    assert float(last.split("Initial residual = ")[1].split(",")[0]) < 1e-8, last
    times = [path for path in case.iterdir() if path.name[0].isdigit() and path.name != "0"]
    temperature = scalar_field(max(times, key=lambda path: float(path.name)) / "T")
    # what flows from the centers of the cells to the faces on top, across them
    areas, centers = face_geometry(cells)
    middles = cell_centers(cells, areas, centers)
    cell = cells.face_cells[:, 0]
    top = (cells.face_cells[:, 1] < 0) & (cells.face_surface != -1) & (areas[:, 2] > 0)
    cell, size = cell[top], np.linalg.norm(areas[top], axis=1)
    way = ((centers[top] - middles[cell]) * areas[top]).sum(axis=1) / size
    diffusivity = np.asarray(media)[cells.cell_block[cell]]
    return float((diffusivity * (1 - temperature[cell]) * size / way).sum())


def face_geometry(cells):
    """(F, 3) the area vector of each face, away from its first cell, and (F, 3) its center."""
    areas, centers = np.empty((2, len(cells.face_cells), 3))
    for face in range(len(areas)):
        corners = cells.points[cells.face_vertices[cells.face_offsets[face] : cells.face_offsets[face + 1]]]
        parts = np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0]) / 2
        weights = np.linalg.norm(parts, axis=1)
        middles = (corners[0] + corners[1:-1] + corners[2:]) / 3
        areas[face], centers[face] = parts.sum(axis=0), weights @ middles / weights.sum()
    return areas, centers


def cell_centers(cells, areas, centers):
    """(C, 3) the centers of the volumes of cells, from the pyramids over their faces."""
    volumes, moments, counts = np.zeros(cells.cells), np.zeros((cells.cells, 3)), np.zeros(cells.cells)
    inner = cells.face_cells[:, 1] >= 0
    sides = [(cells.face_cells[:, 0], areas, centers)]
    sides.append((cells.face_cells[inner, 1], -areas[inner], centers[inner]))
    rough = np.zeros((cells.cells, 3))
    for cell, _, center in sides:
        np.add.at(rough, cell, center)
        np.add.at(counts, cell, 1)
    rough /= counts[:, None]
    for cell, area, center in sides:
        pyramid = ((center - rough[cell]) * area).sum(axis=1) / 3
        np.add.at(volumes, cell, pyramid)
        np.add.at(moments, cell, pyramid[:, None] * (0.75 * center + 0.25 * rough[cell]))
    return moments / volumes[:, None]


def ogs_heat(mesh, folder, media):
    """The same by OpenGeoSys on tetrahedra: what linear elements dissipate at a difference of 1."""
    save_mesh(mesh, folder / "mesh.vtu")
    triangles, surface = mesh.faces["triangle"], mesh.face_surface["triangle"]
    corners = mesh.points[triangles]
    up = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    once = outside_triangles(mesh)
    flat = once & (surface != -1)
    write_ogs_nodes(folder / "top.vtu", mesh.points, triangles[flat & (up > 0)])
    write_ogs_nodes(folder / "base.vtu", mesh.points, triangles[flat & (up < 0)])
    pressure = run_ogs(folder, "mesh", media, "base", "top")
    elements = mesh.elements["tetrahedron"]
    points, values = mesh.points[elements], pressure[elements]
    edges = points[:, 1:] - points[:, :1]
    gradient = np.linalg.solve(edges, (values[:, 1:] - values[:, :1])[..., None])[..., 0]
    volume = np.linalg.det(edges) / 6
    diffusion = np.asarray(media)[mesh.element_block["tetrahedron"]]
    return float((diffusion * volume * (gradient**2).sum(axis=1)).sum())


def outside_triangles(mesh):
    """(F,) bool: which given triangles belong to one element only."""
    elements = mesh.elements["tetrahedron"]
    faces = np.sort(elements[:, [[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]]].reshape(-1, 3), axis=1)
    kinds, counts = np.unique(faces, axis=0, return_counts=True)
    single = {tuple(row) for row in kinds[counts == 1].tolist()}
    return np.array([tuple(sorted(row)) in single for row in mesh.faces["triangle"].tolist()])


def write_ogs_nodes(path, points, triangles):
    """A mesh of faces for boundary conditions, with the numbers of its points in the whole mesh."""
    used, corners = np.unique(triangles, return_inverse=True)
    corners = corners.reshape(-1, 3)

    def array(name, values, kind, components=1):
        text = " ".join(map(repr, np.ravel(values).tolist()))
        return (
            f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" '
            f'format="ascii">{text}</DataArray>'
        )

    path.write_text(
        '<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="1.0"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="{len(used)}" NumberOfCells="{len(corners)}">'
        f"<PointData>{array('bulk_node_ids', used, 'UInt64')}</PointData>"
        f"<Points>{array('Points', points[used], 'Float64', 3)}</Points>"
        f"<Cells>{array('connectivity', corners, 'Int64')}"
        f"{array('offsets', 3 * np.arange(1, len(corners) + 1), 'Int64')}"
        f"{array('types', np.full(len(corners), 5), 'UInt8')}</Cells>"
        "</Piece></UnstructuredGrid></VTKFile>"
    )


def run_calculix(folder, mesh_file, materials, gravity):
    """(N, 3) the displacements of all nodes under their own weight, the base held. materials: Young's modulus
    and density by the name of the block; Poisson's ratio is 0."""
    lines = [f"*INCLUDE, INPUT={mesh_file}"]
    for name, (stiffness, density) in materials.items():
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{stiffness!r}, 0", "*DENSITY", repr(density)]
        lines.append(f"*SOLID SECTION, ELSET={name}, MATERIAL={name}")
    lines += ["*BOUNDARY", "base_nodes, 1, 3", "*STEP", "*STATIC", "*DLOAD"]
    lines += [f"all_elements, GRAV, {gravity!r}, 0, 0, -1", "*NODE PRINT, NSET=all_nodes", "U", "*END STEP"]
    (folder / "weight.inp").write_text("\n".join(lines) + "\n")
    done = subprocess.run(["ccx", "weight"], cwd=folder, capture_output=True, text=True, check=False)
    assert "Job finished" in done.stdout, done.stdout[-3000:]
    return np.loadtxt(folder / "weight.dat", skiprows=3)[:, 1:]


_MODFLOW_FILES = {
    "mfsim.nam": "BEGIN timing\n TDIS6 m.tdis\nEND timing\nBEGIN models\n GWF6 m.nam m\nEND models\n"
    "BEGIN exchanges\nEND exchanges\nBEGIN solutiongroup 1\n IMS6 m.ims m\nEND solutiongroup 1\n",
    "m.ims": "BEGIN nonlinear\n OUTER_DVCLOSE 1e-9\nEND nonlinear\n"
    "BEGIN linear\n INNER_MAXIMUM 1000\n INNER_DVCLOSE 1e-9\n INNER_RCLOSE 1e-9\n"
    " LINEAR_ACCELERATION BICGSTAB\nEND linear\n",
    "m.tdis": "BEGIN dimensions\n NPER 1\nEND dimensions\nBEGIN perioddata\n 1 1 1\nEND perioddata\n",
}


def write_modflow_simulation(folder, package, file, more=()):
    """A simulation of one steady step, of a grid (its package and file) and of the packages of `more`."""
    for name, text in _MODFLOW_FILES.items():
        (folder / name).write_text(text)
    lines = [f" {package} {file} {package[:4].lower()}", *more]
    (folder / "m.nam").write_text("BEGIN packages\n" + "\n".join(lines) + "\nEND packages\n")


def run_mf6(folder):
    """MODFLOW 6 runs the simulation of a folder to its end."""
    done = subprocess.run(["mf6"], cwd=folder, capture_output=True, text=True, check=False, timeout=300)
    assert "Normal termination of simulation." in done.stdout, done.stdout[-3000:]


def run_modflow(folder, file, conductivity, heads):
    """Steady flow through a grid of DISU: the conductivity of each cell, and the cells whose head is held.
    Returns the head of each cell."""
    import flopy

    more = [" NPF6 m.npf", " IC6 m.ic", " CHD6 m.chd", " OC6 m.oc"]
    write_modflow_simulation(folder, "DISU6", file, more)
    values = "\n".join(map(repr, np.asarray(conductivity, float).tolist()))
    (folder / "m.npf").write_text(
        "BEGIN griddata\n icelltype\n  CONSTANT 0\n k\n  INTERNAL FACTOR 1\n" + values + "\nEND griddata\n"
    )
    (folder / "m.ic").write_text("BEGIN griddata\n strt\n  CONSTANT 0\nEND griddata\n")
    held = "\n".join(f" {cell + 1} {head!r}" for cell, head in heads.items())
    (folder / "m.chd").write_text(
        f"BEGIN dimensions\n MAXBOUND {len(heads)}\nEND dimensions\nBEGIN period 1\n{held}\nEND period 1\n"
    )
    (folder / "m.oc").write_text(
        "BEGIN options\n HEAD FILEOUT m.hds\nEND options\nBEGIN period 1\n SAVE HEAD ALL\nEND period 1\n"
    )
    run_mf6(folder)
    balance = re.findall(r"PERCENT DISCREPANCY = *(\S+)", (folder / "m.lst").read_text())
    assert max(abs(float(percent)) for percent in balance) < 0.1
    with contextlib.closing(flopy.utils.HeadFile(str(folder / "m.hds"))) as file:
        return file.get_data().ravel()
