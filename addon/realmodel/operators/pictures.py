# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures and animations of the model: light and camera, turntable, stages."""

import math

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..bl import overlay
from ..bl.display import viewpoints
from ..bl.objects.viewports import CAMERA_ELEVATION
from ..bl.pictures import animation, capture, first_picture, picture
from ..bl.project import library_rows, project_settings, settings
from ..bl.shading import look_assets, looks, weathering
from ..core import InputRefused
from ..core.base.errors import counted
from .baking import rocks
from .reporting import Reporting, a_library, a_model, a_model_or_beds
from .start import invoke


def _size(scene):
    return scene.render.resolution_x, scene.render.resolution_y


def by_hand(operator):
    """Whether an operator was called from the panel or a menu, or again by the panel of the last one, not by
    a script."""
    return operator.options.is_invoke or operator.options.is_repeat


def set_up_first(scene):
    """Sets up light and camera for the model or the beds of a scene where the user has set up none. Returns
    whether it did."""
    is_seen = bpy.context.scene == scene and len(viewpoints.model_points(scene, cut=True)) > 0
    if not is_seen or not first_picture.is_free(scene):
        return False
    bpy.ops.realmodel.set_up_picture(view="MODEL")
    first_picture.keep(scene)
    return True


class _Lit(Reporting):
    """Sets up light and camera, and changes what all of the scene shares only by this box."""

    scene_settings: BoolProperty(
        name="Scene Settings",
        description="Replace the world by a sky, choose the render engine, and show colors without a view "
        "transform. On by default only if the scene has no light, camera, world, engine or object of its own",
        options={"SKIP_SAVE"},
    )

    def changes_scene(self, scene):
        """Whether the box is on; one that nobody has set is on in an empty scene."""
        if not self.properties.is_property_set("scene_settings"):
            self.scene_settings = first_picture.is_empty(scene)
        return self.scene_settings


class REALMODEL_OT_set_up_picture(_Lit, bpy.types.Operator):
    """Add a camera, a sun and a ground for the model, for Render Image (F12). They replace earlier ones of
    RealModel. World, render engine and view transform change only if Scene Settings is on"""

    bl_label = "Light and Camera"
    needs = (a_model_or_beds,)

    view: EnumProperty(
        name="View",
        description="View direction of the camera",
        items=(
            ("VIEWPORT", "Viewport", "As the viewport does"),
            ("MODEL", "Whole Model", "From the southeast, at the whole model"),
        ),
    )
    sun_azimuth: FloatProperty(
        name="Sun Azimuth",
        description="Direction of the sun, clockwise from north (+Y)",
        default=picture.SUN_AZIMUTH,
        min=0.0,
        max=2.0 * math.pi,
        subtype="ANGLE",
    )
    sun_elevation: FloatProperty(
        name="Sun Elevation",
        description="Angle of the sun above the horizon. A low sun gives warm light",
        default=picture.SUN_ELEVATION,
        min=math.radians(2.0),
        max=0.5 * math.pi,
        subtype="ANGLE",
    )

    def act(self, context):
        scene = context.scene
        with_scene = self.changes_scene(scene)
        view = capture.viewport(context) if self.view == "VIEWPORT" and not bpy.app.background else None
        picture.set_up(
            scene,
            viewpoints.model_points(scene, cut=True),
            _size(scene),
            None if view is None else view[2],
            legend=overlay.legend_shares(scene, _size(scene)),
            sun=(self.sun_azimuth, self.sun_elevation),
            with_sky=with_scene,
        )
        if with_scene:
            picture.choose_renderer(scene, picture.SAMPLES, picture.TIME_LIMIT)


class REALMODEL_OT_turntable(_Lit, bpy.types.Operator):
    """Set up light and camera, and make the camera go around the model once. Replaces an earlier turntable.
    Render Animation (Ctrl F12) renders it"""

    bl_label = "Turntable"
    needs = (a_model_or_beds,)

    frames: IntProperty(name="Frames", description="Frames of one turn", default=120, min=2, soft_max=1000)
    elevation: FloatProperty(
        name="Elevation",
        description="Angle of the camera above the horizon, seen from the model",
        default=CAMERA_ELEVATION,
        min=0.0,
        max=math.radians(85.0),
        subtype="ANGLE",
    )

    def act(self, context):
        scene = context.scene
        legend = overlay.legend_shares(scene, _size(scene))
        points = viewpoints.model_points(scene, cut=True)
        with_scene = self.changes_scene(scene)
        animation.turntable(scene, points, _size(scene), self.frames, self.elevation, legend, with_scene)
        if with_scene:
            picture.choose_renderer(scene, picture.SAMPLES, picture.TIME_LIMIT)
        self.report({"INFO"}, f"Frames {scene.frame_start} to {scene.frame_end}")


class REALMODEL_OT_animate_stages(Reporting, bpy.types.Operator):
    """Set keyframes of the stage from the oldest rock to the whole model; they replace earlier keyframes of
    the stage. Enables Lock Interface in the menu Render, which their renders need"""

    bl_label = "Animate Stages"
    needs = (a_model,)

    frames: IntProperty(
        name="Frames per Stage", description="Duration of each stage", default=12, min=1, soft_max=240
    )

    def act(self, context):
        scene = context.scene
        count = animation.animate_stages(scene, self.frames)
        self.report({"INFO"}, f"{count} stages, frames {scene.frame_start} to {scene.frame_end}")


class REALMODEL_OT_render_picture(Reporting, bpy.types.Operator):
    """Render the model with the camera of the scene. If there is none, set up light and camera first"""

    bl_label = "Render Picture"
    needs = (a_model_or_beds,)

    def act(self, context):
        if context.scene.camera is None:
            invoke(bpy.ops.realmodel.set_up_picture, self)
        how = "EXEC_DEFAULT" if bpy.app.background else "INVOKE_DEFAULT"  # with a window it stays alive
        bpy.ops.render.render(how)


class REALMODEL_OT_rock_looks(Reporting, bpy.types.Operator):
    """Give the materials of the library's rocks a look: procedural textures that follow the layers"""

    bl_label = "Rock Looks"
    needs = (a_library,)

    look: EnumProperty(
        name="Look",
        description="Appearance of the rocks in rendered pictures",
        items=looks.ITEMS,
    )
    only_active: BoolProperty(
        name="Active Only", description="Only the active property of the library; otherwise all"
    )
    scale: FloatProperty(
        name="Scale",
        description="Size of the texture. 1 fits the model",
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


class REALMODEL_OT_weathering(Reporting, bpy.types.Operator):
    """Weather the selected blocks, or all, for pictures. A modifier changes their appearance; the exact
    blocks do not change"""

    bl_label = "Weathering"
    needs = (a_model_or_beds,)

    strength: FloatProperty(
        name="Strength",
        description="Strength of the erosion. At 1 soft beds recede by about half the mean thickness of beds",
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
        description="Wear of edges in the materials, without a finer mesh. Cycles also rounds them. At 1 a "
        "tenth of the mean thickness of beds",
        default=0.5,
        min=0.0,
        soft_max=3.0,
    )
    noise_scale: FloatProperty(
        name="Noise Scale",
        description="Size of hollows and of eroded layers. 1 fits the thickness of beds",
        default=1.0,
        min=0.001,
        soft_max=10.0,
    )
    seed: IntProperty(name="Seed", description="Other hollows", min=0)
    grass_slope: FloatProperty(
        name="Grass Slope",
        description="Steepest slope with grass. 0: none",
        subtype="ANGLE",
        default=math.radians(28.0),
        min=0.0,
        max=math.pi / 2,
    )
    scree_slope: FloatProperty(
        name="Scree Slope",
        description="Steepest slope with scree. 0: none",
        subtype="ANGLE",
        default=math.radians(40.0),
        min=0.0,
        max=math.pi / 2,
    )
    detail: IntProperty(
        name="Detail",
        description="Number of subdivisions of each exposed polygon, fewer if Most Faces is exceeded. Each "
        "makes four of one",
        default=2,
        min=0,
        max=weathering.FINEST,
    )
    most_faces: IntProperty(
        name="Most Faces",
        description="Exposed polygons after subdivision. If Detail makes more, it is lowered",
        default=1_500_000,
        min=1,
        soft_min=10_000,
        soft_max=20_000_000,
    )

    adaptive: BoolProperty(
        name="Adaptive to Camera",
        description="Fewer subdivisions far from the scene camera, one less at each doubling of the "
        "distance, so that Most Faces allows more near it",
    )
    plants: FloatProperty(
        name="Plants and Stones",
        description="Density of tufts on grass and stones on scree, as instances. 1 fits the model. 0: none",
        default=0.0,
        min=0.0,
        soft_max=4.0,
    )
    made: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def draw(self, _context):
        self.layout.use_property_split = True
        for key in type(self).__annotations__:
            if key != "made":
                self.layout.prop(self, key)
        self.layout.label(text=self.made)

    def act(self, context):
        values = (self.strength, self.rounding, self.noise_scale, self.seed)
        covers = (self.grass_slope, self.scree_slope)
        items = rocks(context)
        camera = context.scene.camera if self.adaptive else None
        if self.adaptive and camera is None:
            raise InputRefused("the scene has no camera", advice="add one, or switch Adaptive to Camera off")
        detail, faces, size, near = weathering.cost(items, self.detail, self.most_faces, camera)
        parameters = weathering.Weathering(*values, *covers, detail, self.plants, self.wear, near)
        weathering.put_on(context.scene, items, parameters)
        lowered = f", as Most Faces does not allow {self.detail}" if detail < self.detail else ""
        self.made = f"{weathering.cost_text(faces, size)}, Detail {detail}{lowered}"
        self.report({"INFO"}, f"Weathered {counted(len(items), 'block')}: {self.made}")


class REALMODEL_OT_weathering_remove(Reporting, bpy.types.Operator):
    """Remove the weathering of the selected blocks, or of all"""

    bl_label = "Remove Weathering"
    needs = (a_model_or_beds,)

    def act(self, context):
        items = [obj for obj in rocks(context) if weathering.modifier_of(obj) is not None]
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
