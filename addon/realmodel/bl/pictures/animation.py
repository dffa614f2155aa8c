# SPDX-License-Identifier: GPL-3.0-or-later
"""Animations of a model: the camera goes around it, or its stages follow one another.

Both are keyframes that can be edited and removed as any others. What was made here before is replaced. An
animation is as long as the longer of the two, and a turn that is shorter is repeated.
"""

import math

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ...core.project.project import ROCK
from ..host import versions
from ..objects.viewports import view_rotation
from ..project import method_settings, settings
from . import picture

_STAGE = "realmodel.stage"
_SECTORS = 32  # of the circles that the camera is to see


def turntable(scene, points, size, frames, elevation, legend=(0.0, 0.0), with_sky=True):
    """Sets up camera and light, and rotates the camera around a model once, counter-clockwise from above.

    points: (N, 3) that the picture is to show. size: (width, height) of the picture. frames: of one turn.
    elevation: of the camera, radians. legend, with_sky: as for `picture.set_up`. Returns the empty that
    rotates.
    """
    camera = picture.set_up(scene, points, size, legend=legend, with_sky=with_sky)
    points = np.asarray(points, np.float64)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    rotation = view_rotation(elevation=elevation)
    turned = _turned(points, middle)
    left = picture.left_of_points(turned, size, legend, rotation)
    camera.data.shift_x = -left / 2 * size[0] / max(size)
    camera.matrix_basis, away = picture.camera_matrix(turned, size, left, rotation)
    camera.data.clip_end = max(camera.data.clip_end, 10.0 * away)
    pivot = bpy.data.objects.new("RealModel Turntable", None)
    pivot[picture.KEY] = picture.TURNTABLE
    pivot.location = middle
    pivot.empty_display_size = 0.1 * float(np.linalg.norm(np.ptp(points, axis=0)))
    scene.collection.objects.link(pivot)
    camera.parent = pivot
    camera.matrix_parent_inverse = Matrix.Translation(-Vector(middle))
    for frame, angle in ((1, 0.0), (1 + frames, 2.0 * math.pi)):
        pivot.rotation_euler.z = angle
        pivot.keyframe_insert("rotation_euler", index=2, frame=frame)
    pivot.rotation_euler.z = 0.0
    curve = versions.curves(pivot).find("rotation_euler", index=2)
    for point in curve.keyframe_points:
        point.interpolation = "LINEAR"
    curve.modifiers.new("CYCLES")
    _set_range(scene, frames)
    return pivot


def _turned(points, middle):
    """(N, 3): the circles around the upright axis through `middle` that points go along as they turn, for
    some heights."""
    heights = np.linspace(points[:, 2].min(), points[:, 2].max(), 9)
    away = np.linalg.norm(points[:, :2] - middle[:2], axis=1)
    at = np.abs(points[:, 2, None] - heights).argmin(axis=1)
    radius = np.zeros(len(heights))
    np.maximum.at(radius, at, away)
    angles = np.linspace(0.0, 2.0 * math.pi, _SECTORS, endpoint=False)
    # a corner of the polygon is where the circle is no more than touched by its sides
    radius /= math.cos(math.pi / _SECTORS)
    rings = radius[:, None, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    return np.column_stack([(middle[:2] + rings).reshape(-1, 2), heights.repeat(_SECTORS)])


def animate_stages(scene, frames):
    """Sets keyframes of the stage: each is shown for some frames, beginning with the oldest that has rock.
    Other keyframes of the stage are removed. Returns the number of stages."""
    first = 0 if _has_base(scene) else 1
    last = max(settings.last_stage(scene), first)
    curves = versions.curves(scene)
    before = None if curves is None else curves.find(_STAGE)
    if before is not None:
        curves.remove(before)
    shown = scene.realmodel.stage
    with settings.filling():
        for number, stage in enumerate(range(first, last + 1)):
            scene.realmodel.stage = stage
            scene.keyframe_insert(_STAGE, frame=1 + number * frames)
        scene.realmodel.stage = shown
    for point in versions.curves(scene).find(_STAGE).keyframe_points:
        point.interpolation = "CONSTANT"
    count = last + 1 - first
    scene.render.use_lock_interface = True  # the window must not draw meshes while a render changes them
    _set_range(scene, frames * count)
    scene.frame_set(scene.frame_end)  # the whole model, as it was
    return count


def _has_base(scene):
    rows = scene.realmodel.rocks
    return any(method_settings.value(row, "base_elevation", ROCK) is not None for row in rows)


def _set_range(scene, frames):
    """Sets the length of the animation: this number of frames, or the length of the other kind if that is
    longer."""
    curves = versions.curves(scene)
    stages = None if curves is None else curves.find(_STAGE)
    ends = [frames]
    if stages is not None:
        at = [point.co[0] for point in stages.keyframe_points]
        ends.append(round(2 * at[-1] - at[-2]) - 1 if len(at) > 1 else round(at[-1]))
    pivot = picture.turntable_of(scene)
    if pivot is not None and versions.curves(pivot) is not None:
        turn = versions.curves(pivot).find("rotation_euler", index=2)
        ends.append(round(turn.keyframe_points[-1].co[0]) - 1)
    scene.frame_start, scene.frame_end = 1, max(ends)
