# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks for other programs: UV maps, colors and attributes, and baked pictures."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..bl.jobs.bake_job import BakeJob
from ..bl.objects import filled_beds
from ..bl.project import project_settings
from ..bl.scene import bake
from ..bl.shading import rock_layers
from ..core import InputRefused
from ..core.base.errors import counted
from .reporting import InBackground, Reporting, a_model_or_beds, not_building, object_mode

MAPS = EnumProperty(
    name="Maps",
    description="Pictures to bake. Shift-click chooses several",
    items=bake.KINDS,
    options={"ENUM_FLAG"},
    default={"COLOR", "ROUGHNESS", "NORMAL"},
)
PICTURE_SIZE = IntProperty(
    name="Picture Size",
    description="Width of the pictures in pixels",
    default=1024,
    min=64,
    soft_min=512,
    soft_max=8192,
    max=16384,
)


def layout_menu(default):
    return EnumProperty(
        name="Pictures", description="What shares pictures", items=bake.LAYOUTS, default=default
    )


def rocks(context):
    """The selected blocks and beds of filled meshes, all where none is selected."""
    items = [row.object for row in context.scene.realmodel.results if row.object is not None]
    items += filled_beds.of_scene(context.scene)
    items = [obj for obj in items if obj.type == "MESH" and obj.library is None and obj.data.library is None]
    selected = set(context.selected_objects)
    return [obj for obj in items if obj in selected] or items


class REALMODEL_OT_unwrap(Reporting, bpy.types.Operator):
    """Give the selected beds and blocks, or all, a UV map along the bedding, the color of their rock as the
    active color attribute, and attributes of their vertices: bed, hardness, and wetness. Beds of Fill with
    Strata have them already"""

    bl_label = "Unwrap Rock"
    needs = (a_model_or_beds, object_mode)

    texture_size: FloatProperty(
        name="Texture Size",
        description="Length of a UV unit in the scene, the same for all. 0: a texture unit, which is a 250th "
        "of the diagonal of the model or of the filled mesh",
        subtype="DISTANCE",
        min=0.0,
    )

    def act(self, context):
        items = rocks(context)
        if not items:
            raise InputRefused("there is no block to unwrap", advice="build the model, or make blocks local")
        size = rock_layers.write(context.scene, items, self.texture_size)
        self.report({"INFO"}, f"Unwrapped {counted(len(items), 'object')}: a UV unit is {size:.4g} long")


class REALMODEL_OT_bake_looks(InBackground, bpy.types.Operator):
    """Bake the looks of the selected beds and blocks, or of all, to pictures in a folder, by Cycles. The
    objects get the UV map Baked, which the pictures fit. Esc cancels"""

    bl_label = "Bake Looks"
    needs = (a_model_or_beds, not_building, object_mode)

    directory: StringProperty(
        name="Folder",
        description="Folder of the pictures; // is that of the .blend file. It is made where there is none",
        subtype="DIR_PATH",
        default="//textures",
    )
    maps: MAPS
    layout: layout_menu("OBJECT")
    picture_size: PICTURE_SIZE
    plain_materials: BoolProperty(
        name="Plain Materials",
        description="Replace the procedural materials by one with the pictures, and apply modifiers",
    )

    _is_asked = False

    def invoke(self, context, event):
        if bpy.app.background or context.window is None:
            return self.execute(context)
        self._is_asked = True
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        if self._is_asked:
            self._is_asked = False
            return super().invoke(context, None)
        return super().execute(context)

    def begin(self, context):
        items = rocks(context)
        if not items:
            raise InputRefused("there is no block to bake", advice="build the model, or make blocks local")
        if not self.maps:
            raise InputRefused("no picture is chosen", advice="choose some under Maps")
        folder = project_settings.absolute(self.directory)
        if folder is None or (self.directory.startswith("//") and not bpy.data.filepath):
            raise InputRefused(
                f"the folder {self.directory} is beside the .blend file, which was not saved",
                advice="save the file, or choose another folder",
            )
        self._folder = folder
        return BakeJob(
            context, items, folder, self.maps, self.layout, self.picture_size, self.plain_materials
        )

    def tell_done(self, names):
        self.report({"INFO"}, f"Wrote {counted(len(names), 'picture')} to {self._folder}")
