# SPDX-License-Identifier: GPL-3.0-or-later
"""The model and its report out to files."""

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper

from ..bl import project_settings
from ..bl.display import shown_models
from ..core import UsageError
from ..core.atomic import Outputs
from ..core.exporters import WRITERS, save_model, writer_for
from ..core.exporters.report import write_report
from .reporting import Reporting, a_model, needed_path


class REALMODEL_OT_export(Reporting, bpy.types.Operator, ExportHelper):
    """Export the built model; the ending of the file name says the format"""

    bl_idname = "realmodel.export"
    bl_label = "Export Model"
    bl_options = {"REGISTER"}
    needs = (a_model,)

    filename_ext = ".npz"
    check_extension = None  # any of the formats
    filter_glob: StringProperty(default=";".join(f"*{e}" for e in WRITERS), options={"HIDDEN"})

    def act(self, context):
        path = project_settings.absolute(needed_path(self.filepath, "the model"))
        writer_for(path)
        save_model(shown_models.whole(context.scene), path)
        self.report({"INFO"}, f"Wrote {path}")

    def check(self, _context):
        return False


class REALMODEL_OT_report(Reporting, bpy.types.Operator, ExportHelper):
    """Write a report of the built model (JSON): volumes, settings, warnings, and the proof of the model"""

    bl_idname = "realmodel.report"
    bl_label = "Write Report"
    bl_options = {"REGISTER"}
    needs = (a_model,)

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})

    def act(self, context):
        path = project_settings.absolute(needed_path(self.filepath, "the report"))
        if path.suffix.lower() != ".json":
            raise UsageError(f"{path}: a report ends in .json")
        model = shown_models.whole(context.scene)
        with Outputs() as outputs, outputs.file(path) as file:
            write_report(model, path, file)
        self.report({"INFO"}, f"Wrote {path}")


CLASSES = (REALMODEL_OT_export, REALMODEL_OT_report)
