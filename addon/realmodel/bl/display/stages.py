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
    """Shows a stage of a scene's model. Raises RealModelError; then the scene is not changed."""
    shapes = shown_models.shapes_at_stage(scene, stage)
    for row in scene.realmodel.results:
        _give_shape(scene, row, shapes.get((row.rock, row.name)))


def present(row):
    """Whether a block is there at the stage that is shown."""
    return row.object is not None and row.object.type == "MESH" and len(row.object.data.polygons) > 0


def _give_shape(scene, row, shape):
    obj = row.object
    if obj is not None and (obj.type != "MESH" or obj.library is not None or obj.mode != "OBJECT"):
        return
    if obj is None:
        if shape is not None:
            _new(scene, row, shape)
    elif shape is None and STAGE_ONLY in obj:
        row.object = None
        replacing.remove(obj)
    elif not meshes.holds(obj.data, shape or _EMPTY):
        replacing.give_shape(obj, shape or _EMPTY)


def _new(scene, row, shape):
    """An object for a block that was eroded away later."""
    rock = next((rock for rock in scene.realmodel.rocks if rock.name == row.rock), None)
    if rock is None or rock.blocks is None:
        return
    obj = bpy.data.objects.new(row.name, meshes.new_mesh(row.name, shape))
    obj.data.materials.append(library_rows.material_of(scene, row.property_id))
    obj[model_tree.TAG], obj[model_tree.ROCK], obj[model_tree.SURFACE] = "block", row.rock, row.surface
    obj[model_tree.BLOCK], obj[model_tree.PROPERTY] = row.name, row.property_id
    obj[STAGE_ONLY] = True
    rock.blocks.objects.link(obj)
    row.object = obj
