# SPDX-License-Identifier: GPL-3.0-or-later
"""The field of a series in the view: in bands of color on the face of the cut, and as level sets; one scale
for both. They are made in a thread while a window would wait."""

import json

import bpy
import numpy as np

from ...core import Cancelled, RealModelError
from ...core.base import work
from ...core.display.field_shapes import field_levels, field_range, field_section, field_surfaces
from ...core.display.polygon_mesh import PolygonMesh
from ...core.drawing import color_scale
from ...core.drawing.overlay import ColorKey
from ...core.project.looks import hex_color
from ..host.debounce import DebouncedJob
from ..host.threads import threads
from ..objects import viewports
from ..objects.origin import offsets_from
from ..project import project_settings
from . import bodies, colors, cuts, explosion, replacing, shown_models

SECTION, LEVELS = "field section", "field levels"  # kinds of bodies
_STEPS = 15  # of the color scale: each is a material, which all ways of shading show
_AWAY = 2e-3  # of the model's size: of the section from the face of the cut, against flickering


def series(scene):
    """The names of the series with fields."""
    return [row.name for rock in scene.realmodel.rocks for row in rock.series if row.kind == "field"]


def shown_series(scene):
    """The name of the series whose field is shown; empty where there is none."""
    names, wanted = series(scene), scene.realmodel.view.field_series
    return wanted if wanted in names else next(iter(names), "")


def show(scene):
    """Shows what is wanted of the field of a scene, in place of what is shown: at once in background mode,
    else after it was made."""
    view = scene.realmodel.view
    wanted = _state(scene)
    for kind, is_wanted in ((SECTION, wanted["plane"]), (LEVELS, wanted["levels"])):
        if not is_wanted:
            bodies.remove(scene, kind)
    if not (wanted["plane"] or wanted["levels"]):
        view.field_of = ""
        colors.remove_unused()
    elif view.field_of == json.dumps(wanted) and all(
        bodies.listed(scene, kind) for kind, key in ((SECTION, "plane"), (LEVELS, "levels")) if wanted[key]
    ):
        return
    elif replacing.must_finish_now():
        _take(scene, _begun(scene, wanted).result())
    else:
        _work.touch(scene.name)


def key(scene):
    """The core's ColorKey of the field, or None where none is shown."""
    if not (bodies.listed(scene, SECTION) or bodies.listed(scene, LEVELS)):
        return None
    low, high = scene.realmodel.view.field_limits
    if not high > low:
        return None
    names = json.loads(scene.realmodel.view.field_surfaces or "[]")
    # Limits are 32-bit numbers: a surface at the end of the range is within them as such a number.
    surfaces = tuple((name, value) for name, value in names if low <= np.float32(value) <= high)
    return ColorKey(f"Field of {shown_series(scene)}", limits=(low, high), colors=_colors(), names=surfaces)


def is_working(scene):
    """Whether the field is being made for a scene."""
    return _work.is_working(scene.name)


def stop():
    """Stops the running jobs."""
    _work.stop()


def _state(scene):
    """What the bodies are made from: plane, levels and series, where they are wanted."""
    group, name = scene.realmodel, shown_series(scene)
    is_there = bool(len(group.results) and name)
    plane = None
    if is_there and group.view.show_field_section and cuts.is_shown(scene):
        plane = json.loads(group.view.cut)[:2]
    levels = group.view.field_levels if is_there and group.view.show_field_levels else 0
    return {
        "plane": plane,
        "levels": levels,
        "series": name,
        "stamp": group.built_stamp,
        "stage": group.stage,
    }


def _begun(scene, wanted):
    """A job that makes the shapes; its result is what `_take` takes."""
    request = shown_models.StageRequest(scene, wanted["stage"])

    def task(_):
        model, name = request.make(), wanted["series"]
        limits = field_range(model, name)
        edges = np.linspace(*limits, _STEPS + 1)[1:-1]
        section = None
        if wanted["plane"]:
            section = field_section(model, name, model.section(*wanted["plane"], threads=threads()), edges)
        values = np.linspace(*limits, 2 * wanted["levels"] + 1)[1::2]  # in the middles of as many bands
        levels = field_levels(model, name, values) if wanted["levels"] else None
        return wanted, request, (limits, field_surfaces(model, name)), section, levels

    return work.start(task, threads())


def _take(scene, made):
    wanted, request, (limits, surfaces), section, levels = made
    request.keep()
    view = scene.realmodel.view
    view.field_limits, view.field_surfaces = limits, json.dumps(surfaces)
    view.field_of = json.dumps(wanted)
    for kind in (SECTION, LEVELS):
        bodies.remove(scene, kind)
    if section is not None:
        away = _AWAY * float(np.linalg.norm(np.subtract(*explosion.bounds(scene))))
        _put(scene, SECTION, section[0] + away * np.array(wanted["plane"][1]), section[1])
    if levels is not None:
        band = (levels[1] + 0.5) * _STEPS / wanted["levels"]
        _put(scene, LEVELS, levels[0], np.minimum(band.astype(np.int64), _STEPS - 1))
    colors.remove_unused()


def _put(scene, kind, places, bands):
    """Adds a body of triangles (T, 3, 3) in the colors of their bands (T,)."""
    if not len(places):
        return
    vertices, corners = np.unique(places.reshape(-1, 3), axis=0, return_inverse=True)
    offsets = np.arange(0, 3 * len(places) + 1, 3, dtype=np.int32)
    local = offsets_from(project_settings.model_origin(scene), vertices)
    shape = PolygonMesh(local, offsets, corners.ravel().astype(np.int32))
    body = bodies.add(scene, kind, f"{shown_series(scene)} {kind}", shape)
    codes = [hex_color(color) for color in _colors()[:, :3].tolist()]
    for code in codes:
        body.data.materials.append(colors.plain_material(f"Scale {code}", code))
    body.data.polygons.foreach_set("material_index", bands.astype(np.int32))
    body.data.update()


def _colors():
    return color_scale.colors(np.linspace(0.0, 1.0, _STEPS), (0.0, 1.0))


def _begin(name, _changed_at):
    scene = bpy.data.scenes.get(name)
    if scene is None:
        return None
    wanted = _state(scene)
    try:
        return _begun(scene, wanted) if wanted["plane"] or wanted["levels"] else None
    except RealModelError as error:
        _tell(scene, error)
        return None


def _finish(name, job, _changed_at):
    scene = bpy.data.scenes.get(name)
    if scene is None:
        return
    try:
        made = job.result()
        if made[0] == _state(scene):  # else another one is on its way
            _take(scene, made)
            _show(scene)
    except Cancelled:
        return
    except RealModelError as error:
        _tell(scene, error)
    viewports.redraw()


def _tell(scene, error):
    scene.realmodel.view.message = str(error)


def show_with(show):
    """Sets show(scene), which is called when the field was made in the background."""
    global _show
    _show = show


_show = None
_work = DebouncedJob(lambda: 0.0, _begin, _finish)
