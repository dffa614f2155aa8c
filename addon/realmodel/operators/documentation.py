# SPDX-License-Identifier: GPL-3.0-or-later
"""The user guide, which travels with the add-on."""

from pathlib import Path

import bpy

from .reporting import Reporting

# Beside the add-on's files where it was installed, as text above them where it runs from its repository.
_GUIDES = ("docs/guide/index.html", "../../docs/guide/README.md")
_PACKAGE = Path(__file__).resolve().parents[1]


def guide():
    """The first page of the guide, or None where it was not installed."""
    return next((path for path in map(_PACKAGE.joinpath, _GUIDES) if path.is_file()), None)


def _a_guide(_context):
    return "this copy of RealModel has no documentation" if guide() is None else None


class REALMODEL_OT_documentation(Reporting, bpy.types.Operator):
    """Open the user guide in the web browser"""

    bl_label = "RealModel Documentation"
    bl_options = {"REGISTER"}
    needs = (_a_guide,)

    def act(self, _context):
        return bpy.ops.wm.url_open(url=guide().resolve().as_uri())


def _help_menu(self, _context):
    self.layout.operator(REALMODEL_OT_documentation.bl_idname, icon="HELP")


def _manual_map():
    """Links for F1 and "Online Manual" over a button of the tab."""
    page = guide()
    folder = "" if page is None else page.resolve().parent.as_uri() + "/"
    tour = "tour.html" if folder and page.suffix == ".html" else "tour.md"
    patterns = ("bpy.ops.realmodel.*", "bpy.types.realmodel*")
    return folder, tuple((pattern, tour) for pattern in patterns) if folder else ()


def register():
    bpy.types.TOPBAR_MT_help.append(_help_menu)
    bpy.utils.register_manual_map(_manual_map)


def unregister():
    bpy.utils.unregister_manual_map(_manual_map)
    bpy.types.TOPBAR_MT_help.remove(_help_menu)
