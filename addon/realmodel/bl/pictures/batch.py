# SPDX-License-Identifier: GPL-3.0-or-later
"""build_model.py inside Blender in background mode: scene, .blend file, render."""

import contextlib
import os
import sys
from pathlib import Path

import bpy

from ...core import OutputFailed
from ..objects import viewports
from ..scene import built_scene
from . import picture


def write_scene(model, project=None):
    """Put a model into the current scene, in place of an earlier one there.

    model: realmodel.core.Model. project: as for `built_scene.write_model`. The add-on must be registered.
    Where no .blend file was opened, what Blender's startup file brings along (its cube, light and camera)
    is taken out first; in an opened file other objects are left alone. The 3D viewports are turned to
    show the model.
    """
    scene = bpy.context.scene
    built_scene.write_model(scene, model, project)
    if not bpy.data.filepath:
        _remove_startup_objects(scene, scene.realmodel.collection)
    viewports.frame(scene, viewports.all_spaces())


def save_blend(path):
    """Write the current state to a .blend file, compressed. Raises OutputFailed."""
    try:
        with silenced_stdout():
            bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=True, check_existing=False)
    except RuntimeError as error:
        raise _failed(path, error) from error


def render(path, size=(1600, 1000), samples=picture.SAMPLES, time_limit=picture.TIME_LIMIT):
    """Render the model of the current scene to a PNG file.

    path: the file, whatever its ending. size: (width, height) in pixels. samples: rays per pixel.
    time_limit: seconds after which no more of them are begun, 0 for no limit.
    Returns by how much the heights were exaggerated; the scene and the file's other data stay as they are.
    Raises OutputFailed where there is nothing to see or the picture cannot be written.
    """
    if not Path(path).parent.is_dir():  # newer versions of Blender would make the folder
        raise OutputFailed(f"{path}: there is no folder {Path(path).parent}")
    try:
        with silenced_stdout():
            return picture.render_picture(bpy.context.scene, path, size, samples, time_limit)
    except RuntimeError as error:
        raise _failed(path, error) from error


@contextlib.contextmanager
def silenced_stdout():
    """Suppress Blender's own output (a line per sample of a render).

    Its errors are raised as RuntimeError, too.
    """
    sys.stdout.flush()
    saved_stdout = os.dup(1)
    try:
        with open(os.devnull, "wb") as sink:
            os.dup2(sink.fileno(), 1)
            yield
    finally:
        os.dup2(saved_stdout, 1)
        os.close(saved_stdout)


def _failed(path, error):
    """OutputFailed in one line: Blender's own messages bring a prefix and line breaks along."""
    reason = " ".join(str(error).removeprefix("Error:").split())
    return OutputFailed(f"{path}: {reason}")


def _remove_startup_objects(scene, project):
    """Remove every object and collection of the scene that does not belong to the model."""
    keep = {obj.name for obj in project.all_objects}
    for obj in list(bpy.data.objects):
        if obj.name not in keep:
            bpy.data.objects.remove(obj)
    for collection in list(scene.collection.children):
        if collection != project:
            bpy.data.collections.remove(collection)
    for store in (bpy.data.meshes, bpy.data.lights, bpy.data.cameras, bpy.data.materials):
        for datablock in [datablock for datablock in store if not datablock.users]:
            store.remove(datablock)
