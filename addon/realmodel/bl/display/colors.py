# SPDX-License-Identifier: GPL-3.0-or-later
"""The colors of blocks and interfaces: by property, block, rock mass, age, or a value (`shades`).

The mesh of a block keeps its property's material. Other colors are materials in the slots of the object, not
of the mesh. So they show in every shading mode and in renders, and can be removed completely.
"""

import collections
import colorsys

import bpy
import numpy as np

from ...core.drawing import color_scale
from ...core.drawing.overlay import ColorKey
from ...core.project.looks import encoded, hex_color, rgb
from ..objects import materials, viewports
from ..project import compartments, library_rows, settings
from . import bodies, modes, shades, stages

KEY = "realmodel_colour"  # on a material: the value that it shows; .blend files contain this name
_GOLDEN = 0.618034  # of the circle of hues: no two of the first dozens come near each other
_FAULTS = "#c8504a"
_OLD, _YOUNG = (0.72, 0.62, 0.55), (0.13, 0.55, 0.95)  # hue, saturation, value at the ends of the ages


def apply(scene):
    """Sets the colors of all blocks and interfaces by the settings."""
    by = scene.realmodel.color_by
    shades.apply(scene, by)
    common = shades.material() if by in shades.IN_MESH else None
    for row in scene.realmodel.results:
        if _can_take(row.object):
            plain = None if by == "PROPERTY" or common else plain_material(*_entry(scene, by, row))
            _put_into_slot(row.object, common or plain)
    blocks = {settings.row_of_block(scene, row): row for row in scene.realmodel.results}
    for place, surface in settings.interface_rows(scene):
        obj, row = surface.interface, blocks.get(surface)
        if not _can_take(obj) or not len(scene.realmodel.results):
            continue
        if any(m is not None for m in obj.data.materials):
            continue  # the user's own
        if common is not None:
            material = common
        elif place[0] == "fault":
            material = plain_material("Faults", _FAULTS)
        elif by == "PROPERTY" or row is None:
            material = of_property(scene, surface.property_id)
        else:
            material = plain_material(*_entry(scene, by, row))
        if not len(obj.data.materials):
            obj.data.materials.append(None)
        _put_into_slot(obj, material)
    bodies.follow_materials(scene)
    remove_unused()


def key(scene):
    """The core's ColorKey of the visible objects, or None where nothing is visible."""
    by, group = scene.realmodel.color_by, scene.realmodel
    if by in shades.TITLES:
        low, high = shades.limits(scene)
        colors = color_scale.colors(np.linspace(0.0, 1.0, 64), (0.0, 1.0))
        title = f"{shades.TITLES[by]} ({group.units})"
        return ColorKey(title, limits=(low, high), colors=colors) if high > low else None
    if by == shades.COMPARTMENT:
        names = compartments.names(scene)
        rows = [(name, shades.compartment_color(number)) for number, name in enumerate(names)]
        return ColorKey("Compartment", rows) if len(rows) > 1 else None
    entries, library, places = {}, library_rows.library_of(scene), {}
    number = collections.Counter()  # of the blocks so far, in each rock mass, the youngest first
    for row in reversed(group.results):
        number[row.rock] += 1
        body = modes.body_of(scene, row)
        if body is None or not stages.present(row) or modes.is_hidden(scene, row):
            continue
        if by == "PROPERTY":
            name, _ = materials.name_and_color(library, row.property_id)
            material = body.material_slots[0].material if len(body.material_slots) else None
            if material is not None and library_rows.find(scene, row.property_id) is None:
                name = material.name  # as it was called when the block was built
            color = shown_color(body)
        else:
            _, color = _entry(scene, by, row)
            name = {"ROCK": row.rock, "BLOCK": row.name, "AGE": row.surface}[by]
            color = rgb(color)
        entries.setdefault(name, color)
        places[name] = min(places.get(name, number[row.rock]), number[row.rock])
    titles = {"PROPERTY": "Property", "ROCK": "Rock Mass", "BLOCK": "Block", "AGE": "Age"}
    ordered = sorted(entries.items(), key=lambda entry: places[entry[0]])  # as in the rock masses, from above
    return ColorKey(titles[by], ordered) if ordered else None


def shade_viewports(by, before):
    """Sets solid shading in the active viewport to vertex colors while these are displayed; resets all
    viewports to material colors afterward. before: the settings that were shown before."""
    wanted, was = by in shades.IN_MESH, before.get("color_by") in shades.IN_MESH
    if wanted == was:
        return
    old, new = ("MATERIAL", "VERTEX") if wanted else ("VERTEX", "MATERIAL")
    spaces = viewports.spaces(bpy.context) if wanted else [a.spaces.active for a in viewports.areas()]
    for space in spaces:
        if space.shading.color_type == old:
            space.shading.color_type = new


def forget(scene):
    """Removes all such colors from a scene."""
    for obj in _colored(scene):
        slot = obj.material_slots[0]
        if slot.link == "OBJECT" and not _is_of_user(slot):
            slot.material = None
            slot.link = "DATA"
    shades.apply(scene, None)
    remove_unused()


def shown_color(item):
    """(red, green, blue) of an object's material from 0 to 1, sRGB, as the screen has it."""
    return tuple(encoded(channel) for channel in shown_linear(item))


def shown_linear(item):
    """(red, green, blue) of an object's material from 0 to 1, scene-linear."""
    material = item.material_slots[0].material if len(item.material_slots) else None
    if material is None:
        return materials.linear_color(materials.NEUTRAL_GRAY)
    return tuple(material.diffuse_color[:3])


def _colored(scene):
    items = [row.object for row in scene.realmodel.results]
    items += [surface.interface for _, surface in settings.interface_rows(scene)]
    return [obj for obj in items if _can_take(obj) and len(obj.material_slots)]


def _can_take(obj):
    return obj is not None and obj.type == "MESH" and obj.library is None and obj.data.library is None


def _entry(scene, by, row):
    """(name, "#rrggbb") of the color of a block."""
    if by == "ROCK":
        number = [rock.name for rock in scene.realmodel.rocks].index(row.rock) if _has_rock(scene, row) else 0
        return f"Rock mass {row.rock}", hue(number)
    if by == "BLOCK":
        number = next(n for n, other in enumerate(scene.realmodel.results) if other == row)
        return f"Block {row.name}", hue(number)
    place, last = settings.time_of_block(scene, row), settings.last_stage(scene)
    at = place / last if last else 0.0
    hsv = [old + at * (young - old) for old, young in zip(_OLD, _YOUNG, strict=True)]
    return f"Age {place}", hex_color(colorsys.hsv_to_rgb(*hsv))


def _has_rock(scene, row):
    return any(rock.name == row.rock for rock in scene.realmodel.rocks)


def hue(number):
    """The color "#rrggbb" of the thing of this number, which that of the next ones is unlike."""
    brightness = 0.9 if number % 2 else 0.7
    return hex_color(colorsys.hsv_to_rgb((0.06 + number * _GOLDEN) % 1.0, 0.65, brightness))


def plain_material(name, color):
    """The material of a name and color that another scene or block may have already."""
    stands_for = f"{name} {color}"
    for material in bpy.data.materials:
        if material.get(KEY) == stands_for and material.library is None:
            return material
    material = materials.new_material(name, materials.NO_PROPERTY, color)
    del material[materials.KEY]
    material[KEY] = stands_for
    return material


def dark():
    """The material of edges."""
    return plain_material("Edges", "#050505")


def of_property(scene, property_id):
    """The material of a property, whether a block has it or not."""
    scene_materials = library_rows.scene_materials(scene, property_id)
    if scene_materials:
        return scene_materials[0]
    return plain_material(*library_rows.name_and_color(scene, property_id))


def _put_into_slot(obj, material):
    if not len(obj.material_slots) or _is_of_user(obj.material_slots[0]):
        return
    slot = obj.material_slots[0]
    if material is None:
        if slot.link == "OBJECT":
            slot.material = None
            slot.link = "DATA"
        return
    if slot.link != "OBJECT":
        slot.link = "OBJECT"
    if slot.material != material:
        slot.material = material


def _is_of_user(slot):
    """Whether the user has given the object, not its mesh, a material."""
    material = slot.material if slot.link == "OBJECT" else None
    return material is not None and not {KEY, materials.KEY, shades.ATTRIBUTE} & set(material.keys())


def remove_unused():
    """Removes the materials of colors that nothing has any more."""
    for material in [m for m in bpy.data.materials if (KEY in m or shades.ATTRIBUTE in m) and not m.users]:
        bpy.data.materials.remove(material)
