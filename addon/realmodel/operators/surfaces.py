# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of surfaces of the active rock mass."""

import contextlib
from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..bl import built_scene, live, project_settings, settings
from ..core import InputRefused, PointFile
from ..core.errors import HeightsMissing
from ..core.readers import MAP_ENDINGS, MESH_ENDINGS, RASTER_ENDINGS, read_mesh, read_point_file
from .reporting import Reporting, a_surface
from .rocks import add_rock

_TABLE_ENDINGS = (".csv", ".xyz", ".txt", ".dat", ".tsv")
_ENDINGS = (*MESH_ENDINGS, *_TABLE_ENDINGS, *RASTER_ENDINGS, *MAP_ENDINGS)


class REALMODEL_OT_surface_add(Reporting, bpy.types.Operator, ImportHelper):
    """Add a surface above the youngest one: from a points or mesh file, from the active mesh object, or
    empty"""

    bl_idname = "realmodel.surface_add"
    bl_label = "Add New Surface"

    name: StringProperty(name="Name", description="Name of the surface; empty: that of its file or object")
    filepath: StringProperty(name="File", description="File with its points or its mesh", subtype="FILE_PATH")
    use_object: BoolProperty(
        name="Active object",
        description="Take the active mesh object as the surface instead of a file",
        options={"SKIP_SAVE"},
    )
    empty: BoolProperty(
        name="Empty", description="Choose the source afterwards", options={"SKIP_SAVE", "HIDDEN"}
    )
    filter_glob: StringProperty(
        default=";".join(f"*{ending}" for ending in _ENDINGS),
        options={"HIDDEN"},
    )
    filename_ext = ""

    def act(self, context):
        scene = context.scene
        item, path = None, None
        if self.use_object:
            item = context.active_object
            if item is None or item.type != "MESH":
                raise InputRefused("the active object is no mesh", advice="make a mesh object active")
        elif self.filepath.strip() and not self.empty:
            path = project_settings.absolute(self.filepath)
            _check_file(path)
        rock = settings.active_rock(scene) or add_rock(scene)
        with settings.filling():
            row = rock.surfaces.add()
            wanted = self.name.strip() or (item.name if item else path.stem if path else "surface")
            row.name = settings.free_name(rock.surfaces, wanted, own=row)
            if item is not None:
                row.source, row.object = "MESH_OBJECT", item
            elif path is not None:
                row.source = "MESH_FILE" if path.suffix.lower() in MESH_ENDINGS else "POINTS_FILE"
                row.filepath = str(path)
            rock.active_surface = len(rock.surfaces) - 1
        live.touch(scene)

    def invoke(self, context, event):
        if self.use_object or self.empty:
            return self.execute(context)
        return ImportHelper.invoke(self, context, event)

    def check(self, _context):
        return False  # a file of any ending


def _check_file(path: Path):
    """Raises InputRefused for a file that cannot be read as what its ending says, however it is looked at:
    what holds the heights of shapes may be chosen once the surface is there."""
    if not path.is_file():
        raise InputRefused(f"file not found: {path}", advice="check the path")
    if path.suffix.lower() in MESH_ENDINGS:
        read_mesh(path)
    else:
        with contextlib.suppress(HeightsMissing):
            read_point_file(PointFile(path))


class REALMODEL_OT_surface_remove(Reporting, bpy.types.Operator):
    """Remove the active surface; a mesh that you brought stays in the scene"""

    bl_idname = "realmodel.surface_remove"
    bl_label = "Remove Surface"
    needs = (a_surface,)

    def act(self, context):
        scene = context.scene
        row, rock = settings.active_surface(context.scene), settings.active_rock(scene)
        number = list(rock.surfaces).index(row)
        with settings.filling():
            built_scene.release_surface(scene, row)
            rock.surfaces.remove(number)
            rock.active_surface = max(0, min(number, len(rock.surfaces) - 1))
            scene.realmodel.stage = min(scene.realmodel.stage, settings.last_stage(scene))
        live.touch(scene)


class REALMODEL_OT_surface_copy(Reporting, bpy.types.Operator):
    """Add a copy of the active surface just above it, from the same source"""

    bl_idname = "realmodel.surface_copy"
    bl_label = "Copy Surface"
    needs = (a_surface,)

    def act(self, context):
        rock, chosen = settings.active_rock(context.scene), settings.active_surface(context.scene)
        number = list(rock.surfaces).index(chosen)
        row = rock.surfaces.add()
        source = rock.surfaces[number]
        settings.copy_row(source, row)
        with settings.filling():
            row.name = settings.free_name(rock.surfaces, source.name, own=row)
            row.interface, row.interface_digest, row.figures, row.block = None, "", "", ""
            if row.source in ("POINTS_FILE", "MESH_FILE"):
                row.object = None
            rock.surfaces.move(len(rock.surfaces) - 1, number + 1)
            rock.active_surface = number + 1
        live.touch(context.scene)


class REALMODEL_OT_surface_move(Reporting, bpy.types.Operator):
    """Make the active surface younger (up) or older (down)"""

    bl_idname = "realmodel.surface_move"
    bl_label = "Move Surface"
    needs = (a_surface,)

    direction: EnumProperty(
        name="Direction",
        description="Which way it moves in the list",
        items=(
            ("UP", "Up", "Make it younger: up in the list, as in the field"),
            ("DOWN", "Down", "Make it older: down in the list"),
        ),
    )

    def act(self, context):
        rock = settings.active_rock(context.scene)
        number = rock.active_surface
        target = number + (1 if self.direction == "UP" else -1)
        if not 0 <= target < len(rock.surfaces):
            return {"CANCELLED"}
        rock.surfaces.move(number, target)
        rock.active_surface = target
        live.touch(context.scene)
        return {"FINISHED"}


class REALMODEL_OT_surface_hide(Reporting, bpy.types.Operator):
    """Hide the active surface's interface in the viewport, or show it again; it is built all the same"""

    bl_idname = "realmodel.surface_hide"
    bl_label = "Hide or Show Surface"
    needs = (a_surface,)

    def act(self, context):
        row = settings.active_surface(context.scene)
        row.hide = not row.hide


_property_items = []  # Blender does not keep the texts of dynamic enums itself


def _library_items(_operator, context):
    rows = context.scene.realmodel.library if context else ()
    _property_items[:] = [("0", "None", "No property", 0)]
    _property_items.extend(
        (str(row.id), f"{row.name} ({row.id})", row.description, number) for number, row in enumerate(rows, 1)
    )
    return _property_items


class REALMODEL_OT_surface_property(Reporting, bpy.types.Operator):
    """Choose from the library what was deposited beneath the active surface"""

    bl_idname = "realmodel.surface_property"
    bl_label = "Property of the Surface"
    needs = (a_surface,)

    property_id: EnumProperty(name="Property", description="The entry of the library", items=_library_items)

    def act(self, context):
        settings.active_surface(context.scene).property_id = int(self.property_id)


CLASSES = (
    REALMODEL_OT_surface_add,
    REALMODEL_OT_surface_remove,
    REALMODEL_OT_surface_copy,
    REALMODEL_OT_surface_move,
    REALMODEL_OT_surface_hide,
    REALMODEL_OT_surface_property,
)
