# SPDX-License-Identifier: GPL-3.0-or-later
"""The model's settings as properties of the scene: `scene.realmodel`, saved in the .blend.

They are the whole input of a model: what a build needs beside them are the objects that they point to.
What goes on at the moment (progress, the last problem) is in `window_manager.realmodel` and not saved.
"""

import sys

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import preferences, props_import, props_planned, props_rock, props_view
from .bl import changes, display
from .bl.objects.stored_arrays import ArraysProperty
from .bl.project import library_rows, results, units
from .bl.scene import data_objects, quality
from .bl.shading import looks
from .core.base.units import MODEL_UNIT
from .core.project.library import PROPERTY
from .core.project.project import PROJECT
from .props_schema import properties_of
from .registration import classes


class RealModelProperty(
    properties_of(
        PROPERTY,
        name=changes.property_name,
        rock=changes.property_rock,
        look_scale=changes.property_look,
        look_seed=changes.property_look,
        hardness=changes.property_hardness,
    ),
    bpy.types.PropertyGroup,
):
    """One entry of the library: the rock that a block consists of."""

    id: IntProperty(
        name="ID",
        description="Number by which surfaces refer to this property; unique in the library",
        default=1,
        update=changes.property_id,
        options=set(),
    )
    known_id: IntProperty(options={"HIDDEN"})
    color: FloatVectorProperty(
        name="Color",
        description="Color of the blocks with this property, and of their material",
        subtype="COLOR_GAMMA",
        size=3,
        min=0.0,
        max=1.0,
        default=(0.7019608, 0.7019608, 0.7019608),
        update=changes.property_color,
        options=set(),
    )
    has_color: BoolProperty(options={"HIDDEN"})
    look: EnumProperty(
        name="Look",
        description="Appearance of the rock in rendered pictures",
        items=[
            (library_rows.NO_LOOK, "As It Is", "The material stays as it is"),
            *looks.ITEMS,
        ],
        update=changes.property_look,
        options=set(),
    )
    exact = ArraysProperty()


class RealModelBlock(bpy.types.PropertyGroup):
    """A row of the results: one block as it was built."""

    name: StringProperty(name="Block")
    rock: StringProperty(name="Rock Mass")
    surface: StringProperty(name="Surface", description="The surface at the top of the block")
    is_body: BoolProperty(options={"HIDDEN"})  # and `surface` is its name
    property_id: IntProperty(name="Property", options=set())
    volume: FloatProperty(name="Volume", subtype="NONE", options=set())
    volume_exact: StringProperty(options={"HIDDEN"})
    share: FloatProperty(name="Share", subtype="PERCENTAGE", options=set())
    cells: IntProperty(name="Cells", options=set())
    components: IntProperty(
        name="Components", description="Number of connected parts of the block", options=set()
    )
    slivers: IntProperty(
        name="Slivers", description="Number of parts with less than 0.1 % of its volume", options=set()
    )
    object: PointerProperty(type=bpy.types.Object)


class RealModelMisfit(bpy.types.PropertyGroup):
    """A row of the list of data that the model does not have as they say."""

    kind: StringProperty(name="Kind")
    rock: StringProperty(name="Rock Mass")
    name: StringProperty(name="Of", description="The surface, or the block")
    source: StringProperty(name="Source", description="The hole, or the file and the row")
    hole: StringProperty(name="Hole")
    depth: StringProperty(name="Depth", description="Along the hole")
    says: StringProperty(name="Says", description="The value of the datum")
    has: StringProperty(name="Has", description="The value of the model, or why the datum is not used")
    by: StringProperty(name="By", description="The difference")
    place = ArraysProperty()  # model coordinates


class RealModelReason(bpy.types.PropertyGroup):
    """A row of the list of what a proposal has decided, and of what it could not decide."""

    kind: StringProperty(
        name="Kind", description="Choice, rule, alternative, conflict, lens, repeat, warning"
    )
    name: StringProperty(name="Of", description="Subject of the row")
    text: StringProperty(name="Reason", description="Reason of the choice")
    hole: StringProperty(name="Hole")
    depth: StringProperty(name="Depth", description="Along the hole")


class RealModelLeftOutHole(bpy.types.PropertyGroup):
    """A row of the table of cross-validation by holes."""

    name: StringProperty(name="Hole")
    rock: StringProperty(name="Rock Mass")
    share: StringProperty(name="Right", description="Percent of its logged length in the right block")
    error: StringProperty(name="Worst", description="Largest distance of a contact from its surface")
    refused: StringProperty(name="Refused", description="Why the surfaces cannot be made without this hole")
    detail: StringProperty(options={"HIDDEN"})  # JSON of its length and its contacts


class RealModelSettings(bpy.types.PropertyGroup):
    """`scene.realmodel`: a model and how it is shown."""

    version: IntProperty(options={"HIDDEN"})
    name: StringProperty(
        name="Name", description="Name of the model and of its collection", update=changes.setting
    )
    exists: BoolProperty(options={"HIDDEN"})
    units: EnumProperty(
        name="Units",
        description="Length unit of the model; files in other units are converted",
        items=units.ITEMS,
        default=MODEL_UNIT,
        update=changes.model_unit,
        options=set(),
    )
    crs: StringProperty(
        name=PROJECT["crs"].label,
        description=PROJECT["crs"].tip,
        update=changes.setting,
        options=set(),
    )
    origin: FloatVectorProperty(
        name="Origin",
        description="Vector added to the coordinates of the scene to get those of the model",
        size=3,
        subtype="XYZ",
        precision=1,
        options=set(),
        get=data_objects.origin_of,
        set=data_objects.set_origin,
    )
    show_data: BoolProperty(
        name="Show Data",
        description="Show the points of the surfaces, the outlines, and the boreholes from the files",
        options=set(),
        update=data_objects.shown_changed,
    )
    project_file: StringProperty(
        name="Project File",
        description="The project file that the model was opened from or saved to",
        subtype="FILE_PATH",
    )
    rocks: CollectionProperty(type=props_rock.RealModelRock)
    active_rock: IntProperty(
        name="Active Rock Mass", description="The rock mass whose surfaces are shown", options=set()
    )
    faults: CollectionProperty(type=props_rock.RealModelFault)
    bodies: CollectionProperty(type=props_rock.RealModelBody)
    structure_kind: EnumProperty(
        name="Kind",
        description="Show faults or bodies in the list",
        items=(
            ("FAULT", "Faults", "Open surfaces in any position that displace the rock"),
            (
                "BODY",
                "Bodies",
                "Closed surfaces around another rock, or none: intrusions, domes, tunnels",
            ),
        ),
        options=set(),
    )
    active_fault: IntProperty(
        name="Active Fault", description="The fault whose settings are shown", options=set()
    )
    active_body: IntProperty(
        name="Active Body", description="The body whose settings are shown", options=set()
    )
    structures: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    library: CollectionProperty(type=RealModelProperty)
    library_path: StringProperty(options={"HIDDEN"})
    active_property: IntProperty(
        name="Active Property",
        description="The entry of the library whose settings are shown",
        options=set(),
    )
    cells: EnumProperty(
        name="For",
        description="Purpose of the model, which decides how its blocks are divided into cells",
        items=preferences.CELLS,
        default="COLUMNS",
        update=changes.setting,
        options=set(),
    )
    stage: IntProperty(
        name="Stage",
        description=(
            "Replay deposition and erosion: 0 shows only the oldest surface, the last stage the whole model. "
            "Can be animated"
        ),
        min=0,
        update=changes.stage,
    )
    known_last: IntProperty(default=-1, options={"HIDDEN"})  # settings.last_stage; -1: not known yet
    stage_slider: PointerProperty(type=props_view.RealModelStage)
    display: EnumProperty(
        name="Display",
        description="How the model is displayed",
        items=preferences.DISPLAYS,
        default="BLOCKS",
        update=lambda self, _context: display.mode_changed(self.id_data),
    )
    explode: FloatProperty(
        name="Explode",
        description="Move the blocks apart to show the layers inside; 0: in place",
        min=0.0,
        soft_max=2.0,
        update=lambda self, _context: display.explode_changed(self.id_data),
    )
    explode_direction: EnumProperty(
        name="Direction",
        description="Direction in which the blocks move apart",
        items=(
            ("Z", "Upward", "The younger a block, the higher it is lifted"),
            ("CENTER", "From Center", "Each block moves away from the center of the model"),
            ("BLOCK", "Side by Side", "The blocks stand side by side, the oldest first"),
            ("COMPARTMENT", "Compartments", "The compartments between faults move apart"),
        ),
        update=lambda self, _context: display.explode_changed(self.id_data),
    )
    color_by: EnumProperty(
        name="Color By",
        description="What the colors of the blocks show",
        items=(
            ("PROPERTY", "Property", "Colors of the library"),
            ("BLOCK", "Block", "A color for each block"),
            ("ROCK", "Rock Mass", "A color for each rock mass"),
            ("AGE", "Age", "From the oldest to the youngest"),
            (
                "UNCERTAINTY",
                "Standard Deviation",
                "Standard deviation of the elevations of an interpolated surface, on the blocks above",
            ),
            ("ELEVATION", "Elevation", "Elevation in the coordinates of the model"),
            ("THICKNESS", "Thickness", "Vertical thickness of the layer"),
            ("COMPARTMENT", "Compartment", "A color for each compartment between faults"),
        ),
        update=lambda self, _context: display.colors_changed(self.id_data),
    )
    live: BoolProperty(
        name="Auto",
        description=(
            "Rebuild automatically after each change to an interface or a setting, after a short pause"
        ),
        update=changes.live_switched,
        options=set(),
    )
    results: CollectionProperty(type=RealModelBlock)
    misfits: CollectionProperty(type=RealModelMisfit)
    active_misfit: IntProperty(
        name="Active Misfit",
        description="Active misfit. Click a row to turn the viewport there and to pick its datum",
        default=-1,
        update=changes.misfit_chosen,
        options=set(),
    )
    proposal: CollectionProperty(type=RealModelReason)
    active_reason: IntProperty(
        name="Active Reason", description="The row of the proposal that is shown in full", options=set()
    )
    left_out_holes: CollectionProperty(type=RealModelLeftOutHole)
    active_left_out_hole: IntProperty(
        name="Active Hole",
        description="Active row of the table of left-out holes. Click a row to turn the viewport there",
        default=-1,
        update=changes.left_out_hole_chosen,
        options=set(),
    )
    hole_validation: StringProperty(options={"HIDDEN"})  # JSON: what was found in all, of which model
    active_result: IntProperty(
        name="Active Block",
        description="Active row of the results. Click a row to select the block in the viewport",
        update=results.row_chosen,
        options=set(),
    )
    warnings: StringProperty(options={"HIDDEN"})
    built_stamp: StringProperty(options={"HIDDEN"})
    built_from: StringProperty(options={"HIDDEN"})  # the fingerprint of what the blocks were built from
    is_outdated: BoolProperty(options={"HIDDEN"})  # and it is another one now: see bl/scene/live.py
    is_coarse: BoolProperty(options={"HIDDEN"})  # the blocks are of coarse fields: see bl/scene/live.py
    collection: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    view: PointerProperty(type=props_view.RealModelView)
    ensemble: PointerProperty(type=props_planned.RealModelEnsemble)
    planned_holes: CollectionProperty(type=props_planned.RealModelPlannedHole)
    active_planned_hole: IntProperty(
        name="Active Planned Hole", description="The planned hole whose table is shown", options=set()
    )
    realization_slider: PointerProperty(type=props_planned.RealModelRealization)


class RealModelActivity(bpy.types.PropertyGroup):
    """`window_manager.realmodel`: running work; not saved."""

    running: BoolProperty(options={"SKIP_SAVE"})
    progress: FloatProperty(
        name="Progress",
        description="Progress of the build",
        subtype="PERCENTAGE",
        min=0.0,
        max=100.0,
        precision=0,
        options={"SKIP_SAVE"},
    )
    text: StringProperty(options={"SKIP_SAVE"})
    chart: EnumProperty(
        name="Chart",
        description="Chart that the panel Quality shows",
        items=quality.CHARTS,
        options={"SKIP_SAVE"},
    )
    unfolded: BoolProperty(name="Messages", description="Show all messages in full", options={"SKIP_SAVE"})
    estimate: StringProperty(options={"SKIP_SAVE"})  # of bl.jobs.estimate_job
    problem: StringProperty(options={"SKIP_SAVE"})
    problem_item: StringProperty(options={"SKIP_SAVE"})
    problem_object: StringProperty(options={"SKIP_SAVE"})
    problem_triangles: StringProperty(options={"SKIP_SAVE"})
    problem_place: StringProperty(options={"SKIP_SAVE"})


_MODULES = (
    props_import,
    *(props_rock, props_rock, props_rock, props_rock, props_view, props_view, props_planned),
    props_planned,
    sys.modules[__name__],
)


def register():
    for cls in classes(_MODULES):
        bpy.utils.register_class(cls)
    bpy.types.Scene.realmodel = PointerProperty(type=RealModelSettings, name="RealModel")
    bpy.types.WindowManager.realmodel = PointerProperty(type=RealModelActivity, name="RealModel")


def unregister():
    del bpy.types.WindowManager.realmodel
    del bpy.types.Scene.realmodel
    for cls in reversed(classes(_MODULES)):
        bpy.utils.unregister_class(cls)
