# SPDX-License-Identifier: GPL-3.0-or-later
"""The display of a built model: display modes, stage, exploded view, colors, cut.

Input: a built model, the settings of the view. Output: what the viewport shows. Each setting calls one
function of this module when it changes; the build calls `built` and `cleared`. Nothing here changes the
model: see docs/guide/tour.md, "View".

shown_models   the model at a stage, from the core
stages         the blocks' shapes at a stage
modes          the six display modes
bodies, cells  objects that are only for viewing
drawing        points and lines; render_marks: the same in a final render
explosion      the blocks moved apart
colors        the meaning of the colors
ensembles      the section of an ensemble
fields         the field of a series: on the face of the cut, and as level sets
cuts, sections the movable plane; sections as mesh objects
preparing      long work, in a thread
viewpoints     the view directions of the viewports
coordinates    the block, property and thickness under the cursor
"""

import json

import bpy

from ...core import RealModelError
from ..objects import exaggeration
from ..objects.model_tree import TAG
from ..project import settings
from . import (
    bodies,
    colors,
    coordinates,
    cuts,
    drawing,
    ensembles,
    explosion,
    fields,
    modes,
    preparing,
    render_marks,
    replacing,
    residuals,
    shades,
    shown_models,
    stages,
)

_field = None  # see show_field_with
_STRETCHED = (TAG, settings.DATA, settings.IMAGE)  # on objects that are shown with vertical exaggeration
_SHAPES = (bpy.types.Object, bpy.types.Mesh, bpy.types.Curve)  # what models are made from
_ANIMATED = ("stage", "explode", "explode_direction", "display", "color_by")


def register():
    """Called when the add-on is enabled."""
    cuts.show_with(mode_changed)
    preparing.show_with(show_all)
    fields.show_with(exaggeration_changed)
    drawing.handler.register()


def unregister():
    """Called when the add-on is disabled; removes all draw handlers."""
    drawing.handler.unregister()
    stop()


def stop():
    """Stops all work: another file was opened, or the add-on is disabled."""
    cuts.stop()
    preparing.stop()
    fields.stop()
    replacing.stop()


def forget_meshes():
    """Clears the caches of data read from meshes."""
    drawing.forget()
    coordinates.forget()


def show_all(scene):
    """Updates the whole display from the settings."""
    _show(scene, **{key: getattr(scene.realmodel, key) for key in _ANIMATED})


def opened():
    """A .blend was opened, or a step undone: updates the display, which may not have been complete when it
    was saved."""
    for scene in bpy.data.scenes:
        group = scene.realmodel
        different = {
            key: getattr(group, key)
            for key, value in _applied(scene).items()
            if key in _ANIMATED and getattr(group, key) != value
        }
        if different:
            _show(scene, **different)


def mode_changed(scene):
    """The display mode was changed, or a surface or property hidden or shown, or the cut is another one."""
    if _field is not None:
        _field.follow_cut(scene)
    fields_changed(scene)
    _show(scene, display=scene.realmodel.display)


def stage_changed(scene):
    """The stage was changed."""
    _show(scene, stage=scene.realmodel.stage)
    fields_changed(scene)


def explode_changed(scene):
    """The blocks moved apart, farther or less."""
    group = scene.realmodel
    _show(scene, explode=group.explode, explode_direction=group.explode_direction)


def exaggeration_changed(scene):
    """The vertical is stretched more, or less; or there are other objects that are to be."""
    if _field is not None:
        _field.follow_exaggeration(scene)
    items = [obj for obj in scene.objects if any(key in obj for key in _STRETCHED)]
    exaggeration.apply(scene, [*items, cuts.plane_of(scene)], explosion.bounds(scene)[0][2])
    residuals.follow_exaggeration(scene)


def residuals_changed(scene):
    """The residuals of points are wanted, or not; or there is another model."""
    try:
        if scene.realmodel.view.show_residuals and len(scene.realmodel.results):
            residuals.show(scene)
        else:
            residuals.hide(scene)
    except RealModelError as error:
        scene.realmodel.view.message = str(error)
    exaggeration_changed(scene)


def field_changed(scene):
    """Other field data are to be shown, or the data are others; or there is another model."""
    if scene.library is None and _field is not None:
        _field.show(scene)
        exaggeration_changed(scene)


def fields_changed(scene):
    """Other parts of the field of a series are to be shown, or the cut or the model is another one."""
    if scene.library is not None:
        return
    try:
        fields.show(scene)
    except RealModelError as error:
        scene.realmodel.view.message = str(error)
    exaggeration_changed(scene)


def show_field_with(shown):
    """Sets what shows field data: show(scene), with ahead(scene) as here; follow_exaggeration(scene) shapes
    them anew, follow_cut(scene) those on the section plane."""
    global _field
    _field = shown


def ahead(scene):
    """What may be asked of a new model of a scene before it is shown: functions of it, for other threads."""
    return residuals.ahead(scene) + ([] if _field is None else _field.ahead(scene))


def ensemble_changed(scene):
    """The coloring of the ensemble's section, or its realization, was changed."""
    try:
        ensembles.recolor(scene)
    except RealModelError as error:
        scene.realmodel.view.message = str(error)


def colors_changed(scene):
    """The coloring, or a color in the library, was changed."""
    _show(scene, color_by=scene.realmodel.color_by)


def section_changed(scene):
    """The section plane is another one, or the cut is wanted or not wanted."""
    if not cuts.is_on(scene):
        cuts.take_off(scene)
        mode_changed(scene)
    else:
        try:
            cuts.refresh(scene)
        except RealModelError as error:
            scene.realmodel.view.message = str(error)
        mode_changed(scene)


def built(scene, bounds, stage=None):
    """A model was built anew: `built_models.current(scene)` has it. bounds: lowest and highest coordinates of
    its blocks, (3,) each. stage: the stage that is shown, where it was made with the model: (number, model,
    shapes)."""
    made = [row.object for row in scene.realmodel.results]
    made += [surface.interface for _, surface in settings.interface_rows(scene)]
    for layer in scene.view_layers:
        if any(obj is not None and obj.name not in layer.objects for obj in made):
            layer.update()  # or it would show all new objects when it learns of them
    forget_meshes()
    shown_models.forget()
    if stage is not None:
        shown_models.remember_stage(scene, *stage)
    explosion.set_bounds(scene, *bounds)
    group = scene.realmodel
    group.view.cells_of = group.view.surviving_of = ""
    if group.view.show_residuals:
        residuals_changed(scene)
    field_changed(scene)
    fields_changed(scene)
    whole = group.stage >= settings.last_stage(scene)
    _show(scene, whole, **{key: getattr(group, key) for key in _ANIMATED})


def release(item):
    """An interface is one no more: it is drawn as any object."""
    modes.release(item)


def cleared(scene):
    """The blocks are gone."""
    forget_meshes()
    for kind in (bodies.CELLS, bodies.SURVIVING):
        bodies.remove(scene, kind)
    scene.realmodel.view.surviving_of = ""
    residuals.hide(scene)
    field_changed(scene)
    cuts.take_off(scene)
    fields_changed(scene)
    colors.forget(scene)
    modes.without_blocks(scene)
    exaggeration_changed(scene)
    scene.realmodel.view.applied = ""


def frame_changed(scene, depsgraph=None):
    """The frame of an animation was changed: keyframed settings have changed without their callbacks.
    depsgraph: the evaluated one; while an animation is rendered only that one has their values."""
    if not len(scene.realmodel.results):
        return
    evaluated = scene if depsgraph is None else scene.evaluated_get(depsgraph)
    before = _applied(scene)
    now = {key: getattr(evaluated.realmodel, key) for key in _ANIMATED}
    different = {key: value for key, value in now.items() if before.get(key) != value}
    if different:
        _show(scene, **different)
    try:
        if cuts.follow(scene, depsgraph):
            _show(scene, display=now["display"])
    except RealModelError as error:
        scene.realmodel.view.message = str(error)


def render_begins(scene):
    """A render begins: from now on no data may be freed that the renderer may use."""
    replacing.remove_leftovers()
    replacing.begin_render()
    if len(scene.realmodel.results) and scene.library is None:
        render_marks.put(scene, scene.realmodel.display)


def render_ends(scene):
    """The render is complete or cancelled."""
    if scene.library is None:
        bodies.remove(scene, bodies.MARKS)
    replacing.end_render()


def undone():
    """After undo and redo: the objects are those of another state."""
    opened()
    for scene in bpy.data.scenes:
        if scene.library is not None:
            continue
        if len(scene.realmodel.results):
            colors.apply(scene)
        if cuts.is_on(scene):
            cuts.touch(scene)


def evaluated(depsgraph):
    """(whether it is an object, its name) of all that Blender has evaluated with another shape or place.
    Cached data of meshes are outdated then."""
    names = set()
    for update in depsgraph.updates:
        datablock = update.id.original
        if isinstance(datablock, bpy.types.Mesh) and update.is_updated_geometry:
            drawing.forget({datablock.name_full})
            coordinates.forget({datablock.name_full})
        if isinstance(datablock, _SHAPES) and (update.is_updated_geometry or update.is_updated_transform):
            names.add((isinstance(datablock, bpy.types.Object), datablock.name_full))
    return names


def changed(scene, names):
    """What has these names, as of `evaluated`, was changed."""
    if cuts.is_on(scene) and (True, scene.realmodel.view.plane.name_full) in names:
        cuts.touch(scene)


def _applied(scene):
    text = scene.realmodel.view.applied
    return json.loads(text) if text else {}


def _show(scene, has_shapes=False, **wanted):
    """Updates the display for all settings, or for some that can be animated, by their names. has_shapes: the
    blocks have the shapes of the stage already."""
    group = scene.realmodel
    if not len(group.results) or scene.library is not None:
        return
    replacing.remove_leftovers()
    group.view.message = ""
    now = {key: getattr(group, key) for key in _ANIMATED} | _applied(scene) | wanted
    stage = now["stage"] if "stage" in wanted and not has_shapes else None
    try:
        if ("display" in wanted or "stage" in wanted) and preparing.lacks(scene, stage, now["display"]):
            return  # and comes here again when it has been made
        if stage is not None:
            stages.show(scene, stage)
            forget_meshes()
        if "stage" in wanted and cuts.is_on(scene):
            cuts.refresh(scene, now["stage"])
    except RealModelError as error:
        group.view.message = str(error)
        return
    moved = "explode" in wanted or "explode_direction" in wanted or "stage" in wanted
    apart = now["explode"] if now["explode_direction"] == "COMPARTMENT" else 0.0
    if moved:
        explosion.apply(scene, now["explode"], now["explode_direction"])
    if "display" in wanted or "stage" in wanted or (moved and (apart or group.view.cells_of)):
        modes.apply(scene, now["display"], now["stage"], apart)
        if replacing.is_rendering():
            render_marks.put(scene, now["display"])
    if "color_by" in wanted or "stage" in wanted or (moved and apart) or now["color_by"] in shades.IN_MESH:
        colors.apply(scene)
        colors.shade_viewports(now["color_by"], _applied(scene))
    if not replacing.is_rendering():
        exaggeration_changed(scene)
    group.view.applied = json.dumps({key: now[key] for key in _ANIMATED})
