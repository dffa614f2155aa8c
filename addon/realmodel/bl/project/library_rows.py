# SPDX-License-Identifier: GPL-3.0-or-later
"""The library's rows in the settings, and the materials that follow them."""

import bpy

from ...core import Library, Property
from ...core.project.library import PROPERTY
from ...core.project.looks import hex_color
from ...core.results.automatic_library import palette
from ..objects import materials, model_tree
from . import method_settings, settings

NO_LOOK = "NONE"  # the material stays as it is


def library_of(scene):
    """The realmodel.core.Library of the rows, or None where there are none. Raises InputRefused."""
    rows = scene.realmodel.library
    if not len(rows):
        return None
    return Library([_property(row) for row in rows])


def name_and_color(scene, property_id):
    """As of `materials.name_and_color`, of one row alone. Raises InputRefused."""
    row = find(scene, property_id)
    return materials.name_and_color(None if row is None else Library([_property(row)]), property_id)


def _property(row):
    values = method_settings.values(row, Property)
    if values["look_scale"] == PROPERTY["look_scale"].start:
        del values["look_scale"]
    look = None if row.look == NO_LOOK else row.look.lower()
    return Property(row.id, color=hex_color(row.color) if row.has_color else None, look=look, **values)


def fill(scene, library):
    """Fills the rows from a library; None empties them."""
    group = scene.realmodel
    with settings.filling():
        group.library.clear()
        group.active_property = 0
        for entry in library or ():
            add(scene, entry)


def add(scene, entry):
    """A row for one realmodel.core.Property."""
    row = scene.realmodel.library.add()
    with settings.filling():
        row.id = row.known_id = entry.id
        method_settings.set_values(row, Property, entry)
        row.look = NO_LOOK if entry.look is None else entry.look.upper()
        if entry.color is not None:
            row.color = entry.rgb
            row.has_color = True
    return row


def next_color(scene):
    """An "#rrggbb" of the palette for one more property: the first of those that are used least."""
    used = [hex_color(row.color) for row in scene.realmodel.library]
    return min(palette(), key=used.count)


def for_surface(scene, name):
    """The ID of the property called so, for a surface of that name; one is added where there is none."""
    same = (row.id for row in scene.realmodel.library if row.name.casefold() == name.casefold())
    property_id = next(same, None)
    return (
        add(scene, Property(free_id(scene), name, color=next_color(scene))).id
        if property_id is None
        else property_id
    )


def remove_made(scene, surface):
    """A surface or a body leaves the list: the entry added for it goes, where nothing was made of it."""
    row = find(scene, surface.property_id)
    users = sum(other.property_id == surface.property_id for other in settings.property_rows(scene))
    if row is None or users > 1 or row.name != surface.name:
        return
    if (
        any((row.density, row.porosity, row.permeability, row.hardness))
        or row.look != NO_LOOK
        or any(row.get(key) for key, setting in PROPERTY.items() if setting.kind == "note")
    ):
        return
    group = scene.realmodel
    group.library.remove(list(group.library).index(row))
    group.active_property = max(0, min(group.active_property, len(group.library) - 1))


def find(scene, property_id):
    """The row of an ID, or None."""
    return next((row for row in scene.realmodel.library if row.id == property_id), None)


def free_id(scene):
    return max((row.id for row in scene.realmodel.library), default=0) + 1


def take_id(row):
    """Whether a row's new ID can be taken; then what had the property has it under that ID, else the row has
    its old ID again."""
    scene, old = row.id_data, row.known_id
    with settings.filling():
        if row.id < 1 or sum(other.id == row.id for other in scene.realmodel.library) > 1:
            row.id = old
            return False
        row.known_id = row.id
        for material in scene_materials(scene, old):
            material[materials.KEY] = row.id
        for source in settings.property_rows(scene):
            if source.property_id == old:
                source.property_id = row.id
        for block in scene.realmodel.results:
            if block.property_id == old:
                block.property_id = row.id
    for obj in scene.objects:
        if obj.get(materials.KEY) == old:
            obj[materials.KEY] = row.id
    return True


def update_material(row):
    """The material of the property in this scene takes its name and color at once."""
    for material in scene_materials(row.id_data, row.id):
        if material.name != row.name and row.name and row.name not in bpy.data.materials:
            material.name = row.name
        materials.set_color(material, hex_color(row.color) if row.has_color else materials.NEUTRAL_GRAY)


def update_materials(scene):
    """Sets the names and colors of all materials from the library."""
    for row in scene.realmodel.library:
        update_material(row)


def material_of(scene, property_id):
    """The material of a property: that of the scene's model, else one that nothing uses, else a new one.
    Raises InputRefused for a library that is not valid."""
    candidates = scene_materials(scene, property_id) or [
        m for m in bpy.data.materials if m.get(materials.KEY) == property_id and not (m.users or m.library)
    ]
    if candidates:
        return candidates[0]
    name, color = materials.name_and_color(library_of(scene), property_id)
    return materials.new_material(name, property_id, color)


def scene_materials(scene, property_id):
    """The materials of a property that the model's blocks and sections use."""
    materials_by_name = {}
    for obj in [*(block.object for block in scene.realmodel.results), *model_tree.sections(scene)]:
        if obj is None or obj.type != "MESH":
            continue
        for material in obj.data.materials:
            if material is not None and material.get(materials.KEY) == property_id:
                materials_by_name[material.name_full] = material
    return list(materials_by_name.values())
