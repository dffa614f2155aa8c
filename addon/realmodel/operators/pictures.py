# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures and animations of the model: light and camera, turntable, stages."""

import math

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty

from ..bl import overlay
from ..bl.display import viewpoints
from ..bl.objects.viewports import CAMERA_ELEVATION
from ..bl.pictures import animation, capture, first_picture, picture
from .reporting import Reporting, a_model, a_model_or_beds
from .start import invoke


def _size(scene):
    return scene.render.resolution_x, scene.render.resolution_y


def by_hand(operator):
    """Whether an operator was called from the panel or a menu, or again by the panel of the last one, not by
    a script."""
    return operator.options.is_invoke or operator.options.is_repeat


def set_up_first(scene):
    """Sets up light and camera for the model or the beds of a scene where nobody has cared for them. Returns
    whether it did."""
    is_seen = bpy.context.scene == scene and len(viewpoints.model_points(scene, cut=True)) > 0
    if not is_seen or not first_picture.is_free(scene):
        return False
    bpy.ops.realmodel.set_up_picture(view="MODEL")
    first_picture.keep(scene)
    return True


class REALMODEL_OT_set_up_picture(Reporting, bpy.types.Operator):
    """Add a camera, sun, sky and ground for the model and choose the renderer, so that Render Image (F12)
    gives a good picture. Earlier ones of RealModel are replaced, your own cameras and lights stay"""

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
        description="Height of the sun above the horizon; the light of a low one is warm",
        default=picture.SUN_ELEVATION,
        min=math.radians(2.0),
        max=0.5 * math.pi,
        subtype="ANGLE",
    )

    def act(self, context):
        scene = context.scene
        view = capture.viewport(context) if self.view == "VIEWPORT" and not bpy.app.background else None
        picture.set_up(
            scene,
            viewpoints.model_points(scene, cut=True),
            _size(scene),
            None if view is None else view[2],
            legend=overlay.legend_shares(scene, _size(scene)),
            sun=(self.sun_azimuth, self.sun_elevation),
        )
        picture.choose_renderer(scene, picture.SAMPLES, picture.TIME_LIMIT)


class REALMODEL_OT_turntable(Reporting, bpy.types.Operator):
    """Set up light and camera, and have the camera go around the model once. Render Animation (Ctrl-F12)
    writes it; an earlier turntable is replaced"""

    bl_label = "Turntable"
    needs = (a_model_or_beds,)

    frames: IntProperty(name="Frames", description="Frames of one turn", default=120, min=2, soft_max=1000)
    elevation: FloatProperty(
        name="Elevation",
        description="Height of the camera above the horizon, seen from the model",
        default=CAMERA_ELEVATION,
        min=0.0,
        max=math.radians(85.0),
        subtype="ANGLE",
    )

    def act(self, context):
        scene = context.scene
        legend = overlay.legend_shares(scene, _size(scene))
        points = viewpoints.model_points(scene, cut=True)
        animation.turntable(scene, points, _size(scene), self.frames, self.elevation, legend)
        picture.choose_renderer(scene, picture.SAMPLES, picture.TIME_LIMIT)
        self.report({"INFO"}, f"Frames {scene.frame_start} to {scene.frame_end}")


class REALMODEL_OT_animate_stages(Reporting, bpy.types.Operator):
    """Set keyframes of the stage from the oldest rock to the whole model. Keyframes that the stage has are
    replaced. Switches on Lock Interface in the menu Render, which their renders need"""

    bl_label = "Animate Stages"
    needs = (a_model,)

    frames: IntProperty(
        name="Frames per Stage", description="How long each stage is shown", default=12, min=1, soft_max=240
    )

    def act(self, context):
        scene = context.scene
        count = animation.animate_stages(scene, self.frames)
        self.report({"INFO"}, f"{count} stages, frames {scene.frame_start} to {scene.frame_end}")


class REALMODEL_OT_render_picture(Reporting, bpy.types.Operator):
    """Render the model with its camera; where the scene has none, set up light and camera first"""

    bl_label = "Render Picture"
    needs = (a_model_or_beds,)

    def act(self, context):
        if context.scene.camera is None:
            invoke(bpy.ops.realmodel.set_up_picture, self)
        how = "EXEC_DEFAULT" if bpy.app.background else "INVOKE_DEFAULT"  # with a window it stays alive
        bpy.ops.render.render(how)
