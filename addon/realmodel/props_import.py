# SPDX-License-Identifier: GPL-3.0-or-later
"""What the dialogs of imports ask: the meaning of each column of a table, and which objects of a file."""

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from .bl.field import field_tables

OF_POINTS, OF_HOLES = "points", "field data"  # imports, as profiles name them
AXES = ("x", "y", "z")
UNITS = "surface"  # a column of points whose values name surfaces
IGNORED = "-"
MEANINGS = {
    OF_POINTS: {
        **{axis: (axis, f"Coordinate {axis}") for axis in AXES},
        UNITS: ("surface", "Names surfaces: one for each value"),
    },
    OF_HOLES: {name: (name, f"As `{name}` of a project file") for name in field_tables.ALL_COLUMNS},
}
_ITEMS = {
    of: [(IGNORED, "Ignore", "The column is not read"), *((key, *texts) for key, texts in words.items())]
    for of, words in MEANINGS.items()
}


class RealModelHeading(bpy.types.PropertyGroup):
    """A column of a table that is to be imported, and what it means. column: by name, or its number."""

    file: StringProperty()
    of: StringProperty(default=OF_POINTS)
    column: StringProperty()
    meaning: EnumProperty(
        name="Meaning",
        description="What the column of the table is",
        options=set(),
        items=lambda heading, _context: _ITEMS.get(heading.of, _ITEMS[OF_POINTS]),
    )

    @property
    def key(self):
        """The column by name, or by number from 1."""
        return int(self.column) if self.column.isdecimal() else self.column


class RealModelFileObject(bpy.types.PropertyGroup):
    """An object of a file that is to be imported, or not. size: its triangles, or its points."""

    file: StringProperty()
    name: StringProperty()
    kind: StringProperty()
    size: IntProperty(options=set())
    chosen: BoolProperty(name="Import", description="Import this object", default=True, options=set())
