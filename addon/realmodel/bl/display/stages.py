# SPDX-License-Identifier: GPL-3.0-or-later
"""The stage in the scene: the block objects get the shapes that their blocks had just after a surface.

Objects are kept, so the user's changes to them stay. A block that does not exist at a stage has an empty
mesh; one that is eroded later gets an object while it is shown.
"""

import bpy
import numpy as np

from ...core.display.polygon_mesh import PolygonMesh
from ..objects import meshes, model_tree
from ..project import library_rows
from . import replacing, shown_models

STAGE_ONLY = "realmodel_stage_only"  # on an object: its block is not in the whole model
_EMPTY = PolygonMesh(np.empty((0, 3), np.float32), np.zeros(1, np.int32), np.empty(0, np.int32))


def show(scene, stage):
    """Shows a stage of a scene's model. Raises RealModelError; then the scene is as it was."""
    shapes = shown_models.shapes_at_stage(scene, stage)
    for row in scene.realmodel.results:
        _give_shape(scene, row, shapes.get((row.rock, row.name)))


def present(row):
    """Whether a block is there at the stage that is shown."""
    return row.object is not None and row.object.type == "MESH" and len(row.object.data.polygons) > 0


def _give_shape(scene, row, shape):
    item = row.object
    if item is not None and (item.type != "MESH" or item.library is not None or item.mode != "OBJECT"):
        return
    if item is None:
        if shape is not None:
            _new(scene, row, shape)
    elif shape is None and STAGE_ONLY in item:
        row.object = None
        replacing.remove(item)
    elif not meshes.holds(item.data, shape or _EMPTY):
        replacing.give_shape(item, shape or _EMPTY)


def _new(scene, row, shape):
    """An object for a block that was eroded away later."""
    rock = next((rock for rock in scene.realmodel.rocks if rock.name == row.rock), None)
    if rock is None or rock.blocks is None:
        return
    item = bpy.data.objects.new(row.name, meshes.new_mesh(row.name, shape))
    item.data.materials.append(library_rows.material_of(scene, row.property_id))
    item[model_tree.TAG], item[model_tree.ROCK], item[model_tree.SURFACE] = "block", row.rock, row.surface
    item[model_tree.BLOCK], item[model_tree.PROPERTY] = row.name, row.property_id
    item[STAGE_ONLY] = True
    rock.blocks.objects.link(item)
    row.object = item
