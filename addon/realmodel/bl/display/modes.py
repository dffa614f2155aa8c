# SPDX-License-Identifier: GPL-3.0-or-later
"""The six display modes: which of the model's objects are in sight, and how each is drawn.

mode        what is in sight                               drawn by
POINTS      vertices of blocks or interfaces               `drawing`, in renders `render_marks`
LINES       edges of blocks or interfaces                  likewise
AREAS       faces of blocks or interfaces with their edges Blender, wires over the faces
SURFACES    the interfaces, smooth                         Blender
POLYHEDRA   the single cells, each a little smaller        Blender, bodies of kind "cells"
BLOCKS      the blocks, or their cut halves                Blender
"""

import json

from ...core import RealModelError, polygon_mesh
from .. import project_settings, settings
from . import bodies, cells, cuts, shown_models, stages
from .visible import WANTED, want

WIRE = "realmodel_wire"  # on an object whose wires the view has switched on
SEE_THROUGH = "realmodel_see_through"  # on an interface that is drawn as wires because blocks are in sight
DRAWN = ("POINTS", "LINES")
_WITH_SUBJECT = ("POINTS", "LINES", "AREAS")


def apply(scene, mode, stage):
    """Shows a scene's model, which is at a stage, in a display mode."""
    view = scene.realmodel.view
    subject = view.subject
    if mode == "POLYHEDRA":
        try:
            _make_cells(scene, stage)
        except RealModelError as error:
            view.message = str(error)
    else:
        bodies.remove(scene, bodies.CELLS)
        view.cells_of = ""
    surviving = {}
    if mode == "SURFACES" and view.surfaces == "SURVIVING":
        try:
            surviving = _make_surviving(scene, stage)
        except RealModelError as error:
            view.message = str(error)
    else:
        bodies.remove(scene, bodies.SURVIVING)
        view.surviving_of = ""
    cell_bodies = bodies.of_kind(scene, bodies.CELLS)
    halves = bodies.of_kind(scene, bodies.CUT)
    cut = cuts.is_shown(scene)
    with_blocks, with_interfaces = shown_kinds(mode, subject)
    solid = mode in ("BLOCKS", "AREAS")
    for row in scene.realmodel.results:
        here = stages.present(row) and not is_hidden(scene, row)
        rendered = here and with_blocks and solid
        want(scene, row.object, here and with_blocks and solid and not cut, rendered and not cut)
        half = halves.get(row.object)
        want(scene, half, here and with_blocks and solid and cut, rendered and cut)
        want(scene, cell_bodies.get(row.object), here, here)
        for item in (row.object, half):
            _wires(item, mode == "AREAS")
    shown = with_interfaces and mode not in DRAWN and view.surviving_of == ""
    _interfaces(scene, shown, mode == "AREAS", with_blocks)
    for _, surface in settings.surface_rows(scene):
        want(scene, surviving.get(surface.interface), not surface.hide, not surface.hide)


def shown_kinds(mode, subject):
    """(whether blocks are in sight, whether interfaces are)."""
    if mode in _WITH_SUBJECT:
        return subject != "INTERFACES", subject != "BLOCKS"
    return mode != "SURFACES", mode == "SURFACES"


def shows_something(scene):
    """Whether anything of the model is in sight."""
    blocks, interfaces = shown_kinds(scene.realmodel.display, scene.realmodel.view.subject)
    rows = [row for row in scene.realmodel.results if stages.present(row) and not is_hidden(scene, row)]
    surfaces = [
        surface for _, surface in settings.surface_rows(scene) if not surface.hide and surface.interface
    ]
    return bool((blocks and rows) or (interfaces and surfaces))


def drawn(scene, mode=None):
    """The objects whose points or lines are drawn, in the modes that Blender does not draw itself. mode:
    where it is not the one of the settings."""
    group = scene.realmodel
    mode = mode or group.display
    if mode not in DRAWN:
        return []
    with_blocks, with_interfaces = shown_kinds(mode, group.view.subject)
    found = []
    if with_blocks:
        halves = bodies.of_kind(scene, bodies.CUT) if cuts.is_shown(scene) else None
        for row in group.results:
            if stages.present(row) and not is_hidden(scene, row):
                found.append(row.object if halves is None else halves.get(row.object))
    if with_interfaces:
        rows = settings.surface_rows(scene)
        found += [surface.interface for _, surface in rows if not surface.hide]
    return [item for item in found if item is not None and item.type == "MESH"]


def body_of(scene, row):
    """The object that a block is to be seen as: itself, or its cut half (None: it was taken off)."""
    return bodies.of_kind(scene, bodies.CUT).get(row.object) if cuts.is_shown(scene) else row.object


def _see_through(item, wanted):
    """Draws an interface as wires where blocks are in sight too, whoever shows it: it lies on their faces,
    and the two would flicker. One that the user draws otherwise than solid is left as it is."""
    if item is None or item.library is not None:
        return
    if wanted and item.display_type == "TEXTURED":
        item.display_type = "WIRE"
        item[SEE_THROUGH] = True
    elif not wanted and SEE_THROUGH in item:
        if item.display_type == "WIRE":
            item.display_type = "TEXTURED"
        del item[SEE_THROUGH]


def _interfaces(scene, shown, wires, beside_blocks):
    for rock in scene.realmodel.rocks:
        if rock.interfaces is not None and rock.interfaces.library is None:
            hidden = not shown
            if rock.interfaces.hide_render != hidden:
                rock.interfaces.hide_render = hidden
        for surface in rock.surfaces:
            want(scene, surface.interface, shown and not surface.hide, not surface.hide)
            _wires(surface.interface, wires)
            _see_through(surface.interface, beside_blocks)


def _wires(item, wanted):
    if item is None or item.library is not None:
        return
    if wanted and not item.show_wire:
        item.show_wire = item.show_all_edges = True
        item[WIRE] = True
    elif not wanted and WIRE in item:
        item.show_wire = item.show_all_edges = False
        del item[WIRE]


def _make_cells(scene, stage):
    """A body for each block's cells, or for those of its half."""
    group = scene.realmodel
    made_of = cells.made_of(scene, stage)
    if group.view.cells_of == made_of and bodies.of_kind(scene, bodies.CELLS):
        return
    shapes = cells.of_scene(scene, stage)
    rows = {(row.rock, row.name): row.object for row in group.results}
    bodies.put(scene, bodies.CELLS, [(rows[key], shape) for key, shape in shapes.items() if rows.get(key)])
    group.view.cells_of = made_of
    cells.forget()


def _make_surviving(scene, stage):
    """What is left of each interface, or of its half: {interface: body}."""
    view = scene.realmodel.view
    made_of = cells.made_of(scene, stage)
    if view.surviving_of != made_of:
        half = cuts.known_half(view.cut) if cuts.is_shown(scene) else None
        model = half or shown_models.at_stage(scene, stage)
        shapes = polygon_mesh.of_surfaces(model, project_settings.model_origin(scene))
        names = [(rock.name, surface.name) for rock in model.project.rocks for surface in rock.surfaces]
        named = dict(zip(names, shapes, strict=False))  # a stage has fewer surfaces
        pairs = [
            (row.interface, named.get((rock.name, row.name))) for rock, row in settings.surface_rows(scene)
        ]
        bodies.put(scene, bodies.SURVIVING, [pair for pair in pairs if None not in pair])
        view.surviving_of = made_of
    return bodies.of_kind(scene, bodies.SURVIVING)


def without_blocks(scene):
    """Shows the interfaces alone, as ordinary objects: the blocks are gone."""
    for _, surface in settings.surface_rows(scene):
        item = surface.interface
        if item is not None and item.library is None:
            item.pop(WANTED, None)
            want(scene, item, not surface.hide, not surface.hide)
            let_go(item)


def let_go(item):
    """Draws an interface as Blender does of its own accord."""
    _wires(item, False)
    _see_through(item, False)


def needs_cells(scene, mode, stage):
    """Whether a display mode shows cells that are not in the scene yet."""
    if mode != "POLYHEDRA":
        return False
    is_there = scene.realmodel.view.cells_of == cells.made_of(scene, stage)
    return not (is_there and bodies.of_kind(scene, bodies.CELLS))


def hidden_properties(scene):
    """The property IDs whose blocks are hidden."""
    text = scene.realmodel.view.hidden
    return set(json.loads(text)) if text else set()


def hide_properties(scene, ids):
    scene.realmodel.view.hidden = json.dumps(sorted(ids)) if ids else ""


def is_hidden(scene, row):
    return row.property_id in hidden_properties(scene)
