# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes for simulation in the formats of solvers, as readers that nobody here wrote read them."""

import os
import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from mixed_meshes import SETS, VOLUMES, layered_mesh, mixed_mesh
from realmodel.core import BuildFailed, UsageError
from realmodel.core.exporters import MESH, save_mesh
from realmodel.core.exporters.solvers.modflow import element_volumes
from realmodel.core.simulation import PolyhedralMesh, VolumeMesh
from realmodel.core.simulation.elements import ElementFaces
from sample_scripts import built_sample
from solvers import run_modflow, write_modflow_simulation

WHY = "not installed: scripts/test.sh installs it"
SHIFT = (400_000.25, 5_300_000.5, -12.0)
MESHIO_KINDS = {"tetra": "tetrahedron", "pyramid": "pyramid", "wedge": "prism", "hexahedron": "hexahedron"}


@pytest.fixture(scope="module")
def mesh():
    return mixed_mesh(SHIFT)


def assert_same_elements(mesh, read):
    """meshio's mesh has the same points and elements, in the same order of corners."""
    assert np.array_equal(read.points, mesh.points)
    for block in read.cells:
        if block.type not in MESHIO_KINDS:
            continue
        assert (element_volumes(read.points, MESHIO_KINDS[block.type], block.data) > 0).all()
    for name, kind in MESHIO_KINDS.items():
        found = [block.data for block in read.cells if block.type == name]
        assert np.array_equal(np.concatenate(found), mesh.elements[kind])


def test_the_mesh_of_the_tests_is_whole(mesh):
    faces = ElementFaces(mesh)
    found = {s.name: (len(s.corners["triangle"]), len(s.corners["quadrilateral"])) for s in faces.sets()}
    assert found == SETS
    whole = faces.polyhedral()
    assert (whole.face_cells[:, 1] >= 0).sum() == 5
    volume = np.zeros(2)
    for kind, elements in mesh.elements.items():
        np.add.at(volume, mesh.element_block[kind], element_volumes(mesh.points, kind, elements))
    assert volume == pytest.approx([VOLUMES[0], VOLUMES[1]], rel=1e-8)


def test_faces_of_three_elements_are_refused(mesh):
    elements = mesh.elements | {"tetrahedron": np.concatenate([mesh.elements["tetrahedron"]] * 3)}
    of = mesh.element_block | {"tetrahedron": np.ones(3, np.int32)}
    broken = VolumeMesh(
        mesh.points, elements, of, {}, {}, mesh.block_names, mesh.block_property, [], np.empty(0, np.int32)
    )
    with pytest.raises(BuildFailed, match="three elements share"):
        ElementFaces(broken)


def test_vtu(mesh, tmp_path):
    vtk = pytest.importorskip("vtk", reason=f"VTK is {WHY}")
    from vtk.util.numpy_support import vtk_to_numpy

    save_mesh(mesh, tmp_path / "m.vtu")
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "m.vtu"))
    reader.Update()
    grid = reader.GetOutput()
    assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), mesh.points)
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    volume = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume"))
    assert (volume > 0).all()
    block = vtk_to_numpy(grid.GetCellData().GetArray("MaterialIDs"))
    assert np.bincount(block, volume) == pytest.approx([VOLUMES[0], VOLUMES[1]], rel=1e-8)
    assert set(vtk_to_numpy(grid.GetCellData().GetArray("property"))) == {3, 7}


def test_gmsh(mesh, tmp_path):
    gmsh = pytest.importorskip("gmsh", reason=f"Gmsh is {WHY}", exc_type=ImportError)
    save_mesh(mesh, tmp_path / "m.msh")
    gmsh.initialize(interruptible=False)  # or Ctrl-C would end Python from then on
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(tmp_path / "m.msh"))
        groups = {gmsh.model.getPhysicalName(*at): at for at in gmsh.model.getPhysicalGroups()}
        assert set(groups) == {"Clay", "Grès à", *SETS, "top"}
        for name, (triangles, quadrilaterals) in SETS.items():
            found = 0
            for entity in gmsh.model.getEntitiesForPhysicalGroup(*groups[name]):
                found += sum(map(len, gmsh.model.mesh.getElements(2, entity)[1]))
            assert found == triangles + quadrilaterals
        for name, block in (("Clay", 0), ("Grès à", 1)):
            (entity,) = gmsh.model.getEntitiesForPhysicalGroup(*groups[name])
            _, tags, _ = gmsh.model.mesh.getElements(3, entity)
            volume = sum(gmsh.model.mesh.getElementQualities(list(part), "volume").sum() for part in tags)
            assert volume == pytest.approx(VOLUMES[block], rel=1e-8)
        assert len(gmsh.model.getEntitiesForPhysicalGroup(*groups["top"])) == 2
        _, coordinates, _ = gmsh.model.mesh.getNodes()
        assert np.array_equal(np.sort(coordinates.reshape(-1, 3), axis=0), np.sort(mesh.points, axis=0))
    finally:
        gmsh.finalize()


def test_gmsh_by_meshio(mesh, tmp_path):
    meshio = pytest.importorskip("meshio", reason=f"meshio is {WHY}")
    save_mesh(mesh, tmp_path / "m.msh")
    read = meshio.read(tmp_path / "m.msh")
    assert_same_elements(mesh, read)
    assert read.field_data["Clay"].tolist() == [1, 3]


def test_inp(mesh, tmp_path):
    meshio = pytest.importorskip("meshio", reason=f"meshio is {WHY}")
    save_mesh(mesh, tmp_path / "m.inp")
    read = meshio.read(tmp_path / "m.inp")
    assert np.array_equal(read.points, mesh.points)
    count = {}
    total = np.zeros(2)
    text = (tmp_path / "m.inp").read_text()
    order = [name == "Gres_a" for name in re.findall(r"\*ELEMENT, TYPE=\w+, ELSET=(\w+)", text)]
    for cells, block in zip(read.cells, order, strict=True):
        volume = element_volumes(read.points, MESHIO_KINDS[cells.type], cells.data)
        assert (volume > 0).all()
        total[int(block)] += volume.sum()
        count[cells.type] = count.get(cells.type, 0) + len(cells.data)
    assert total == pytest.approx([VOLUMES[0], VOLUMES[1]], rel=1e-8)
    assert count == {"hexahedron": 1, "wedge": 2, "tetra": 3}  # CalculiX has no pyramids
    surfaces = dict(re.findall(r"\*SURFACE, NAME=(\w+), TYPE=ELEMENT\n((?:\d+, S\d\n)+)", text))
    expected = {"base": 3, "sides": 8, "top_Ground": 3, "top_Top_of_clay": 1, "Top_of_clay": 3}
    assert set(surfaces) == set(SETS)
    elements = [
        corners for cells in read.cells for corners in cells.data.tolist()
    ]  # meshio numbers in the order of the file, as we do
    sides = {
        4: [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
        6: [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)],
        8: [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)],
    }  # CalculiX' manual, 6.2
    for name, rows in surfaces.items():
        entries = re.findall(r"(\d+), S(\d)", rows)
        if (
            name == "Top_of_clay"
        ):  # the side of one of its elements, of the hexahedron or of both halves above
            assert len(entries) in (2, 3)
        else:
            assert len(entries) == expected[name]
        used = set()
        for element, side in entries:
            corners = elements[int(element) - 1]
            used |= {corners[k] for k in sides[len(corners)][int(side) - 1]}
        nodes = re.search(rf"\*NSET, NSET={name}_nodes\n((?:\d+,\n)+)", text)[1]
        assert used == {int(node) - 1 for node in re.findall(r"\d+", nodes)}
    parts = [
        re.search(rf"NSET={name}_nodes\n((?:\d+,\n)+)", text)[1] for name in ("top_Ground", "top_Top_of_clay")
    ]
    top = re.search(r"NSET=top_nodes\n((?:\d+,\n)+)", text)[1]
    assert set(top.split()) == {node for part in parts for node in part.split()}
    if shutil.which("ccx"):
        (tmp_path / "c.inp").write_text(
            "*INCLUDE, INPUT=m.inp\n*MATERIAL, NAME=rock\n*ELASTIC\n1e9, 0.2\n*DENSITY\n2000\n"
            "*SOLID SECTION, ELSET=Clay, MATERIAL=rock\n*SOLID SECTION, ELSET=Gres_a, MATERIAL=rock\n"
            "*BOUNDARY\nbase_nodes, 1, 3\n*STEP\n*STATIC\n*DLOAD\nall_elements, GRAV, 9.81, 0, 0, -1\n"
            "*NODE PRINT, NSET=top_Ground_nodes\nU\n*END STEP\n"
        )
        done = subprocess.run(["ccx", "c"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
        assert "Job finished" in done.stdout, done.stdout[-2000:]


def test_inp_has_no_field_longer_than_calculix_reads(mesh, tmp_path):
    noise = 1.4210854715202004e-14 * np.array([[1, -1, 0.3]])
    for scale, shift in ((1, 0), (1e-7, 0), (1, 4_512_345.678), (1, -1e-9)):
        moved = replace(mesh, points=mesh.points * scale / 3 + shift + noise)
        save_mesh(moved, tmp_path / "m.inp")
        text = (tmp_path / "m.inp").read_text()
        rows = re.search(r"\*NODE, NSET=all_nodes\n([^*]*)", text)[1].splitlines()
        fields = [row.split(", ")[1:] for row in rows]
        assert max(len(field) for row in fields for field in row) <= 20
        size = np.abs(moved.points).max()
        assert np.array(fields, float) == pytest.approx(moved.points, abs=1e-14 * size, rel=0)


def test_cdb(mesh, tmp_path):
    archive = pytest.importorskip("mapdl_archive", reason=f"mapdl-archive is {WHY}")
    save_mesh(mesh, tmp_path / "m.cdb")
    read = archive.Archive(str(tmp_path / "m.cdb"), parse_vtk=False)
    assert np.allclose(read.nodes, mesh.points, rtol=1e-15, atol=0)
    assert read.material_type.tolist() == [1, 1, 1, 2, 2]
    volume = element_volumes(read.nodes, "hexahedron", np.array([row[10:] - 1 for row in read.elem]))
    assert (volume > 0).all()
    assert np.bincount(read.material_type - 1, volume) == pytest.approx([VOLUMES[0], VOLUMES[1]], rel=1e-8)
    assert set(read.element_components) == {"CLAY", "GRES_A"}
    assert {k: len(v) for k, v in read.element_components.items()} == {"CLAY": 3, "GRES_A": 2}
    assert {name.upper() for name in SETS if name != "Top_of_clay"} <= set(read.node_components)
    assert len(read.node_components["BASE"]) == 6


def test_flac3d(mesh, tmp_path):
    meshio = pytest.importorskip("meshio", reason=f"meshio is {WHY}")
    save_mesh(mesh, tmp_path / "m.f3grid")
    read = meshio.read(tmp_path / "m.f3grid")
    assert_same_elements(mesh, read)
    assert "zone:Grès à:1" in read.cell_sets or any("Grès à" in name for name in read.cell_sets)


def test_exodus(mesh, tmp_path):
    vtk = pytest.importorskip("vtk", reason=f"VTK is {WHY}")
    save_mesh(mesh, tmp_path / "m.exo")
    reader = vtk.vtkExodusIIReader()
    reader.SetFileName(str(tmp_path / "m.exo"))
    reader.UpdateInformation()
    assert reader.GetNumberOfElementBlockArrays() == 4
    names = [reader.GetElementBlockArrayName(k) for k in range(4)]
    assert sum("Clay" in name for name in names) == 2
    sides = {reader.GetSideSetArrayName(k): k for k in range(reader.GetNumberOfSideSetArrays())}
    assert {re.split(r"[ :]", name)[0] for name in sides} >= {"base"} or len(sides) == len(SETS)
    for name in sides:
        reader.SetSideSetArrayStatus(name, 1)
    reader.Update()
    output = reader.GetOutput()
    volume, cells = 0.0, 0
    blocks = output.GetBlock(0)
    for k in range(blocks.GetNumberOfBlocks()):
        sizes = vtk.vtkCellSizeFilter()
        sizes.SetInputData(blocks.GetBlock(k))
        sizes.Update()
        array = sizes.GetOutput().GetCellData().GetArray("Volume")
        # VTK takes the prisms of Exodus as its own, which turn the other way round
        each = [abs(array.GetValue(i)) for i in range(array.GetNumberOfTuples())]
        volume, cells = volume + sum(each), cells + len(each)
    assert cells == mesh.cells
    assert volume == pytest.approx(2.5, rel=1e-8)
    side_sets = output.GetBlock(4)
    found = {}
    for k in range(side_sets.GetNumberOfBlocks()):
        name = side_sets.GetMetaData(k).Get(vtk.vtkCompositeDataSet.NAME())
        found[name.split()[0]] = side_sets.GetBlock(k).GetNumberOfCells()
    assert sorted(found.values()) == sorted(sum(counts) for counts in SETS.values())


def test_exodus_is_netcdf(mesh, tmp_path):
    netcdf_file = pytest.importorskip("scipy.io", reason=f"SciPy is {WHY}").netcdf_file
    save_mesh(mesh, tmp_path / "m.exo")
    with netcdf_file(tmp_path / "m.exo", mmap=False) as data:
        assert np.array_equal(data.variables["coordx"][:], mesh.points[:, 0])
        names = [b"".join(row).decode().strip("\0") for row in data.variables["ss_names"][:]]
        assert names == [found.name for found in ElementFaces(mesh).sets()]


def test_exodus_of_polyhedra(tmp_path):
    vtk = pytest.importorskip("vtk", reason=f"VTK is {WHY}")
    model = built_sample("two_layers")
    model.save(tmp_path / "m.exo")
    reader = vtk.vtkExodusIIReader()
    reader.SetFileName(str(tmp_path / "m.exo"))
    reader.Update()
    blocks = reader.GetOutput().GetBlock(0)
    assert blocks.GetNumberOfBlocks() == 2
    for k, block in enumerate(model.blocks):
        grid = blocks.GetBlock(k)
        assert grid.GetNumberOfCells() == block.cells
        assert {grid.GetCellType(i) for i in range(block.cells)} == {42}
        cell = next(i for i in range(len(model.cell_block)) if model.cell_block[i] == k)
        faces = (model.face_cells == cell).any(axis=1).sum()
        assert grid.GetCell(0).GetNumberOfFaces() == faces


@pytest.mark.skipif(shutil.which("checkMesh") is None, reason=f"OpenFOAM is {WHY}")
def test_openfoam(mesh, tmp_path):
    save_mesh(mesh, tmp_path / "m.foam")
    found = subprocess.run(
        ["checkMesh", "-allTopology", "-case", tmp_path / "m.foam"],
        env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ},
        capture_output=True,
        text=True,
        timeout=60,
    ).stdout
    assert "Upper triangular ordering OK." in found
    assert "Number of regions: 1 (OK)." in found
    for kind, count in (("hexahedra", 1), ("prisms", 2), ("pyramids", 1), ("tetrahedra", 1)):
        assert re.search(rf"\b{kind}: +{count}\b", found), found
    boundary = (tmp_path / "m.foam/constant/polyMesh/boundary").read_text()
    assert re.findall(r"inGroups +1\((\w+)\)", boundary) == ["top", "top"]


def modflow(folder, package, file):
    """The package of a simulation that consists of it alone, as flopy reads it."""
    flopy = pytest.importorskip("flopy", reason=f"flopy is {WHY}")
    write_modflow_simulation(folder, package, file)
    simulation = flopy.mf6.MFSimulation.load(sim_ws=str(folder), verbosity_level=0)
    return simulation.get_model("m").get_package(package[:4].lower())


def test_modflow_disv(tmp_path):
    mesh = layered_mesh()
    save_mesh(mesh, tmp_path / "g.disv")
    grid = modflow(tmp_path, "DISV6", "g.disv")
    columns = len(mesh.plan.triangles)
    assert (grid.nlay.get_data(), grid.ncpl.get_data()) == (3, columns)
    top, bottom = grid.top.array, grid.botm.array
    thickness = -np.diff(np.concatenate([top[None], bottom]), axis=0)
    volume = element_volumes(mesh.points, "prism", mesh.elements["prism"])
    assert (thickness * 0.5).sum() == pytest.approx(volume.sum())
    domain = grid.idomain.array
    assert (domain == -1).sum() == 3 * columns - mesh.cells
    assert ((thickness > 0) == (domain == 1)).all()
    assert bottom[-1] == pytest.approx(np.zeros(columns), abs=1e-12)
    blocks = np.fromstring((tmp_path / "g_block.txt").read_text(), sep=" ").reshape(3, columns)
    assert ((blocks > 0) == (domain == 1)).all()
    assert (blocks[2] == 1).all()
    assert (blocks[1] == 2).all()
    assert len(grid.vertices.get_data()) == len(mesh.plan.vertices)
    assert len(grid.cell2d.get_data()) == columns


def test_modflow_disu(tmp_path):
    mesh = layered_mesh()
    save_mesh(mesh, tmp_path / "g.disu")
    grid = modflow(tmp_path, "DISU6", "g.disu")
    volume = element_volumes(mesh.points, "prism", mesh.elements["prism"])
    thickness = grid.top.array - grid.bot.array
    assert np.sort(thickness * grid.area.array) == pytest.approx(np.sort(volume))
    assert grid.vertical_offset_tolerance.get_data() > 0
    ja, iac, ihc = grid.ja.array, grid.iac.array, grid.ihc.array
    assert len(ja) == iac.sum()
    begins = np.concatenate([[0], np.cumsum(iac)[:-1]])
    assert np.array_equal(ja[begins], np.arange(mesh.cells))
    pairs = {}
    of = np.repeat(np.arange(mesh.cells), iac)
    for one, two, kind, size in zip(of, ja, ihc, grid.hwva.array, strict=True):
        if one != two:
            pairs.setdefault((min(one, two), max(one, two)), []).append((kind, size))
    whole = ElementFaces(mesh).polyhedral()
    assert len(pairs) == (whole.face_cells[:, 1] >= 0).sum()
    assert all(len(found) == 2 and found[0] == found[1] for found in pairs.values())
    upright = [size for (kind, size), _ in pairs.values() if kind == 0]
    assert upright == pytest.approx(np.full(len(upright), 0.5))
    assert len(upright) == mesh.cells - len(mesh.plan.triangles)
    assert (grid.cl12.array[ja != of] > 0).all()


def test_modflow_disu_of_a_model(tmp_path):
    """What MODFLOW 6 refuses (Disu.f90, Connections.f90): cells without thickness, lower cells with lower
    numbers, and tops above the bottoms of upper cells beyond the tolerance; connections without a width make
    no matrix."""
    model = built_sample("two_layers")
    model.save(tmp_path / "g.disu")
    grid = modflow(tmp_path, "DISU6", "g.disu")
    top, bottom = grid.top.array, grid.bot.array
    assert (top > bottom).all()
    volume = grid.area.array * (top - bottom)
    assert sorted(volume) == pytest.approx(sorted(model.cell_volumes), rel=1e-9)
    blocks = np.array((tmp_path / "g_disu_block.txt").read_text().split(), int)
    assert np.bincount(blocks - 1, volume) == pytest.approx([block.volume for block in model.blocks])
    ja, iac, ihc, width = grid.ja.array, grid.iac.array, grid.ihc.array, grid.hwva.array
    of = np.repeat(np.arange(len(iac)), iac)
    below = (ihc == 0) & (ja > of)
    allowed = grid.vertical_offset_tolerance.get_data()
    assert (top[ja[below]] - bottom[of[below]] <= allowed).all()
    assert ((top + bottom)[of[below]] > (top + bottom)[ja[below]]).all()  # the upper one comes first
    apart = ja != of
    assert (grid.cl12.array[apart] > 0).all()
    assert (
        width[apart] > 1e-9 * np.minimum(*(np.sqrt(grid.area.array[k[apart]]) for k in (ja, of))) ** 2
    ).all()


def test_modflow_disu_of_cells_as_narrow_as_rounding(tmp_path):
    """Two cells had a negative volume over no area to speak of: their tops were 52 m below their bottoms."""
    built_sample("castle_hill").save(tmp_path / "g.disu")
    text = (tmp_path / "g.disu").read_text()
    parts = [text.split(f"  {name}\n    INTERNAL FACTOR 1\n")[1] for name in ("TOP", "BOT", "AREA")]
    top, bottom, area = (np.array(part[: re.search("[A-Z]", part).start()].split(), float) for part in parts)
    assert len(top) == len(bottom) == len(area) > 80_000
    assert (top > bottom).all()
    assert (top - bottom < 400.0).all()
    assert (area > 0).all()


@pytest.mark.skipif(shutil.which("mf6") is None, reason="MODFLOW 6 is absent: neither Debian nor PyPI has it")
@pytest.mark.parametrize("name", ["two_layers", "gravel_plain", "castle_hill"])
def test_modflow_computes_a_flow_through_the_exact_cells(tmp_path, name):
    """From the base to what lies highest: heads are between those that are held."""
    pytest.importorskip("flopy", reason=f"flopy is {WHY}")
    model = built_sample(name)
    model.save(tmp_path / "g.disu")
    grid = modflow(tmp_path, "DISU6", "g.disu")
    blocks = np.array((tmp_path / "g_disu_block.txt").read_text().split(), int)
    top, bottom = grid.top.array, grid.bot.array
    high = top > np.quantile(top, 0.95)
    low = ~high & (bottom <= np.quantile(bottom, 0.05))
    held = {int(cell): float(high[cell]) for cell in np.flatnonzero(low | high)}
    heads = run_modflow(tmp_path, "g.disu", 10.0 ** -(blocks % 3), held)
    assert len(heads) == len(blocks)
    assert (heads > -1e-9).all()
    assert (heads < 1 + 1e-9).all()
    assert ((heads > 0.01) & (heads < 0.99)).any()


def test_modflow_disu_refuses_inclined_faults(tmp_path):
    model = built_sample("fault_blocks")
    with pytest.raises(UsageError, match="MODFLOW 6 wants cells in an order from the top"):
        model.save(tmp_path / "g.disu")
    assert list(tmp_path.iterdir()) == []


def test_what_a_format_cannot_hold_is_refused(mesh, tmp_path):
    model = built_sample("two_layers")
    for ending in (".msh", ".inp", ".cdb", ".f3grid", ".disv"):
        with pytest.raises(UsageError, match=r"no polyhedra; use one of \.vtu, \.foam, \.exo, \.disu"):
            save_mesh(PolyhedralMesh.of_model(model), tmp_path / f"m{ending}")
    with pytest.raises(UsageError, match="needs a mesh of layered columns"):
        save_mesh(mesh, tmp_path / "m.disv")
    with pytest.raises(UsageError, match=r"meshes are not written as '.xyz'; use one of .vtu"):
        save_mesh(mesh, tmp_path / "m.xyz")
    assert list(tmp_path.iterdir()) == []


def test_the_same_mesh_gives_the_same_bytes(tmp_path):
    mesh = layered_mesh()
    for known in MESH.formats():
        if known.folder:
            continue
        files = [tmp_path / f"{name}{known.ending}" for name in "ab"]
        for file in files:
            save_mesh(mesh, file)
        assert files[0].read_bytes() == files[1].read_bytes()
