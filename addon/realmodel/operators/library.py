# SPDX-License-Identifier: GPL-3.0-or-later
"""The library of properties: its rows, its files, and giving a property to blocks."""

import bpy
from bpy.props import BoolProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ..bl import display
from ..bl.project import library_rows, settings
from ..bl.scene import live, properties_of_blocks
from ..bl.shading import looks
from ..core import Property, load_library
from ..core.project.project_writer import save_library
from .reporting import Reporting, a_library, chosen_path, file_filter, selected_blocks


class REALMODEL_OT_library_add(Reporting, bpy.types.Operator):
    """Add a property to the library"""

    bl_label = "Add Property"

    name: StringProperty(name="Name", description="Name of the rock", default="New property")

    def act(self, context):
        group = context.scene.realmodel
        number = library_rows.free_id(context.scene)
        name = settings.free_name(group.library, self.name.strip() or "New property")
        library_rows.add(context.scene, Property(number, name, color=library_rows.next_color(context.scene)))
        with settings.filling():
            group.active_property = len(group.library) - 1


class REALMODEL_OT_library_remove(Reporting, bpy.types.Operator):
    """Remove the active property from the library, and from the surfaces that have it"""

    bl_label = "Remove Property"
    needs = (a_library,)

    def act(self, context):
        group = context.scene.realmodel
        number = min(group.active_property, len(group.library) - 1)
        gone = group.library[number].id
        with settings.filling():
            group.library.remove(number)
            group.active_property = max(0, min(number, len(group.library) - 1))
            if library_rows.find(context.scene, gone) is None:
                for row in settings.property_rows(context.scene):
                    if row.property_id == gone:
                        row.property_id = 0
        properties_of_blocks.follow_surfaces(context.scene)
        live.touch(context.scene)


class REALMODEL_OT_library_import(Reporting, bpy.types.Operator, ImportHelper):
    """Import properties from a library file (TOML); they replace those with the same ID"""

    bl_label = "Import Library"

    filename_ext = ".toml"
    filter_glob: file_filter(".toml")
    replace: BoolProperty(name="Replace", description="Remove all properties of the library first")

    def act(self, context):
        path = chosen_path(self, "the library")
        library = load_library(path)
        scene = context.scene
        entries = (
            [] if self.replace else [e for e in library_rows.library_of(scene) or () if e.id not in library]
        )
        library_rows.fill(scene, [*entries, *library])
        library_rows.update_materials(scene)
        looks.follow(scene)
        display.colors_changed(scene)
        live.touch(scene)
        self.report({"INFO"}, f"Read {len(library)} properties")


class REALMODEL_OT_library_export(Reporting, bpy.types.Operator, ExportHelper):
    """Export the library to a file (TOML)"""

    bl_label = "Export Library"
    bl_options = {"REGISTER"}
    needs = (a_library,)

    filename_ext = ".toml"
    filter_glob: file_filter(".toml")

    def act(self, context):
        library = library_rows.library_of(context.scene)
        path = chosen_path(self, "the library")
        save_library(library, path)
        self.report({"INFO"}, f"Wrote {len(library)} properties to {path}")


class REALMODEL_OT_assign_property(Reporting, bpy.types.Operator):
    """Assign the active property of the library to the selected blocks and the surfaces above them"""

    bl_label = "Assign to Selected Blocks"
    needs = (a_library, selected_blocks)

    def act(self, context):
        group = context.scene.realmodel
        entry = group.library[min(group.active_property, len(group.library) - 1)]
        selected = set(context.selected_objects)
        rows = [row for row in group.results if row.object in selected]
        properties_of_blocks.assign(context.scene, rows, entry.id)
        self.report({"INFO"}, f"{entry.name}: {', '.join(row.name for row in rows)}")
