# SPDX-License-Identifier: GPL-3.0-or-later
"""What holds for every mesh for solvers, computed from its elements alone."""

from collections import Counter

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


def directed_faces(mesh):
    """Every face of every element as it is seen from outside, from its least corner on, with its block and
    compartment."""
    for kind, elements in mesh.elements.items():
        blocks = mesh.element_block[kind].tolist()
        compartments = [0] * len(blocks)
        if mesh.element_compartment is not None:
            compartments = mesh.element_compartment[kind].tolist()
        for face in _FACES[kind]:
            for corners, *part in zip(elements[:, face].tolist(), blocks, compartments, strict=True):
                first = corners.index(min(corners))
                yield tuple(corners[first:] + corners[:first]), part


def check_solver_mesh(mesh):
    """Elements are positive, share whole faces and leave no gap; faces are those outside and on surfaces."""
    for kind in mesh.elements:
        assert element_volumes(mesh, kind)[1].min() > 0, kind
        assert all(len(set(row)) == len(row) for row in mesh.elements[kind].tolist())
    seen = {}
    for face, part in directed_faces(mesh):
        assert face not in seen, f"{face} is a face of two elements on one side"
        seen[face] = part
    reverse = lambda face: (face[0], *face[:0:-1])  # noqa: E731
    outside = {face for face in seen if reverse(face) not in seen}
    edges = Counter()
    for face in outside:
        for a, b in zip(face, (*face[1:], face[0]), strict=True):
            edges[a, b] += 1
    assert all(edges[b, a] == count for (a, b), count in edges.items()), "the outside is not closed"
    given = {}
    for kind, faces in mesh.faces.items():
        for corners, surface in zip(faces.tolist(), mesh.face_surface[kind].tolist(), strict=True):
            first = corners.index(min(corners))
            given[tuple(corners[first:] + corners[:first])] = surface
    assert outside <= set(given), "a face outside is not given, or the other way round"
    inner = {min(f, reverse(f)) for f in seen if reverse(f) in seen and seen[f] != seen[reverse(f)]}
    rest = set(given) - outside
    assert len(rest) == len(given) - len(outside)
    for face in rest:
        if given[face] >= 0 and mesh.surface_kind[given[face]] != 0:  # a fault divides a block, too
            assert reverse(face) in seen
        else:
            assert min(face, reverse(face)) in inner
    flat = {face for face in inner if min(face, reverse(face)) and not _is_upright(mesh, face)}
    assert flat <= {min(f, reverse(f)) for f in rest}, "a face between blocks is not given"
    used = np.zeros(len(mesh.points), bool)
    for rows in (*mesh.elements.values(), *mesh.faces.values()):
        used[rows] = True
    assert used.all()
    # vertices at one position would be a slit
    assert len(np.unique(mesh.points, axis=0)) == len(mesh.points)
    return outside


def _is_upright(mesh, face):
    x, y = mesh.points[list(face)][:, :2].T
    return len(face) == 4 or len({*zip(x.tolist(), y.tolist(), strict=True)}) < 3


def outside_volume(mesh, outside):
    """The volume that the outside encloses: that of all elements only where none is missing within."""
    total = 0.0
    origin = mesh.points.mean(axis=0)
    for face in outside:
        corners = mesh.points[list(face)] - origin
        for i in range(1, len(corners) - 1):
            total += np.dot(corners[0], np.cross(corners[i], corners[i + 1])) / 6
    return total


def least_angles(vertices, triangles):
    """(T,) the least angle of each triangle in plan, degrees."""
    found = []
    for i in range(3):
        o, a, b = (vertices[triangles[:, (i + k) % 3]] for k in range(3))
        u, v = a - o, b - o
        found.append(np.arctan2(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]), (u * v).sum(axis=1)))
    return np.degrees(np.min(found, axis=0))
