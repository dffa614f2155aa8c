# SPDX-License-Identifier: GPL-3.0-or-later
"""The model's settings as properties of the scene: `scene.realmodel`, saved in the .blend.

They are the whole input of a model: what a build needs beside them are the objects that they point to.
What goes on at the moment (progress, the last problem) is in `window_manager.realmodel` and not saved.
"""

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

from . import props_rock, props_stage, props_surface, props_view
from .bl import changes, display, library_rows, results, units
from .core.units import MODEL_UNIT

DISPLAYS = (
    ("POINTS", "Points", "Vertices of the interfaces and blocks"),
    ("LINES", "Lines", "Edges of the interfaces and blocks"),
    ("AREAS", "Areas", "Faces of the blocks as separate, flat areas with their edges"),
    ("SURFACES", "Surfaces", "The interfaces: the surfaces that the model is built from"),
    ("POLYHEDRA", "Polyhedra", "The polyhedral cells that the blocks consist of"),
    ("BLOCKS", "Blocks", "The blocks as solid bodies"),
)


class RealModelProperty(bpy.types.PropertyGroup):
    """One entry of the library: what a block may be made of."""

    id: IntProperty(
        name="ID",
        description="Number by which surfaces name this property; each entry has its own",
        default=1,
        update=library_rows.id_changed,
    )
    known_id: IntProperty(options={"HIDDEN"})
    name: StringProperty(
        name="Name",
        description="Name of the rock; the material of its blocks is called so",
        update=library_rows.changed,
    )
    color: FloatVectorProperty(
        name="Colour",
        description="Colour of the blocks that have this property; their material follows at once",
        subtype="COLOR_GAMMA",
        size=3,
        min=0.0,
        max=1.0,
        default=(0.7019608, 0.7019608, 0.7019608),
        update=library_rows.colour_changed,
    )
    has_color: BoolProperty(options={"HIDDEN"})
    rock: StringProperty(name="Rock", description="Kind of rock, such as sandstone")
    age: StringProperty(name="Age", description="Geological age, such as Triassic", update=changes.colouring)
    structure: StringProperty(name="Structure", description="Bedding, texture, grain size")
    density: FloatProperty(
        name="Density",
        description="Density in your units, such as kg/m³; 0 where it is not known",
        min=0.0,
        precision=1,
    )
    description: StringProperty(name="Description", description="Whatever else is to be kept")
    exact: StringProperty(options={"HIDDEN"})


class RealModelBlock(bpy.types.PropertyGroup):
    """A row of the results: one block as it was built."""

    name: StringProperty(name="Block")
    rock: StringProperty(name="Rock mass")
    surface: StringProperty(name="Surface", description="The surface that the block was deposited beneath")
    property_id: IntProperty(name="Property")
    volume: FloatProperty(name="Volume", subtype="NONE")
    volume_exact: StringProperty(options={"HIDDEN"})
    share: FloatProperty(name="Share", subtype="PERCENTAGE")
    cells: IntProperty(name="Cells")
    components: IntProperty(name="Components", description="Separate bodies that the block consists of")
    object: PointerProperty(type=bpy.types.Object)


class RealModelSettings(bpy.types.PropertyGroup):
    """`scene.realmodel`: a model and how it is shown."""

    version: IntProperty(options={"HIDDEN"})
    name: StringProperty(
        name="Name", description="Name of the model; its collection is called so", update=changes.setting
    )
    exists: BoolProperty(options={"HIDDEN"})
    units: EnumProperty(
        name="Units",
        description="Unit of the model's lengths; files in other units are brought to it",
        items=units.ITEMS,
        default=MODEL_UNIT,
        update=changes.model_unit,
    )
    project_file: StringProperty(
        name="Project file",
        description="The project file that the model was opened from or saved to",
        subtype="FILE_PATH",
    )
    rocks: CollectionProperty(type=props_rock.RealModelRock)
    active_rock: IntProperty(name="Active rock mass", description="The rock mass whose surfaces are shown")
    library: CollectionProperty(type=RealModelProperty)
    library_path: StringProperty(options={"HIDDEN"})
    active_property: IntProperty(
        name="Active property", description="The entry of the library whose settings are shown"
    )
    cells: EnumProperty(
        name="Cells",
        description="What the model is made of",
        items=(
            ("COLUMNS", "Columns", "Many small cells, each under one facet of a surface: for simulation"),
            ("BLOCKS", "Blocks", "One cell for each connected part of a block: much faster, and lighter"),
        ),
        default="COLUMNS",
        update=changes.setting,
    )
    stage: IntProperty(
        name="Stage",
        description=(
            "Replay deposition and erosion: 0 shows the oldest surface only, the last stage the whole model. "
            "It can be keyframed"
        ),
        min=0,
        update=changes.stage,
    )
    stage_slider: PointerProperty(type=props_stage.RealModelStage)
    display: EnumProperty(
        name="Display",
        description="How the model is drawn",
        items=DISPLAYS,
        default="BLOCKS",
        update=lambda self, _context: display.mode_changed(self.id_data),
    )
    explode: FloatProperty(
        name="Explode",
        description="Move the blocks apart so that the layers inside show; 0 leaves them in place",
        min=0.0,
        soft_max=2.0,
        update=lambda self, _context: display.explode_changed(self.id_data),
    )
    explode_direction: EnumProperty(
        name="Explode",
        description="Where the blocks go",
        items=(
            ("Z", "Upwards", "The younger a block, the higher it is lifted"),
            ("CENTRE", "From the centre", "Every block moves away from the middle of the model"),
            ("BLOCK", "By block", "The blocks stand side by side, the oldest first"),
        ),
        update=lambda self, _context: display.explode_changed(self.id_data),
    )
    color_by: EnumProperty(
        name="Colour by",
        description="What the colours of the blocks tell",
        items=(
            ("PROPERTY", "Property", "The colours of the library"),
            ("BLOCK", "Block", "Each block its own colour"),
            ("ROCK", "Rock mass", "Each rock mass its own colour"),
            ("AGE", "Age", "From the oldest to the youngest"),
            (
                "UNCERTAINTY",
                "Standard Deviation",
                "Standard deviation of the interpolated elevations of the surface, or of the surface above a block",
            ),
            ("ELEVATION", "Elevation", "Elevation above the zero of the model's coordinates"),
            ("THICKNESS", "Thickness", "Vertical thickness of the layer"),
        ),
        update=lambda self, _context: display.colours_changed(self.id_data),
    )
    live: BoolProperty(
        name="Live",
        description=(
            "Build again on its own after each change to an interface or a setting, when the hand rests"
        ),
        update=changes.live_switched,
    )
    results: CollectionProperty(type=RealModelBlock)
    active_result: IntProperty(
        name="Active block",
        description="The row of the results; choosing one selects the block in the viewport",
        update=results.row_chosen,
    )
    warnings: StringProperty(options={"HIDDEN"})
    built_stamp: StringProperty(options={"HIDDEN"})
    collection: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    view: PointerProperty(type=props_view.RealModelView)


class RealModelActivity(bpy.types.PropertyGroup):
    """`window_manager.realmodel`: what goes on at the moment; not saved."""

    running: BoolProperty(options={"SKIP_SAVE"})
    progress: FloatProperty(
        name="Progress",
        description="How much of the build is done",
        subtype="PERCENTAGE",
        min=0.0,
        max=100.0,
        precision=0,
        options={"SKIP_SAVE"},
    )
    text: StringProperty(options={"SKIP_SAVE"})
    problem: StringProperty(options={"SKIP_SAVE"})
    problem_object: StringProperty(options={"SKIP_SAVE"})
    problem_triangles: StringProperty(options={"SKIP_SAVE"})
    problem_place: StringProperty(options={"SKIP_SAVE"})


_CLASSES = (
    *props_surface.CLASSES,
    *props_rock.CLASSES,
    *props_view.CLASSES,
    *props_stage.CLASSES,
    RealModelProperty,
    RealModelBlock,
    RealModelSettings,
    RealModelActivity,
)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.realmodel = PointerProperty(type=RealModelSettings, name="RealModel")
    bpy.types.WindowManager.realmodel = PointerProperty(type=RealModelActivity, name="RealModel")


def unregister():
    del bpy.types.WindowManager.realmodel
    del bpy.types.Scene.realmodel
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
