# SPDX-License-Identifier: GPL-3.0-or-later
"""The faces of elements, and prisms and pyramids divided into tetrahedra so that neighbors divide alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.algebra import begins_run, norm
from ..base.errors import BuildFailed
from .patches import boundary_patches, solver_names
from .volume_mesh import PolyhedralMesh, VolumeMesh

_STEEP = 0.5  # upward part of a unit normal: what is steeper may be an overhang of the mesh alone

# The faces of each kind of element, counter-clockwise seen from outside, in the order in which Abaqus numbers
# them.
OUTWARD = {
    "tetrahedron": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)),
    "pyramid": ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    "prism": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "hexahedron": (
        (0, 3, 2, 1),
        (4, 5, 6, 7),
        (0, 1, 5, 4),
        (1, 2, 6, 5),
        (2, 3, 7, 6),
        (3, 0, 4, 7),
    ),
}
SHAPES = {"triangle": 3, "quadrilateral": 4}


@dataclass(frozen=True, eq=False)
class FaceSet:
    """Named faces of a mesh: a patch of the outside, or the inner faces on a surface.

    corners: of each of SHAPES, (F, 3 or 4) int32. element, side: of each, (F,): an element with this face
    (all elements counted through), and the face's number in OUTWARD of its kind. group: of a patch, else "".
    """

    name: str
    group: str
    corners: dict[str, np.ndarray]
    element: dict[str, np.ndarray]
    side: dict[str, np.ndarray]


class ElementFaces:
    """The faces of all elements of a mesh. Raises BuildFailed where three elements share one."""

    def __init__(self, mesh: VolumeMesh):
        self.mesh = mesh
        self._of = {shape: self._faces(shape) for shape in SHAPES}

    def _faces(self, shape: str) -> _Faces:
        corners, element, side = [], [], []
        first = 0
        for kind, elements in self.mesh.elements.items():
            for number, local in enumerate(OUTWARD[kind]):
                if len(local) == SHAPES[shape]:
                    corners.append(elements[:, local])
                    element.append(np.arange(first, first + len(elements), dtype=np.int32))
                    side.append(np.full(len(elements), number, np.int8))
            first += len(elements)
        none = np.empty(0, np.int32)
        return _Faces(
            np.concatenate([*corners, np.empty((0, SHAPES[shape]), np.int32)]),
            np.concatenate([*element, none]),
            np.concatenate([*side, none.astype(np.int8)]),
            len(self.mesh.points),
        )

    def polyhedral(self) -> PolyhedralMesh:
        """The same mesh as polyhedra that share faces."""
        mesh = self.mesh
        corners, offsets, cells, surface = [], [np.zeros(1, np.int64)], [], []
        for shape, size in SHAPES.items():
            faces = self._of[shape]
            corners.append(faces.corners[faces.first].ravel())
            offsets.append(np.full(len(faces.first), size, np.int64))
            second = np.where(faces.has_twin, faces.element[faces.second], -1)
            cells.append(np.column_stack([faces.element[faces.first], second]))
            on = np.full(len(faces.first), -1, np.int32)
            if shape in mesh.faces and len(mesh.faces[shape]):
                on[faces.find(mesh.faces[shape])] = mesh.face_surface[shape]
            surface.append(on)
        return PolyhedralMesh(
            mesh.points,
            np.cumsum(np.concatenate(offsets)),
            np.concatenate(corners).astype(np.int32, copy=False),
            np.concatenate(cells).astype(np.int32, copy=False),
            np.concatenate(surface),
            mesh.of_all(mesh.element_block),
            mesh.block_names,
            mesh.block_property,
            mesh.surface_names,
            mesh.surface_kind,
            None if mesh.element_compartment is None else mesh.of_all(mesh.element_compartment),
        )

    def sets(self, longest: int = 64) -> list[FaceSet]:
        """The patches of the outside (boundary_patches), then the inner faces on each surface. Their names
        are
        as of solver_names, and different from one another; longest: letters of a name."""
        mesh = self.mesh
        shapes = [shape for shape in SHAPES if shape in mesh.faces and len(mesh.faces[shape])]
        indices = {shape: self._of[shape].find(mesh.faces[shape]) for shape in shapes}
        outside = {shape: ~self._of[shape].has_twin[indices[shape]] for shape in shapes}
        surface = [mesh.face_surface[shape][outside[shape]] for shape in shapes]
        if not shapes:
            return []
        on = np.concatenate(surface)
        corners = [self._part(shape, indices[shape][outside[shape]])[0] for shape in shapes]
        patches, number = boundary_patches(
            on, self._rises(corners, on), mesh.surface_names, mesh.surface_kind
        )
        per_shape = np.split(number, np.cumsum([len(part) for part in surface])[:-1])
        of_patch = {
            shape: np.where(outside[shape], 0, -1) for shape in shapes
        }  # the set of each named face, -1: of no patch
        for shape, numbers in zip(shapes, per_shape, strict=True):
            of_patch[shape][outside[shape]] = numbers
        inner = np.unique(np.concatenate([mesh.face_surface[shape][~outside[shape]] for shape in shapes]))
        inner = inner[inner >= 0]
        for shape in shapes:
            on = mesh.face_surface[shape]
            within = ~outside[shape] & (on >= 0)
            of_patch[shape][within] = len(patches) + np.searchsorted(inner, on[within])
        groups = [patch.group for patch in patches] + [""] * len(inner)
        names = [patch.name for patch in patches] + [mesh.surface_names[k] for k in inner.tolist()]
        sets = []
        for k, (name, group) in enumerate(zip(solver_names(names, longest), groups, strict=True)):
            parts = {shape: self._part(shape, indices[shape][of_patch[shape] == k]) for shape in shapes}
            sets.append(
                FaceSet(name, group, *({shape: part[j] for shape, part in parts.items()} for j in range(3)))
            )
        return sets

    def _part(self, shape: str, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        faces = self._of[shape]
        rows = faces.first[numbers]
        return faces.corners[rows], faces.element[rows], faces.side[rows]

    def _rises(self, corners: Sequence[np.ndarray], surface: np.ndarray) -> np.ndarray:
        """The upward parts of the normals of faces, of several shapes; of steep ones together with those
        around them on the same surface: a face of a rough mesh may overhang."""
        normals = []
        for shape in corners:
            at = self.mesh.points[shape] - self.mesh.points[shape[:, :1]]
            normals.append(np.cross(at, np.roll(at, -1, axis=1)).sum(axis=1))
        normal = np.concatenate(normals)
        count = np.repeat([shape.shape[1] for shape in corners], [len(shape) for shape in corners])
        face = np.repeat(np.arange(len(normal)), count)
        use = np.column_stack([surface[face], np.concatenate([shape.ravel() for shape in corners])])
        use = np.unique(use, axis=0, return_inverse=True)[1].ravel()
        around = np.bincount(use, normal[face, 2])
        together = np.bincount(face, around[use], len(normal))
        return np.where(np.abs(normal[:, 2]) < _STEEP * norm(normal), together, normal[:, 2])


def joint_sets(sets: list[FaceSet]) -> dict[str, list[FaceSet]]:
    """The sets by name, then those of each group of patches by its name, where no patch has this."""
    joint = {face_set.name: [face_set] for face_set in sets}
    groups: dict[str, list[FaceSet]] = {}
    for face_set in sets:
        if face_set.group and face_set.group not in joint:
            groups.setdefault(face_set.group, []).append(face_set)
    return joint | groups


class _Faces:
    """Faces of one shape: all that elements have, and which of them are the same.

    corners (M, K), element (M,), side (M,). first, second: for each face the rows of the elements that have
    it,
    the lower element first; has_twin: whether there is a second one."""

    def __init__(self, corners: np.ndarray, element: np.ndarray, side: np.ndarray, points: int):
        self.corners, self.element, self.side, self._points = corners, element, side, points
        key = self._key(corners)
        order = np.argsort(key, kind="stable")
        sorted_key = key[order]
        begins = begins_run(sorted_key)
        at = np.flatnonzero(begins)
        uses = np.diff(np.append(at, len(key)))
        if (uses > 2).any():
            where = corners[order[at[uses > 2][0]]].tolist()
            raise BuildFailed(f"the mesh is not valid: three elements share the face of the points {where}")
        self._keys = sorted_key[at]
        self.has_twin = uses == 2
        self.first = order[at]
        self.second = order[np.minimum(at + 1, max(len(key) - 1, 0))]
        later = self.has_twin & (element[self.first] > element[self.second])
        self.first, self.second = (
            np.where(later, self.second, self.first),
            np.where(later, self.first, self.second),
        )

    def _key(self, corners: np.ndarray) -> np.ndarray:
        """A number for each face: the same for the same three lowest corners. A conforming mesh has no two
        faces of one shape with these in common."""
        low = np.sort(corners, axis=1).astype(np.int64)
        count = self._points
        if count < 2_000_000:
            return (low[:, 0] * count + low[:, 1]) * count + low[:, 2]
        wide = np.empty(len(low), [("a", "<i8"), ("b", "<i8")])
        wide["a"], wide["b"] = low[:, 0] * count + low[:, 1], low[:, 2]
        return wide

    def find(self, corners: np.ndarray) -> np.ndarray:
        """The numbers of faces that are given by their corners, any way round. Raises BuildFailed."""
        key = self._key(np.asarray(corners))
        at = np.minimum(np.searchsorted(self._keys, key), max(len(self._keys) - 1, 0))
        if len(key) and (not len(self._keys) or (self._keys[at] != key).any()):
            raise BuildFailed("the mesh is not valid: a named face is of no element")
        return at


# a prism turned so that its least vertex comes first
_TURNED_PRISM = np.array(
    [
        [0, 1, 2, 3, 4, 5],
        [1, 2, 0, 4, 5, 3],
        [2, 0, 1, 5, 3, 4],
        [3, 5, 4, 0, 2, 1],
        [4, 3, 5, 1, 0, 2],
        [5, 4, 3, 2, 1, 0],
    ]
)
# by the diagonal of the quadrilateral across from the first vertex: 1 - 5, or 2 - 4
_TETRAHEDRA_OF_PRISM = np.array(
    [[[0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3]], [[0, 1, 2, 4], [0, 4, 2, 5], [0, 4, 5, 3]]]
)


def divided_prisms(corners: np.ndarray) -> np.ndarray:
    """(3 E, 4) tetrahedra of prisms (E, 6), those of one prism together."""
    turned = np.take_along_axis(corners, _TURNED_PRISM[corners.argmin(axis=1)], axis=1)
    other = turned[:, [1, 5]].min(axis=1) > turned[:, [2, 4]].min(axis=1)
    rows = _TETRAHEDRA_OF_PRISM[other.astype(np.intp)].reshape(len(corners), 12)
    return np.take_along_axis(turned, rows, axis=1).reshape(-1, 4)


def divided_pyramids(corners: np.ndarray) -> np.ndarray:
    """(2 E, 4) tetrahedra of pyramids (E, 5), those of one pyramid together."""
    sides = divided_quadrilaterals(corners[:, :4])
    return np.column_stack([sides, np.repeat(corners[:, 4], 2)])


def divided_quadrilaterals(corners: np.ndarray) -> np.ndarray:
    """(2 F, 3) triangles of quadrilaterals (F, 4), the two of one together, in its direction."""
    least = corners.argmin(axis=1)
    turned = np.take_along_axis(corners, (least[:, None] + np.arange(4)) % 4, axis=1)
    return turned[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


_DIVIDED = {
    "tetrahedron": (1, lambda corners: corners),
    "pyramid": (2, divided_pyramids),
    "prism": (3, divided_prisms),
}


def divided(of_kind: dict[str, dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """Elements by kind (one at least), each a dict of `corners` and of rows with a number for each, as
    tetrahedra alone: a dict with the same rows."""
    parts = []
    for kind, rows in of_kind.items():
        count, division = _DIVIDED[kind]
        parts.append(
            {
                name: division(values) if name == "corners" else np.repeat(values, count)
                for name, values in rows.items()
            }
        )
    return {name: np.concatenate([part[name] for part in parts]).astype(np.int32) for name in parts[0]}
