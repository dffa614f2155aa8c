# SPDX-License-Identifier: GPL-3.0-or-later
"""Assigns another property to built blocks: only materials change, no build is needed."""

from .. import display
from ..objects import materials, model_tree
from ..project import library_rows, settings
from ..shading import looks, weathering


def assign(scene, rows, property_id):
    """Assigns a property to blocks (rows of the results): to the surfaces above them, or to the bodies that
    they are."""
    with settings.filling():
        for row in rows:
            source = settings.row_of_block(scene, row)
            if source is not None:
                source.property_id = property_id
    follow_surfaces(scene)


def follow_surfaces(scene):
    """The blocks take the properties that their surfaces have now."""
    for row in scene.realmodel.results:
        source = settings.row_of_block(scene, row)
        if source is None or source.property_id == row.property_id:
            continue
        property_id = source.property_id
        row.property_id = property_id
        if row.object is not None:
            row.object[model_tree.PROPERTY] = property_id
            materials.give(row.object, library_rows.material_of(scene, property_id))
    for row in settings.property_rows(scene):
        if row.interface is not None and row.interface.library is None:
            row.interface[model_tree.PROPERTY] = row.property_id
    looks.follow(scene)
    weathering.follow(scene)
    display.colors_changed(scene)
    model_tree.remove_unused_materials()
