# SPDX-License-Identifier: GPL-3.0-or-later
"""Another property for blocks that are there: no build is needed for it, only other materials."""

from . import display, library_rows, materials, scene, settings


def assign(current, rows, property_id):
    """Gives a property to blocks (rows of the results), and to the surfaces that they lie beneath."""
    with settings.filling():
        for row in rows:
            for rock, surface in settings.surface_rows(current):
                if (rock.name, surface.name) == (row.rock, row.surface):
                    surface.property_id = property_id
    follow_surfaces(current)


def follow_surfaces(current):
    """The blocks take the properties that their surfaces have now."""
    wanted = {(r.name, s.name): s.property_id for r, s in settings.surface_rows(current)}
    for row in current.realmodel.results:
        property_id = wanted.get((row.rock, row.surface), row.property_id)
        if property_id == row.property_id:
            continue
        row.property_id = property_id
        if row.object is not None:
            row.object[scene.PROPERTY] = property_id
            materials.give(row.object, library_rows.material_of(current, property_id))
    for _, surface in settings.surface_rows(current):
        if surface.interface is not None and surface.interface.library is None:
            surface.interface[scene.PROPERTY] = surface.property_id
    display.colors_changed(current)
    scene.remove_unused_materials()
