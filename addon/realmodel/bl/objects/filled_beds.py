# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes of objects that are filled with strata, and the beds that are in a scene then, without a model."""

from dataclasses import dataclass, replace

import numpy as np

from ...core import InputRefused
from ...core.base.triangles import welded
from ...core.display.box_projection import area_vectors
from ...core.filling import ITEM, closed_mesh, without_holes
from ..host.nodes import modifier_with
from . import exaggeration, meshes, shapes
from .boolean_job import VOLUME

STRATA = "realmodel_strata_group"  # on the node group of the modifier Strata: its version
SCREE = "realmodel_scree"  # on faces of an eroded mesh: whether they are of scree; on the object of scree
BED = "realmodel_bed"  # on the object of a bed, and on the vertices of a mask: its number, 1 for the oldest
_CUT, _WALL = -3, -1  # surfaces of faces: where a model was cut, and where it ends
_LEVEL = 0.6  # least upward part of the normal of a face that is ground


def of_scene(scene):
    """The beds that the scene shows."""
    return [obj for obj in scene.objects if obj.type == "MESH" and BED in obj and VOLUME in obj]


def shown(scene):
    """The beds, and the meshes with strata that are not hidden behind theirs."""
    has_strata = (obj for obj in scene.objects if obj.type == "MESH" and modifier_with(obj, STRATA))
    return [*of_scene(scene), *(obj for obj in has_strata if not obj.hide_render and SCREE not in obj)]


def exposed(shape, matrix):
    """The shape of a bed (PolygonMesh) with what was the surface of the filled mesh as walls, and as ground
    where that is rather level: looks and weathering go by this. matrix: (4, 4) from its coordinates to the
    world."""
    outside = shape.face_surface == _CUT
    ends = shape.coordinates[shape.corners].astype(np.float64) @ matrix[:3, :3].T
    area = area_vectors(ends, shape.offsets)
    is_level = area[:, 2] > _LEVEL * np.linalg.norm(area, axis=1)
    bedding = replace(shape.bedding, is_top=outside & is_level)
    surface = np.where(outside, _WALL, shape.face_surface).astype(np.int32)
    return replace(shape, face_surface=surface, bedding=bedding)


def together(item):
    """The beds of the filled mesh that a bed is of."""
    items = [item] if not item.users_collection else item.users_collection[0].objects
    return [bed for bed in items if BED in bed and bed.type == "MESH"]


def size(item):
    """The length of the diagonal of the filled mesh that a bed is of, in the object's own coordinates."""
    vertices = [meshes.mesh_coordinates(bed.data) for bed in together(item)]
    places = np.concatenate([[places.min(axis=0), places.max(axis=0)] for places in vertices if len(places)])
    return float(np.linalg.norm(np.ptp(places, axis=0))) or 1.0


@dataclass(eq=False)
class FilledShape:
    """The shape of an object that is to be filled.

    local: (V, 3) float32, in its own coordinates; matrix: (4, 4) from there to the world; vertices: (V, 3)
    float64 in the world; triangles: (T, 3).
    """

    name: str
    local: np.ndarray
    matrix: np.ndarray
    vertices: np.ndarray
    triangles: np.ndarray

    @classmethod
    def of(cls, item, depsgraph, matrix=None):
        """Reads an object. matrix: None for where it is now. Raises InputRefused."""
        matrix = exaggeration.true_matrix(item) if matrix is None else matrix
        determinant = np.linalg.det(matrix[:3, :3])
        if determinant == 0 or not np.isfinite(determinant):
            raise InputRefused(
                "its scale is zero along an axis", item=item.name, advice="give it another scale"
            )
        with shapes.evaluated_mesh(item, depsgraph) as mesh:
            if not len(mesh.polygons):
                raise InputRefused("it has no faces", item=item.name, advice="choose another object")
            local = meshes.mesh_coordinates(mesh)
            places = local.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
            return cls(item.name, local, matrix, places, shapes.mesh_triangles(mesh))

    @property
    def is_mirrored(self):
        """Whether faces that face outward in the world face inward in the object's coordinates."""
        return bool(np.linalg.det(self.matrix[:3, :3]) < 0)

    def closed(self, base_depth, close_holes):
        """Vertices in the world and triangles of what is filled. base_depth: of the base of an open mesh
        beneath its lowest point, as a share of its height or of a tenth of its width where that is more.
        close_holes: whether holes are closed instead. Raises InputRefused."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        size = high - low
        base = low[2] - base_depth * max(size[2], 0.1 * size[:2].max())
        mesh = self.vertices, self.triangles
        with named(self.name):
            return without_holes(*mesh) if close_holes else closed_mesh(*mesh, float(base))

    def to_world(self, local):
        """(N, 3) float64: the inverse of `to_local`."""
        return local.astype(np.float64) @ self.matrix[:3, :3].T + self.matrix[:3, 3]

    def to_local(self, places):
        """(N, 3) float64: places in the world in the coordinates of the object, without any change of its own
        vertices."""
        inverse = np.linalg.inv(self.matrix)
        local = places @ inverse[:3, :3].T + inverse[:3, 3]
        same = welded(np.concatenate([self.vertices, places]))[len(self.vertices) :]
        is_vertex = same < len(self.vertices)
        local[is_vertex] = self.local[same[is_vertex]]
        return local


class named:
    """Within it refusals of the mesh name the object."""

    def __init__(self, name):
        self._name = name

    def __enter__(self):
        return self

    def __exit__(self, _kind, error, _trace):
        if isinstance(error, InputRefused) and error.item in (ITEM, None):
            raise InputRefused(
                error.what, item=self._name, advice=error.advice, triangles=error.triangles, place=error.place
            ) from error
