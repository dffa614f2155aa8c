# SPDX-License-Identifier: GPL-3.0-or-later
"""The looks of rock in renders: textures, and weathering."""

import math

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..bl.objects import filled_beds
from ..bl.project import library_rows, project_settings, settings
from ..bl.shading import look_assets, looks, weathering
from ..core import InputRefused
from ..core.base.errors import counted
from .reporting import Reporting, a_library, a_model_or_beds


class REALMODEL_OT_rock_looks(Reporting, bpy.types.Operator):
    """Give the materials of the library's rocks a look: procedural textures that follow the layers"""

    bl_label = "Rock Looks"
    needs = (a_library,)

    look: EnumProperty(
        name="Look",
        description="How the rocks look in rendered pictures",
        items=looks.ITEMS,
    )
    only_active: BoolProperty(
        name="Active Only", description="Only the active property of the library; otherwise all"
    )
    scale: FloatProperty(
        name="Scale",
        description="Size of the texture; 1 suits the model",
        default=1.0,
        min=0.001,
        soft_max=10.0,
    )
    seed: IntProperty(name="Seed", description="Another texture of the same kind", min=0)

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self)

    def act(self, context):
        group = context.scene.realmodel
        rows = list(group.library)
        if self.only_active:
            rows = rows[min(group.active_property, len(rows) - 1) :][:1]
        if not any(library_rows.scene_materials(context.scene, row.id) for row in rows):
            raise InputRefused("no block has these properties", advice="build the model first")
        with settings.filling():
            for row in rows:
                row.look, row.look_seed = self.look, self.seed
                settings.set_number(row, "look_scale", self.scale)
        looks.follow(context.scene, rows, anew=True)


def _blocks(context):
    """The selected blocks and beds of filled meshes, all where none is selected."""
    items = [row.object for row in context.scene.realmodel.results if row.object is not None]
    items += filled_beds.of_scene(context.scene)
    items = [obj for obj in items if obj.type == "MESH" and obj.library is None]
    selected = set(context.selected_objects)
    return [obj for obj in items if obj in selected] or items


class REALMODEL_OT_weathering(Reporting, bpy.types.Operator):
    """Weather the selected blocks, or all, for pictures: a modifier on top of the exact blocks"""

    bl_label = "Weathering"
    needs = (a_model_or_beds,)

    strength: FloatProperty(
        name="Strength",
        description="How much is worn away; 1 suits the model",
        default=1.0,
        min=0.0,
        soft_max=5.0,
    )
    rounding: FloatProperty(
        name="Edge Rounding",
        description="How round exposed edges are",
        subtype="FACTOR",
        default=0.6,
        min=0.0,
        max=1.0,
    )
    wear: FloatProperty(
        name="Edge Wear",
        description="How far materials show edges worn, in Cycles also round, without a finer mesh; 1 suits "
        "the model",
        default=0.5,
        min=0.0,
        soft_max=3.0,
    )
    noise_scale: FloatProperty(
        name="Noise Scale",
        description="Size of hollows and of eroded beds; 1 suits the model",
        default=1.0,
        min=0.001,
        soft_max=10.0,
    )
    seed: IntProperty(name="Seed", description="Other hollows", min=0)
    grass_slope: FloatProperty(
        name="Grass Slope",
        description="The steepest ground that grass grows on; 0: none",
        subtype="ANGLE",
        default=math.radians(28.0),
        min=0.0,
        max=math.pi / 2,
    )
    scree_slope: FloatProperty(
        name="Scree Slope",
        description="The steepest ground that scree lies on; 0: none",
        subtype="ANGLE",
        default=math.radians(40.0),
        min=0.0,
        max=math.pi / 2,
    )
    detail: IntProperty(
        name="Detail",
        description="How often each polygon is divided: once makes four",
        default=2,
        min=0,
        max=weathering.FINEST,
    )

    plants: FloatProperty(
        name="Plants and Stones",
        description="How many tufts of grass and stones lie on grass and scree, as instances; 1 suits the "
        "model, 0: none",
        default=0.0,
        min=0.0,
        soft_max=4.0,
    )

    def act(self, context):
        values = (self.strength, self.rounding, self.noise_scale, self.seed)
        covers = (self.grass_slope, self.scree_slope)
        items = _blocks(context)
        parameters = weathering.Weathering(*values, *covers, self.detail, self.plants, self.wear)
        weathering.put_on(context.scene, items, parameters)
        self.report(
            {"INFO"}, f"Weathered {counted(len(items), 'block')}; the modifier of each has all settings"
        )


class REALMODEL_OT_weathering_remove(Reporting, bpy.types.Operator):
    """Remove the weathering of the selected blocks, or of all"""

    bl_label = "Remove Weathering"
    needs = (a_model_or_beds,)

    def act(self, context):
        items = [obj for obj in _blocks(context) if weathering.modifier_of(obj) is not None]
        if not items:
            raise InputRefused("no block is weathered", advice="use Weathering first, or select other blocks")
        weathering.take_off(items)


class REALMODEL_OT_install_looks(Reporting, bpy.types.Operator):
    """Make an asset library of the looks and of the presets of Fill with Strata, and add it to the
    preferences: materials to drag onto any object"""

    bl_label = "Install Assets"
    bl_options = {"REGISTER"}

    directory: StringProperty(
        name="Folder",
        description="Folder of the library; empty: Blender's folder of the user",
        subtype="DIR_PATH",
    )

    def act(self, context):
        directory = self.directory.strip()
        folder = project_settings.absolute(directory) if directory else look_assets.default_folder()
        look_assets.write(folder)
        look_assets.register(folder)
        self.report({"INFO"}, f"The asset library '{look_assets.LIBRARY}' is in {folder}")
