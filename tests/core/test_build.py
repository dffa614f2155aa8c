# SPDX-License-Identifier: GPL-3.0-or-later
"""From a project to a model: what comes out, and what bad input is answered with."""

from itertools import pairwise

import numpy as np
import pytest
from conftest import grid_surface
from realmodel import _native
from realmodel.core import (
    Cancelled,
    InputRefused,
    Library,
    Project,
    Property,
    Rock,
    Surface,
    UsageError,
    build,
    load_project,
)
from realmodel.core.base.work import run


def level(name, z, n=2, shift=0.0, **more):
    vertices, triangles = grid_surface(n, lambda x, y: z + 0 * x)
    return Surface(name, vertices + np.array([shift, 0.0, 0.0]), triangles, **more)


def dome(name, height, n=20):
    """Above z = 0.5 in the middle only."""
    return Surface(name, *grid_surface(n, lambda x, y: height - 4 * ((x - 0.5) ** 2 + (y - 0.5) ** 2)))


def rock(*surfaces, name="rock", **more):
    return Project("project", [Rock(name, list(surfaces), **more)])


def figures(model):
    return [(block.name, pytest.approx(block.volume), block.components) for block in model.blocks]


def test_level_layers(layers):
    model = build(load_project(layers([0, 1, 3])))
    assert figures(model) == [("S1 block", 1.0, 1), ("S2 block", 2.0, 1)]
    assert [block.cells for block in model.blocks] == [2, 2]
    assert model.surface_names == ["S0", "S1", "S2"]
    assert model.volume == pytest.approx(3.0)
    assert (model.cell_kind, model.warnings) == ("columns", [])
    vertices, triangles = model.surface(1)
    assert vertices[:, 2].tolist() == [1, 1, 1, 1]
    assert triangles.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_what_was_eroded_away_is_listed_without_cells(layers):
    model = build(
        load_project(layers([0, 3, 1], rock_keys="base_elevation = -2.0", surface_keys="property = 7"))
    )
    assert figures(model) == [("base block", 2.0, 1), ("S1 block", 1.0, 1), ("S2 block", 0.0, 0)]
    assert [block.property for block in model.blocks] == [7, 7, 7]
    assert [block.surface for block in model.blocks] == [0, 1, 2]


def test_a_cut_that_leaves_several_bodies():
    """A valley through the middle leaves two bodies of the layer above its floor."""
    valley = Surface("valley", *grid_surface(16, lambda x, y: 2 - 4 * np.exp(-20 * (x - 0.5) ** 2)))
    model = build(rock(level("S0", 0.0), level("S1", 1.0), valley))
    assert model.blocks[0].components == 2
    component = model.cell_component[model.cell_block == 0]
    assert len(np.unique(component)) == 2
    blocks = build(rock(level("S0", 0.0), level("S1", 1.0), valley), cells="blocks")
    assert blocks.blocks[0].cells == 2
    assert [block.volume for block in blocks.blocks] == pytest.approx(
        [block.volume for block in model.blocks]
    )


def test_block_boundaries_are_closed_and_turn_outward():
    model = build(rock(level("S0", 0.0, 3), dome("S1", 1.0), level("S2", 0.4, 5), base_elevation=-2.0))
    for number, block in enumerate(model.blocks):
        shell = model.block_boundary(number)
        following = np.arange(1, len(shell.face_vertices) + 1)
        following[shell.face_offsets[1:] - 1] = shell.face_offsets[:-1]
        a, b = shell.face_vertices.astype(np.int64), shell.face_vertices[following].astype(np.int64)
        ahead, back = a * len(shell.vertices) + b, b * len(shell.vertices) + a
        assert np.array_equal(np.sort(ahead), np.sort(back)), "each edge as often one way as the other"
        assert len(np.unique(shell.face_vertices)) == len(shell.vertices)
        fans = [
            (face[0], p, q)
            for face in np.split(shell.face_vertices, shell.face_offsets[1:-1])
            for p, q in pairwise(face[1:])
        ]
        corners = shell.vertices[np.array(fans)]
        volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
        assert volume == pytest.approx(block.volume)
        assert np.array_equal(model.face_surface[shell.faces], shell.face_surface)


def test_a_stage_is_built_with_the_threads_of_its_model():
    whole = build(rock(level("S0", 0.0, 3), level("S1", 1.0, 3), base_elevation=-2.0), threads=2)
    assert (whole.threads, whole.stage(0).threads) == (2, 2)


def test_stages():
    surfaces = [level("S0", 0.0, 3), dome("S1", 1.0), level("S2", 0.4, 5), level("S3", 2.0, 4)]
    project = rock(*surfaces, base_elevation=-2.0)
    whole = build(project)
    for m in range(4):
        staged, direct = whole.stage(m), build(project, stage=m)
        alone = build(rock(*surfaces[: m + 1], base_elevation=-2.0))
        for name in (
            "vertices",
            "face_vertices",
            "face_cells",
            "face_surface",
            "cell_block",
            "surface_vertices",
        ):
            assert np.array_equal(getattr(staged, name), getattr(alone, name))
            assert np.array_equal(getattr(direct, name), getattr(alone, name))
        assert staged.blocks == alone.blocks == direct.blocks
        assert staged.surface_names == [f"S{k}" for k in range(m + 1)]
    assert whole.stage(3) is whole
    for stage in (4, -1, 1.5, True):
        with pytest.raises(UsageError, match="stages run from 0 to 3"):
            whole.stage(stage)
        with pytest.raises(UsageError, match="stages run from 0 to 3"):
            build(project, stage=stage)


def test_rock_masses_apart():
    project = Project(
        "two",
        [
            Rock("west", [level("S0", 0.0), level("S1", 1.0, property=2)], base_elevation=-1.0),
            Rock(
                "east",
                [level("S0", 0.0, shift=3.0), level("S1", 2.0, shift=3.0, property=5), level("S2", 3, 1, 3)],
            ),
        ],
        Library([Property(2, "Clay"), Property(5, "Sand")]),
    )
    model = build(project)
    assert figures(model) == [
        ("base block", 1.0, 1),
        ("S1 block", 1.0, 1),
        ("S1 block", 2.0, 1),
        ("S2 block", 1.0, 1),
    ]
    assert [(block.rock, block.surface) for block in model.blocks] == [(0, 0), (0, 1), (1, 3), (1, 4)]
    assert set(np.unique(model.face_surface)) == {-2, -1, 0, 1, 2, 3, 4}
    assert model.face_cells.max() == len(model.cell_block) - 1
    assert model.face_offsets[-1] == len(model.face_vertices)
    assert len(np.unique(model.vertices, axis=0)) == len(model.vertices)
    west = model.vertices[model.block_boundary(1).face_vertices.max()]
    assert west[0] <= 3.0
    assert model.stage(1).blocks[:3] == model.blocks[:3]


def two_rocks(shift):
    west = Rock("west", [level("S0", 0.0), level("S1", 2.0)])
    east = Rock("east", [level("S0", 1.0, shift=shift), level("S1", 3.0, shift=shift)])
    return Project("two", [west, east])


@pytest.mark.parametrize("shift", [1.0, -1.0])
def test_rock_masses_share_the_wall_between_them(shift):
    model = build(two_rocks(shift))
    rock = np.array([block.rock for block in model.blocks])[model.cell_block]
    sides = model.face_cells[(model.face_surface == -1) & (model.face_cells[:, 1] >= 0)]
    between = sides[rock[sides[:, 0]] != rock[sides[:, 1]]]
    assert len(between) == 2  # one for each pair of columns, from z = 1 to 2 where both have rock
    assert [block.volume for block in model.blocks] == pytest.approx([2.0, 2.0])
    assert len(np.unique(model.vertices, axis=0)) == len(model.vertices)


@pytest.mark.parametrize("shift", [0.5, 0.0, -0.5])
def test_rock_masses_that_overlap_are_refused_by_name(shift):
    with pytest.raises(InputRefused, match="rock 'east': it overlaps rock 'west' in plan near"):
        build(two_rocks(shift))


@pytest.mark.parametrize(
    "rule, volumes",
    [
        ("erosional", [0.75, 0.25]),
        ("conformable", [1.0, 0.25]),
        ("base", [1.0, 0.25]),
        ("discontinuous", [0.75, 0.25]),
    ],
)
def test_the_rule_of_a_surface_that_dips_below_the_top(rule, volumes):
    """A plane that rises from z = 0 to 2 over a slab from 0 to 1 cuts a quarter off it, or ends there."""
    tilted = level("S2", 0.0)
    tilted.vertices = np.array(tilted.vertices, float)
    tilted.vertices[:, 2] = 2 * tilted.vertices[:, 0]
    tilted.rule = rule
    model = build(Project("rules", [Rock("rock", [level("S0", 0.0), level("S1", 1.0), tilted])]))
    assert [block.volume for block in model.blocks] == pytest.approx(volumes)


@pytest.mark.parametrize("rule, left", [("base", 1.0), ("discontinuous", 1.0), ("conformable", 0.5)])
def test_what_protects_itself_is_not_cut(rule, left):
    protecting, cutting = level("S1", 1.0), level("S2", 0.5)
    protecting.rule = rule
    model = build(Project("rules", [Rock("rock", [level("S0", 0.0), protecting, cutting])]))
    assert [block.volume for block in model.blocks] == pytest.approx([left, 0.0])


def test_a_region_that_meets_no_surface_is_refused():
    project = rock(level("S0", 0.0), level("S1", 1.0), region=np.array([[5.0, 5], [6, 5], [6, 6]]))
    with pytest.raises(InputRefused, match=r"surface 'S0': its mesh lies 5\.66 m southwest of the region"):
        build(project)


def test_coordinates_joined_by_rounding_are_a_warning():
    nudged = level("S1", 1.0)
    nudged.vertices[nudged.vertices[:, 0] == 1.0, 0] = np.nextafter(1.0, 2.0)
    model = build(rock(level("S0", 0.0), nudged))
    assert [warning.kind for warning in model.warnings] == ["joined"]
    assert model.vertices[:, 0].max() in (1.0, np.nextafter(1.0, 2.0))
    assert len(np.unique(model.vertices[:, 0])) == 3  # no sliver along the border


OFF = "OFF\n{} {} 0\n{}"


def test_vertical_triangles_are_named_with_their_place(write, layers):
    path = layers([0, 1])
    write("s1.off", "OFF\n5 3 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n0.5 0.5 2\n3 0 1 2\n3 0 2 3\n3 0 2 4\n")
    with pytest.raises(InputRefused) as raised:
        build(load_project(path))
    assert raised.value.triangles == (2,)
    assert len(raised.value.place) == 3
    message = str(raised.value)
    assert message.startswith(
        f"{path.parent / 's1.off'}: rock 'rock', surface 'S1': triangle 2 is vertical near ("
    )


def test_double_valued_surfaces_are_named_with_their_triangles(write, layers):
    path = layers([0, 1])
    write(
        "s1.off",
        "OFF\n7 3 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n.2 .2 2\n.8 .2 2\n.8 .3 2\n4 0 1 2 3\n3 4 5 6\n3 0 1 4\n",
    )
    with pytest.raises(InputRefused) as raised:
        build(load_project(path))
    assert len(raised.value.triangles) == 2
    message = str(raised.value)
    assert "surface 'S1': triangles" in message
    assert "overlap in plan near (" in message
    assert "(of faces 0 and " in message, "polygons are divided: the faces of the file are named too"


def test_a_base_that_is_not_below_is_named_with_its_line(layers):
    path = layers([5, 6], rock_keys="base_elevation = 6.5")
    with pytest.raises(InputRefused) as raised:
        build(load_project(path))
    assert raised.value.line == 5
    assert "base_elevation 6.5 is not below any of the rock mass" in str(raised.value)
    assert "choose one below 5" in str(raised.value)


def test_triangles_without_area_are_left_out_with_a_warning(write, layers):
    path = layers([0, 1])
    write("s1.off", "OFF\n4 3 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n3 0 1 2\n3 0 2 3\n3 0 1 1\n")
    model = build(load_project(path))
    assert figures(model) == [("S1 block", 1.0, 1)]
    assert len(model.warnings) == 1
    warning = model.warnings[0]
    assert (warning.rock, warning.surface, warning.items) == ("rock", "S1", (2,))
    assert "surface 'S1': " in str(warning)


@pytest.mark.parametrize(
    ("file", "text", "words"),
    [
        ("s1.off", "OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", "s1.off:4: rock 'rock', surface 'S1': "),
        ("s1.off", "", "s1.off: rock 'rock', surface 'S1': the file is empty"),
    ],
)
def test_broken_files_are_named_with_what_they_belong_to(write, layers, file, text, words):
    path = layers([0, 1])
    write(file, text)
    with pytest.raises(InputRefused) as raised:
        build(load_project(path))
    assert words in str(raised.value)


def test_files_are_read_when_built_and_kept_for_later(write, layers):
    path = layers([0, 1])
    project = load_project(path)
    write("s1.off", (path.parent / "s1.off").read_text().replace(" 1\n", " 4\n"))
    model = build(project)
    for file in path.parent.glob("*.off"):
        file.unlink()
    again = build(model.project)
    assert np.array_equal(again.vertices, model.vertices)
    assert project.rocks[0].surfaces[0].vertices is None, "the project that was given is not changed"


def test_wrong_calls():
    project = rock(level("S0", 0.0), level("S1", 1.0))
    with pytest.raises(UsageError, match="cells must be"):
        build(project, cells="cubes")
    for threads in (-1, 1.5, "2", True):
        with pytest.raises(UsageError, match="threads must be"):
            build(project, threads=threads)


def test_one_surface_alone_warns():
    model = build(rock(level("S0", 0.0)))
    assert model.blocks == []
    assert "a single surface" in str(model.warnings[0])


@pytest.fixture(scope="module")
def long_build():
    """A project that takes long enough for many calls of progress() and cancel()."""

    def height(k):
        return lambda x, y: 0.1 * k + 0.4 * np.sin(7 * x + k) * np.cos(6 * y - k)

    return rock(*(Surface(f"S{k}", *grid_surface(90 + k, height(k))) for k in range(10)))


def test_progress_of_a_build(long_build):
    calls = []
    build(long_build, progress=lambda fraction, text: calls.append((fraction, text)))
    fractions, texts = zip(*calls, strict=True)
    assert list(fractions) == sorted(fractions)
    assert 0.0 <= fractions[0] < 1.0
    assert fractions[-1] == 1.0
    assert any("intersecting" in text for text in texts)
    assert len(set(fractions)) > 5


def counted_after_cancel(project, share, monkeypatch):
    """What native work counts of itself, 1 being a whole call, after cancel() has said yes; it does so once
    this share of the build is done."""
    controls, fractions, asked = [], [0.0], []
    control = _native.Execution

    def recorded(*arguments):
        controls.append(control(*arguments))
        return controls[-1]

    def counted():
        return sum(one.fraction for one in controls)

    def cancel():
        if fractions[-1] < share:
            return False
        asked.append(counted())
        return True

    with monkeypatch.context() as patch:
        patch.setattr(_native, "Execution", recorded)
        with pytest.raises(Cancelled):
            build(project, progress=lambda fraction, text: fractions.append(fraction), cancel=cancel)
        run(lambda work: None)  # waits for the work that was stopped
    assert len(asked) == 1
    return counted() - asked[0]


@pytest.mark.parametrize("share", [0.0, 0.2, 0.4, 0.6])
def test_a_cancelled_build_does_little_more(long_build, share, monkeypatch):
    """Of several attempts one must: on a busy machine work goes on before the wish arrives."""
    most = 0.1
    assert any(counted_after_cancel(long_build, share, monkeypatch) < most for _ in range(6))


def test_what_a_method_leaves_below_the_base_is_cut_off(write):
    """Two points in one triangle make DSI steep: the lowest place is none that points show."""
    write("p.csv", "x,y,z\n5,5,10\n5.2,5.1,13\n5.1,5.2,11\n")
    path = write(
        "p.toml",
        'format = 1\nname = "x"\n[[rock]]\nname = "r"\nregion = [[0, 0], [20, 0], [20, 20], [0, 20]]\n'
        'edge_length = 4\nbase_elevation = 0\n[[rock.surface]]\nname = "s"\npoints = "p.csv"\n'
        'method = "dsi"\n',
    )
    model = build(load_project(path))
    texts = [warning.text for warning in model.warnings if warning.kind == "below_base"]
    assert len(texts) == 1 and "below base_elevation 0 on" in texts[0]
    assert model.vertices[:, 2].min() == 0
