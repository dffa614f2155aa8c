# SPDX-License-Identifier: GPL-3.0-or-later
"""The active datum: an empty stands at its place, and where that is moved, the datum goes too."""

import bpy
import numpy as np

from ...core import RealModelError
from ...core.validation.misfits import attitude_text
from .. import display
from ..display import bodies
from ..host.debounce import DebouncedJob
from ..objects import exaggeration, model_tree, viewports, visible
from ..project import project_settings
from ..scene import data_objects, live
from . import data, edits, heights, misfits

KIND = "datum"  # of a body
_SIZE = 0.02  # of the extent of all data
_FRAMED = 0.15  # of it, around a datum that is jumped to
REST_SECONDS = 0.03  # pause after a movement before the data are shown anew


def active(scene):
    """The active datum, or None."""
    return data.Datum.of_text(scene.realmodel.view.datum)


def item_of(scene):
    """The object at the active datum, or None."""
    return next(iter(bodies.listed(scene, KIND)), None)


def activate(context, datum, jumps=False):
    """Makes a datum the active one; its object is selected alone. jumps: turns the viewport there. Raises
    InputRefused where the datum is not there any more."""
    scene = context.scene
    edits.find(scene, datum)
    empty = item_of(scene)
    if empty is None:
        empty = bpy.data.objects.new("Datum", None)
        empty[bodies.KIND], empty[model_tree.TAG] = KIND, "view"
        empty.empty_display_type = "SPHERE"
        empty.show_in_front, empty.hide_render = True, True
        bodies.view_collection(scene).objects.link(empty)
        display.exaggeration_changed(scene)
    scene.realmodel.view.datum = datum.text()
    empty.name = datum.hole or datum.name
    empty.empty_display_size = _SIZE * heights.extent(scene)
    _stand(scene, empty, datum)
    if context.mode == "OBJECT":
        context.view_layer.update()
        visible.select_alone(context, empty)
    if jumps:
        show(context)


def show(context):
    """Turns the viewport to the active datum."""
    empty = item_of(context.scene)
    if empty is None:
        return
    context.view_layer.update()
    _look_at(context, exaggeration.world_matrix(empty).translation)


def _look_at(context, place):
    viewports.look_at(context, place, _FRAMED * heights.extent(context.scene))


def show_misfit(context):
    """Turns the viewport to the active row of the list of misfits, and makes its datum the active one."""
    scene = context.scene
    row = scene.realmodel.misfits[scene.realmodel.active_misfit]
    datum = misfits.datum_of(scene, row)
    if datum is not None:
        activate(context, datum)
    if row.place:
        _look_at(context, project_settings.in_world(scene, row.place["values"])[0])


def text_of(scene, datum):
    """A datum in one line."""
    x, y, z = datum.place
    at = f"({x:,.1f}, {y:,.1f}{'' if z != z else f', {z:,.1f}'})"
    where = f"hole {datum.hole}, " if datum.hole else ""
    attitude = ""
    if datum.kind in data.DIPS:
        group, number = edits.find(scene, datum)
        attitude = f" {attitude_text(group.normals[number])}"
    of = f" of {datum.name}" if datum.name else ""
    return f"{where}{datum.kind}{attitude}{of} at {at}"


def clear(scene):
    """No datum is active any more."""
    scene.realmodel.view.datum = ""
    empty = item_of(scene)
    if empty is not None:
        bpy.data.objects.remove(empty)
        bodies.remove_collection_if_empty(scene)


def follow(scene):
    """The object stands where its datum is, after the datum was changed elsewhere; without one it is gone."""
    datum, empty = active(scene), item_of(scene)
    if datum is None or empty is None:
        return
    try:
        group, number = edits.find(scene, datum)
    except RealModelError:
        clear(scene)
        return
    scene.realmodel.view.datum = group.datum(number).text()
    _stand(scene, empty, group.datum(number))


def changed(scene, names):
    """What has these names, as of `display.evaluated`, was changed: where the object was moved, its datum is
    too."""
    empty = item_of(scene) if scene.realmodel.view.datum else None
    if empty is not None and (True, empty.name_full) in names:
        take_place(scene)


def take_place(scene):
    """Moves the active datum to its object, where that stands elsewhere."""
    empty, datum = item_of(scene), active(scene)
    now = exaggeration.true_matrix(empty)[:3, 3]
    if np.array_equal(np.float32(now), np.float32(_offset(scene, datum))):
        return
    try:
        moved = edits.move(scene, datum, now + project_settings.model_origin(scene))
    except RealModelError:
        clear(scene)
        return
    scene.realmodel.view.datum = moved.text()
    live.touch(scene)
    _work.touch(scene.name)


def stop():
    _work.stop()


def _stand(scene, empty, datum):
    empty.location = _offset(scene, datum)


def _offset(scene, datum):
    """(3,) the place of a datum relative to the scene's origin; heights that are not known are given one."""
    place = np.array(datum.place)
    if np.isnan(place[2]):
        place[2] = heights.of_dips(scene, datum.rock, np.array([datum.name]), place[None])[0]
    return place - project_settings.model_origin(scene)


def _begin(name, _changed_at):
    scene = bpy.data.scenes.get(name)
    if scene is not None:
        data_objects.update(scene)


_work = DebouncedJob(lambda: REST_SECONDS, _begin, lambda *_: None)
