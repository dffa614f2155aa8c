# SPDX-License-Identifier: GPL-3.0-or-later
"""Booleans of triangulated surfaces: what the result says of itself, identities, and answers of others."""

import functools
import itertools
import threading

import manifold3d
import numpy as np
import pytest
import solids
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from realmodel.core import Cancelled, InputRefused, UsageError, intersect
from realmodel.core.readers import read_mesh
from stacks import places

OPERATIONS = {
    "union": np.logical_or,
    "intersection": np.logical_and,
    "difference": lambda a, b: a & ~b,
    "reverse_difference": lambda a, b: b & ~a,
}
TURN = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)  # z to y
TORI = solids.torus(), solids.moved(solids.torus(), (2, 0, 0.1), TURN)
SHIFTED_BOX = solids.box((0.25, 0.5, 0.25), (1.5, 0.75, 2))
PAIRS = {
    "tori that cross": (solids.torus(), solids.moved(solids.torus(tube=0.5), (0.3, 1.5, 0.1), TURN)),
    "tori that are linked": TORI,
    "boxes": (solids.box((0, 0, 0), (1, 1, 1)), SHIFTED_BOX),
    "boxes with a common face": (solids.box((0, 0, 0), (1, 1, 1)), solids.box((1, 0, 0), (2, 1, 1))),
    "boxes with a part of a face": (solids.box((0, 0, 0), (1, 1, 1)), solids.box((1, 0.5, 0), (2, 2, 0.5))),
    "boxes with a common edge": (solids.box((0, 0, 0), (1, 1, 1)), solids.box((1, 1, 0), (2, 2, 1))),
    "boxes with a common corner": (solids.box((0, 0, 0), (1, 1, 1)), solids.box((1, 1, 1), (2, 2, 2))),
    "the same twice": (solids.torus(), solids.torus()),
    "one in the other": (solids.box((0, 0, 0), (4, 4, 4)), solids.box((1, 1, 1), (2, 2, 3))),
    "two parts": (
        solids.together(solids.box((0, 0, 0), (1, 1, 1)), solids.box((2, 0, 0), (3, 1, 1))),
        solids.box((0.5, 0.25, 0.25), (2.5, 0.75, 0.5)),
    ),
}


def volumes(found):
    return {name: solids.volume(*getattr(found, name)()) for name in OPERATIONS}


def check_identities(a, b):
    """A + B = union + intersection, A = difference + intersection, and the other way round the same: exactly,
    A and B as the refinement has them, which rounding moved by 1e-12 at most."""
    found = intersect(a, b)
    size = max(abs(vertices).max() for vertices, _ in (a, b))
    allowed = 1e-12 * size**3
    parts, unit = solids.exact_volumes(found.vertices, found.triangles)

    def volume_of(rows, is_turned):
        return (parts[rows][~is_turned].sum() - parts[rows][is_turned].sum()) * unit

    volume_a, volume_b = (parts[found.source == number].sum() * unit for number in (0, 1))
    for volume, surface in zip((volume_a, volume_b), (a, b), strict=True):
        own, own_unit = solids.exact_volumes(*surface)
        assert abs(volume - own.sum() * own_unit) < allowed
    v = {name: volume_of(*found.boundary(name)) for name in OPERATIONS}
    assert v["union"] + v["intersection"] == volume_a + volume_b
    assert v["difference"] + v["intersection"] == volume_a
    assert v["reverse_difference"] + v["intersection"] == volume_b
    assert all(volume > -allowed for volume in v.values())
    blocks = [volume_of(*found.rows_of(number)) for number in range(len(found.sub_blocks))]
    for volume, block in zip(blocks, found.sub_blocks, strict=True):
        assert block.volume == pytest.approx(float(volume), rel=1e-12, abs=1e-18 * size**3)
    solid = (block.in_a or block.in_b for block in found.sub_blocks)  # others are hollows
    assert sum(itertools.compress(blocks, solid)) == v["union"]
    for name in OPERATIONS:
        result = getattr(found, name)()
        assert solids.volume(*result) == pytest.approx(float(v[name]), abs=allowed)
        assert solids.open_edges(result[1]) == 0
    other = volumes(intersect(b, a))
    for name, same in zip(OPERATIONS, ("union", "intersection", *list(OPERATIONS)[:1:-1]), strict=True):
        assert other[name] == pytest.approx(float(v[same]), abs=allowed)
    return found


def check_divides_nothing(surface):
    """A result fed back in, beside a solid far away: no triangle of it crosses another one."""
    vertices, triangles = surface
    far = solids.box(vertices.max(axis=0) + 1, vertices.max(axis=0) + 2)
    again = intersect(surface, far)
    own = again.source == 0
    assert again.loops == []
    assert (again.source_triangle[own] == np.arange(len(triangles))).all()
    parts, wholes = again.vertices[again.triangles[own]], vertices[triangles]
    assert (np.sort(parts, axis=1) == np.sort(wholes, axis=1)).all()


@pytest.mark.parametrize("a, b", PAIRS.values(), ids=PAIRS)
def test_identities(a, b):
    found = check_identities(a, b)
    for name in OPERATIONS:
        vertices, triangles = getattr(found, name)()
        if len(triangles):
            assert len(np.unique(triangles)) == len(vertices)
            check_divides_nothing((vertices, triangles))


@pytest.mark.parametrize("a, b", PAIRS.values(), ids=PAIRS)
def test_what_is_inside_by_solid_angles(a, b):
    found = intersect(a, b)
    both = np.concatenate([a[0], b[0]])
    points = np.random.default_rng(5).uniform(both.min(axis=0), both.max(axis=0), (300, 3))
    in_a, in_b = (np.rint(solids.winding(points, *surface)) != 0 for surface in (a, b))
    for name, kept in OPERATIONS.items():
        vertices, triangles = getattr(found, name)()
        inside = np.rint(solids.winding(points, vertices, triangles)) if len(triangles) else np.zeros(300)
        assert (inside == kept(in_a, in_b)).all(), name
    for block in found.sub_blocks:
        inside = np.rint(solids.winding(points, found.vertices, block.triangles)) == 1
        assert (in_a[inside] == block.in_a).all() and (in_b[inside] == block.in_b).all()
        assert solids.open_edges(block.triangles) == 0
        assert block.volume == pytest.approx(solids.volume(found.vertices, block.triangles), rel=1e-12)


@pytest.mark.parametrize("a, b", PAIRS.values(), ids=PAIRS)
def test_where_triangles_come_from(a, b):
    found = intersect(a, b)
    areas = solids.area(found.vertices, found.triangles)
    for number, (vertices, triangles) in enumerate((a, b)):
        own = found.source == number
        origin = found.source_triangle[own]
        parts = np.bincount(origin, areas[own], len(triangles))
        assert parts == pytest.approx(solids.area(vertices, triangles), rel=1e-9)
        first, second, third = vertices[triangles[origin]].transpose(1, 0, 2)
        normal = np.cross(second - first, third - first)
        for corner in range(3):
            beside = found.vertices[found.triangles[own, corner]] - first
            assert abs(np.einsum("ij,ij->i", beside, normal)).max() < 1e-12 * abs(vertices).max() ** 3
        p, q, r = found.vertices[found.triangles[own]].transpose(1, 0, 2)
        assert (np.einsum("ij,ij->i", np.cross(q - p, r - p), normal) > 0).all(), "turned as the input"
    assert sorted(row for part in found.sub_surfaces for row in part.triangles) == list(
        range(len(found.triangles))
    )
    for part in found.sub_surfaces:
        assert (found.source[part.triangles] == part.source).all()
        assert all(0 <= loop < len(found.loops) for loop in part.loops)


def test_loops_of_a_torus_and_a_sheet():
    torus, sheet = solids.torus(), solids.sheet(height=0.1)
    found = intersect(torus, sheet)
    assert [loop.kind for loop in found.loops] == ["hard_closed"] * 2
    for loop in found.loops:
        at = found.vertices[loop.vertices]
        assert np.ptp(at[:, 2]) < 1e-12 and len(np.unique(loop.vertices)) == len(loop.vertices)
    parts = [(part.source, len(part.loops), part.is_public) for part in found.sub_surfaces]
    assert sorted(parts) == [(0, 2, False), (0, 2, False), (1, 1, False), (1, 1, False), (1, 2, True)]
    above, below = sorted(found.sub_blocks, key=lambda block: block.volume)
    assert above.volume + below.volume == pytest.approx(solids.volume(*torus), rel=1e-12)
    assert found.vertices[above.triangles].mean(axis=(0, 1))[2] > 0.1
    assert all(block.in_a and not block.in_b for block in found.sub_blocks)


def test_loops_of_open_surfaces():
    found = intersect(solids.sheet(), solids.moved(solids.sheet(4.0), (0, 0, 1), TURN))
    assert [loop.kind for loop in found.loops] == ["open"]
    at = found.vertices[found.loops[0].vertices]
    assert (at[:, 1] == 0).all() and (at[:, 2] == 0).all()
    assert abs(at[0] - at[-1]).tolist() == [4, 0, 0]
    assert found.sub_blocks == [] and not any(part.is_public for part in found.sub_surfaces)


def test_loops_that_meet_in_a_vertex():
    sheet = solids.moved(solids.sheet(4.0), (0, 0, 0), TURN)
    across = solids.moved(solids.sheet(4.0), (0, 0, 0), TURN[[1, 0, 2]])
    found = intersect(solids.sheet(2.0), solids.together(sheet, across))
    assert {loop.kind for loop in found.loops} <= {"open", "soft_closed"}
    steps = sum(len(loop.vertices) - (loop.kind != "hard_closed") for loop in found.loops)
    edges = {
        frozenset(edge)
        for loop in found.loops
        for edge in itertools.pairwise(
            loop.vertices.tolist() + loop.vertices[:1].tolist() * (loop.kind == "hard_closed")
        )
    }
    assert len(edges) == steps, "no edge is in two loops"


def test_a_solid_that_crosses_itself_is_where_it_winds():
    crossing = solids.together(solids.box((0, 0, 0), (2, 1, 1)), solids.box((1, 0, 0), (3, 1, 1)))
    found = intersect(crossing, solids.box((0, 0, 0), (3, 1, 0.5)))
    v = volumes(found)
    assert v == pytest.approx(
        {"union": 3.0, "intersection": 1.5, "difference": 1.5, "reverse_difference": 0.0}, abs=1e-12
    )


# on a lattice much touches and coincides
_LATTICE = st.tuples(*[st.integers(-3, 3)] * 3)
_ANY = st.tuples(*[st.floats(-1, 1, width=32)] * 3)


def _tetrahedra(corner):
    return st.lists(corner, min_size=4, max_size=4).map(np.array)


def _parts(corner):
    return st.lists(_tetrahedra(corner), min_size=1, max_size=2)


def _solid_of(parts):
    for corners in parts:
        assume(abs(np.linalg.det((corners[1:] - corners[0]).astype(float))) > 1e-3)
    return solids.together(*map(solids.tetrahedron, parts))


@pytest.mark.parametrize("corner", [_LATTICE, _ANY], ids=["lattice", "any"])
def test_identities_of_random_solids(corner):
    @settings(max_examples=60)
    @given(_parts(corner), _tetrahedra(corner))
    def check(parts, other):
        a, b = _solid_of(parts), _solid_of([other])
        one = intersect(a, solids.moved(a, (100, 0, 0))).difference()  # what winds twice counts once
        check_divides_nothing(one)
        found = check_identities(one, b)
        for name in OPERATIONS:
            result = getattr(found, name)()
            if len(result[1]):
                check_divides_nothing(result)

    check()


def test_a_chain_of_operations():
    """Each result is the next input; the volume is known by counting."""
    rng = np.random.default_rng(11)
    grid = np.zeros((8, 8, 8), bool)
    low, high = np.array((0, 0, 0)), np.array((8, 8, 8))
    grid[:] = True
    solid = solids.box(low, high)
    for step in range(50):
        low = rng.integers(0, 6, 3)
        high = np.minimum(low + rng.integers(1, 5, 3), 8)
        part = np.zeros_like(grid)
        part[tuple(slice(*ends) for ends in zip(low, high, strict=True))] = True
        found = intersect(solid, solids.box(low, high))
        if step % 3:
            solid, grid = found.difference(), grid & ~part
        else:
            solid, grid = found.union(), grid | part
        assert solids.volume(*solid) == pytest.approx(grid.sum(), rel=1e-12)
    assert 0 < grid.sum() < 512


def _tool(rng, solid):
    kind = rng.integers(6)
    low = rng.integers(-4, 3, 3) / 2
    if kind == 0:
        return solids.box(low, low + rng.integers(1, 5, 3) / 2)
    if kind == 1:
        turned = solids.box(-rng.uniform(0.2, 1, 3), rng.uniform(0.2, 1, 3))
        return solids.moved(turned, low, solids.rotation(rng))
    if kind == 2:
        small = solids.torus(10, 6, radius=0.8, tube=0.3)
        return solids.moved(small, rng.normal(size=3), solids.rotation(rng))
    if kind == 3:  # itself, up to rounding
        return np.nextafter(solid[0], rng.choice([-np.inf, np.inf], 3)), solid[1]
    corners = rng.integers(-2, 3, (4, 3)) if kind == 4 else rng.normal(size=(4, 3))
    if abs(np.linalg.det((corners[1:] - corners[0]).astype(float))) < 0.1:
        return _tool(rng, solid)
    return solids.tetrahedron(corners)


def test_a_chain_of_operations_of_all_kinds():
    """Many after one another on solids of all kinds: volumes add up, and no result crosses itself."""
    rng = np.random.default_rng(2)
    solid = solids.torus(16, 8)
    for _ in range(25):
        found = check_identities(solid, _tool(rng, solid))
        results = (getattr(found, name)() for name in OPERATIONS)
        large = [result for result in results if solids.volume(*result) > 1]
        if large:
            solid = large[rng.integers(len(large))]
            check_divides_nothing(solid)


def test_any_number_of_threads_gives_the_same():
    a, b = PAIRS["tori that cross"]
    one, two = (intersect(a, b, threads=n) for n in (1, 2))
    for name in ("vertices", "triangles", "source", "source_triangle"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()
    assert [loop.vertices.tolist() for loop in one.loops] == [loop.vertices.tolist() for loop in two.loops]
    assert [block.volume for block in one.sub_blocks] == [block.volume for block in two.sub_blocks]


def test_arrays_outlive_the_result_and_are_not_written_to():
    found = intersect(*PAIRS["boxes"])
    vertices, block, loop = found.vertices, found.sub_blocks[0].triangles, found.loops[0].vertices
    kept = vertices.copy(), block.copy(), loop.copy()
    del found
    assert (vertices == kept[0]).all() and (block == kept[1]).all() and (loop == kept[2]).all()
    with pytest.raises(ValueError, match="read-only"):
        vertices[0] = 0


def manifold_volumes(a, b):
    one, two = (
        manifold3d.Manifold(manifold3d.Mesh64(np.ascontiguousarray(v), np.ascontiguousarray(t, np.uint64)))
        for v, t in (a, b)
    )
    assert {solid.status() for solid in (one, two)} == {manifold3d.Error.NoError}
    results = {"union": one + two, "intersection": one ^ two}
    results |= {"difference": one - two, "reverse_difference": two - one}
    return {name: solid.volume() for name, solid in results.items()}


def test_volumes_as_manifold_has_them():
    rng = np.random.default_rng(3)
    for _ in range(10):
        a = solids.moved(solids.torus(32, 16), rng.normal(size=3), solids.rotation(rng))
        b = solids.moved(solids.torus(20, 10, tube=0.9), rng.normal(size=3), solids.rotation(rng))
        assert volumes(intersect(a, b)) == pytest.approx(manifold_volumes(a, b), rel=1e-9, abs=1e-9)


SCANS = ("bunny25k", "cow", "fertility")


@functools.cache
def scan(name):
    """One unit long, around the origin."""
    mesh = read_mesh(solids.SOLIDS / f"{name}.obj")
    return (mesh.vertices - mesh.vertices.mean(axis=0)) / np.ptp(mesh.vertices, axis=0).max(), mesh.triangles


def check_scans(first, second, count):
    """In so many random positions, the same ones every time."""
    rng = np.random.default_rng([SCANS.index(first), SCANS.index(second)])
    for _ in range(count):
        a, b = (
            solids.moved(scan(name), 0.2 * rng.normal(size=3), solids.rotation(rng))
            for name in (first, second)
        )
        found = check_identities(a, b)
        assert volumes(found) == pytest.approx(manifold_volumes(a, b), rel=1e-9, abs=1e-9)
        check_divides_nothing(found.union())


# a hundred in all held: check_scans(..., 17) of each pair
@pytest.mark.skipif(not solids.SOLIDS.is_dir(), reason=places.DATA_ABSENT)
@pytest.mark.parametrize("first, second", itertools.combinations_with_replacement(SCANS, 2))
def test_scanned_solids_in_random_positions(first, second):
    check_scans(first, second, 1)


@pytest.mark.parametrize("operation", OPERATIONS)
def test_an_open_surface_is_refused_where_a_solid_is_needed(operation):
    found = intersect(solids.torus(), solids.sheet())
    with pytest.raises(InputRefused, match=r"the second surface: it is open, for example near \(") as refused:
        getattr(found, operation)()
    assert max(abs(value) for value in refused.value.place[:2]) == 5.0
    with pytest.raises(InputRefused, match="the first surface: it is open"):
        getattr(intersect(solids.sheet(), solids.torus()), operation)()


def test_triangles_that_face_both_ways_are_no_solid():
    vertices, triangles = solids.box((0, 0, 0), (1, 1, 1))
    turned = triangles.copy()
    turned[3] = turned[3, ::-1]
    found = intersect((vertices, turned), solids.torus())
    with pytest.raises(InputRefused, match="face both ways"):
        found.union()
    inside_out = intersect((vertices, triangles[:, ::-1]), solids.moved((vertices, triangles), (0.5, 0, 0)))
    assert solids.volume(*inside_out.union()) == pytest.approx(1.5)


GOOD = solids.box((0, 0, 0), (1, 1, 1))
NAN = GOOD[0].copy()
NAN[5, 1] = np.nan
REFUSED = {
    "shape of vertices": ((GOOD[0][:, :2], GOOD[1]), r"vertices must be an array \(V, 3\)"),
    "shape of triangles": ((GOOD[0], GOOD[1][:, :2]), r"triangles must be an array \(T, 3\)"),
    "no triangles": ((GOOD[0], GOOD[1][:0]), "T > 0"),
    "fractions": ((GOOD[0], GOOD[1] + 0.5), "whole numbers"),
    "words": (([["a", "b", "c"]], GOOD[1]), "not an array of numbers"),
    "NaN": ((NAN, GOOD[1]), "vertex 5 is .*, not finite"),
    "infinite": ((np.full((8, 3), np.inf), GOOD[1]), "not finite"),
    "beyond": ((GOOD[0], GOOD[1] + 1), "numbered from 0 to 7"),
    "negative": ((GOOD[0], GOOD[1] - 1), "numbered from 0 to 7"),
}


@pytest.mark.parametrize("bad, expected", REFUSED.values(), ids=REFUSED)
def test_refused(bad, expected):
    with pytest.raises(InputRefused, match=f"the first surface: .*{expected}"):
        intersect(bad, GOOD)
    with pytest.raises(InputRefused, match=f"the second surface: .*{expected}"):
        intersect(GOOD, bad)


def test_wrong_use():
    with pytest.raises(UsageError, match="vertices, triangles"):
        intersect(GOOD[0], None)
    with pytest.raises(UsageError, match="threads"):
        intersect(GOOD, GOOD, threads=-1)
    with pytest.raises(UsageError, match="union"):
        intersect(GOOD, GOOD).boundary("join")


def test_progress_and_cancel():
    a, b = solids.torus(700, 350), solids.moved(solids.torus(700, 350), (0.5, 0.1, 0.2), TURN)
    calls = []
    with pytest.raises(Cancelled):
        intersect(
            a, b, progress=lambda share, text: calls.append((share, text)), cancel=lambda: len(calls) > 5
        )
    assert all(text == "intersecting" for _, text in calls)
    assert [share for share, _ in calls] == sorted(share for share, _ in calls)
    assert calls[-1][0] < 1
    others = [thread for thread in threading.enumerate() if thread.name == "realmodel work"]
    assert len(others) <= 1, "only the one that frees what it has taken"


def moved_less_than_edges(mesh, way, by):
    """A copy; by: in edges."""
    vertices, triangles = mesh
    edge = np.linalg.norm(vertices[triangles[:, 0]] - vertices[triangles[:, 1]], axis=1).mean()
    if way == "shifted":
        return vertices + by * edge * np.array([0.6, 0.64, 0.48]), triangles
    if way == "scaled":
        return vertices * (1 + 2 * by * edge), triangles
    return vertices + by * edge * np.random.default_rng(1).uniform(-1, 1, vertices.shape), triangles


# before: three times the pieces after three rounds, and no end
@pytest.mark.skipif(not solids.SOLIDS.is_dir(), reason=places.DATA_ABSENT)
@pytest.mark.parametrize(
    "way, by",
    # with more for each vertex the copy would cross itself
    [("shifted", 1e-6), ("scaled", 1e-3), ("each vertex", 0.03)],
)
def test_a_result_of_nearly_coinciding_scans_with_its_operands(way, by):
    a = scan("cow")
    b = moved_less_than_edges(a, way, by)
    first = intersect(a, b)
    whole = solids.volume(*first.union())
    for operand in (a, b):
        again = check_identities(first.union(), operand)
        assert solids.volume(*again.union()) == pytest.approx(whole, abs=1e-12)
        assert len(again.triangles) <= 1.1 * len(first.triangles)
    check_identities(first.difference(), b)


def test_inside_of_solids_that_overlap_themselves():
    """Where the winding number is not zero. Manifold, which asks for no overlaps, counts layers."""
    two = solids.together(solids.box((0, 0, 0), (2, 2, 2)), solids.box((1, 1, 1), (3, 3, 3)))
    vertices, triangles = solids.box((5, 0, 0), (6, 1, 1))
    inside_out = solids.together(solids.box((0, 0, 0), (2, 2, 2)), (vertices, triangles[:, [0, 2, 1]]))
    around = solids.box((-1, -1, -1), (9, 9, 9))
    for solid, ours, theirs in ((two, 15, 16), (inside_out, 9, 7)):
        assert volumes(intersect(solid, around))["intersection"] == pytest.approx(ours)
        one = manifold3d.Manifold(
            manifold3d.Mesh64(
                np.ascontiguousarray(solid[0], float), np.ascontiguousarray(solid[1], np.uint64)
            )
        )
        assert one.volume() == pytest.approx(theirs)
