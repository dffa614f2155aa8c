# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that are continued beyond their borders: by `extend`, and where they all but reach."""

import numpy as np
import pytest
from realmodel.core import Fault, InputRefused, Project, Rock, Surface, build
from realmodel.core.base.triangles import border_loops, meet, open_edges
from realmodel.core.base.work import run
from realmodel.core.structures.shapes.continued import border_of, continued, extended
from realmodel.core.structures.shapes.reading import read_structures
from realmodel.core.structures.sheets import interpolated_sheets
from structure_cases import SQUARE, plane_fault, with_structures


def grid(x, y, height=lambda x, y: 0 * x, left_out=()):
    """A mesh of squares over lines in plan, without those at some places (column, row)."""
    corners = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    vertices = np.column_stack([corners, height(*corners.T)])
    triangles = []
    for i in range(len(x) - 1):
        for j in range(len(y) - 1):
            a = i * len(y) + j
            if (i, j) not in left_out:
                triangles += [(a, a + len(y), a + len(y) + 1), (a, a + len(y) + 1, a + 1)]
    return vertices.astype(float), np.array(triangles, np.int32)


def area(vertices, triangles):
    """By triangle, seen from above."""
    a, b, c = vertices[triangles, :2].transpose(1, 0, 2)
    return ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2


def test_a_mesh_is_continued_in_its_plane():
    vertices, triangles = grid(np.arange(5.0), np.arange(4.0), lambda x, y: 0.5 * x)
    wide, more = extended(vertices, triangles, 2.0)
    assert np.array_equal(wide[: len(vertices)], vertices) and np.array_equal(
        more[: len(triangles)], triangles
    )
    assert wide[:, 2] == pytest.approx(0.5 * wide[:, 0])
    level = 2.0 / np.hypot(1, 0.5)
    assert [*wide.min(axis=0)[:2], *wide.max(axis=0)[:2]] == pytest.approx([-level, -2, 4 + level, 5])
    assert (area(wide, more) > 0).all()
    assert area(wide, more).sum() == pytest.approx((4 + 2 * level) * 7)
    assert len(border_loops(more)) == 1


def test_a_hole_stays():
    vertices, triangles = grid(np.arange(6.0), np.arange(6.0), left_out=[(2, 2), (2, 3)])
    wide, more = extended(vertices, triangles, 1.5)
    assert area(wide, more).sum() == pytest.approx(8 * 8 - 2) and (area(wide, more) > 0).all()


@pytest.mark.parametrize("by", [0.3, 1.0, 4.0])
def test_a_ragged_border_with_a_bay_does_not_overlap_itself(by):
    """Steps along one side, and a bay wider than twice the extension, or much narrower."""
    steps = [(i, j) for i in range(12) for j in range(12) if i + j > 15 or (j < 4 and i in (3, 4, 5))]
    vertices, triangles = grid(np.arange(13.0), np.arange(13.0), left_out=steps)
    wide, more = extended(vertices, triangles, by)
    assert (area(wide, more) > 0).all()
    assert np.array_equal(more[: len(triangles)], triangles)
    ends = wide[np.unique(open_edges(wide, more))]
    assert (
        len(ends) and ends[:, :2].min() == pytest.approx(-by) and ends[:, 1].max() == pytest.approx(12 + by)
    )


def test_a_fault_that_dies_out_is_continued_up_and_down_its_dip():
    vertices, triangles = grid(np.arange(9.0), np.arange(4.0), lambda x, y: 2.0 * y)
    wide, _ = extended(vertices, triangles, 1.0, sideways=False)
    assert wide[:, 0].min() == 0 and wide[:, 0].max() == 8
    assert wide[:, 1].max() == pytest.approx(3 + 1 / np.sqrt(5))
    assert wide[:, 1].min() == pytest.approx(-1 / np.sqrt(5))


def test_only_some_edges_are_continued():
    vertices, triangles = grid(np.arange(4.0), np.arange(4.0))
    border = border_of(vertices, triangles)
    east = border.some(border.away[:, 0] > 0.9)
    wide, more = continued(vertices, triangles, east, 0.25)
    assert wide[:, 0].max() == 3.25 and wide[:, :2].min() == 0 and wide[:, 1].max() == 3
    assert area(wide, more).sum() == pytest.approx(9 + 3 * 0.25)


def test_a_border_that_returns_beside_itself_is_refused():
    turn = np.linspace(0.0, 1.9 * np.pi, 40)
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    vertices = np.concatenate([np.column_stack([r * ring, 0 * turn]) for r in (0.05, 1.0)])
    k = np.arange(39)
    triangles = np.concatenate(
        [np.column_stack([k, k + 40, k + 41]), np.column_stack([k, k + 41, k + 1])]
    ).astype(np.int32)
    with pytest.raises(InputRefused, match="its border turns back on itself near"):
        extended(vertices, triangles, 5.0)


def test_a_mesh_with_extend_is_read_extended():
    vertices, triangles = grid(np.arange(5.0), np.arange(4.0))
    project = Project("p", [], faults=[Fault("F", vertices, triangles, extend=1.0)])
    (fault,), _, _ = run(lambda work: read_structures(work, project))
    assert fault.vertices[:, :2].min() == -1 and fault.extend == 0
    assert not meet(vertices[triangles], fault.vertices[fault.triangles[len(triangles) :]] + [0, 0, 1]).any()


def leaning(y=(-1.0, 11.0), top=20.0, bottom=-12.0):
    """A fault in the plane x = 5 - 0.3 z, of many triangles."""
    ys, zs = np.linspace(*y, 9), np.linspace(bottom, top, 9)
    plan, triangles = grid(ys, zs)
    return np.column_stack([5.0 - 0.3 * plan[:, 1], plan[:, 0], plan[:, 1]]), triangles


PLAN = np.random.default_rng(1).uniform(0.0, 10.0, (200, 2))


def horizon(name, level):
    """A sloping one with a throw of 1 at that fault."""
    z = level + 0.1 * PLAN[:, 0] - np.where(PLAN[:, 0] > 5.0 - 0.3 * level, 1.0, 0.0)
    return Surface(name, points=np.column_stack([PLAN, z]), method="natural_neighbour")


def erosion(place):
    return 4.5 + 0.4 * np.sin(place[..., 0]) * np.cos(place[..., 1])


def faulted(*faults, surfaces=None, **more):
    surfaces = surfaces or [horizon("A", 0.0), horizon("B", 3.0)]
    rock = Rock("r", surfaces, region=[SQUARE], edge_length=0.8, base_elevation=-5.0)
    return Project("p", [rock], faults=list(faults), **more)


def closed(model):
    return [warning.text for warning in model.warnings if "it is continued to it" in warning.text]


def volumes(model):
    return [block.volume for block in model.blocks]


@pytest.mark.parametrize(("y", "gap"), [((1e-6, 11.0), "1e-06"), ((0.003, 9.9), "0.1")])
def test_a_fault_that_all_but_reaches_the_wall_is_continued_to_it(y, gap):
    model = build(faulted(Fault("F", *leaning(y))))
    (text,) = closed(model)
    assert text.startswith(f"fault 'F': its border ends up to {gap} before the wall, near (")
    assert volumes(model) == pytest.approx(volumes(build(faulted(Fault("F", *leaning())))), rel=1e-9)
    vertices, _ = model.surface(2)
    own, _ = leaning(y)
    assert np.array_equal(vertices[: len(own)], own) and len(vertices) > len(own)
    assert vertices[:, 1].min() < 0 and vertices[:, 1].max() > 10
    assert vertices[:, 0] == pytest.approx(5.0 - 0.3 * vertices[:, 2])
    assert closed(build(faulted(Fault("F", *leaning(y))), stage=0)) == [text]


def test_a_fault_that_reaches_the_wall_is_used_as_it_is():
    given, triangles = leaning()
    model = build(faulted(Fault("F", given, triangles)))
    assert closed(model) == [] and np.array_equal(model.surface(2)[0], given)


def test_a_model_in_tiles_is_made_from_the_continued_fault():
    project = faulted(Fault("F", *leaning((0.003, 11.0))))
    (entry,), structures = with_structures(project)
    assert sum("it is continued to it" in warning.text for warning in entry.warnings) == 1
    assert np.array_equal(structures.faults[0].vertices, build(project).surface(2)[0])


def never(*arguments):
    raise AssertionError("nothing is interpolated before")


def test_a_fault_that_ends_inside_is_refused_before_anything_is_interpolated(monkeypatch):
    """The gap is wider than a quarter of an edge length, 0.2."""
    monkeypatch.setattr(interpolated_sheets, "give_heights", never)
    with pytest.raises(InputRefused, match=r"'F': it ends inside the rock that it displaces near .*0\.5,"):
        build(faulted(Fault("F", *leaning((0.5, 11.0)))))


def test_a_branch_that_all_but_meets_its_fault_is_continued_to_it(monkeypatch):
    main = Fault("F", *plane_fault())

    def branch(gap):
        corners = [[5 + gap, 4, -20], [15, 4, -20], [15, 4, 20], [5 + gap, 4, 20]]
        return Fault("G", np.array(corners, float), plane_fault()[1], ends_at=["F"])

    model = build(faulted(branch(0.15), main))
    (text,) = closed(model)
    assert text.startswith("fault 'G': its border ends up to 0.15 before fault 'F', near (5.15, 4, ")
    assert volumes(model) == pytest.approx(volumes(build(faulted(branch(-1.0), main))), rel=1e-9)
    monkeypatch.setattr(interpolated_sheets, "give_heights", never)
    with pytest.raises(InputRefused, match=r"does not meet it: the nearest it comes is 0\.5"):
        build(faulted(branch(0.5), main))


def test_a_fault_that_dies_out_may_end_beside_a_wall():
    given, triangles = leaning((0.1, 6.0))
    model = build(faulted(Fault("F", given, triangles, dies_out=True)))
    assert closed(model) == [] and np.array_equal(model.surface(2)[0], given)


def on_erosion(below):
    """The fault whose upper border lies on the surface of erosion, or below it."""
    vertices, triangles = leaning(top=4.5)
    for node in np.arange(8, len(vertices), 9):
        for _ in range(50):
            vertices[node, 2] = erosion(vertices[node]) - below
            vertices[node, 0] = 5.0 - 0.3 * vertices[node, 2]
    return vertices, triangles


def test_a_fault_that_ends_at_a_surface_that_is_interpolated_again_is_continued_to_it(monkeypatch):
    surfaces = [horizon("A", 0.0), horizon("B", 4.4)]
    surfaces.append(Surface("U", points=np.column_stack([PLAN, erosion(PLAN)]), method="natural_neighbour"))
    model = build(faulted(Fault("F", *on_erosion(0.0), youngest="B"), surfaces=surfaces))
    assert any("before surface 'U', near (" in text for text in closed(model))
    # points above its border are on the side on which they are beside it, wherever that is
    whole = build(faulted(Fault("F", *on_erosion(-0.2), youngest="B"), surfaces=surfaces))
    assert closed(whole) == [] and volumes(model) == pytest.approx(volumes(whole), rel=1e-2)
    asked, heights = [], interpolated_sheets.give_heights

    def counted(work, entry, number, *trend):
        asked.append(entry.rock.surfaces[number].name)
        heights(work, entry, number, *trend)

    monkeypatch.setattr(interpolated_sheets, "give_heights", counted)
    with pytest.raises(InputRefused, match="fault 'F': it ends inside the rock that it displaces near"):
        build(faulted(Fault("F", *on_erosion(0.4), youngest="B"), surfaces=surfaces))
    assert set(asked) == {"B", "U"}


def test_a_fault_that_ends_just_below_the_youngest_surface_is_continued_to_it():
    reaching = volumes(build(faulted(Fault("F", *leaning()))))
    model = build(faulted(Fault("F", *leaning(top=3.35))))
    assert [text.split(", near")[0].split(" before ")[1] for text in closed(model)] == ["surface 'B'"]
    assert volumes(model) == pytest.approx(reaching, rel=1e-9)


def test_ready_meshes_have_the_edge_length_of_their_own():
    """Without a region a surface ends where its mesh does: its edges, 1 long, are diagonals, too."""

    def ready(name, level):
        parts = [grid(x, np.arange(0.0, 11)) for x in ([0.0, 3, 5], [5.0, 7, 10])]
        for (vertices, _), height in zip(parts, (level, level - 1.0), strict=True):
            vertices[:, 2] = height
        vertices = np.concatenate([vertices for vertices, _ in parts])
        return Surface(name, vertices=vertices, triangles=np.concatenate([parts[0][1], parts[1][1] + 33]))

    def project(low):
        fault = Fault("F", *plane_fault(y=(low, 11.0)))
        return Project("p", [Rock("r", [ready("A", 0.0), ready("B", 3.0)])], faults=[fault])

    model = build(project(0.2))
    (text,) = closed(model)
    assert "up to 0.2 before the wall" in text
    assert volumes(model) == pytest.approx(volumes(build(project(-1.0))), rel=1e-9)
    with pytest.raises(InputRefused, match="it ends inside the rock"):
        build(project(0.9))
