# SPDX-License-Identifier: GPL-3.0-or-later
"""An asset library of the rock looks and of the presets of Fill with Strata: a .blend with a material of
each, a catalog file, and its entry in the preferences. It is made by the Blender that is to use it, so it
always fits."""

import uuid
from pathlib import Path

import bpy

from ...core.base.atomic import Outputs
from ...core.project.looks import LOOKS
from ..host import thumbnails, versions
from ..objects import materials
from . import looks, strata_presets

LIBRARY = "RealModel"
FILE = "realmodel_assets.blend"
CATALOGS = "blender_assets.cats.txt"
LOOKS_CATALOG, STRATA_CATALOG = "Rock Looks", "Strata"
_IDS = {  # the same in every library
    name: uuid.uuid5(uuid.NAMESPACE_URL, f"realmodel:{name.lower()}")
    for name in (LOOKS_CATALOG, STRATA_CATALOG)
}
_PREVIEWS = "looks.jpg"  # made by scripts/draw_looks.py
_CATALOG_TEXT = """# This is an Asset Catalog Definition file for Blender.
#
# The first non-ignored line should be the version indicator.
# Other lines are of the format "UUID:catalog/path/for/assets:simple catalog name"

VERSION 1

""" + "".join(f"{number}:{name}:{name}\n" for name, number in _IDS.items())


def default_folder():
    """The default folder of this user."""
    return Path(bpy.utils.user_resource("DATAFILES", path="realmodel_assets", create=True))


def write(folder):
    """Writes the library into a folder; files of an earlier one are replaced. Raises OutputFailed."""
    folder = Path(folder)
    made = []
    try:
        for (key, look), preview in zip(LOOKS.items(), thumbnails.pictures(_PREVIEWS), strict=True):
            made.append(_look(key, look))
            _mark(made[-1], LOOKS_CATALOG, looks.says(key, look), ("rock", *look.words[:1]), preview)
        previews = thumbnails.pictures(strata_presets.PICTURES)
        for (key, (label, _)), preview in zip(strata_presets.PRESETS.items(), previews, strict=True):
            made.append(strata_presets.material(key))
            says = f"About what Fill with Strata makes with the preset {label}, with which it begins then"
            _mark(made[-1], STRATA_CATALOG, says, ("strata",), preview)
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
    libraries = bpy.context.preferences.filepaths.asset_libraries
    if any(library.path and Path(library.path).resolve() == folder for library in libraries):
        return False
    versions.add_asset_library(LIBRARY, str(folder))
    bpy.context.preferences.is_dirty = True  # saved at the end, where the preferences are
    return True


def _look(key, look):
    material = bpy.data.materials.new(look.label)
    material.use_nodes = True
    materials.set_color(material, look.color)
    looks.apply(material, key, 1.0, 0, looks.UNITS)  # a texture unit is one meter
    return material


def _mark(material, catalog, description, tags, preview):
    """Makes a material an asset. preview: (side, side, 4) its picture."""
    material.asset_mark()
    data = material.asset_data
    data.catalog_id, data.author, data.description = str(_IDS[catalog]), "RealModel", description
    for tag in tags:
        data.tags.new(tag, skip_if_exists=True)
    image = material.preview_ensure()
    image.image_size = preview.shape[1], preview.shape[0]
    image.image_pixels_float.foreach_set(preview.ravel())
