# SPDX-License-Identifier: GPL-3.0-or-later
"""Cross-validation by holes: the model without each hole, made in a thread; its table, and the way from each
row to the hole."""

import json

import numpy as np

from ...core.validation.left_out_holes import validated_holes
from ..display import shown_models
from ..host.thread_job import ThreadJob
from ..objects import viewports
from ..project import borehole_picks, project_settings, settings
from . import heights

_NOTHING = 1e-6  # of the length of a hole: an error that is none
_FRAMED = 0.15  # of all data, at least, around a hole that is jumped to


class HoleValidationJob(ThreadJob):
    """Leaves holes out of the model of a scene in so many groups; folds: None: each by itself, in at most 20.
    `finish()` puts the table into the scene and returns the core's HoleValidation, or raises what went wrong
    and leaves the scene as it was."""

    def __init__(self, scene, folds=None):
        """Raises InputRefused."""
        self._folds = folds
        self._request = shown_models.StageRequest(scene, settings.last_stage(scene))

    def _work(self, job):
        with job.part(0.0, shown_models.BUILT):
            model = self._request.make()
        with job.part(shown_models.BUILT, 1.0):
            return validated_holes(job, model, self._folds)

    def _put(self, validation):
        scene = self._request.scene()
        self._request.keep()
        _fill(scene.realmodel, validation)
        return validation


def _fill(group, validation):
    """The table: the holes that the others tell least of come first."""
    with settings.filling():
        group.left_out_holes.clear()
        group.active_left_out_hole = -1
        group.hole_validation = json.dumps({"stamp": group.built_stamp, "summary": validation.summary()})
        for result in sorted(validation.holes, key=_goodness):
            row = group.left_out_holes.add()
            row.name, row.rock, row.refused = result.hole, result.rock, result.refused
            row.share = "" if result.share is None else f"{100.0 * result.share:.0f}"
            errors = np.abs(result.errors)
            row.error = f"{float(errors.max()):.3g}" if len(errors) else ""
            contacts = [(one.surface, one.depth, one.error) for one in result.contacts]
            row.detail = json.dumps({"length": result.length, "contacts": contacts})


def _goodness(hole):
    worst = float(np.abs(hole.errors).max(initial=0.0))
    return not hole.refused, 1.0 if hole.share is None else hole.share, -worst


def summary(group):
    """What was found in one line; empty where nothing was asked yet."""
    return json.loads(group.hole_validation)["summary"] if group.hole_validation else ""


def is_outdated(group):
    """Whether the table is of another model than the present one."""
    return bool(group.hole_validation) and json.loads(group.hole_validation)["stamp"] != group.built_stamp


def clear(group):
    """Removes the table."""
    with settings.filling():
        group.left_out_holes.clear()
        group.hole_validation = ""


def lines(row):
    """What is known of a hole, as sentences: a row of the table."""
    if row.refused:
        yield f"Without it there are no surfaces: {row.refused}"
        return
    detail = json.loads(row.detail)
    if row.share:
        yield f"{row.share} % of {detail['length']:.5g} logged are in the right block"
    for surface, depth, error in detail["contacts"]:
        where = "" if depth is None else f" at {depth:.5g}"
        if error is None:
            yield f"{surface}{where}: no surface there"
        elif abs(error) < _NOTHING * detail["length"]:
            yield f"{surface}{where}: met"
        else:
            yield f"{surface}{where}: {abs(error):.3g} too {'high' if error > 0 else 'low'}"


def show(context):
    """Turns the viewport to the hole of the active row, and shows the boreholes with their names."""
    group = context.scene.realmodel
    row = group.left_out_holes[group.active_left_out_hole]
    rock = next((rock for rock in group.rocks if rock.name == row.rock), None)
    if rock is not None:
        show_hole(context, rock, row.name)


def show_hole(context, rock, hole):
    """The same for a hole of the row of a rock mass; whether it has a place."""
    scene, group = context.scene, context.scene.realmodel
    line = borehole_picks.named_paths(rock).get(hole)
    if line is None:
        return False
    group.view.show_boreholes = group.view.show_hole_names = True
    places = project_settings.in_world(scene, line)
    size = max(_FRAMED * heights.extent(scene), 0.6 * float(np.linalg.norm(np.ptp(places, axis=0))))
    viewports.look_at(context, places.mean(axis=0), size)
    return True
