# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes give points to all surfaces of a rock mass at once."""

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..bl import borehole_points, live, project_settings, reading_text
from ..core import InputRefused
from ..core.boreholes import Boreholes
from ..core.point_file import ReadingRefused
from ..core.readers import read_boreholes
from .reporting import Reporting, needed_path, needed_rock


class REALMODEL_OT_boreholes_read(Reporting, bpy.types.Operator, ImportHelper):
    """Read a table with the depths at which boreholes met the surfaces; the surfaces get these points beside
    their own, and are added where they are not there yet"""

    bl_idname = "realmodel.boreholes_read"
    bl_label = "Read Boreholes"

    filename_ext = ""
    filter_glob: StringProperty(default="*.csv;*.txt;*.dat;*.tsv", options={"HIDDEN"})
    collars: StringProperty(
        name="Collars",
        description="Table with hole, x, y and z of each borehole, beside the table of picks or anywhere; "
        "empty: the picks have x, y and z themselves",
    )
    columns: StringProperty(
        name="Columns",
        description="Columns that are called otherwise, in either table, such as hole = BHID; depth = FROM. "
        "There are hole, x, y, z, surface, depth and elevation",
    )
    units: EnumProperty(
        name="Unit",
        description="Unit of both tables",
        items=[(unit or "NONE", *rest) for unit, *rest in reading_text.UNITS],
    )
    add_surfaces: BoolProperty(
        name="Add Surfaces",
        description="Add surfaces that are named in the table but not in the list, the lowest first",
        default=True,
    )

    def act(self, context):
        rock = needed_rock(context)
        picks = project_settings.absolute(needed_path(self.filepath, "the picks"))
        collars = project_settings.absolute(self.collars)
        if collars is not None and not collars.is_file():
            collars = picks.parent / self.collars.strip()
        given = Boreholes(
            picks,
            collars,
            reading_text.named_columns(self.columns),
            units=None if self.units == "NONE" else self.units,
        )
        for file in given.files:
            if not file.is_file():
                raise InputRefused(f"there is no file {file}", advice="check the path")
        try:
            given.check()
        except ReadingRefused as error:
            raise InputRefused(error.what, advice=error.advice) from error
        found = read_boreholes(given, context.scene.realmodel.units)
        told = borehole_points.give(context.scene, rock, found.points, self.add_surfaces)
        live.touch(context.scene)
        for text in [*found.warnings, *told]:
            self.report({"WARNING"}, text)
        self.report({"INFO"}, f"Points for {len(found.points)} surfaces: {', '.join(found.points)}")

    def check(self, _context):
        return False  # a file of any ending


CLASSES = (REALMODEL_OT_boreholes_read,)
