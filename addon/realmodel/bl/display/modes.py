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

from ...core import RealModelError
from ...core.display import polygon_mesh
from ..objects.visible import WANTED, want
from ..project import compartments, project_settings, settings
from . import bodies, cells, cuts, shown_models, stages

WIRE = "realmodel_wire"  # on an object whose wires the view has switched on
SEE_THROUGH = "realmodel_see_through"  # on an interface that is drawn as wires because blocks are visible
DRAWN = ("POINTS", "LINES")
_WITH_SUBJECT = ("POINTS", "LINES", "AREAS")


def apply(scene, mode, stage, apart=0.0):
    """Shows a scene's model, which is at a stage, in a display mode. apart: the factor by which its
    compartments are moved apart."""
    view = scene.realmodel.view
    subject = view.subject
    apart = apart if has_parts(scene, mode, apart) else 0.0
    if mode == "POLYHEDRA" or apart:
        try:
            _make_cells(scene, stage, mode, apart)
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
        shown = here and with_blocks and solid
        part, half = cell_bodies.get(row.object), halves.get(row.object)
        whole = shown and not cut and not (apart and part)
        want(scene, row.object, whole, rendered and whole)
        halved = shown and cut and not (apart and part)
        want(scene, half, halved, rendered and halved)
        want(scene, part, here if mode == "POLYHEDRA" else shown, here if mode == "POLYHEDRA" else shown)
        for obj in (row.object, half, part):
            _wires(obj, mode == "AREAS")
    shown = with_interfaces and mode not in DRAWN and view.surviving_of == ""
    _interfaces(scene, shown, mode == "AREAS", with_blocks)
    for _, surface in settings.interface_rows(scene):
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
        surface for _, surface in settings.interface_rows(scene) if not surface.hide and surface.interface
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
    objects = []
    if with_blocks:
        halves = bodies.of_kind(scene, bodies.CUT) if cuts.is_shown(scene) else None
        halves = bodies.of_kind(scene, bodies.CELLS) or halves  # parts that were moved apart
        for row in group.results:
            if stages.present(row) and not is_hidden(scene, row):
                objects.append(row.object if halves is None else halves.get(row.object))
    if with_interfaces:
        rows = settings.interface_rows(scene)
        objects += [surface.interface for _, surface in rows if not surface.hide]
    return [obj for obj in objects if obj is not None and obj.type == "MESH"]


def apart_shown(scene):
    """The factor by which compartments are moved apart in the display; 0 where they are not."""
    group = scene.realmodel
    apart = group.explode if group.explode_direction == "COMPARTMENT" else 0.0
    shown = has_parts(scene, group.display, apart) and bodies.of_kind(scene, bodies.CELLS)
    return apart if shown else 0.0


def body_of(scene, row):
    """The object that a block is to be seen as: itself, its cut half, or its parts moved apart (None: it was
    taken off)."""
    if apart_shown(scene):
        return bodies.of_kind(scene, bodies.CELLS).get(row.object)
    return bodies.of_kind(scene, bodies.CUT).get(row.object) if cuts.is_shown(scene) else row.object


def _see_through(obj, wanted):
    """Draws an interface as wires where blocks are visible, too: it coincides with their faces, and the two
    would flicker. One that the user does not display as solid is left unchanged."""
    if obj is None or obj.library is not None:
        return
    if wanted and obj.display_type == "TEXTURED":
        obj.display_type = "WIRE"
        obj[SEE_THROUGH] = True
    elif not wanted and SEE_THROUGH in obj:
        if obj.display_type == "WIRE":
            obj.display_type = "TEXTURED"
        del obj[SEE_THROUGH]


def _interfaces(scene, shown, wires, beside_blocks):
    group = scene.realmodel
    for collection in (*(rock.interfaces for rock in group.rocks), group.structures):
        if collection is not None and collection.library is None and collection.hide_render == shown:
            collection.hide_render = not shown
    for _, row in settings.interface_rows(scene):
        want(scene, row.interface, shown and not row.hide, not row.hide)
        _wires(row.interface, wires)
        _see_through(row.interface, beside_blocks)


def _wires(obj, wanted):
    if obj is None or obj.library is not None:
        return
    if wanted and not obj.show_wire:
        obj.show_wire = obj.show_all_edges = True
        obj[WIRE] = True
    elif not wanted and WIRE in obj:
        obj.show_wire = obj.show_all_edges = False
        del obj[WIRE]


def has_parts(scene, mode, apart):
    """Whether the parts of blocks in compartments are shown, moved apart, in the place of the blocks."""
    blocks, _ = shown_kinds(mode, scene.realmodel.view.subject)
    return apart > 0.0 and mode != "POLYHEDRA" and blocks and len(compartments.names(scene)) > 1


def _make_cells(scene, stage, mode, apart):
    """A body for each block's cells, or for those of its half; or for its parts in compartments."""
    group = scene.realmodel
    made_of = f"{cells.made_of(scene, stage, apart)}{apart or ''}"
    if group.view.cells_of == made_of and bodies.of_kind(scene, bodies.CELLS):
        return
    shapes = cells.of_scene(scene, stage, apart)
    rows = {(row.rock, row.name): row.object for row in group.results}
    if apart:
        shifts = compartments.shifts(scene, apart)
        shapes = {key: polygon_mesh.moved_apart(shape, shifts) for key, shape in shapes.items()}
    bodies.put(scene, bodies.CELLS, [(rows[key], shape) for key, shape in shapes.items() if rows.get(key)])
    group.view.cells_of = made_of
    if not apart:
        cells.forget()


def _make_surviving(scene, stage):
    """The parts of the interfaces that survive erosion, or of their halves: {interface: body}."""
    view = scene.realmodel.view
    made_of = cells.made_of(scene, stage)
    if view.surviving_of != made_of:
        half = cuts.known_half(view.cut) if cuts.is_shown(scene) else None
        model = half or shown_models.at_stage(scene, stage)
        shapes = polygon_mesh.of_surfaces(model, project_settings.model_origin(scene))
        places = [(r, s) for r, rock in enumerate(model.project.rocks) for s in range(len(rock.surfaces))]
        for kind in ("fault", "body"):
            places += [place for place, _ in settings.structure_rows(scene) if place[0] == kind]
        named = dict(zip(places, shapes, strict=False))  # a stage has fewer surfaces
        pairs = [(row.interface, named.get(place)) for place, row in settings.interface_rows(scene)]
        bodies.put(scene, bodies.SURVIVING, [pair for pair in pairs if None not in pair])
        view.surviving_of = made_of
    return bodies.of_kind(scene, bodies.SURVIVING)


def without_blocks(scene):
    """Shows the interfaces alone as ordinary objects, when the blocks were removed."""
    for _, surface in settings.interface_rows(scene):
        obj = surface.interface
        if obj is not None and obj.library is None:
            obj.pop(WANTED, None)
            want(scene, obj, not surface.hide, not surface.hide)
            release(obj)


def release(item):
    """Resets the display of an interface to Blender's default."""
    _wires(item, False)
    _see_through(item, False)


def needs_cells(scene, mode, stage):
    """Whether a display mode shows cells that are not in the scene yet."""
    if mode != "POLYHEDRA":
        return False  # parts in compartments are made as fast as the blocks
    is_there = scene.realmodel.view.cells_of == cells.made_of(scene, stage)
    return not (is_there and bodies.of_kind(scene, bodies.CELLS))


def hidden_properties(scene):
    """The property IDs whose blocks are hidden."""
    hidden = scene.realmodel.view.hidden
    return set(hidden["values"].tolist()) if hidden else set()


def hide_properties(scene, ids):
    scene.realmodel.view.hidden = {"values": sorted(ids)} if ids else {}


def is_hidden(scene, row):
    return row.property_id in hidden_properties(scene)
