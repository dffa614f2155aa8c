# SPDX-License-Identifier: GPL-3.0-or-later
"""The slider of the stage, from 0 to the number of the youngest surface: another way to set
`scene.realmodel.stage`."""

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from .bl import changes
from .bl.display import cuts, fields
from .bl.field import boreholes, shown_log, shown_net
from .bl.objects.stored_arrays import ArraysProperty
from .core.validation.misfits import DIP_TOLERANCE


def slider_name(most):
    """The slider that ends at `most`."""
    return f"of_{most}"


def slider_group(class_name, holder, key, ends, **shown):
    """A PropertyGroup with a slider for each of some ends. holder: gives, of scene.realmodel, the group with
    the property `key`, which they set. shown: name, description and min."""

    def slider(most):
        return IntProperty(
            max=most,
            get=lambda self: min(getattr(holder(self.id_data.realmodel), key), most),
            set=lambda self, value: setattr(holder(self.id_data.realmodel), key, value),
            options={"SKIP_SAVE"},  # and not ANIMATABLE: the keyframes are those of the property itself
            **shown,
        )

    return type(
        class_name,
        (bpy.types.PropertyGroup,),
        {
            "__doc__": f"`{key}` as a slider.",
            "__module__": __name__,
            "__annotations__": {slider_name(most): slider(most) for most in ends},
        },
    )


MOST = 100  # a model with more surfaces has the number field alone

DESCRIPTION = (
    "Replay deposition and erosion: 0 shows only the oldest surface, the last stage the whole model. "
    "The number beside the slider can be animated"
)


def stage_slider_name(last):
    """The slider of models whose youngest surface has the number `last`; None where there is none."""
    return slider_name(last) if 1 <= last <= MOST else None


RealModelStage = slider_group(
    "RealModelStage",
    lambda group: group,
    "stage",
    range(1, MOST + 1),
    name="Stage",
    description=DESCRIPTION,
    min=0,
)


def coordinate_field(name, axis, description, place, move):
    """A property with one coordinate of a place in the model. place(row): (3,), or None where there is none
    yet; move(row, place) takes another. Text that is not a number leaves the place as it is."""

    def get_text(row):
        at = place(row)
        return "" if at is None else f"{at[axis]:.3f}"

    def set_text(row, text):
        try:
            value = float(text.replace(",", ""))
        except ValueError:
            return
        at = place(row)
        if at is None or not np.isfinite(value):
            return
        at[axis] = value
        move(row, at)

    return StringProperty(name=name, description=description, options=set(), get=get_text, set=set_text)


def _plane_field(name, axis):
    return coordinate_field(
        name,
        axis,
        "Position of the section plane, in model coordinates",
        lambda view: cuts.place(view.id_data),
        lambda view, place: cuts.move(view.id_data, place),
    )


SUBJECTS = (
    ("BLOCKS", "Blocks", "The blocks"),
    ("INTERFACES", "Interfaces", "The surfaces that the model is built from, including what was eroded"),
    ("BOTH", "Both", "The blocks and the interfaces"),
)


class RealModelView(bpy.types.PropertyGroup):
    """Settings of the view."""

    subject: EnumProperty(
        name="Geometry",
        description="What is displayed as points, lines or faces",
        items=SUBJECTS,
        update=changes.view,
        options=set(),
    )
    hidden = ArraysProperty()  # the property IDs whose blocks are hidden
    collection: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})  # of objects for display only
    plane: PointerProperty(
        name="Section Plane",
        type=bpy.types.Object,
        description="Object whose XY plane cuts the model; the part on the side of its Z axis is removed",
        update=changes.section,
    )
    plane_x: _plane_field("East (x)", 0)
    plane_y: _plane_field("North (y)", 1)
    plane_z: _plane_field("Elevation (z)", 2)
    section_holes: StringProperty(
        name="Holes",
        description="Names of the boreholes of a section, in order, with commas between them",
        options=set(),
    )
    section_beyond: FloatProperty(
        name="Beyond",
        description="How far a section through boreholes continues at both ends, in percent of its length",
        default=5.0,
        min=0.0,
        soft_max=100.0,
        subtype="PERCENTAGE",
        options=set(),
    )
    use_section: BoolProperty(
        name="Show Cut",
        description="Show the model cut along the section plane, with filled cut faces",
        update=changes.section,
        options=set(),
    )
    exaggeration: FloatProperty(
        name="Vertical Exaggeration",
        description="Factor by which elevations are exaggerated in the display. Volumes and exports do not "
        "change",
        default=1.0,
        min=1.0,
        soft_max=20.0,
        max=1000.0,
        step=100,
        precision=1,
        options=set(),
        update=changes.exaggeration,
    )
    surfaces: EnumProperty(
        name="Surfaces",
        description="Which part of the surfaces is displayed",
        items=(
            ("INTERPOLATED", "As Interpolated", "The whole surfaces, including what was eroded"),
            ("SURVIVING", "As They Survive", "The parts of the surfaces that erosion has left"),
        ),
        options=set(),
        update=changes.view,
    )
    surviving_of: StringProperty(
        options={"HIDDEN"}
    )  # JSON of the state that the bodies of kind "surviving" were made from
    show_boreholes: BoolProperty(
        name="Boreholes",
        description="Show the boreholes as tubes, in the colors of the blocks of their intervals, or of the "
        "layer below each pick",
        options=set(),
        update=changes.field_data,
    )
    boreholes_by: StringProperty(
        name="Color By",
        description="Column of the tables of intervals and assays, or curve of logs, that the tubes show; "
        "empty: the blocks",
        search=lambda self, _context, _text: boreholes.columns(self.id_data),
        options=set(),
        update=changes.field_data,
    )
    show_hole_curves: BoolProperty(
        name="Curve Beside",
        description="Draw the numbers that color the boreholes as a curve beside each hole, from the "
        "lowest to the highest, in the viewport and on saved sections",
        options=set(),
        update=changes.field_data,
    )
    show_hole_names: BoolProperty(
        name="Hole Names",
        description="Show the name of each borehole at its collar, in the viewport and in pictures",
        options=set(),
        update=changes.overlay,
    )
    log_hole: StringProperty(
        name="Log",
        description="Borehole whose log is shown beside the model, in the viewport and in pictures. Empty: "
        "none",
        search=lambda self, _context, _text: shown_log.names(self.id_data),
        options=set(),
        update=changes.overlay,
    )
    show_stereonet: BoolProperty(
        name="Stereonet",
        description="Show the poles of dips with their density, mean plane and fold axis beside the model, "
        "in the viewport and in pictures. With Pick Datum, click a pole to find its dip. Dips that are "
        "not picked are light gray",
        options=set(),
        update=changes.field_data,
    )
    stereonet_of: StringProperty(
        name="Dips Of",
        description="Surface, block, series, rock mass or fault whose dips are shown. Empty: the picked "
        "dips, or all except those of faults",
        search=lambda self, _context, _text: shown_net.names(self.id_data),
        options=set(),
        update=changes.field_data,
    )
    net: EnumProperty(
        name="Net",
        description="How the lower hemisphere is projected",
        items=shown_net.NET_ITEMS,
        options=set(),
        update=changes.overlay,
    )
    picked_dips: StringProperty(options={"HIDDEN"})  # JSON of the texts of the picked data
    hole_width: FloatProperty(
        name="Holes Within",
        description="Distance from the section plane within which boreholes, contacts and dips are moved "
        "onto the cut, and boreholes drawn on sections. 0: all stay in place, and drawings have none",
        min=0.0,
        subtype="DISTANCE",
        options=set(),
        update=changes.field_data,
    )
    holes_on: StringProperty(options={"HIDDEN"})  # JSON of the cut that the boreholes are shown on
    show_contacts: BoolProperty(
        name="Contacts",
        description="Show the points of the surfaces, the observations, and the tops of logged intervals, "
        "in the colors of the blocks. Gray: switched off",
        options=set(),
        update=changes.field_data,
    )
    show_dips: BoolProperty(
        name="Dips",
        description="Show the dips as discs in the plane of the surface: the younger side has the color of "
        "the surface and a short normal, the older one is black; gray: switched off",
        options=set(),
        update=changes.field_data,
    )
    show_map: BoolProperty(
        name="Map",
        description="Show the geological map on its ground, in the colors of the blocks",
        options=set(),
        update=changes.field_data,
    )
    show_misfits: BoolProperty(
        name="Misfits",
        description="List the data that the model does not honor, and show them in red",
        options=set(),
        update=changes.field_data,
    )
    misfit_tolerance: FloatProperty(
        name="Tolerance",
        description="Smallest distance of a misfit. 0: everything above rounding",
        min=0.0,
        subtype="DISTANCE",
        options=set(),
        update=changes.field_data,
    )
    dip_tolerance: FloatProperty(
        name="Dip Tolerance",
        description="Smallest angle between a dip and its surface, in degrees, that is a misfit",
        min=0.0,
        max=90.0,
        default=DIP_TOLERANCE,
        precision=1,
        options=set(),
        update=changes.field_data,
    )
    misfit_count: IntProperty(options={"HIDDEN"})  # of all; the list may have fewer
    datum: StringProperty(options={"HIDDEN"})  # JSON of the active datum, see bl/field/data.py
    field_series: StringProperty(
        name="Series",
        description="Series whose field is shown. Empty: the first series with a field",
        search=lambda self, _context, _text: fields.series(self.id_data),
        options=set(),
        update=changes.fields,
    )
    show_field_section: BoolProperty(
        name="On the Cut",
        description="Show the field of the series in bands of color on the face of the cut, as far as its "
        "rock reaches; the model is cut by the section plane (Section)",
        options=set(),
        update=changes.fields,
    )
    show_field_levels: BoolProperty(
        name="Level Sets",
        description="Show surfaces on which the field of the series is equal, at equal steps from its least "
        "to its greatest value, as far as its rock reaches",
        options=set(),
        update=changes.fields,
    )
    field_levels: IntProperty(
        name="Levels",
        description="How many level sets are shown",
        default=7,
        min=1,
        soft_max=30,
        max=200,
        options=set(),
        update=changes.fields,
    )
    field_of: StringProperty(options={"HIDDEN"})  # JSON of the state that the shapes of the field are of
    field_limits: FloatVectorProperty(size=2, options={"HIDDEN"})  # the values at the ends of their scale
    field_surfaces: StringProperty(options={"HIDDEN"})  # JSON: [[surface, value of the field on it]]
    show_residuals: BoolProperty(
        name="Residuals",
        description="Show the points of the surfaces, colored by their distance above the surface",
        options=set(),
        update=changes.residuals,
    )
    residuals: StringProperty(options={"HIDDEN"})  # JSON: statistics of the residuals of each surface
    show_legend: BoolProperty(
        name="Legend",
        description="Show the meaning of the colors, in the viewport and in pictures",
        default=True,
        options=set(),
        update=changes.overlay,
    )
    show_north: BoolProperty(
        name="North Arrow",
        description="Show where north is, in the viewport and in pictures",
        options=set(),
        update=changes.overlay,
    )
    show_scale: BoolProperty(
        name="Scale Bar",
        description="Show a bar of a round length, in the viewport and in pictures",
        options=set(),
        update=changes.overlay,
    )
    show_axes: BoolProperty(
        name="Axes",
        description="Show the coordinates of the model around it, in the viewport and in pictures",
        options=set(),
        update=changes.overlay,
    )
    compartments: StringProperty(options={"HIDDEN"})  # JSON, see bl/project/compartments.py
    shade_limits: FloatVectorProperty(size=2, options={"HIDDEN"})  # values at the ends of the color scale
    cut: StringProperty(options={"HIDDEN"})  # JSON of the plane that the bodies of kind "cut" were made with
    cells_of: StringProperty(
        options={"HIDDEN"}
    )  # JSON of the state that the bodies of kind "cells" were made from
    applied: StringProperty(options={"HIDDEN"})  # JSON of the settings that the objects show
    place: StringProperty(options={"HIDDEN"})  # JSON of the last requested coordinates
    zero = ArraysProperty()  # the point that distances are measured from
    message: StringProperty(options={"HIDDEN", "SKIP_SAVE"})
    bounds_low: FloatVectorProperty(options={"HIDDEN"})
    bounds_high: FloatVectorProperty(options={"HIDDEN"})
