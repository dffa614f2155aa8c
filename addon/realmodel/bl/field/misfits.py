# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of data that the built model does not have as they say, and the way from each to its datum."""

import numpy as np

from ...core import RealModelError
from ...core.validation.misfits import misfits
from ..display import shown_models
from ..host import caches
from ..project import project_settings, settings
from . import data

MOST = 500  # rows of the list: the largest of each kind
_of_model = caches.of_model(misfits)


def shown(scene):
    """The core's Misfits of a scene's model; none where it has no model, or one without its project. Raises
    RealModelError."""
    if not len(scene.realmodel.results):
        return []
    return _asked(scene)(shown_models.whole(scene, None))


def _asked(scene):
    view = scene.realmodel.view
    tolerances = view.misfit_tolerance or None, view.dip_tolerance
    return lambda model: _of_model(model, *tolerances)


def ahead(scene):
    """What may be asked of a new model of a scene before it is shown: functions of it, for other threads."""
    return [_asked(scene)] if scene.realmodel.view.show_misfits else []


def fill(scene):
    """Fills the list anew, or empties it where it is not wanted."""
    group = scene.realmodel
    try:
        misfit_list = shown(scene) if group.view.show_misfits else []
    except RealModelError as error:
        group.view.message, misfit_list = str(error), []
    with settings.filling():
        group.misfits.clear()
        group.active_misfit = -1
        group.view.misfit_count = len(misfit_list)
        for misfit in _largest(misfit_list):
            row = group.misfits.add()
            row.kind, row.rock, row.name = misfit.kind, misfit.rock, misfit.name
            row.source = _source(scene, misfit)
            row.depth = "" if misfit.depth is None else f"{round(misfit.depth, 2):g}"
            row.says, row.has = misfit.says, misfit.has
            row.by = "" if misfit.by is None else f"{misfit.by:.3g}{'°' if misfit.kind == 'dip' else ''}"
            row.place = {} if misfit.place is None else {"values": misfit.place}
            row.hole = misfit.hole


def datum_of(scene, row):
    """The Datum that a row of the list speaks of; None where it has no place, or is not there any more."""
    if not row.place:
        return None
    place = row.place["values"]
    wanted = {"dip": data.DIPS, "point": (data.POINT, data.INTERVAL, data.PLACE)}
    kinds = wanted.get(row.kind, (data.INTERVAL, data.PLACE))
    best = None
    for group in data.groups(scene):
        if group.kind not in kinds or group.rock != row.rock:
            continue
        axes = 2 if group.kind in data.DIPS else 3
        starts = (group.places[:, :axes] == place[:axes]).all(axis=1)
        ends = starts | (group.ends == place).all(axis=1) if group.ends is not None else starts
        for matches, rank in ((starts & (group.names == row.name), 0), (starts, 1), (ends, 2)):
            number = next(iter(np.flatnonzero(matches).tolist()), None)
            if number is not None and (best is None or rank < best[0]):
                best = rank, group.datum(number)
    return None if best is None else best[1]


def _largest(all_misfits):
    """At most MOST, with some of each kind."""
    if len(all_misfits) <= MOST:
        return all_misfits
    kinds = list(dict.fromkeys(misfit.kind for misfit in all_misfits))
    return [e for kind in kinds for e in [e for e in all_misfits if e.kind == kind][: MOST // len(kinds)]]


def _source(scene, misfit):
    """Where a datum comes from: its hole, or its file and row."""
    if misfit.hole:
        return misfit.hole
    if misfit.row is None:
        return misfit.rock
    row = next(
        (s for r, s in settings.surface_rows(scene) if (r.name, s.name) == (misfit.rock, misfit.name)), None
    )
    path = project_settings.absolute(row.filepath) if row is not None and misfit.kind == "point" else None
    what = path.name if path is not None else "dip" if misfit.kind == "dip" else "row"
    return f"{what} {misfit.row + 1}"
