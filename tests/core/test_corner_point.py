# SPDX-License-Identifier: GPL-3.0-or-later
"""Corner-point grids: their volumes, steps and pinched layers, the file, and a simulator that runs it."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from conftest import grid_surface
from displaced_surfaces import Displacing, dome, leaning, mesh_of
from realmodel.core import Library, Project, Property, Rock, Surface, UsageError, build
from sample_models import three_layers
from sample_scripts import built_sample
from structure_cases import SQUARE


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


def sealed():
    """A bed that ends at x = 50 between others."""
    surfaces = [
        flat("low", 10),
        Surface(
            "seal", *grid_surface(4, lambda x, y: 10 + np.clip(8 - 0.16 * x, 0, None), 100.0), block="seal"
        ),
        flat("top", 30),
    ]
    return build(Project("sealed", [Rock("r", base_elevation=0.0, surfaces=surfaces)]))


def waves(seed):
    """Beds with waves, some of which end at others."""
    random = np.random.default_rng(seed)
    surfaces, z = [], 20.0
    for k in range(5):
        a, b, c = random.uniform(0, 6, 3)

        def height(x, y, z=z, a=a, b=b, c=c):
            return z + 3 * np.sin(x / 20 + a) * np.cos(y / 25 + b) + 0.03 * c * x

        surfaces.append(Surface(f"s{k}", *grid_surface(25, height, 100.0), block=f"b{k}"))
        z += random.uniform(2, 20)
    return build(Project("waves", [Rock("r", base_elevation=0.0, surfaces=surfaces)]))


def displaced(faults):
    """Three beds of a dome, displaced."""
    surfaces = []
    for z in (-2.0, 0.0, 1.0):
        mesh = mesh_of(lambda x, y, z=z: dome(x, y) + z, faults)
        surfaces.append(Surface(f"bed {z}", *mesh, block=f"bed {z}"))
    rock = Rock("r", surfaces, region=SQUARE, edge_length=0.5, base_elevation=-8.0)
    return build(Project("p", [rock], faults=[fault.fault() for fault in faults]))


MODELS = {"layered": layered, "faulted": faulted, "eroded": eroded, "sealed": sealed}


def read_grdecl(path):
    """The keywords of a file with their numbers."""
    words = [line.partition("--")[0] for line in path.read_text().splitlines()]
    arrays = {}
    for record in " ".join(words).split("/"):
        for name in ("SPECGRID", "COORD", "ZCORN", "ACTNUM", "FIPNUM", "PORO", "PERMX", "PERMY", "PERMZ"):
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


@pytest.mark.parametrize("azimuth", [0.0, 30.0, 90.0, -135.0])
def test_the_azimuth_is_that_of_j(azimuth):
    grid = layered().corner_point_grid(5.0, azimuth=azimuth)
    turn = np.radians(azimuth)
    for along, direction in (
        (grid.coord[1:, 0] - grid.coord[:-1, 0], [np.sin(turn), np.cos(turn)]),
        (grid.coord[0, 1:] - grid.coord[0, :-1], [np.cos(turn), -np.sin(turn)]),
    ):
        unit = along[:, :2] / np.hypot(*along[:, :2].T)[:, None]
        assert unit == pytest.approx(np.broadcast_to(direction, unit.shape), abs=1e-9)


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


def touching(grid):
    """(B, B) the areas between blocks in a grid, those of level faces in plan."""
    nx, ny, nz = grid.shape
    corners, block = grid.zcorn.reshape(nz, 2, ny, 2, nx, 2), np.where(grid.actnum > 0, grid.fipnum, 0) - 1
    i, j = grid.cell_size
    sides = [
        (
            corners[..., :-1, 1].mean(axis=3),
            corners[..., 1:, 0].mean(axis=3),
            block[..., :-1],
            block[..., 1:],
            j,
        ),
        (
            corners[:, :, :-1, 1].mean(axis=4),
            corners[:, :, 1:, 0].mean(axis=4),
            block[:, :-1],
            block[:, 1:],
            i,
        ),
    ]
    areas = np.zeros((len(grid.names), len(grid.names)))
    level = corners.mean(axis=(3, 5))
    for a, b in np.ndindex(nz, nz):
        pairs = [
            (
                one[a],
                other[b],
                (np.minimum(left[a, 1], right[b, 1]) - np.maximum(left[a, 0], right[b, 0])) * width,
            )
            for left, right, one, other, width in sides
        ]
        pairs.append((block[a], block[b], np.where(np.abs(level[a, 1] - level[b, 0]) < 1e-9, i * j, 0.0)))
        for one, other, area in pairs:
            meet = (one >= 0) & (other >= 0) & (one != other) & (area > 1e-9)
            np.add.at(areas, (one[meet], other[meet]), area[meet])
    return areas + areas.T


def neighbors(model):
    """The pairs of blocks that have a face in common."""
    sides = model.face_blocks[(model.face_blocks >= 0).all(axis=1)]
    return {tuple(sorted(pair)) for pair in sides[sides[:, 0] != sides[:, 1]].tolist()}


FAULTS = {
    "normal": [Displacing("F", leaning(lean=-0.5), 1.7)],
    "reverse": [Displacing("F", leaning(lean=0.5), 1.7)],
    "oblique": [Displacing("F", leaning(turn=0.4), 2.5)],
    "steep": [Displacing("F", leaning(4.3, 0.05, -0.2), 6.0)],
    "two": [Displacing("F", leaning(3.0, -0.3), 0.8), Displacing("G", leaning(7.0, 0.3, 0.1), -1.3)],
    "ending": [Displacing("F", leaning(), lambda y: np.maximum(0.3 * (7 - y), 0.0), tip=7.0)],
}


@pytest.mark.parametrize("azimuth", [0.0, 30.0])
@pytest.mark.parametrize("name", FAULTS)
def test_blocks_of_a_faulted_model_touch_in_the_grid_as_in_the_model(name, azimuth):
    model = displaced(FAULTS[name])
    grid = model.corner_point_grid(0.1, azimuth=azimuth)
    assert np.abs(grid.difference).max() < 0.01
    assert (np.diff(grid.zcorn, axis=0) >= 0).all()
    areas = touching(grid)
    exact = neighbors(model)
    assert all(areas[pair] > 0 for pair in exact)
    others = sum(areas[a, b] for a, b in np.ndindex(areas.shape) if a < b and (a, b) not in exact)
    assert others < 1e-3 * areas.sum()


@pytest.mark.parametrize("throw", [7.0, 25.0, 39.0])
def test_blocks_touch_across_an_upright_fault_where_those_of_the_model_do(throw):
    model = faulted(throw)
    areas = touching(model.corner_point_grid(10.0))
    assert {(a, b) for a, b in np.ndindex(areas.shape) if a < b and areas[a, b]} == neighbors(model)


@pytest.mark.parametrize("seed", range(4))
def test_beds_go_on_from_column_to_column(seed):
    grid = waves(seed).corner_point_grid(2.0)
    assert np.abs(grid.difference).max() < 0.003
    corners = grid.zcorn.reshape(grid.shape[2], 2, 50, 2, 50, 2)
    apart = np.abs(corners[:, :, :, :, :-1, 1] - corners[:, :, :, :, 1:, 0]).max(axis=(1, 3))
    ends = (grid.actnum == 0).any(axis=0)
    for axis in (0, 1):
        ends = ends | np.roll(ends, 1, axis) | np.roll(ends, -1, axis)
    assert apart[:, ~ends[:, :-1] & ~ends[:, 1:]].max() < 1e-9
    assert apart.max() < 1.0  # where a bed ends, a little of its thickness in a column


@pytest.mark.parametrize("sample", ["two_layers", "gravel_plain", "mapped_valley", "tunnel", "intrusion"])
def test_samples_have_their_volumes_at_a_hundred_columns(sample):
    grid = built_sample(sample).corner_point_grid()
    assert max(grid.shape[:2]) == 100
    assert np.abs(grid.difference).max() < 0.01
    assert (np.diff(grid.zcorn, axis=0) >= 0).all()
    assert "corner_point_volume" not in {warning.kind for warning in grid.warnings}


def test_blocks_that_few_columns_show_are_named():
    grid = eroded().corner_point_grid(90.0)
    (warning,) = grid.warnings
    assert warning.kind == "corner_point_volume"
    worst = grid.names[int(np.abs(grid.difference).argmax())]
    assert re.search(rf"less: '{worst}' [+-]\d", warning.text)


def test_columns_none_of_which_has_its_center_in_the_model_are_refused():
    outline, hole = [[50, 0], [100, 50], [50, 100], [0, 50]], [[40, 40], [60, 40], [60, 60], [40, 60]]
    surface = Surface("s", method="constant", options={"value": 10.0})
    rock = Rock("r", [surface], region=outline, holes=[hole], edge_length=10.0, base_elevation=0.0)
    model = build(Project("ring", [rock]))
    with pytest.raises(UsageError, match="smaller"):
        model.corner_point_grid(200.0)
    assert model.corner_point_grid(1.0).volumes == pytest.approx([46000.0])


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
    model = built_sample("fault_blocks")
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
FMTOUT
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
{seal}
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
WWPR
 OUT /
SCHEDULE
WELSPECS
 IN G 1 1 1* WATER /
 OUT G {out} {ny} 1* WATER /
/
COMPDAT
 IN 1 1 1 {lowest} OPEN 2* 0.2 /
 OUT {out} {ny} {highest} {nz} OPEN 2* 0.2 /
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


def test_the_library_gives_porosity_and_permeability(tmp_path):
    """Where it has them; blocks without one have 0, with a warning."""
    surfaces = [flat("clay", 10), flat("sand", 30)]
    surfaces[0].property, surfaces[1].property = 4, 7
    entries = [Property(4, "Clay", porosity=0.05), Property(7, "Sand", porosity=0.25, permeability=120.5)]
    model = build(Project("p", [Rock("r", base_elevation=0.0, surfaces=surfaces)], library=Library(entries)))
    model.save(path := tmp_path / "m.grdecl", cell_size=25.0)
    arrays = read_grdecl(path)
    assert arrays["PORO"].tolist() == [0.25] * 16 + [0.05] * 16
    for axis in "XYZ":
        assert arrays[f"PERM{axis}"].tolist() == [120.5] * 16 + [0.0] * 16
    grid = model.corner_point_grid(25.0)
    assert [warning.kind for warning in grid.warnings] == ["corner_point_permeability"]
    assert grid.warnings[0].text.endswith(": clay")
    layered().save(path, cell_size=25.0)
    assert "PORO" not in path.read_text()


@pytest.mark.parametrize("connects", ["PINCH\n/\n", ""])
@pytest.mark.parametrize("name", MODELS)
def test_opm_flow_runs_it_to_the_end(tmp_path, name, connects):
    """Water from a well to another through a fault, where a layer ends, and below and above a seal: that one
    only where the bed ends, by PINCH."""
    flow = shutil.which("flow")
    if flow is None:
        pytest.skip("OPM Flow is not installed (Debian's libopm-simulators-bin)")
    model = MODELS[name]()
    path = tmp_path / "m.grdecl"
    model.save(path, cell_size=10.0, grid_layers=2)
    assert path.read_text().count("PINCH\n/\n") == 1
    path.write_text(path.read_text().replace("PINCH\n/\n", connects))
    grid = model.corner_point_grid(10.0, layers=2)
    nx, ny, nz = grid.shape
    seal = (
        np.flatnonzero(grid.fipnum[:, 0, 0] == 1 + (grid.names.index("seal") if name == "sealed" else 0)) + 1
    )
    is_sealed = name == "sealed"
    deck = DECK.format(
        nx=nx,
        ny=ny,
        nz=nz,
        cells=nx * ny * nz,
        seal=f"EQUALS\n PERMX 0 1 {nx} 1 {ny} {seal.min()} {seal.max()} /\n PERMY 0 /\n PERMZ 0 /\n/"
        if is_sealed
        else "",
        out=1 if is_sealed else nx,
        lowest=seal.min() - 1 if is_sealed else nz,
        highest=seal.max() + 1 if is_sealed else 1,
    )
    (tmp_path / "DECK.DATA").write_text(deck)
    run = subprocess.run(
        [flow, "--output-dir=out", "--threads-per-process=1", "DECK.DATA"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stdout[-3000:] + run.stderr[-2000:]
    assert "End of simulation" in run.stdout
    produced = float((tmp_path / "out" / "DECK.FUNSMRY").read_text().split()[-1])
    assert produced == pytest.approx(0.0 if is_sealed and not connects else 20.0, abs=1e-3)
