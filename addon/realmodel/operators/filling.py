# SPDX-License-Identifier: GPL-3.0-or-later
"""Strata in any mesh object: the modifier that shows them, erosion, and the beds as solids."""

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from .. import props_strata
from ..bl.host import thumbnails
from ..bl.jobs.fill_job import ErosionJob, FillJob
from ..bl.objects import meshes, placing
from ..bl.objects.boolean_job import VOLUME
from ..bl.shading import strata_modifier, strata_presets
from ..bl.shading.strata_modifier import SCREE
from ..bl.shading.strata_presets import PRESETS, SHAPES
from ..core import RealModelError, rock_shape
from ..core.base.errors import counted
from .pictures import by_hand, set_up_first
from .reporting import InBackground, Reporting, not_building, object_mode

_PICTURE_SIZE = 3.0  # in heights of a button
_WIDTH = 640  # of the dialog, in units of the interface


def a_mesh(context):
    obj = context.active_object
    if obj is None or obj.type != "MESH":
        return "the active object is no mesh; make the object that is to be filled active"
    return None


def some_strata(context):
    obj = context.active_object
    if obj is None or obj.type != "MESH" or strata_modifier.modifier_of(obj) is None or SCREE in obj:
        return "the active object has no strata; choose a preset first (Strata, Beds)"
    return None


def _preset_items(has_none):
    none = (("NONE", "None", "The values below"),) if has_none else ()
    return (*none, *((key, name, f"Values for {name.lower()} strata") for key, (name, _) in PRESETS.items()))


def _set_preset(self, _context):
    for name, value in strata_presets.values(self.preset).items():
        setattr(self, name, value)


class _OfStrata(InBackground):
    """An operator whose work is a job of the active object's strata, `_strata_job`."""

    def shown(self, context):
        """The active object, with its modifier. Raises RealModelError."""
        obj = context.active_object
        if strata_modifier.beds_of(obj) is None:
            strata_modifier.update(obj)
        return obj

    def warn(self):
        for warning in self._strata_job.warnings:
            self.report({"WARNING"}, warning)


class REALMODEL_OT_fill_with_strata(_OfStrata, bpy.types.Operator):
    """Fill the active mesh with strata. Each bed is a closed object with its own rock; together the beds
    equal the mesh, which is hidden. An open mesh with one elevation at each position is filled down to a
    base. Beds that were made of the mesh before are replaced. Esc cancels"""

    bl_label = "Fill with Strata"
    bl_options = {"REGISTER", "UNDO", "PRESET"}
    needs = (not_building, object_mode, a_mesh)

    __annotations__ = {
        "preset": EnumProperty(
            name="Preset",
            description="Initial values. A choice replaces the values below",
            items=_preset_items(True),
            default="NONE",
            update=_set_preset,
            options={"SKIP_SAVE"},
        ),
        "use_dialog": BoolProperty(
            name="Dialog",
            description="Ask for the values first. Otherwise those of the object are taken",
            default=True,
            options={"HIDDEN", "SKIP_SAVE"},
        ),
        **props_strata.VALUES,
    }

    _preset = None  # that the preview shows
    _before = None  # the values that the object had before the dialog, None without strata
    _name = ""
    _is_asked = False
    _problem = ""

    def invoke(self, context, event):
        obj = context.active_object
        self._take_values(obj)
        preset = strata_presets.of_item(obj)
        if preset is not None and not self.properties.is_property_set("preset"):
            self.preset = preset
        if bpy.app.background or context.window is None:
            return self.execute(context)
        if not self.use_dialog:
            return super().invoke(context, event)
        has_strata = strata_modifier.modifier_of(obj) is not None
        self._before = props_strata.values_of(obj.realmodel_strata) if has_strata else None
        self._name, self._is_asked, self._preset = obj.name, True, self.preset
        self._show()
        if context.area is not None and context.area.type == "VIEW_3D":
            # The dialog opens around the mouse: at the left it does not hide the object in the middle.
            half = round(0.55 * _WIDTH * context.preferences.system.ui_scale)
            context.window.cursor_warp(context.area.x + half, context.area.y + 4 * context.area.height // 5)
        return context.window_manager.invoke_props_dialog(self, width=_WIDTH)

    def check(self, _context):
        if self._is_asked:
            if self.preset != self._preset:  # its update, which sets the others, comes only after this
                self._preset = self.preset
                _set_preset(self, _context)
            self._show()
        return True

    def draw(self, _context):
        layout = self.layout
        columns = layout.split(factor=0.5)
        left, right = columns.column(), columns.column()
        draw_presets(left, 3, lambda cell, key: cell.prop_enum(self, "preset", key))
        draw_values(left, self, (*props_strata.SHAPE, ("erosion",), *props_strata.EROSION))
        draw_values(right, self, (*props_strata.BEDS, *props_strata.SOLID))
        if self._problem:
            layout.label(text=self._problem, icon="ERROR")

    def execute(self, context):
        if self._is_asked:
            self._is_asked = False
            return super().invoke(context, None)
        self._take_values(context.active_object)
        return super().execute(context)

    def cancel(self, context):
        if self._is_asked:
            self._is_asked = False
            obj = bpy.data.objects.get(self._name)
            if obj is not None and self._before is None:
                strata_modifier.take_off(obj)
            elif obj is not None:
                strata_modifier.set_values(obj, self._before)
        super().cancel(context)

    def begin(self, context):
        obj = context.active_object
        had_strata = strata_modifier.modifier_of(obj) is not None
        try:
            props_strata.copy(self, obj)
            self._strata_job = FillJob(context.scene, self.shown(context))
        except RealModelError:
            if not had_strata:
                strata_modifier.take_off(obj)
            raise
        return self._strata_job

    def tell_done(self, result):
        beds = sum(VOLUME in obj for obj in result.objects)
        self.warn()
        has_picture = by_hand(self) and set_up_first(bpy.context.scene)
        renders = "; F12 renders them" if has_picture else ""
        self.report({"INFO"}, f"{counted(beds, 'bed')}: see {result.name}{renders}")

    def _take_values(self, obj):
        """Values that are not given are those of the object, where it has strata."""
        if obj is None or strata_modifier.modifier_of(obj) is None:
            return
        for name in props_strata.VALUES:
            if not self.properties.is_property_set(name) and self.preset == "NONE":
                setattr(self, name, getattr(obj.realmodel_strata, name))

    def _show(self):
        """Shows the strata on the object, or says why they cannot be made."""
        self._problem = ""
        obj = bpy.data.objects.get(self._name)
        try:
            props_strata.copy(self, obj)
            if strata_modifier.modifier_of(obj) is None:
                strata_modifier.update(obj)
        except RealModelError as error:
            self._problem = str(error)


class REALMODEL_OT_strata_preset(Reporting, bpy.types.Operator):
    """Show strata on the active mesh, by a modifier that follows its shape. A choice replaces all values"""

    bl_label = "Strata Preset"
    needs = (a_mesh,)

    preset: EnumProperty(name="Preset", description="Values of the strata", items=_preset_items(False))

    def act(self, context):
        obj = context.active_object
        strata_modifier.set_values(obj, strata_presets.values(self.preset))
        if strata_modifier.modifier_of(obj) is None:
            strata_modifier.update(obj)


class REALMODEL_OT_strata_fit(Reporting, bpy.types.Operator):
    """Lay the beds through the mesh anew, as it is now. They stay in place while you sculpt"""

    bl_label = "Fit Beds to Mesh"
    needs = (some_strata,)

    def act(self, context):
        strata_modifier.update(context.active_object)


class REALMODEL_OT_strata_remove(Reporting, bpy.types.Operator):
    """Remove the strata of the active mesh. Beds that were made of it stay"""

    bl_label = "Remove Strata"
    needs = (some_strata,)

    def act(self, context):
        strata_modifier.take_off(context.active_object)


class REALMODEL_OT_strata_erode(_OfStrata, bpy.types.Operator):
    """Show what erosion leaves of the mesh: hard beds stand out, soft ones recede beneath them. The mesh
    itself stays as it is. Esc cancels"""

    bl_label = "Erode"
    needs = (not_building, object_mode, some_strata)

    def begin(self, context):
        obj = self.shown(context)
        strata_modifier.set_values(obj, {"erosion": True})
        self._strata_job = ErosionJob(context.scene, obj)
        return self._strata_job

    def tell_done(self, result):
        self.warn()
        self.report({"INFO"}, f"{counted(result, 'face')} after erosion")


class REALMODEL_OT_strata_edit(Reporting, bpy.types.Operator):
    """Show the mesh that the beds were made of, and hide these. Make Solid replaces them"""

    bl_label = "Edit Shape"
    needs = (object_mode,)

    def act(self, context):
        obj = next((o for o in context.scene.objects if _is_shape_of(o, context.active_object)), None)
        if obj is None:
            self.report({"WARNING"}, "the active object is no bed of a filled mesh")
            return {"CANCELLED"}
        for bed in obj.realmodel_strata.beds_in.objects:
            placing.hide(bed)
        obj.hide_set(False)
        obj.hide_render = False
        strata_modifier.show_eroded(obj, None)
        placing.select([obj])
        return {"FINISHED"}


class REALMODEL_OT_strata_rock_add(Reporting, bpy.types.Operator):
    """Add a rock with strata that erosion has worked on: a mesh to sculpt, with the modifier Strata"""

    bl_label = "Add Strata Rock"
    needs = (object_mode,)

    kind: EnumProperty(
        name="Shape",
        description="Kind of rock",
        items=tuple((key, name, tip) for key, (name, tip, _) in SHAPES.items()),
    )
    size: FloatProperty(
        name="Size", description="Width", subtype="DISTANCE", default=20.0, min=0.01, soft_max=1000.0
    )
    seed: IntProperty(name="Seed", description="Another shape with other beds", min=0)
    strength: FloatProperty(
        name="Erosion",
        description="Depth of the erosion; 0: none",
        default=1.0,
        min=0.0,
        max=20.0,
        soft_max=3.0,
    )
    faces: IntProperty(
        name="Faces",
        description="About how many triangles the eroded mesh has",
        default=200_000,
        min=1000,
        max=5_000_000,
        soft_max=1_500_000,
    )

    def act(self, context):
        name, _, given = SHAPES[self.kind]
        vertices, triangles = rock_shape(self.kind.lower(), self.size, self.seed)
        mesh = meshes.triangle_mesh(name, vertices.astype(np.float32), triangles)
        obj = bpy.data.objects.new(f"Strata {name}", mesh)
        obj.location = context.scene.cursor.location
        context.collection.objects.link(obj)
        placing.select([obj])
        values = strata_presets.values(given["preset"]) | {k: v for k, v in given.items() if k != "preset"}
        erosion = {"erosion": self.strength > 0, "strength": self.strength, "faces": self.faces}
        try:
            strata_modifier.set_values(obj, {**values, **erosion, "seed": self.seed})
            strata_modifier.update(obj)
            if self.strength > 0:
                ErosionJob(context.scene, obj).run()
        except RealModelError:
            strata_modifier.take_off(obj)
            bpy.data.meshes.remove(mesh)  # and its object with it
            raise


def _is_shape_of(obj, bed):
    """Whether an object is the mesh that a bed was made of, or the bed itself is that mesh."""
    if obj.type != "MESH" or strata_modifier.modifier_of(obj) is None:
        return False
    collection = obj.realmodel_strata.beds_in
    return collection is not None and bed is not None and (obj == bed or bed.name in collection.objects)


def draw_presets(layout, columns, button):
    """Pictures of the presets. button(layout, key) draws what chooses one."""
    grid = layout.grid_flow(row_major=True, columns=columns, even_columns=True)
    for number, key in enumerate(PRESETS):
        cell = grid.column(align=True)
        cell.template_icon(icon_value=thumbnails.icon(strata_presets.PICTURES, number), scale=_PICTURE_SIZE)
        button(cell, key)


def draw_values(layout, values, groups):
    """Values of strata, in groups of names."""
    layout.use_property_split = True
    for names in groups:
        column = layout.column(align=True)
        for name in names:
            column.prop(values, name)


def unregister():
    thumbnails.forget()
