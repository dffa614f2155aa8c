# SPDX-License-Identifier: GPL-3.0-or-later
"""An asset library of the rock looks: a .blend with a material of each, a catalog file, and its entry in the
preferences. It is made by the Blender that is to use it, so it always fits."""

import uuid
from pathlib import Path

import bpy

from ...core.base.atomic import Outputs
from ...core.project.looks import LOOKS
from ..host import thumbnails, versions
from ..objects import materials
from . import looks

LIBRARY = "RealModel Rock Looks"
FILE = "rock_looks.blend"
CATALOGS = "blender_assets.cats.txt"
CATALOG = uuid.uuid5(uuid.NAMESPACE_URL, "realmodel:rock looks")  # the same in every library
_PREVIEWS = "looks.jpg"  # made by scripts/draw_looks.py
_CATALOG_TEXT = f"""# This is an Asset Catalog Definition file for Blender.
#
# The first non-ignored line should be the version indicator.
# Other lines are of the format "UUID:catalog/path/for/assets:simple catalog name"

VERSION 1

{CATALOG}:Rock Looks:Rock Looks
"""


def default_folder():
    """The default folder of this user."""
    return Path(bpy.utils.user_resource("DATAFILES", path="realmodel_rock_looks", create=True))


def write(folder):
    """Writes the library into a folder; files of an earlier one are replaced. Raises OutputFailed."""
    folder = Path(folder)
    made = []
    try:
        previews = thumbnails.pictures(_PREVIEWS)
        for number, (key, look) in enumerate(LOOKS.items()):
            made.append(_asset(key, look, previews[number]))
        with Outputs() as outputs:
            with outputs.path(folder / FILE) as file:
                bpy.data.libraries.write(str(file), set(made), compress=True)
            with outputs.file(folder / CATALOGS) as file:
                file.write(_CATALOG_TEXT.encode())
    finally:
        bpy.data.batch_remove(made)


def register(folder):
    """Adds the folder to the asset libraries of the preferences. Returns whether it was new there."""
    folder = Path(folder).resolve()
    known = bpy.context.preferences.filepaths.asset_libraries
    if any(library.path and Path(library.path).resolve() == folder for library in known):
        return False
    versions.add_asset_library(LIBRARY, str(folder))
    bpy.context.preferences.is_dirty = True  # saved at the end, where the preferences are
    return True


def _asset(key, look, preview):
    material = bpy.data.materials.new(look.label)
    material.use_nodes = True
    materials.set_color(material, look.color)
    looks.apply(material, key, 1.0, 0, looks.UNITS)  # a texture unit is one meter
    material.asset_mark()
    material.asset_data.catalog_id = str(CATALOG)
    material.asset_data.author = "RealModel"
    material.asset_data.description = looks.says(key, look)
    for tag in ("rock", *look.words[:1]):
        material.asset_data.tags.new(tag, skip_if_exists=True)
    image = material.preview_ensure()
    image.image_size = preview.shape[1], preview.shape[0]
    image.image_pixels_float.foreach_set(preview.ravel())
    return material
