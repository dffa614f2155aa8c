# SPDX-License-Identifier: GPL-3.0-or-later
"""Models with faults and bodies in tiles, built in this process: the same cells as undivided ones."""

import functools
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
import structure_cases
from faulted.generate import random_case
from folded_rocks import dome, folded_project, given_field, sheet
from realmodel.core import Body, Fault, InputRefused, Project, Rock, Surface, UsageError, build, open_tiles
from realmodel.core.base.mapped_arrays import MappedArrays
from realmodel.core.base.work import run
from realmodel.core.cells.cell_complex import CellComplex
from realmodel.core.tiles.grid import TileGrid
from realmodel.core.tiles.owned_cells import Seam, face_keys, inseparable, owners, reach_of
from realmodel.core.tiles.windows import Windows, _any_passes
from realmodel.distributed import build as build_tiles
from realmodel.distributed import faulted_folder
from tiled_models import assert_same_warnings, sample

pytestmark = pytest.mark.usefixtures("tiles_in_this_process")


@functools.cache
def undivided(name, cells):
    """The model of a sample."""
    return build(sample(name), cells=cells)


@pytest.fixture(scope="module")
def in_six(tmp_path_factory):
    """in_six(name, cells) is a sample in six tiles, as it was built, and its folder."""

    @functools.cache
    def made(name, cells):
        folder = tmp_path_factory.mktemp("six")
        size = tile_size(undivided(name, cells), 3, 2)
        return build_tiles(sample(name), folder, size, cells=cells), folder

    return made


def tile_size(model, columns, rows):
    extent = np.ptp(model.vertices[:, :2], axis=0)
    return extent[0] / columns, extent[1] / rows


def assert_same_blocks(tiled, whole, columns_off=0.0):
    """columns_off: the share of cells by which columns may differ. In an undivided model sheets end beside
    compartments, and columns that reach beyond may be divided there."""
    assert [block.name for block in tiled.blocks] == [block.name for block in whole.blocks]
    for one, other in zip(tiled.blocks, whole.blocks, strict=True):
        assert (one.surface, one.rock, one.property) == (other.surface, other.rock, other.property)
        assert one.components == other.components, one
        off = 0.0 if tiled.cell_kind == "blocks" else columns_off
        assert abs(one.cells - other.cells) <= off * other.cells, (one, other)
        assert abs(one.volume - other.volume) <= 1e-12 * other.volume, (one, other)
    assert tiled.unequal == 0
    assert tiled.surface_names == whole.surface_names


def cell_keys(model):
    """Of each cell its faces, by their corners and surfaces, and its block and compartment."""
    keys, cells = face_keys(model, np.arange(len(model.face_surface))), [[] for _ in model.cell_block]
    for key, sides in zip(keys.tolist(), model.face_cells.tolist(), strict=True):
        for cell in sides:
            if cell >= 0:
                cells[cell].append(key)
    names = [model.compartment_names[number] for number in model.cell_compartment]
    return [
        (tuple(sorted(own)), block, name)
        for own, block, name in zip(cells, model.cell_block.tolist(), names, strict=True)
    ]


@pytest.mark.parametrize(
    ("name", "cells"),
    [
        ("fault_blocks", "columns"),
        ("rift_basin", "blocks"),
        ("intrusion", "columns"),
        ("quarry", "blocks"),
        ("tunnel", "columns"),
        ("tunnel", "blocks"),
    ],
)
def test_samples_have_the_blocks_of_the_undivided_model(name, cells, in_six):
    whole = undivided(name, cells)
    tiled, folder = in_six(name, cells)
    assert len(tiled.tiles) == 6 and tiled.patches > 0
    assert_same_blocks(tiled, whole)
    opened = open_tiles(folder)
    assert [block.volume for block in opened.blocks] == [block.volume for block in tiled.blocks]
    for tile in opened.tiles:
        model = tile.model()
        assert model.is_cut and model.validate().passed  # whole blocks were joined from proven columns
        assert model.surface_names == whole.surface_names
        assert np.array_equal(model.surface_kind, whole.surface_kind)


@pytest.mark.parametrize("name", ["fault_blocks", "quarry"])
def test_cells_do_not_depend_on_where_tiles_end(name, in_six, tmp_path):
    whole, found = undivided(name, "columns"), []
    one, others = (
        build_tiles(sample(name), tmp_path / f"{columns}-{rows}", tile_size(whole, columns, rows))
        for columns, rows in ((1, 1), (2, 3))
    )
    for tiled, count in ((one, 1), (in_six(name, "columns")[0], 6), (others, 6)):
        assert len(tiled.tiles) == count
        keys = [key for tile in tiled.tiles for key in cell_keys(tile.model())]
        assert len(keys) == len(set(keys))
        found.append(set(keys))
    assert found[0] == found[1] == found[2]


def test_sheets_of_neighbors_do_not_depend_on_where_tiles_end(tmp_path):
    """Of two faults: between them there are no points of the younger surface, beyond them two."""
    plan = np.random.default_rng(5).uniform(0.0, 10.0, (300, 2))
    drop = np.where(plan[:, 0] > 3, 0.6, 0.0) + np.where(plan[:, 0] > 7, 0.5, 0.0)
    low = np.column_stack([plan, 0.03 * plan[:, 1] - drop])
    high = low[plan[:, 0] < 2.5] + np.array([0.0, 0.0, 2.0])
    few = low[plan[:, 0] > 7][:2] + np.array([0.0, 0.0, 2.1])
    surfaces = [Surface("S0", points=low), Surface("S1", points=np.concatenate([high, few]))]
    rock = Rock("r", surfaces, region=structure_cases.SQUARE, edge_length=1.0, base_elevation=-4.0)
    faults = [
        Fault(name, *structure_cases.plane_fault(x, lean))
        for name, x, lean in (("F", 3.0, 0.2), ("G", 7.0, -0.1))
    ]
    project = Project("p", [rock], faults=faults)
    whole = build(project)
    texts = {warning.text for warning in whole.warnings}
    assert sum(text.count("the throw of fault") for text in texts) == 2
    found = []
    for folder, size in (("one", (20.0, 20.0)), ("six", (3.4, 5.1))):
        tiled = build_tiles(project, tmp_path / folder, size)
        assert_same_warnings(tiled, whole)
        found.append({key for tile in tiled.tiles for key in cell_keys(tile.model())})
        assert_same_blocks(tiled, whole, 0.02)
    assert found[0] == found[1]


def test_sections_boreholes_and_warnings_are_those_of_the_whole(in_six):
    whole, (tiled, _) = undivided("fault_blocks", "columns"), in_six("fault_blocks", "columns")
    rng = np.random.default_rng(3)
    low, high = whole.vertices.min(axis=0), whole.vertices.max(axis=0)
    for x, y in rng.uniform(low[:2], high[:2], (40, 2)):
        ours, theirs = tiled.borehole(x, y), whole.borehole(x, y)
        assert [each.block for each in ours] == [each.block for each in theirs]
        assert np.allclose([each.top for each in ours], [each.top for each in theirs], rtol=0, atol=1e-9)
    for normal in ((1, 0, 0), (1, 2, 0)):
        sections = (model.section((low + high) / 2, normal) for model in (tiled, whole))
        areas = [areas_of(section, len(whole.blocks)) for section in sections]
        assert np.allclose(areas[0], areas[1], rtol=1e-12)
    assert_same_warnings(tiled, whole)


@pytest.mark.parametrize("fault", [(), (Fault("F", *structure_cases.plane_fault(5.3, 0.4)),)])
def test_series_have_the_cells_of_the_undivided_model(fault, monkeypatch, tmp_path):
    """The second level lies in one corner alone: most tiles have none of it."""
    given_field(monkeypatch, dome, (3.0, 11.0))
    younger = [sheet("base of B", lambda x, y: 6.0 + 0.2 * y)]
    project = folded_project(dome, (3.0, 11.0), younger, faults=list(fault))
    project.rocks[0].edge_length = 1.0
    whole, found = build(project), []
    for folder, size in (("one", (20.0, 20.0)), ("eight", (3.4, 5.6))):
        tiled = build_tiles(project, tmp_path / folder, size)
        assert_same_blocks(tiled, whole, 0.02)
        assert_same_warnings(tiled, whole)
        models = [tile.model() for tile in open_tiles(tmp_path / folder).tiles]
        assert all(model.validate().passed for model in models)
        found.append({key for model in models for key in cell_keys(model)})
        assert_same_fields(open_tiles(tmp_path / folder), whole)
        with pytest.raises(UsageError, match="of tiles only the whole has it"):
            models[0].field("folded")
    assert len(models) == 8
    assert found[0] == found[1]


def assert_same_fields(tiled, whole):
    (rock,) = tiled.rock_fields()
    places = np.random.default_rng(4).uniform(0.0, 10.0, (50, 3))
    assert rock.compartments == whole.compartment_names or len(rock.compartments) == 1
    for name in rock.compartments:
        fields = [model.field("folded", name) for model in (tiled, whole)]
        assert fields[0].lattice == fields[1].lattice
        assert np.array_equal(*(field.at(places) for field in fields))


def areas_of(section, blocks):
    """(B,) the area of each block in a section."""
    areas = np.zeros(blocks)
    for number, block in enumerate(section.block.tolist()):
        begin, end = section.offsets[number : number + 2]
        places = section.vertices[section.polygon_vertices[begin:end]]
        normal = np.cross(places[1:-1] - places[0], places[2:] - places[0]).sum(axis=0)
        areas[block] += np.linalg.norm(normal) / 2
    return areas


def lattice(n, z, size=1000.0):
    """A surface on a lattice; z(x, y)."""
    x, y = (each.ravel() for each in np.meshgrid(*[np.linspace(0, size, n + 1)] * 2))
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    a, b, c, d = corner, corner + 1, corner + n + 2, corner + n + 1
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return np.column_stack([x, y, z(x, y)]), triangles.astype(np.int32)


def plane_fault(name, low, high, azimuth, at, **more):
    """A leaning fault through (at, 500) that passes the rock, or with `half` dies out."""
    half = more.pop("half", 2000.0)
    along = np.array([np.sin(azimuth), np.cos(azimuth)])
    corners = [(-half, low), (half, low), (half, high), (-half, high)]
    lean = np.array([along[1], -along[0]]) * 0.4
    vertices = [[*(np.array([at, 500.0]) + s * along + z * lean), z] for s, z in corners]
    return Fault(name, np.array(vertices), np.array([[0, 1, 2], [0, 2, 3]]), **more)


def faulted(n=24, dies_out=False):
    """Four surfaces, two crossing faults, a third one that ends at the first, and a body."""

    def thrown(shift, throw):
        return lambda x, y: shift + 15 * np.sin(x / 130) + 10 * np.cos(y / 170) + throw * (x > 480)

    surfaces = [
        Surface(f"S{k}", *lattice(n + 3 * k, thrown(-300 + 100 * k, 0)), rule=rule)
        for k, rule in enumerate(["erosional", "conformable", "erosional", "erosional"])
    ]
    half = {"half": 300.0} if dies_out else {}
    faults = [
        plane_fault("A", -900, 900, 0.2, 470.0, youngest="S2", dies_out=dies_out, **half),
        plane_fault("B", -900, 900, 1.3, 500.0, youngest="S1"),
    ]
    vertices, triangles = lattice(3, lambda x, y: 0 * x - 150, 300.0)
    bottom = vertices + np.array([350, 350, 0])
    closed = np.concatenate([bottom, bottom + np.array([0, 0, 120])])
    rim = [0, 1, 2, 3, 7, 11, 15, 14, 13, 12, 8, 4]
    walls = []
    for a, b in zip(rim, rim[1:] + rim[:1], strict=True):
        walls += [[a, b, b + 16], [a, b + 16, a + 16]]
    faces = np.concatenate([triangles[:, ::-1], triangles + 16, walls])
    return Project(
        "faulted",
        [Rock("rock", surfaces, base_elevation=-600.0)],
        faults=faults,
        bodies=[Body("intrusion", closed, faces, after="S2")],
    )


def test_surfaces_and_sheets_are_kept_in_files(monkeypatch, tmp_path):
    """Sheets go there as they are made, and the files are gone at the end."""
    real, are_mapped = Windows.__init__, []

    def look(self, work, inputs, *more):
        for entry in inputs:
            meshes = [sheet for row in entry.structure.sheets for sheet in row]
            meshes += [mesh for mesh in (*entry.surfaces, entry.region) if mesh is not None]
            are_mapped.extend(isinstance(each, np.memmap) for mesh in meshes for each in mesh)
            made = [values for of in entry.attributes.values() for values in of.values()]
            are_mapped.extend(isinstance(each, np.memmap) for each in made)
        real(self, work, inputs, *more)

    monkeypatch.setattr(Windows, "__init__", look)
    for name in ("fault_blocks", "rift_basin"):
        before = len(are_mapped)
        build_tiles(sample(name), tmp_path / name, (1e6, 1e6))
        assert len(are_mapped) > before and all(are_mapped)
        assert not (tmp_path / name / "run").exists()


def test_plan_coordinates_are_made_equal_once():
    """A surface whose eastern border was written with other digits."""
    project = faulted()
    x = project.rocks[0].surfaces[1].vertices[:, 0]
    x[x == 1000] = np.nextafter(1000, 2000)
    inputs, structures = structure_cases.with_structures(project, 2)
    windows = run(lambda work: Windows(work, inputs, structures))
    assert windows.joined.startswith("plan coordinates merged that differ only by rounding")
    east = [
        [max(vertices[:, 0].max() for vertices, _ in entry.structure.distinct(k)) for k in range(4)]
        for entry in (inputs[0], windows.inputs[0])
    ]
    assert east == [[1000, x.max(), 1000, 1000], [1000] * 4]


def test_memory_does_not_grow_with_the_triangles(tmp_path):
    """That which is kept while tiles are built; all else is made of one surface, or for one window."""

    def kept(n):
        with MappedArrays(tmp_path / str(n)) as arrays:
            inputs, structures = structure_cases.with_structures(faulted(n), 2, arrays.keep)
            tracemalloc.start()
            windows = run(lambda work: Windows(work, inputs, structures, arrays.keep))
            windows.divide((251, 262))
            found = tracemalloc.get_traced_memory()[0]
            tracemalloc.stop()
            return found, sum(len(triangles) for _, triangles in inputs[0].surfaces)

    kept(3)
    (small, few), (large, many) = kept(20), kept(120)
    assert large - small < many - few  # bytes, triangles


def test_fine_meshes_need_a_part_of_the_triangles_only(tmp_path, monkeypatch):
    project = faulted(36, True)
    whole, seen = build(project), []
    real = Windows.window

    def look(self, work, name, farther):
        window = real(self, work, name, farther)
        seen.append(farther)
        used = sum(len(triangles) for _, triangles in window.inputs[0].surfaces)
        assert used < 0.55 * sum(len(triangles) for _, triangles in whole.rock_inputs[0].surfaces)
        return window

    monkeypatch.setattr(Windows, "window", look)
    tiled = build_tiles(project, tmp_path / "t", (251, 262))
    assert_same_blocks(tiled, whole, 0.05)
    assert seen == [0] * len(tiled.tiles) == [0] * 16


def test_rounding_is_judged_alike_in_all_tiles(tmp_path):
    """Nodes of one rock mass are nearer to a fault than rounding is in the other one, far in the east."""
    corners = np.array([[x, 0.25, z] for x, z in ((-1, -9), (2000, -9), (2000, 9), (-1, 9))], float)
    fault = Fault("F", corners, np.array([[0, 1, 2], [0, 2, 3]]))
    rocks = []
    for name, begin in (("west", 0.0), ("east", 1000.0)):
        surfaces = []
        for k in range(3):
            nodes, triangles = lattice(4, lambda x, y, k=k: k + 0.1 * np.sin(7 * x + 5 * y + k), size=1.0)
            nodes[nodes[:, 1] == 0.25, 1] += 3e-14
            nodes[:, 0] += begin
            surfaces.append(Surface(f"{name} {k}", nodes, triangles))
        rocks.append(Rock(name, surfaces))
    project = Project("far apart", rocks, faults=[fault])
    found = []
    for width in (2000.0, 500.3):
        tiled = build_tiles(project, tmp_path / f"{width}", (width, 2.0))
        found.append({key for tile in tiled.tiles for key in cell_keys(tile.model())})
    assert found[0] == found[1]


def test_tiles_that_see_too_little_are_built_again(tmp_path, monkeypatch):
    project = faulted(12)
    whole, asked = build(project), []
    real, around = Windows.window, Windows._around

    def narrow(self, work, tile, farther=0):
        asked.append(farther)
        calls = []

        def least(own, of):
            calls.append(of)
            return around(own, of) if len(calls) > 2 or farther != 0 else of

        with monkeypatch.context() as patch:
            patch.setattr(Windows, "_around", least)
            return real(self, work, tile, farther)

    monkeypatch.setattr(Windows, "window", narrow)
    tiled = build_tiles(project, tmp_path / "t", (340, 340))
    assert_same_blocks(tiled, whole, 0.05)
    assert asked.count(0) == 9 and 1 in asked


# 62000015 leaves windows without rock, 62000085 cells as thin as rounding between those of two tiles. Bodies
# of 64000401 have columns between older surfaces, that of 64000049 is in two rock masses. A cell of 50000233
# touches itself; a fault of 50000413 dies out beside a part of a cell that it cuts off
@pytest.mark.parametrize(
    "seed",
    [
        *(50_000_003, 50_000_021, 50_000_055, 50_000_144, 50_000_233, 50_000_413),
        *(62_000_015, 62_000_085, 64_000_401, 64_000_049),
    ],
)
def test_random_models(seed, tmp_path):
    project = random_case(seed).project()
    cells = "blocks" if seed % 2 else "columns"
    try:
        whole = build(project, cells=cells)
    except InputRefused as error:
        with pytest.raises(InputRefused) as refused:
            build_tiles(project, tmp_path / "t", (400, 400))
        assert str(refused.value) == str(error)
        return
    if not len(whole.cell_block):
        pytest.skip("nothing is left of this model")
    tiled = build_tiles(project, tmp_path / "t", tile_size(whole, 4, 3), cells=cells)
    for one, other in zip(tiled.blocks, whole.blocks, strict=True):
        assert one.components == other.components
        assert cells == "columns" or one.cells == other.cells
        assert abs(one.volume - other.volume) <= 1e-12 * max(other.volume, 1e-3 * whole.volume)


def test_a_run_goes_on_where_it_stopped(tmp_path, monkeypatch):
    project, built = faulted(12), []
    real = faulted_folder._build

    def stops(shared, task):
        if len(built) == 3:
            raise OSError(28, "No space left on device")
        built.append(task)
        real(shared, task)

    monkeypatch.setattr(faulted_folder, "_build", stops)
    with pytest.raises(OSError, match="No space"):
        build_tiles(project, tmp_path / "t", (340, 340))
    with pytest.raises(InputRefused):
        open_tiles(tmp_path / "t")
    first = list(built)

    def goes_on(shared, task):
        built.append(task)
        real(shared, task)

    monkeypatch.setattr(faulted_folder, "_build", goes_on)
    tiled = build_tiles(project, tmp_path / "t", (340, 340))
    assert built[:3] == first and sorted(built[:9]) == sorted(set(built)) and len(tiled.tiles) == 9
    assert_same_blocks(tiled, build(project), 0.05)
    assert not (tmp_path / "t" / "run").exists()
    monkeypatch.setattr(faulted_folder, "_build", None)  # it is only opened
    again = build_tiles(project, tmp_path / "t", (340, 340))
    assert again.blocks == tiled.blocks


def test_a_fault_that_ends_in_the_rock_is_refused_as_without_tiles(tmp_path):
    project = faulted()
    short = plane_fault("A", -900, 900, 0.2, 470.0, half=300.0)
    shape = lattice(24, lambda x, y: -200 + 60.0 * (x > 480))
    project.rocks[0].surfaces[1] = replace(
        project.rocks[0].surfaces[1], vertices=shape[0], triangles=shape[1]
    )
    project.faults = [short]
    with pytest.raises(InputRefused, match="it ends inside the rock"):
        build(project)
    with pytest.raises(InputRefused, match="it ends inside the rock"):
        build_tiles(project, tmp_path / "t", (340, 340))


def test_paraview_opens_all_of_them_at_once(in_six):
    pyvista = pytest.importorskip("pyvista")
    tiled, folder = in_six("fault_blocks", "columns")
    grid = pyvista.read(folder / "model.pvtu")
    cells = np.bincount(grid["block"], minlength=len(tiled.blocks))
    assert cells.tolist() == [block.cells for block in tiled.blocks]


def test_cells_between_faces_in_one_place_are_not_parted():
    """Between cells 0 and 3 there are 1 and 2, which have no extent where their triangles are one."""
    shared = CellComplex(
        vertices=np.array([[1.0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 0, 0], [2, 0, 0], [1, 0.5, 0]]),
        face_offsets=np.array([0, 3, 6, 9, 12]),
        face_vertices=np.array([0, 1, 2, 2, 0, 1, 0, 3, 2, 4, 0, 2], np.int32),
        face_cells=np.array([[0, 1], [2, 3], [0, -1], [3, 1]], np.int32),
        face_surface=np.full(4, -1, np.int32),
        cell_block=np.array([0, 1, 0, 1], np.int32),
        cell_kind="columns",
    )
    together = inseparable(shared)
    assert together.tolist() == [0, 0, 2, 2]
    grid = TileGrid(np.array([-0.5, 0.5, 2.5]), np.array([-1.0, 2.0]))
    assert owners(shared, grid, together)[:, 0].tolist() == [0, 0, 1, 1]
    assert reach_of(shared, np.array([True, False, False, False]), together) == (0.0, 0.0, 2.0, 1.0)


def test_owners_and_seams():
    two = CellComplex(  # cubes beside each other
        vertices=np.array([[x, y, z] for x in (0, 1, 2) for y in (0, 1) for z in (0, 1)], float),
        face_offsets=np.array([0, 4, 8, 12]),
        face_vertices=np.array([4, 5, 7, 6, 0, 1, 3, 2, 8, 10, 11, 9], np.int32),
        face_cells=np.array([[0, 1], [0, -1], [1, -1]], np.int32),
        face_surface=np.array([-1, 2, -1], np.int32),
        cell_block=np.array([3, 4], np.int32),
        cell_kind="columns",
    )
    grid = TileGrid(np.array([-0.5, 0.5, 2.5]), np.array([-1.0, 2.0]))
    assert owners(two, grid, inseparable(two)).tolist() == [[0, 0], [1, 0]]
    parts = np.array([[0, 0]])
    given = np.array([0]), np.array([0]), parts, np.array([True])
    one = Seam.of(two, *given)
    turned = replace(
        two,
        face_vertices=np.array([6, 7, 5, 4, 0, 1, 3, 2, 8, 10, 11, 9], np.int32),
        face_cells=np.array([[1, 0], [0, -1], [1, -1]], np.int32),
    )
    other = Seam.of(turned, *given)
    assert one.matches(other) and one.is_one.all() and one.block.tolist() == [[3, 4]]
    assert Seam.of_arrays(one.arrays("a"), "a").matches(other)
    moved = Seam.of(replace(turned, vertices=np.nextafter(two.vertices, 9.0)), *given)
    assert not one.matches(moved) and one.first_difference(moved) == (1.0, 0.0, 0.0)
    assert not one.matches(Seam.of(replace(two, face_surface=two.face_surface + 1), *given))
    assert not one.matches(Seam.of_arrays({}, "none"))


def test_which_triangles_pass_a_box():
    low, high = np.zeros(3), np.ones(3)
    triangle = np.array([[[-1.0, -1.0, 0.5], [3.0, -1.0, 0.5], [-1.0, 3.0, 0.5]]])
    assert _any_passes(triangle, low, high)
    assert not _any_passes(triangle + np.array([0, 0, 0.6]), low, high)
    aside = np.array([[[2.5, 0.0, 0.0], [0.0, 2.5, 0.0], [2.5, 2.5, 1.0]]])  # its box meets, it does not
    assert not _any_passes(aside, low, high)
    assert _any_passes(aside - np.array([0.6, 0, 0]), low, high)
