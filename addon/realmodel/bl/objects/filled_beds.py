# SPDX-License-Identifier: GPL-3.0-or-later
"""The beds that Fill with Strata has put into a scene, without a model."""

from dataclasses import replace

import numpy as np

from ...core.display.box_projection import area_vectors
from . import meshes
from .boolean_job import VOLUME

BED = "realmodel_bed"  # on the object of a bed, and on the vertices of a mask: its number, 1 for the oldest
_CUT, _WALL = -3, -1  # surfaces of faces: where a model was cut, and where it ends
_LEVEL = 0.6  # least upward part of the normal of a face that is ground


def of_scene(scene):
    """The beds that the scene shows."""
    return [obj for obj in scene.objects if obj.type == "MESH" and BED in obj and VOLUME in obj]


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


def size(item):
    """The length of the diagonal of the filled mesh that a bed is of, in the object's own coordinates."""
    together = [item] if not item.users_collection else item.users_collection[0].objects
    vertices = [meshes.mesh_coordinates(bed.data) for bed in together if BED in bed and bed.type == "MESH"]
    places = np.concatenate([[places.min(axis=0), places.max(axis=0)] for places in vertices if len(places)])
    return float(np.linalg.norm(np.ptp(places, axis=0))) or 1.0
