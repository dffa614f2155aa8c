# SPDX-License-Identifier: GPL-3.0-or-later
"""The update callbacks of settings, one function each: called when a setting is changed by hand or by a
script."""

import contextlib
from pathlib import PurePath

from ..core import RealModelError
from ..core.readers.formats import RASTER, endings
from . import display
from .field import handle, hole_validation
from .objects import viewports
from .project import (
    library_rows,
    method_settings,
    names,
    plan_mesh,
    project_settings,
    series_settings,
    settings,
    structure_settings,
    surface_statistics,
    units,
)
from .scene import data_objects, live, planned_holes, region_size
from .shading import looks, weathering


def _unless_filling(consequence):
    """A callback of a property by which the scene changes, if a person or a script has set it."""

    def changed(row, _context):
        if not settings.is_filling():
            consequence(row.id_data)

    return changed


setting = _unless_filling(live.touch)  # of settings that the model depends on
view = _unless_filling(display.mode_changed)  # of settings of the display
residuals = _unless_filling(display.residuals_changed)
field_data = _unless_filling(display.field_changed)
fields = _unless_filling(display.fields_changed)
ensemble = _unless_filling(display.ensemble_changed)
exaggeration = _unless_filling(display.exaggeration_changed)
section = _unless_filling(display.section_changed)  # another plane, or none


def name(row, _context):
    """A rock mass, a surface, a fault or a body was renamed."""
    if not settings.is_filling():
        names.update_references(row)
        live.touch(row.id_data)


def series_run(row, first, last):
    """The surfaces of a rock mass from one number to another are those of a series, and no others."""
    with settings.filling():
        series_settings.set_run(settings.rock_of(row), row, first, last)
    live.touch(row.id_data)


def model_unit(group, _context):
    """The unit of the model's lengths was changed."""
    if not settings.is_filling():
        units.set_up(group.id_data, group.units)
        live.touch(group.id_data)


def edge_length(rock, _context):
    """The edge length of a rock mass. Setting it switches Size From to the edge length."""
    if not settings.is_filling():
        rock.edges_by = "LENGTH"  # comes to `setting`


def triangles(rock, context):
    """The number of triangles was changed. Sizes from the spacing of points are scaled to it."""
    if not settings.is_filling() and rock.edges_by == "AUTO":
        rock.use_triangles = True
    setting(rock, context)


def planned_hole(row, _context):
    """Where a hole is planned was changed."""
    if not settings.is_filling():
        planned_holes.update(row.id_data, row)


def switched_on(switch):
    """A callback for a setting that counts only where `switch` is on: setting it turns the switch on."""

    def changed(row, context):
        if not settings.is_filling():
            setattr(row, switch, True)
            setting(row, context)

    return changed


def base(rock, context):
    """The base of a rock mass was switched on or off: it begins below the points, where no elevation was
    given yet."""
    if not settings.is_filling() and rock.use_base and not rock.is_property_set("base_elevation"):
        scene = rock.id_data
        with settings.filling(), contextlib.suppress(RealModelError):  # no points, or a file is gone
            points = data_objects.points_of(scene, rock, viewports.updated_layer(scene).depsgraph)
            settings.set_number(rock, "base_elevation", plan_mesh.base_below(points))
    setting(rock, context)


def region(rock, context):
    """The region was changed: its stored outline is discarded."""
    if settings.is_filling():
        return
    rock.region_stored, rock.region_stamp = {}, ""
    rock.region_area = -1.0
    region_size.ask()
    data_objects.update(rock.id_data)
    if context is not None and len(shown := data_objects.objects(rock.id_data)) == 1:
        viewports.frame_items(shown, viewports.spaces(context))  # the first visible data
    setting(rock, context)


def ground(rock, context):
    """The file of the ground was changed: its stored data are discarded."""
    if settings.is_filling():
        return
    rock.ground_stored, rock.ground_stamp = {}, ""
    rock.ground_is_raster = PurePath(rock.ground).suffix.lower() in endings(RASTER)
    setting(rock, context)


def source(surface, context):
    """The source of a surface was changed: the surface is made from it, and edits of its interface are
    discarded."""
    if settings.is_filling():
        return
    if surface.interface_digest and _keeps_shape(surface):
        structure_settings.forget_extension(surface)
    surface.interface_digest = ""
    with settings.filling():
        method_settings.fill_reading(surface)
        if surface.source == "POINTS_FILE" and surface.filepath:
            surface.id_data.realmodel.show_data = True
    if surface.source != "MESH_OBJECT":
        surface.stored_stamp = ""
        if surface.filepath and settings.kind_of(surface) != "surface":
            project_settings.forget_shape(surface)
    data_objects.update(surface.id_data)
    setting(surface, context)


def _keeps_shape(surface):
    """Whether a new source gives the shape that was made from the file before."""
    if surface.source == "MESH_OBJECT":
        return surface.object == surface.interface
    return not surface.filepath


def reading(row, context):
    """The import options of a file were changed: the stored data are discarded."""
    if settings.is_filling():
        return
    surface = settings.surface_of(row)
    surface.interface_digest = ""
    if surface.filepath:
        project_settings.forget_shape(surface)
    data_objects.update(surface.id_data)
    setting(surface, context)


def extended(fault, context):
    """The extension of a fault: what is made from its file depends on it; of a trace the line is kept."""
    (setting if fault.source in (*settings.OF_OBJECTS, *settings.TRACES) else reading)(fault, context)


def fitted(fault, context):
    """A setting that the surface through the points of a fault depends on, and where it is extended."""
    (extended if fault.source == "POINTS_FILE" or fault.extend > 0.0 else setting)(fault, context)


def unset_of_file(key):
    """A callback for a setting that an attribute of the file of a trace gives, where it is unset: the file is
    read again then."""

    def changed(fault, context):
        reads = fault.source == "TRACE_FILE" and not getattr(fault, key)
        (reading if reads else setting)(fault, context)

    return changed


def fit_variogram(surface, context):
    """The fitting of the variogram was switched off: the settings begin with the fitted one."""
    if settings.is_filling():
        return
    fitted = (surface_statistics.read(surface) or {}).get("variogram")
    if not surface.fit_variogram and fitted is not None:
        with settings.filling():
            method_settings.take_fitted(surface, fitted)
    setting(surface, context)


def live_switched(_row, _context):
    live.switched()


def stage(group, _context):
    scene = group.id_data
    last = settings.last_stage(scene)
    if group.stage > last:
        group.stage = last  # comes here again
    elif not settings.is_filling():
        display.stage_changed(scene)


def overlay(_row, _context):
    viewports.redraw()


def misfit_chosen(group, context):
    """A row of the list of misfits was chosen."""
    if not settings.is_filling() and 0 <= group.active_misfit < len(group.misfits) and context is not None:
        handle.show_misfit(context)


def left_out_hole_chosen(group, context):
    """A row of the table of holes that were left out was chosen."""
    chosen = 0 <= group.active_left_out_hole < len(group.left_out_holes)
    if not settings.is_filling() and chosen and context is not None:
        hole_validation.show(context)


def property_id(row, _context):
    """The ID of a property was changed: surfaces, blocks and materials follow. An invalid or used ID is
    refused."""
    if settings.is_filling() or row.id == row.known_id:
        return
    if library_rows.take_id(row):
        live.touch(row.id_data)


def property_name(row, _context):
    if not settings.is_filling():
        library_rows.update_material(row)
        looks.follow(row.id_data, [row])
        live.touch(row.id_data)


def property_rock(row, context):
    """The lithology of a property was changed, which may decide its look."""
    property_look(row, context)
    setting(row, context)


def property_look(row, _context):
    """The look of a property or its texture was changed."""
    if not settings.is_filling():
        looks.follow(row.id_data, [row])
        weathering.follow(row.id_data)


def property_hardness(row, _context):
    if not settings.is_filling():
        weathering.follow(row.id_data)


def property_color(row, _context):
    if not settings.is_filling():
        row.has_color = True
        library_rows.update_material(row)
        display.colors_changed(row.id_data)
