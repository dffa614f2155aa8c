# SPDX-License-Identifier: GPL-3.0-or-later
"""Strata in any mesh object, with a preview while values are dragged."""

import math

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from ..bl.host import thumbnails
from ..bl.jobs.fill_job import FilledShape, FillJob
from ..bl.jobs.fill_preview import FillPreview
from ..bl.objects.boolean_job import VOLUME
from ..bl.shading import strata_presets
from ..bl.shading.strata_presets import PRESETS
from ..core import RealModelError, Strata
from ..core.base.errors import counted
from ..core.filling import PALETTES
from ..core.filling.strata import MOST_BEDS, MOST_FAULTS, MOST_PEGS, RECUMBENT, STEEPEST, UPRIGHT
from .pictures import by_hand, set_up_first
from .reporting import InBackground, not_building, object_mode

_PICTURE_SIZE = 3.0  # in heights of a button
_WIDTH = 360  # of the dialog, in units of the interface


def _set_preset(self, _context):
    for name, value in strata_presets.values(self.preset).items():
        setattr(self, name, value)


def _a_mesh(context):
    obj = context.active_object
    if obj is None or obj.type != "MESH":
        return "the active object is no mesh; make the object that is to be filled active"
    return None


def _share(name, description, default=0.0, most=10.0, soft=1.0):
    return FloatProperty(
        name=name, description=description, default=default, min=0.0, max=most, soft_max=soft, precision=3
    )


def _azimuth(name, description, default=0.0):
    return FloatProperty(
        name=name,
        description=f"{description}, clockwise from north, the Y axis",
        subtype="ANGLE",
        default=math.radians(default),
        soft_min=-2 * math.pi,
        soft_max=2 * math.pi,
    )


class REALMODEL_OT_fill_with_strata(InBackground, bpy.types.Operator):
    """Fill the active mesh with strata. Each bed is a closed object with its own rock; together the beds
    equal the mesh, which is hidden. An open mesh with one elevation at each position is filled down to a
    base. Esc cancels"""

    bl_label = "Fill with Strata"
    bl_options = {"REGISTER", "UNDO", "PRESET"}
    needs = (not_building, object_mode, _a_mesh)

    preset: EnumProperty(
        name="Preset",
        description="Values to begin with; a choice replaces those below",
        items=(
            ("NONE", "None", "The values below"),
            *((key, name, f"Values for {name.lower()} strata") for key, (name, _) in PRESETS.items()),
        ),
        default="NONE",
        update=_set_preset,
        options={"SKIP_SAVE"},
    )
    beds: IntProperty(name="Beds", description="How many", default=12, min=2, max=MOST_BEDS, soft_max=60)
    thickness: _share(
        "Thickness",
        "Of a bed on average, as a share of the height of the mesh; 0: the beds fill it. Otherwise the "
        "lowest and the highest bed take the rest",
    )
    variation: FloatProperty(
        name="Variation",
        description="How much the beds differ in thickness",
        subtype="FACTOR",
        default=0.5,
        min=0.0,
        max=1.0,
    )
    dip: FloatProperty(
        name="Dip",
        description="Of the beds, before they are folded",
        subtype="ANGLE",
        default=math.radians(10),
        min=0.0,
        max=math.radians(STEEPEST),
    )
    dip_direction: _azimuth("Dip Direction", "Where the beds dip to", 120.0)
    fold_amplitude: _share("Fold Amplitude", "As a share of the height of the mesh; 0: no folds", soft=0.5)
    fold_wavelength: _share("Fold Wavelength", "As a share of the width of the mesh; 0: no folds", 0.5)
    fold_axis: _azimuth("Fold Axis", "Direction of the fold axes", 30.0)
    axial_dip: FloatProperty(
        name="Axial Dip",
        description="Dip of the axial planes of folds: 90 upright, 10 recumbent. Folds lean to the right of "
        "their axis; the fault strike is at right angles to it then",
        subtype="ANGLE",
        default=math.radians(UPRIGHT),
        min=math.radians(RECUMBENT),
        max=math.radians(UPRIGHT),
    )
    faults: IntProperty(name="Faults", description="How many", default=0, min=0, max=MOST_FAULTS, soft_max=10)
    throw: _share("Throw", "Of each fault, as a share of the height of the mesh", 0.1, soft=0.5)
    fault_strike: _azimuth("Fault Strike", "Direction of the faults, which are vertical", 20.0)
    unconformity: FloatProperty(
        name="Unconformity",
        description="Share of the height, from below, at which level beds cover eroded ones; 0: none",
        subtype="FACTOR",
        default=0.0,
        min=0.0,
        max=0.95,
    )
    gap: _share(
        "Gap",
        "Between beds, and between the two sides of a fault, for a print in parts: as a share of the height",
        soft=0.05,
    )
    pegs: IntProperty(
        name="Pegs",
        description="How many square pegs there are at most on each bed. The holes for them in the next one "
        "are wider by the gap on each side",
        default=0,
        min=0,
        max=MOST_PEGS,
        soft_max=6,
    )
    peg_size: _share("Peg Size", "Width of a peg, as a share of the height of the mesh", 0.1, soft=0.3)
    base_depth: _share(
        "Base Depth",
        "Of an open mesh: depth of the base beneath its lowest point, as a share of its height or of a tenth "
        "of its width",
        0.5,
    )
    palette: EnumProperty(
        name="Palette",
        description="Rocks of the beds",
        items=tuple(
            (key.upper(), key.title(), ", ".join(name for name, _ in rocks))
            for key, rocks in PALETTES.items()
        ),
    )
    rock_looks: BoolProperty(
        name="Rock Looks",
        description="Give the rocks procedural textures; otherwise their colors alone",
        default=True,
    )
    masks: BoolProperty(
        name="Bed Masks",
        description="Add a hidden copy of the mesh whose vertices have the number of their bed and a mask, 0 "
        "or 1, of each bed, as attributes",
    )
    seed: IntProperty(name="Seed", description="Other thicknesses, rocks, folds and faults", min=0)

    _preview = None
    _preset = None  # that the preview shows
    _shape = None
    _filling = None
    _is_asked = False
    _problem = ""

    def invoke(self, context, event):
        obj = context.active_object
        preset = strata_presets.of_item(obj)
        if preset is not None and not self.properties.is_property_set("preset"):
            self.preset = preset
        if bpy.app.background or context.window is None:
            return self.execute(context)
        try:
            self._shape = FilledShape.of(obj, context.evaluated_depsgraph_get())
            self._shape.closed(self.base_depth)
            self._preview, self._preset = FillPreview(obj, self._shape), self.preset
            self._show()
        except RealModelError as error:
            self._end_preview()
            return self._refused(context, error)
        self._is_asked = True
        if context.area is not None and context.area.type == "VIEW_3D":
            # The dialog opens around the mouse: at the left it does not hide the preview in the middle.
            half = round(0.6 * _WIDTH * context.preferences.system.ui_scale)
            context.window.cursor_warp(context.area.x + half, context.area.y + context.area.height // 2)
        return context.window_manager.invoke_props_dialog(self, width=_WIDTH)

    def check(self, _context):
        if self._preview is not None:
            if self.preset != self._preset:  # its update, which sets the others, comes only after this
                self._preset = self.preset
                _set_preset(self, _context)
            self._show()
        return True

    def draw(self, _context):
        layout = self.layout
        layout.label(text="Preset")
        grid = layout.grid_flow(row_major=True, columns=4, even_columns=True)
        for number, key in enumerate(PRESETS):
            cell = grid.column(align=True)
            cell.template_icon(
                icon_value=thumbnails.icon(strata_presets.PICTURES, number), scale=_PICTURE_SIZE
            )
            cell.prop_enum(self, "preset", key)
        layout.use_property_split = True
        groups = (
            ("palette", "rock_looks", "seed"),
            ("beds", "thickness", "variation", "dip", "dip_direction"),
            ("fold_amplitude", "fold_wavelength", "fold_axis", "axial_dip"),
            ("faults", "throw", "fault_strike"),
            ("unconformity", "base_depth", "masks"),
            ("gap", "pegs", "peg_size"),
        )
        for names in groups:
            column = layout.column(align=True)
            for name in names:
                column.prop(self, name)
        if self._problem:
            layout.label(text=self._problem, icon="ERROR")

    def execute(self, context):
        self._end_preview()
        if self._is_asked:
            self._is_asked = False
            return super().invoke(context, None)
        return super().execute(context)

    def cancel(self, context):
        self._end_preview()
        super().cancel(context)

    def begin(self, context):
        shape = self._shape
        self._shape = None
        if shape is None:
            shape = FilledShape.of(context.active_object, context.evaluated_depsgraph_get())
        strata = self._strata(shape.closed(self.base_depth)[0])
        self._filling = FillJob(context.scene, shape, strata, self.base_depth, self.rock_looks, self.masks)
        return self._filling

    def tell_done(self, result):
        beds = sum(VOLUME in obj for obj in result.objects)
        for warning in self._filling.warnings:
            self.report({"WARNING"}, warning)
        has_picture = by_hand(self) and set_up_first(bpy.context.scene)
        renders = "; F12 renders them" if has_picture else ""
        self.report({"INFO"}, f"{counted(beds, 'bed')}: see {result.name}{renders}")

    def _show(self):
        """Shows the strata, or says why they cannot be made."""
        self._problem = ""
        try:
            vertices, _ = self._shape.closed(self.base_depth)
            self._preview.show(self._strata(vertices), self.base_depth)
        except RealModelError as error:
            self._problem = str(error)

    def _end_preview(self):
        if self._preview is not None:
            self._preview.remove()
            self._preview = None

    def _strata(self, vertices):
        """core.Strata for a mesh of this size."""
        size = np.ptp(vertices, axis=0)
        height, width = float(size[2]), float(size[:2].max())
        return Strata(
            beds=self.beds,
            thickness=self.thickness * height,
            variation=self.variation,
            dip=min(math.degrees(self.dip), STEEPEST),
            dip_direction=_degrees(self.dip_direction),
            fold_amplitude=self.fold_amplitude * height,
            fold_wavelength=self.fold_wavelength * width,
            fold_axis=_degrees(self.fold_axis),
            axial_dip=min(max(round(math.degrees(self.axial_dip), 4), RECUMBENT), UPRIGHT),
            faults=self.faults,
            throw=self.throw * height,
            fault_strike=_degrees(self.fault_strike),
            unconformity=self.unconformity,
            gap=self.gap * height,
            pegs=self.pegs,
            peg_size=self.peg_size * height,
            palette=self.palette.lower(),
            seed=self.seed,
        )


def _degrees(angle):
    """An azimuth, which Blender has in radians of 32 bits."""
    return round(math.degrees(angle), 4) % 360.0


def unregister():
    thumbnails.forget()
