# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of boreholes: points for all surfaces of a rock mass at once."""

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..bl import borehole_picks, borehole_points, project_settings, reading_text, settings
from ..core.readers import OBJECT_ENDINGS, TABLE_ENDINGS, read_boreholes
from ..core.settings.boreholes import COLUMNS, Boreholes
from ..core.settings.schema import READING
from ..props_schema import items
from .imports import arrived
from .reporting import Reporting, chosen_path, file_filter, require_file
from .rocks import add_rock


class REALMODEL_OT_boreholes_read(Reporting, bpy.types.Operator, ImportHelper):
    """Read a table with the depths at which boreholes, vertical or not, met the surfaces, or the drillholes
    of an OMF or geoh5 file; the surfaces get these points beside their own, and are added where they are not
    there yet"""

    bl_label = "Import Boreholes"

    filename_ext = ""
    filter_glob: file_filter(*TABLE_ENDINGS, *OBJECT_ENDINGS)
    layer: StringProperty(
        name="Layer",
        description="Object of an OMF or geoh5 file with the boreholes; empty: all of its boreholes",
    )
    collars: StringProperty(
        name="Collars",
        description="Table with hole, x, y and z of each borehole, beside the table of picks or anywhere; "
        "empty: the picks have x, y and z themselves",
    )
    survey: StringProperty(
        name="Survey",
        description="Table with hole, depth along it, azimuth, and dip or inclination, beside the table of "
        "picks or anywhere; empty: holes go as the collars say, or straight down",
    )
    downward_dip: EnumProperty(
        name="Downward Dip",
        description="Sign of the dips of holes that go down",
        items=[
            ("TABLE", "As in the table", "All dips of a table have one sign, and go down"),
            ("NEGATIVE", "Negative", "-90 is straight down"),
            ("POSITIVE", "Positive", "90 is straight down"),
        ],
    )
    columns: StringProperty(
        name="Columns",
        description="Columns with other names, in any of the tables, such as hole = BHID; "
        "depth = FROM. There are " + ", ".join(COLUMNS),
    )
    units: EnumProperty(
        name="Unit",
        description="Unit of all the tables",
        items=items(READING["units"].parts["z"].words),
    )
    add_surfaces: BoolProperty(
        name="Add Surfaces",
        description="Add surfaces that are named in the table but not in the list, the oldest first",
        default=True,
    )

    def act(self, context):
        picks = chosen_path(self, "the picks")
        given = Boreholes(
            picks,
            _beside(picks, self.collars),
            reading_text.named_columns(self.columns),
            units=None if self.units == "NONE" else self.units,
            survey=_beside(picks, self.survey),
            downward_dip=None if self.downward_dip == "TABLE" else self.downward_dip.lower(),
            layer=self.layer.strip() or None,
        )
        for file in given.files:
            require_file(file)
        given.check()
        found = read_boreholes(given, context.scene.realmodel.units)
        rock = settings.active_rock(context.scene) or add_rock(context.scene)
        warnings = borehole_points.give(context.scene, rock, found, self.add_surfaces)
        borehole_picks.keep(rock, found.holes)
        arrived(context, rock, list(found.points.values()))
        for text in [*found.warnings, *warnings]:
            self.report({"WARNING"}, text)
        self.report({"INFO"}, f"Points for {len(found.points)} surfaces: {', '.join(found.points)}")

    def check(self, _context):
        return False  # a file of any ending


def _beside(picks, given):
    """The path of another table, which may stand beside the picks; None where none is given."""
    path = project_settings.absolute(given)
    return picks.parent / given.strip() if path is not None and not path.is_file() else path
