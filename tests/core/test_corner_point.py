# SPDX-License-Identifier: GPL-3.0-or-later
"""Corner-point grids: their volumes, steps and pinched layers, the file, and a simulator that runs it."""

import shutil
import subprocess

import numpy as np
import pytest
from conftest import ROOT, grid_surface
from realmodel.core import Project, Rock, Surface, UsageError, build, load_project
from sample_models import three_layers


def flat(name, z):
    vertices, triangles = grid_surface(1, lambda x, y: z + 0 * x, 100.0)
    return Surface(name, vertices=vertices, triangles=triangles, block=name)


def layered():
    return build(
        Project("layered", [Rock("r", base_elevation=0.0, surfaces=[flat("clay", 10), flat("sand", 30)])])
    )


def faulted(throw=7.0):
    """Two beds, of which the part with x > 50 is lower by the throw; the fault is on a line of pillars."""

    def surface(name, z):
        left = np.array([[0, 0, z], [50, 0, z], [50, 100, z], [0, 100, z]], float)
        right = left + np.array([50, 0, -throw])
        triangles = np.array([[0, 1, 2], [0, 2, 3]])
        return Surface(
            name,
            vertices=np.concatenate([left, right]),
            triangles=np.concatenate([triangles, triangles + 4]),
            block=name,
        )

    return build(
        Project(
            "faulted", [Rock("r", base_elevation=0.0, surfaces=[surface("clay", 20), surface("sand", 40)])]
        )
    )


def eroded():
    """A dipping bed between others, which the ground cuts at x = 50."""
    surfaces = [
        Surface("low", *grid_surface(1, lambda x, y: 10 + 0.2 * x, 100.0), block="low"),
        Surface("bed", *grid_surface(1, lambda x, y: 20 + 0.2 * x, 100.0), block="bed"),
        Surface("cut", *grid_surface(1, lambda x, y: 25 - 0.1 * x, 100.0), block="cut"),
        Surface("top", *grid_surface(1, lambda x, y: 40 + 0 * x, 100.0), block="top"),
    ]
    return build(Project("eroded", [Rock("r", base_elevation=0.0, surfaces=surfaces)]))


MODELS = {"layered": layered, "faulted": faulted, "eroded": eroded}


def read_grdecl(path):
    """The keywords of a file with their numbers."""
    words = [line.partition("--")[0] for line in path.read_text().splitlines()]
    arrays = {}
    for record in " ".join(words).split("/"):
        for name in ("SPECGRID", "COORD", "ZCORN", "ACTNUM", "FIPNUM"):
            keyword, _, rest = record.strip().partition(" ")
            if keyword == name:
                pairs = [word.rpartition("*") for word in rest.split() if word != "F"]
                arrays[name] = np.concatenate([np.full(int(n or 1), float(value)) for n, _, value in pairs])
    return arrays


@pytest.mark.parametrize("azimuth", [0.0, 90.0, 180.0, 270.0])
@pytest.mark.parametrize("name", MODELS)
def test_volumes_are_those_of_the_model(name, azimuth):
    model = MODELS[name]()
    grid = model.corner_point_grid(1.0, layers=2, azimuth=azimuth)
    assert grid.shape[:2] == (100, 100)
    assert grid.shape[2] == 2 * len(model.blocks)
    assert np.abs(grid.difference).max() < 0.01
    assert grid.warnings == []


def test_layers_have_the_heights_of_the_surfaces():
    grid = layered().corner_point_grid(10.0, layers=2)
    depths = [-30, -20, -20, -10, -10, -5, -5, 0]  # the base block is below the clay
    assert grid.zcorn.shape == (8, 20, 20)
    assert grid.zcorn == pytest.approx(np.broadcast_to(np.array(depths, float)[:, None, None], (8, 20, 20)))


def test_a_fault_is_a_step_along_its_pillars():
    grid = faulted().corner_point_grid(10.0)
    depths = np.array([[-40, -33], [-20, -13], [-20, -13], [0, 0]], float)
    expected = np.repeat(depths[:, None, :], 10, axis=2)
    assert grid.zcorn == pytest.approx(np.broadcast_to(expected, (4, 20, 20)), abs=1e-9)


@pytest.mark.parametrize("throw", [7.0, 25.0, 39.0])
def test_cells_meet_across_a_fault_where_the_blocks_of_the_model_do(throw):
    model = faulted(throw)
    grid = model.corner_point_grid(10.0)
    tops, bases = grid.zcorn[::2, 0], grid.zcorn[1::2, 0]
    pairs = {
        tuple(sorted((grid.fipnum[a, 0, 4], grid.fipnum[b, 0, 5])))
        for a, b in np.ndindex(grid.shape[2], grid.shape[2])
        if min(bases[a, 9], bases[b, 10]) - max(tops[a, 9], tops[b, 10]) > 1e-6
        and grid.actnum[a, 0, 4]
        and grid.actnum[b, 0, 5]
    }
    wall = (model.face_cells >= 0).all(axis=1)
    x = model.vertices[:, 0]
    on_fault = [
        face
        for face in np.flatnonzero(wall)
        if (x[model.face_vertices[model.face_offsets[face] : model.face_offsets[face + 1]]] == 50).all()
    ]
    assert pairs == {tuple(sorted(model.face_blocks[face] + 1)) for face in on_fault}


def test_a_layer_ends_where_its_block_is_eroded():
    model = eroded()
    grid = model.corner_point_grid(10.0)
    bed = grid.names.index("bed") + 1
    layer = int(np.flatnonzero(grid.fipnum[:, 0, 0] == bed)[0])
    centers = np.arange(5.0, 100.0, 10.0)
    thickness = np.clip(np.minimum(20 + 0.2 * centers, 25 - 0.1 * centers) - (10 + 0.2 * centers), 0, None)
    assert (grid.actnum[layer] == (thickness > 0)).all()
    assert grid.thickness[layer, 0] == pytest.approx(
        thickness, abs=0.51
    )  # the corner of a bed that ends within a column is on its pillar
    corners = grid.zcorn.reshape(grid.shape[2], 2, -1)
    assert (corners[1:, 0] == corners[:-1, 1]).all()


def test_a_block_that_a_column_has_twice_has_layers_for_each_time():
    """The tunnel of the sample is within a block, which is above it and below it."""
    model = build(load_project(ROOT / "blend_samples" / "fault_blocks" / "project.toml"))
    grid = model.corner_point_grid(20.0)
    assert np.abs(grid.difference).max() < 0.01
    kinds = {warning.kind for warning in grid.warnings}
    assert kinds == {"corner_point_repeats", "corner_point_voids"}
    assert (grid.actnum[grid.fipnum == 0] == 0).all()
    assert (np.diff(grid.zcorn, axis=0) >= 0).all()


def test_the_file_says_what_the_grid_is(tmp_path):
    model = build(three_layers())
    path = tmp_path / "m.grdecl"
    model.save(path, cell_size=0.5, grid_layers=2, grid_azimuth=90.0)
    grid = model.corner_point_grid(0.5, layers=2, azimuth=90.0)
    arrays = read_grdecl(path)
    assert arrays["SPECGRID"][:3].tolist() == list(grid.shape)
    assert arrays["COORD"] == pytest.approx(grid.coord.ravel())
    assert arrays["ZCORN"] == pytest.approx(grid.zcorn.ravel(), abs=1e-6)
    assert (arrays["ACTNUM"] == grid.actnum.ravel()).all()
    assert (arrays["FIPNUM"] == grid.fipnum.ravel()).all()
    text = path.read_text()
    assert f"-- FIPNUM {grid.names.index('sand') + 1} = sand" in text
    again = tmp_path / "again.grdecl"
    model.save(again, cell_size=0.5, grid_layers=2, grid_azimuth=90.0)
    assert again.read_bytes() == path.read_bytes()


@pytest.mark.parametrize("wrong", [{"layers": 0}, {"azimuth": np.nan}, {"cell_size": -1.0}, {"layers": 1.5}])
def test_wrong_requests_are_refused(wrong):
    with pytest.raises(UsageError):
        layered().corner_point_grid(**wrong)


DECK = """RUNSPEC
DIMENS
 {nx} {ny} {nz} /
WATER
METRIC
START
 1 JAN 2020 /
EQLDIMS
/
TABDIMS
/
WELLDIMS
 2 {nz} 1 2 /
UNIFIN
UNIFOUT
GRID
INIT
INCLUDE
 'm.grdecl' /
EQUALS
 PORO 0.2 /
 PERMX 500 /
 PERMY 500 /
 PERMZ 50 /
/
PROPS
PVTW
 100 1 4E-5 0.5 0 /
ROCK
 100 1E-5 /
DENSITY
 800 1000 1 /
SOLUTION
PRESSURE
 {cells}*100 /
SUMMARY
FPR
WWIR
*
/
WWPR
*
/
SCHEDULE
WELSPECS
 IN G 1 1 1* WATER /
 OUT G {nx} {ny} 1* WATER /
/
COMPDAT
 IN 1 1 1 {nz} OPEN 2* 0.2 /
 OUT {nx} {ny} 1 {nz} OPEN 2* 0.2 /
/
WCONINJE
 IN WATER OPEN RATE 20 1* 300 /
/
WCONPROD
 OUT OPEN BHP 5* 90 /
/
TSTEP
 5*10 /
END
"""


@pytest.mark.parametrize("name", MODELS)
def test_opm_flow_runs_it_to_the_end(tmp_path, name):
    """Water from a well in one corner to one in the other, through the fault and where a layer ends."""
    flow = shutil.which("flow")
    if flow is None:
        pytest.skip("OPM Flow is not installed (Debian's libopm-simulators-bin)")
    model = MODELS[name]()
    model.save(tmp_path / "m.grdecl", cell_size=10.0, grid_layers=2)
    nx, ny, nz = model.corner_point_grid(10.0, layers=2).shape
    (tmp_path / "DECK.DATA").write_text(DECK.format(nx=nx, ny=ny, nz=nz, cells=nx * ny * nz))
    run = subprocess.run(
        [flow, "--output-dir=out", "--threads-per-process=1", "DECK.DATA"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stdout[-3000:] + run.stderr[-2000:]
    assert "End of simulation" in run.stdout
