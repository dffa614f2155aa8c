# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact sections as mesh objects with the materials of their layers."""

import bpy
import numpy as np

from ...core import InputRefused
from ...core.polygon_mesh import PolygonMesh
from .. import library_rows, meshes, project_settings, scene
from ..origin import offsets_from
from . import bodies, shown_models

BLOCK_ATTRIBUTE = "realmodel_block"  # of each face: the number of its block, as in the results


def add(current, location, normal):
    """A mesh object with the section of a scene's model, at its stage, by a plane.

    location, normal: three numbers each; location in the coordinates of the scene (to which the model origin
    is added), the normal of any length. Every face has its block's number in the attribute
    "realmodel_block" and its property's material. Raises UsageError for a plane that is none, InputRefused
    for one that does not meet the model, BuildFailed.
    """
    origin = project_settings.model_origin(current)
    model = shown_models.at_stage(current, current.realmodel.stage)
    point = np.asarray(location, np.float64) + origin
    found = model.section(point, normal)
    if not len(found):
        raise InputRefused(
            "the plane does not meet the model", advice="move it to where there are blocks, or turn it"
        )
    used, corners = np.unique(found.polygon_vertices, return_inverse=True)
    shape = PolygonMesh(
        offsets_from(origin, found.vertices[used]), found.offsets.astype(np.int32), corners.astype(np.int32)
    )
    mesh = meshes.new_mesh("Section", shape)
    ids = np.unique(found.property)
    for property_id in ids.tolist():
        mesh.materials.append(library_rows.material_of(current, property_id))
    slots = np.searchsorted(ids, found.property).astype(np.int32)
    mesh.polygons.foreach_set("material_index", slots)
    attribute = mesh.attributes.new(BLOCK_ATTRIBUTE, "INT", "FACE")
    attribute.data.foreach_set("value", np.ascontiguousarray(found.block, np.int32))
    mesh.update()
    item = bpy.data.objects.new("Section", mesh)
    item[scene.TAG] = "section"
    item["realmodel_location"] = [float(value) for value in location]
    item["realmodel_normal"] = [float(value) for value in normal]
    bodies.view_collection(current).objects.link(item)
    return item
