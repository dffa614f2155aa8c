# SPDX-License-Identifier: GPL-3.0-or-later
"""Profiles of imports, in the preferences of the add-on: renamed, removed, saved for others, and loaded."""

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ..bl.field import profiles
from ..core import InputRefused
from ..core.base.errors import counted
from .reporting import Reporting, chosen_path, file_filter, require_file


def any_profile(_context):
    return (
        None if profiles.all_of_user() else "there is no import profile yet; the dialogs of imports make them"
    )


class _OfAProfile(Reporting):
    bl_options = {"REGISTER", "INTERNAL"}
    needs = (any_profile,)

    name: StringProperty(name="Profile", description="Name of the profile", options={"SKIP_SAVE"})

    def require(self):
        """Raises InputRefused where there is no profile of this name."""
        names = [profile.name for profile in profiles.all_of_user()]
        if self.name not in names:
            raise InputRefused(f"there is no profile '{self.name}'", advice=f"there are {', '.join(names)}")


class REALMODEL_OT_profile_rename(_OfAProfile, bpy.types.Operator):
    """Give an import profile another name"""

    bl_label = "Rename Profile"

    new_name: StringProperty(name="New Name", description="Name that it gets", options={"SKIP_SAVE"})

    def invoke(self, context, event):
        self.new_name = self.name
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, _context):
        self.layout.prop(self, "new_name")

    def act(self, _context):
        self.require()
        if not self.new_name.strip():
            raise InputRefused("the new name is empty", advice="type one")
        profiles.rename(self.name, self.new_name.strip())


class REALMODEL_OT_profile_remove(_OfAProfile, bpy.types.Operator):
    """Remove an import profile"""

    bl_label = "Remove Profile"

    def act(self, _context):
        self.require()
        profiles.remove(self.name)


class REALMODEL_OT_profiles_export(Reporting, bpy.types.Operator, ExportHelper):
    """Save all import profiles to a file (JSON), to share them"""

    bl_label = "Save Import Profiles"
    bl_options = {"REGISTER"}
    needs = (any_profile,)

    filename_ext = ".json"
    filter_glob: file_filter(".json")

    def act(self, _context):
        path, saved = chosen_path(self, "the profiles"), profiles.all_of_user()
        profiles.write(saved, path)
        self.report({"INFO"}, f"Wrote {counted(len(saved), 'profile')} to {path}")


class REALMODEL_OT_profiles_import(Reporting, bpy.types.Operator, ImportHelper):
    """Load import profiles from a file (JSON). A profile for the same header replaces yours"""

    bl_label = "Load Import Profiles"
    bl_options = {"REGISTER"}

    filename_ext = ".json"
    filter_glob: file_filter(".json")

    def act(self, _context):
        path = chosen_path(self, "the profiles")
        require_file(path)
        loaded = profiles.read(path)
        profiles.add(*loaded)
        self.report({"INFO"}, f"Read {counted(len(loaded), 'profile')}")
