# SPDX-License-Identifier: GPL-3.0-or-later
"""What holds for every mesh for solvers, computed from its elements alone."""

import numpy as np

_TETRAHEDRA = {
    "tetrahedron": [(0, 1, 2, 3)],
    "pyramid": [(0, 1, 2, 4), (0, 2, 3, 4)],
    "prism": [(0, 1, 2, 3), (1, 2, 3, 4), (2, 3, 4, 5)],
}
_FACES = {
    "tetrahedron": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)],
    "pyramid": [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    "prism": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
}


def element_volumes(mesh, kind):
    """(E,) of straight tetrahedra that the elements divide into, with their signs, and the least of these."""
    corners = mesh.points[mesh.elements[kind]]
    parts = []
    for a, b, c, d in _TETRAHEDRA[kind]:
        o = corners[:, a]
        across = np.cross(corners[:, b] - o, corners[:, c] - o)
        parts.append(np.einsum("ij,ij->i", across, corners[:, d] - o) / 6)
    return np.sum(parts, axis=0), np.min(parts, axis=0)


def block_volumes(mesh):
    total = np.zeros(len(mesh.block_names))
    for kind in mesh.elements:
        total += np.bincount(mesh.element_block[kind], element_volumes(mesh, kind)[0], len(total))
    return total


def in_order(corners):
    """(F, 4) int64: faces of three or four corners, each from its least corner on; -1: there is no fourth."""
    count = corners.shape[1]
    turned = (corners.argmin(axis=1)[:, None] + np.arange(count)) % count
    faces = np.full((len(corners), 4), -1, np.int64)
    faces[:, :count] = np.take_along_axis(corners, turned, axis=1)
    return faces


def reverse(faces):
    a, b, c, d = faces.T
    return np.where((d < 0)[:, None], np.column_stack([a, c, b, d]), np.column_stack([a, d, c, b]))


def numbered(count, *several):
    """Whole numbers for the rows of several arrays of corners below count, the same for equal rows."""
    rows = np.concatenate(several)
    found = rows[:, 0]
    for column in rows.T[1:]:
        found = np.unique(found * (count + 1) + column + 1, return_inverse=True)[1]
    return np.split(found, np.cumsum([len(some) for some in several])[:-1])


def directed_faces(mesh):
    """Every face of every element as it is seen from outside, with its block and compartment (F, 2)."""
    faces, parts = [np.empty((0, 4), np.int64)], [np.empty((0, 2), np.int64)]
    for kind, elements in mesh.elements.items():
        part = np.zeros((len(elements), 2), np.int64)
        part[:, 0] = mesh.element_block[kind]
        if mesh.element_compartment is not None:
            part[:, 1] = mesh.element_compartment[kind]
        for face in _FACES[kind]:
            faces.append(in_order(elements[:, face]))
            parts.append(part)
    return np.concatenate(faces), np.concatenate(parts)


def given_faces(mesh):
    """The faces that a mesh gives, with their surfaces."""
    faces = [np.empty((0, 4), np.int64), *map(in_order, mesh.faces.values())]
    surfaces = [np.empty(0, np.int64), *(mesh.face_surface[kind] for kind in mesh.faces)]
    return np.concatenate(faces), np.concatenate(surfaces)


def check_solver_mesh(mesh):
    """Elements are positive, share whole faces and leave no gap; faces are those outside and on surfaces.
    Returns the faces outside (F, 4), as in_order gives them."""
    for kind, elements in mesh.elements.items():
        assert element_volumes(mesh, kind)[1].min() > 0, kind
        assert np.diff(np.sort(elements, axis=1), axis=1).all()
    faces, part = directed_faces(mesh)
    given, surface = given_faces(mesh)
    count = len(mesh.points)
    seen, behind, given_seen, given_behind = numbered(count, faces, reverse(faces), given, reverse(given))
    order = np.argsort(seen, kind="stable")
    twice = order[1:][np.diff(seen[order]) == 0]
    assert not len(twice), f"{faces[twice[:1]]} is a face of two elements on one side"
    assert len(np.unique(given_seen)) == len(given), "a face is given twice"
    is_outside = ~np.isin(behind, seen)
    assert is_closed(faces[is_outside], count), "the outside is not closed"
    assert np.isin(seen[is_outside], given_seen).all(), "a face outside is not given, or the other way round"
    other = order[np.searchsorted(seen, behind, sorter=order) % max(len(seen), 1)]
    inner = ~is_outside & (part != part[other]).any(axis=1)
    rest = ~np.isin(given_seen, seen[is_outside])
    kinds = np.append(mesh.surface_kind, 0)[surface]  # of faces on no surface: 0
    in_block = rest & (surface >= 0) & (kinds != 0)  # a fault divides a block, too
    assert np.isin(given_behind[in_block], seen).all()
    assert np.isin(given_seen[rest & ~in_block], seen[inner]).all()
    flat = inner & ~_is_upright(mesh, faces)
    of_rest = np.concatenate([given_seen[rest], given_behind[rest]])
    assert np.isin(seen[flat], of_rest).all(), "a face between blocks is not given"
    used = np.zeros(count, bool)
    for rows in (*mesh.elements.values(), *mesh.faces.values()):
        used[rows] = True
    assert used.all()
    # vertices at one position would be a slit
    assert len(np.unique(mesh.points, axis=0)) == count
    return faces[is_outside]


def is_closed(faces, count):
    """Whether each edge is there as often as the other way round."""
    after = np.roll(faces, -1, axis=1)
    after[faces[:, 3] < 0, 2] = faces[faces[:, 3] < 0, 0]
    a, b = faces[faces >= 0], after[faces >= 0]
    return np.array_equal(np.sort(a * count + b), np.sort(b * count + a))


def _is_upright(mesh, faces):
    """Faces of four corners, and those with two corners at one place in plan."""
    a, b, c = (mesh.points[faces[:, k], :2] for k in range(3))
    same = [(one == other).all(axis=1) for one, other in ((a, b), (b, c), (c, a))]
    return (faces[:, 3] >= 0) | np.any(same, axis=0)


def outside_volume(mesh, outside):
    """The volume that the outside encloses: that of all elements only where none is missing within."""
    corners = mesh.points - mesh.points.mean(axis=0)
    four = outside[outside[:, 3] >= 0]
    a, b, c = corners[np.concatenate([outside[:, :3], four[:, [0, 2, 3]]])].transpose(1, 0, 2)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def least_angles(vertices, triangles):
    """(T,) the least angle of each triangle in plan, degrees."""
    found = []
    for i in range(3):
        o, a, b = (vertices[triangles[:, (i + k) % 3]] for k in range(3))
        u, v = a - o, b - o
        found.append(np.arctan2(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]), (u * v).sum(axis=1)))
    return np.degrees(np.min(found, axis=0))
