# SPDX-License-Identifier: GPL-3.0-or-later
"""The stereonet of the dips of a scene: of all, of a name, or of those that were picked in the viewport."""

import json
from contextlib import suppress

import numpy as np

from ...core import InputRefused, RealModelError, Stereonet, UsageError
from ...core.base.algebra import norm
from ...core.results.orientations.axes import projected
from ...core.results.orientations.stereonet import (
    EQUAL_ANGLE,
    EQUAL_AREA,
    DipSet,
    dip_names,
    normals_of,
)
from ..project import surface_dips
from . import data, edits

NET_ITEMS = (
    (EQUAL_AREA.upper(), "Equal Area (Schmidt)", "Equal areas, so densities can be compared"),
    (EQUAL_ANGLE.upper(), "Equal Angle (Wulff)", "Equal angles: circles stay circles"),
)
_NEAR = 0.1  # of the radius of a net, between the mouse and a pole, at most


def _rows(scene):
    """(row, names of what all of its dips are of, whether it is a fault)."""
    for rock in scene.realmodel.rocks:
        yield rock, (rock.name,), False
        yield from ((row, (rock.name, row.name), False) for row in rock.series)
        for row in rock.surfaces:
            yield row, (rock.name, row.name, *([row.series] if row.series else [])), False
    yield from ((row, (row.name,), True) for row in scene.realmodel.faults)


def are_there(scene):
    return any(row.dips for row, _, _ in _rows(scene))


def _sets(scene):
    sets = []
    for row, *more in _rows(scene):
        with suppress(RealModelError):  # damaged arrays, which a build refuses
            sets += [DipSet(surface_dips.of_row(row), *more)] if row.dips else []
    return sets


def names(scene):
    """Whatever some dips of a scene are of."""
    return dip_names(_sets(scene))


def shown_dips(scene, of=""):
    """The Stereonet of the dips of a scene that are of a name; of an empty one those that were picked, else
    all but those of faults. Raises UsageError where there are none."""
    dips = picked(scene)
    if of or not dips:
        name = of or scene.realmodel.name or "Dips"
        return Stereonet(normals_of(_sets(scene), of or None), name)
    return Stereonet(np.array([normal_of(scene, datum) for datum in dips]), "Picked dips")


def beside_the_model(scene):
    """The Stereonet that is shown beside the model; None where none is, or of a name without dips."""
    view = scene.realmodel.view
    with suppress(UsageError):
        return shown_dips(scene, view.stereonet_of) if view.show_stereonet and are_there(scene) else None
    return None


def pick(scene, dips):
    """Has the stereonet of a scene show these dips alone (a list of Datum); of an empty list, all again."""
    scene.realmodel.view.picked_dips = json.dumps([datum.text() for datum in dips]) if dips else ""


def picked(scene):
    """The dips that were picked and are in use."""
    texts = json.loads(scene.realmodel.view.picked_dips or "[]")
    dips = [data.Datum.of_text(text) for text in texts]
    return [datum for datum in dips if normal_of(scene, datum) is not None]


def are_picked(scene, group):
    """(N,) bool: the dips of a Group that the stereonet has, where it shows picked ones; else all."""
    view = scene.realmodel.view
    dips = set(json.loads(view.picked_dips or "[]")) if view.show_stereonet else ()
    if not dips:
        return np.ones(len(group.places), bool)
    return np.array([group.datum(n).text() in dips for n in range(len(group.places))])


def normal_of(scene, datum):
    """The normal (3,) of a datum, of length 1; None of what is no dip, or not in use any more."""
    with suppress(InputRefused):
        group, number = edits.find(scene, datum)
        if group.kind in data.DIPS and group.used[number]:
            return group.normals[number] / norm(group.normals[number])
    return None


def marked(scene):
    """The pole (3,) of the active datum; None where it is no dip."""
    datum = data.Datum.of_text(scene.realmodel.view.datum)
    return None if datum is None else normal_of(scene, datum)


def datum_at(scene, place):
    """The Datum of the shown pole nearest to a place (2,) in the net, whose radius is 1; None where none is
    near."""
    normals = beside_the_model(scene).normals
    away = norm(projected(normals, scene.realmodel.view.net.lower() == EQUAL_AREA) - place)
    if away.min() > _NEAR:
        return None
    pole, best = normals[away.argmin()], (np.inf, None)
    for group in data.groups(scene, data.DIPS):
        units = group.normals / norm(group.normals)[:, None]
        differences = np.where(group.used, norm(units - pole), np.inf)
        number = int(differences.argmin())
        best = min(best, (differences[number], group.datum(number)), key=lambda entry: entry[0])
    return best[1]


def key(scene):
    """What the stereonet of a scene follows from."""
    view = scene.realmodel.view
    digests = [row.dips.digest for row, _, _ in _rows(scene) if row.dips]
    named = [str(of) for _, *of in _rows(scene)]
    shown = view.stereonet_of, view.net, view.picked_dips, view.datum, scene.realmodel.name
    return *shown, *map(str, digests), *named
