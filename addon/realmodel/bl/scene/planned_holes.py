# SPDX-License-Identifier: GPL-3.0-or-later
"""Planned holes: what they meet in the model of a scene, kept in their rows, and shown as tubes in the colors
of the blocks."""

import json
from dataclasses import astuple

import numpy as np

from ...core import HoleAxis, HoleContact, HoleInterval, PlannedHole, RealModelError
from .. import display
from ..display import bodies, colors, explosion
from ..host import caches
from ..objects import built_models, marks
from ..project import project_settings, settings

KIND = "planned"
_RADIUS = 0.006  # of the model's size
_AXIS = 0.002  # the same where it meets nothing
_SIDES = 10
_NOTHING = ("Planned hole", "#404040")


def collar(row):
    """[x, y, z] of the collar of a hole, model coordinates."""
    return row.collar["values"].tolist() if row.collar else [0.0, 0.0, 0.0]


def set_collar(row, place):
    row.collar = {"values": np.asarray(place, np.float64)}


def move_collar(row, place):
    """Moves the collar of a hole, and shows what it meets there."""
    set_collar(row, place)
    update(row.id_data, row)


def axis_of(row):
    """The core's HoleAxis of a row. Raises UsageError."""
    angles = (settings.number(row, key) for key in ("azimuth", "dip", "length"))
    return HoleAxis(tuple(collar(row)), *angles)


@caches.of_model
def _met(model, axis):
    return model.planned_hole(axis.collar, axis.azimuth, axis.dip, axis.length)


def ahead(scene):
    """As of `display.ahead`."""
    try:
        axes = [axis_of(row) for row in scene.realmodel.planned_holes]
    except RealModelError:
        return []  # their look-up tells
    return [lambda model, axis=axis: _met(model, axis) for axis in axes]


def update(scene, row):
    """Shows all holes. What this one meets is asked of the model, if that is in memory; if not, it is not
    known until the next build."""
    _look_up(scene, row)
    show(scene)


def update_all(scene):
    """The same for all holes: there is another model, or none."""
    for row in scene.realmodel.planned_holes:
        _look_up(scene, row)
    show(scene)


def begin_on_ground(row):
    """Moves the collar of a hole straight down to where it enters the rock."""
    hole = kept(row)
    if hole is not None and hole.intervals:
        x, y, z = collar(row)
        move_collar(row, (x, y, z - hole.intervals[0].begin))


def _look_up(scene, row):
    if is_current(scene, row):
        return
    row.result, row.shares = "", {}
    model = built_models.current(scene)
    if model is None:
        return
    try:
        keep(scene, row, _met(model, axis_of(row)))
    except RealModelError as error:
        scene.realmodel.view.message = str(error)


def is_current(scene, row):
    """Whether what is kept of a hole is what it meets in the model now."""
    return bool(row.result) and json.loads(row.result)["of"] == _of(scene, row)


def _of(scene, row):
    return [scene.realmodel.built_stamp, *collar(row), row.azimuth, row.dip, row.length]


def keep(scene, row, hole):
    """Keeps what a hole meets."""
    row.result = json.dumps(
        {
            "of": _of(scene, row),
            "unit": hole.unit,
            "remarks": hole.remarks,
            "names": hole.block_names,
            "properties": hole.properties,
            "intervals": [astuple(interval) for interval in hole.intervals],
            "contacts": [astuple(contact) for contact in hole.contacts],
        }
    )
    has_shares = hole.probability is not None
    row.shares = {"depths": hole.depths, "probability": hole.probability} if has_shares else {}


def kept(row):
    """The core's PlannedHole that a row keeps; None where it keeps none. Raises InputRefused for damaged
    arrays."""
    if not row.result:
        return None
    table = json.loads(row.result)
    return PlannedHole(
        axis_of(row),
        [HoleInterval(*fields) for fields in table["intervals"]],
        [HoleContact(*fields) for fields in table["contacts"]],
        table["names"],
        table["properties"],
        table["unit"],
        tuple(table.get("remarks", ())),
        **row.shares,
    )


def active(scene):
    """The row of the active planned hole, or None."""
    rows = scene.realmodel.planned_holes
    number = scene.realmodel.active_planned_hole
    return rows[min(max(number, 0), len(rows) - 1)] if len(rows) else None


def show(scene):
    """Shows the planned holes of a scene, in place of those that are shown."""
    bodies.remove(scene, KIND)
    if not (len(scene.realmodel.results) and len(scene.realmodel.planned_holes)):
        return
    low, high = explosion.bounds(scene)
    size = float(np.linalg.norm(high - low))
    for row in scene.realmodel.planned_holes:
        try:
            hole, axis = kept(row), axis_of(row)
        except RealModelError:
            continue
        met = [] if hole is None else hole.intervals
        parts = [(hole.properties[interval.block], interval.begin, interval.end) for interval in met]
        _show(scene, row.name, axis, parts, size)
    display.exaggeration_changed(scene)


def _show(scene, name, axis, parts, size):
    """The axis as a thin bar, and a tube for each part (property, from, to)."""
    ends = np.array([(0.0, axis.length), *((begin, end) for _, begin, end in parts)]).ravel()
    places = axis.places(ends) - project_settings.model_origin(scene)
    pairs = np.arange(len(places)).reshape(-1, 2)
    radii = size * np.where(pairs[:, 0] == 0, _AXIS, _RADIUS)
    body = bodies.add(scene, KIND, name, marks.lines(places, pairs, radii, _SIDES))
    body.show_in_front = True  # it begins on the ground: blocks hide all of it
    of_parts = [colors.of_property(scene, number) for number, *_ in parts]
    bodies.give_materials(body.data, [colors.plain_material(*_NOTHING), *of_parts], _SIDES)
