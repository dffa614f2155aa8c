# SPDX-License-Identifier: GPL-3.0-or-later
"""Field data as bodies: contacts as points and dips as discs in the colors of their surfaces, what is
switched off in gray, what does not fit in red."""

import functools
import sys

import numpy as np

from ...core import RealModelError
from ...core.display.polygon_mesh import PolygonMesh
from ...core.results.sections.section_holes import near_plane
from .. import display
from ..display import bodies, colors, cuts
from ..objects import exaggeration, marks
from ..project import project_settings, settings
from . import boreholes, data, handle, heights, hole_curves, map_settings, misfits, shown_net

MAP, CONTACTS, DIPS, MISFITS = "map", "contacts", "dips", "misfits"
KINDS = (CONTACTS, DIPS, MISFITS)  # shaped for the exaggeration
_OFF, _RED = ("Switched Off", "#8c8c8c"), ("Misfit", "#e01818")
_NOT_PICKED = ("Not Picked", "#d9d9d9")
_STRETCH = "realmodel_stretch"  # on an object: the vertical exaggeration that it is shaped for
_MOST = 20_000  # data of a kind shown at most
_LIFT = 1e-3  # of a map over the ground, of the size of all, against flickering
_DISC = 0.025  # radius of a disc, of the size of all
_LARGER = 1.6  # contacts than vertices of a model, so that they are seen from far
_RED_LARGER = 1.6 * _LARGER  # so that they are seen around contacts
_TUBE, _SIDES = 0.009, 8  # of an interval that does not fit: radius, of the size of all


def register():
    """Called when the add-on is enabled."""
    display.show_field_with(sys.modules[__name__])


def unregister():
    """Called when the add-on is disabled."""
    handle.stop()


ahead = misfits.ahead


def show(scene):
    """Shows what is wanted of the field data of a scene, in place of what is shown."""
    view = scene.realmodel.view
    misfits.fill(scene)
    _show_near_cut(scene)
    _show(scene, (MAP, view.show_map, _maps), (MISFITS, view.show_misfits, _misfits))


def _show(scene, *kinds):
    """kinds: a kind of bodies, whether it is wanted, and what makes it."""
    for kind, wanted, shown in kinds:
        bodies.remove(scene, kind)
        if wanted:
            try:
                shown(scene)
            except RealModelError as error:
                scene.realmodel.view.message = str(error)
        for body in bodies.listed(scene, kind):
            body[_STRETCH] = exaggeration.factor(scene)


def _show_near_cut(scene):
    """Shows what a cut leaves only near the section plane."""
    view = scene.realmodel.view
    _show(
        scene,
        (boreholes.BOREHOLES, view.show_boreholes, boreholes.show),
        (hole_curves.CURVES, hole_curves.is_wanted(scene), hole_curves.show),
        (CONTACTS, view.show_contacts, _contacts),
        (DIPS, view.show_dips, _dips),
    )
    view.holes_on = _cut(scene)


def follow_exaggeration(scene):
    """Shapes the bodies for the vertical exaggeration of the scene."""
    shown = [body for kind in KINDS for body in bodies.listed(scene, kind)]
    if any(body.get(_STRETCH) != exaggeration.factor(scene) for body in shown):
        show(scene)


def follow_cut(scene):
    """Shows holes, contacts and dips on the section plane, where that has moved."""
    view = scene.realmodel.view
    is_any = view.show_boreholes or view.show_contacts or view.show_dips
    if is_any and view.holes_on != _cut(scene):
        _show_near_cut(scene)
        display.exaggeration_changed(scene)


def _cut(scene):
    """The state of the cut that they lie on; empty where they stand in their places."""
    return scene.realmodel.view.cut if boreholes.is_on_cut(scene) else ""


def _near_cut(scene, places):
    """The numbers of places (N, 3) that are shown, and where they are: all of them in their places or, on a
    cut, those near the section plane, on it."""
    if not (boreholes.is_on_cut(scene) and len(places)):
        return np.arange(len(places)), places
    view = scene.realmodel.view
    indices, on_plane, _ = near_plane(places, places, cuts.plane_in_model(scene), view.hole_width)
    return indices, on_plane


def _contacts(scene):
    """Points of surfaces, contacts that follow from logs, and observed places."""
    places, materials = [], []
    material_of = _materials(scene)
    for group in data.groups(scene):
        if group.kind in data.DIPS:
            continue
        places.append(group.places[:_MOST])
        materials += map(material_of, group.names[:_MOST].tolist(), group.used[:_MOST].tolist())
    indices, places = _near_cut(scene, np.concatenate([np.empty((0, 3)), *places]))
    _add_points(scene, CONTACTS, "Contacts", places, [materials[n] for n in indices.tolist()], _LARGER)


def _materials(scene):
    """A function that gives the material of a name as of `_property_ids`, or of what is switched off; each is
    looked for once."""
    of_block = _property_ids(scene)
    of_used = functools.cache(lambda name: colors.of_property(scene, of_block.get(name, 0)))
    of_off = functools.cache(lambda: colors.plain_material(*_OFF))
    return lambda name, is_used: of_used(name) if is_used else of_off()


def _property_ids(scene):
    """{name of a surface, of its block, of a body, or of a series: its property}; of a series that of its
    youngest surface."""
    of_series = {row.series: row.property_id for _, row in settings.surface_rows(scene) if row.series}
    rows = [*(row for _, row in settings.surface_rows(scene)), *scene.realmodel.bodies]
    return of_series | {
        name: row.property_id for row in rows for name in (row.name, getattr(row, "block", "") or row.name)
    }


def _add_points(scene, kind, name, places, materials, larger=1.0):
    if not len(places):
        return None
    stretch = exaggeration.factor(scene)
    shape = marks.spaced_points(
        places - project_settings.model_origin(scene), larger * heights.extent(scene), stretch
    )
    body = bodies.add(scene, kind, name, shape)
    bodies.give_materials(body.data, materials, len(shape.offsets) // len(places))
    return body


def _dips(scene):
    places, normals, materials = [], [], []
    material_of = _materials(scene)
    for group in data.groups(scene):
        if group.kind not in data.DIPS:
            continue
        at, names = group.places[:_MOST].copy(), group.names[:_MOST]
        at[:, 2] = heights.of_dips(scene, group.rock, names, at)
        places.append(at)
        normals.append(group.normals[:_MOST])
        of_group = map(material_of, names.tolist(), group.used[:_MOST].tolist())
        are_picked = shown_net.are_picked(scene, group).tolist()
        materials += [
            material if is_picked else colors.plain_material(*_NOT_PICKED)
            for material, is_picked in zip(of_group, are_picked, strict=False)
        ]
    indices, places = _near_cut(scene, np.concatenate([np.empty((0, 3)), *places]))
    if not len(indices):
        return
    places = places - project_settings.model_origin(scene)
    radius = _DISC * heights.extent(scene)
    shape = marks.discs(places, np.concatenate(normals)[indices], radius, exaggeration.factor(scene))
    body = bodies.add(scene, DIPS, "Dips", shape)
    edges = [colors.dark()] * (marks.DISC_FACES - 1)
    bodies.give_materials(body.data, [part for n in indices.tolist() for part in (materials[n], *edges)], 1)


def _maps(scene):
    of_block = _property_ids(scene)
    lift = np.array([0.0, 0.0, _LIFT * heights.extent(scene)])
    for rock in scene.realmodel.rocks:
        draped = map_settings.of_rock(rock)
        if draped is None or not len(draped.triangles):
            continue
        places = np.array(draped.vertices, np.float64)
        places[:, 2] = heights.over_the_ground(scene, rock.name, places)
        places += lift - project_settings.model_origin(scene)
        corners = draped.triangles.ravel().astype(np.int32)
        offsets = np.arange(0, len(corners) + 1, 3, dtype=np.int32)
        shape = PolygonMesh(places.astype(np.float32), offsets, corners)
        body = bodies.add(scene, MAP, f"{rock.name} map", shape)
        unit_materials = [
            colors.of_property(scene, of_block[name]) if name in of_block else colors.plain_material(*_OFF)
            for name in draped.names
        ]
        bodies.give_materials(body.data, [unit_materials[unit] for unit in draped.unit.tolist()], 1)


def _misfits(scene):
    shown = misfits.shown(scene)
    places = np.array([misfit.place for misfit in shown if misfit.place is not None][:_MOST]).reshape(-1, 3)
    places = np.unique(places, axis=0)  # several may speak of one place
    red = colors.plain_material(*_RED)
    body = _add_points(scene, MISFITS, "Misfits", places, [red] * len(places), _RED_LARGER)
    if body is not None:
        body.show_in_front = True  # also where blocks are in front of it
    ends = [end for misfit in shown if misfit.end is not None for end in (misfit.place, misfit.end)]
    if not ends:
        return
    places = np.array(ends) - project_settings.model_origin(scene)
    pairs = np.arange(len(places)).reshape(-1, 2)
    shape = marks.lines(places, pairs, _TUBE * heights.extent(scene), _SIDES)
    body = bodies.add(scene, MISFITS, "Misfits of Intervals", shape)
    body.show_in_front = True
    body.data.materials.append(red)
