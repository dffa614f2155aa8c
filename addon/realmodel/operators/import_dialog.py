# SPDX-License-Identifier: GPL-3.0-or-later
"""What an import shows before anything is read: the first rows of tables with a menu for each column, and the
objects of a file with a tick for each."""

from fnmatch import fnmatchcase

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, IntProperty, StringProperty

from .. import props_import
from ..bl.field import profiles
from ..core import RealModelError
from ..core.base.errors import counted
from ..core.readers.objects.geo_object import LINES, POINTS, SURFACE
from ..props_import import IGNORED, MEANINGS, OF_POINTS
from ..ui.lists import OfRows
from ..ui.panel import message, right_label

WIDTH = 720  # of a dialog
LETTERS = 110  # in a line of it
SHOWN = 3  # tables
_BESIDE = 8  # columns side by side
_KINDS = (
    ("ANY", "Any Kind", "Surfaces, points and lines"),
    (SURFACE, "Surfaces", "Triangulated surfaces"),
    (POINTS, "Points", "Sets of points"),
    (LINES, "Lines", "Lines, whose vertices are taken"),
)


class TableDialog:
    """An operator with a dialog about tables. `of`: OF_POINTS or OF_HOLES. `understood(preview)`: {meaning:
    column} of a table without a choice."""

    headings: CollectionProperty(type=props_import.RealModelHeading, options={"SKIP_SAVE", "HIDDEN"})

    of = OF_POINTS
    _previews = ()
    _before = ()  # the meanings of all headings, as they were when one was changed

    def begin_tables(self, previews):
        """Fills the menus: as a profile has them, or as the columns are understood. Returns the other import
        options of the profiles."""
        self._previews = previews
        self.headings.clear()
        reading = {}
        for preview in previews:
            profile = profiles.of_header(self.of, preview.names) if preview.has_header else None
            columns = self.understood(preview)
            if profile is not None:
                columns, reading = profile.columns, reading | profile.reading
            for number, name in enumerate(preview.names, 1):
                heading = self.headings.add()
                is_name = preview.names.count(name) == 1 and not name.isdecimal()
                heading.file, heading.of = preview.key, self.of
                heading.column = name if is_name else str(number)
            self._mean(preview.key, columns)
        self._before = self._meanings()
        return reading

    def _mean(self, file, columns):
        by_column = {column: meaning for meaning, column in columns.items() if meaning in MEANINGS[self.of]}
        for heading in self.headings_of(file):
            heading.meaning = by_column.get(heading.key, IGNORED)

    def _meanings(self):
        return [heading.meaning for heading in self.headings]

    def headings_of(self, file):
        """The menus of a table, of all its columns."""
        return [heading for heading in self.headings if heading.file == str(file)]

    def columns_of(self, file):
        """{meaning: column} as the menus of a table say; empty where it has none."""
        headings = self.headings_of(file)
        return {heading.meaning: heading.key for heading in headings if heading.meaning != IGNORED}

    def settle_columns(self):
        """A meaning has one column in a table: the one that was chosen last."""
        for number, (heading, before) in enumerate(zip(self.headings, self._before, strict=False)):
            if heading.meaning in (before, IGNORED):
                continue
            for other_number, other in enumerate(self.headings):
                is_same = (other.file, other.meaning) == (heading.file, heading.meaning)
                if is_same and other_number != number:
                    other.meaning = IGNORED
        self._before = self._meanings()

    def remember(self, reading):
        """Keeps what was chosen as profiles, for tables that have one or are understood otherwise without
        one. reading: the other import options."""
        new = []
        for preview in self._previews if self.options.is_invoke else ():
            columns, header = self.columns_of(preview.key), tuple(preview.names)
            known = profiles.of_header(self.of, header)
            if preview.has_header and (known or reading or columns != self.understood(preview)):
                name = (preview.sheet or preview.file.stem) if known is None else known.name
                new.append(profiles.ImportProfile(name, self.of, header, columns, dict(reading)))
        if new:
            try:
                profiles.add(*new)
            except (RealModelError, OSError) as error:
                self.report({"WARNING"}, f"the choices are not remembered: {error}")

    def draw_tables(self, layout, said):
        """said(preview): (text, icon) of each message about a table."""
        for preview in self._previews[:SHOWN]:
            box = layout.box()
            box.label(text=preview.title, icon="FILE")
            self._draw_table(box, preview)
            for text, icon in said(preview):
                message(box.column(align=True), text, icon=icon, most=LETTERS)
        if len(self._previews) > SHOWN:
            layout.label(text=f"and {counted(len(self._previews) - SHOWN, 'more table')}")

    def _draw_table(self, layout, preview):
        headings = self.headings_of(preview.key)
        for begin in range(0, len(headings), _BESIDE):
            row = layout.row(align=True)
            for number, heading in enumerate(headings[begin : begin + _BESIDE], begin):
                column = row.column(align=True)
                column.prop(heading, "meaning", text="")
                cells = column.box().column(align=True)
                cells.scale_y = 0.8
                cells.active = heading.meaning != IGNORED
                cells.label(text=preview.names[number])
                for entries in preview.rows:
                    cells.label(text=entries[number] if number < len(entries) else "")


class ObjectDialog:
    """An operator with a dialog about the objects of files. What the filters do not show is not imported."""

    objects: CollectionProperty(type=props_import.RealModelFileObject, options={"SKIP_SAVE", "HIDDEN"})
    active_object: IntProperty(name="Active Object", options={"SKIP_SAVE", "HIDDEN"})
    every_object: BoolProperty(
        name="All",
        description="Switch all objects of the list on, or off",
        default=True,
        options={"SKIP_SAVE", "HIDDEN"},
    )
    object_name: StringProperty(
        name="Named",
        description="Only objects whose names contain this text, or match this pattern: Top* or *fault*",
        options={"SKIP_SAVE", "HIDDEN", "TEXTEDIT_UPDATE"},
    )
    object_kind: EnumProperty(
        name="Kind", description="Only objects of this kind", items=_KINDS, options={"SKIP_SAVE", "HIDDEN"}
    )
    object_size: IntProperty(
        name="At Least",
        description="Only objects with at least this number of triangles or points",
        min=0,
        options={"SKIP_SAVE", "HIDDEN"},
    )

    _were_all = True

    def begin_objects(self, rows):
        """rows: (path, name, kind, size) of each object."""
        self.objects.clear()
        for path, name, kind, size in rows:
            row = self.objects.add()
            row.file, row.name, row.kind, row.size = str(path), name, kind, size

    def settle_objects(self):
        """All that are listed are switched on, or off, where that was chosen."""
        if self.every_object != self._were_all:
            self._were_all = self.every_object
            for row in self.objects:
                row.chosen = self.every_object if fits(self, row) else row.chosen

    def wants(self, path, name):
        """Whether an object is to be imported: all are where there is no choice."""
        rows = [row for row in self.objects if row.file in ("", str(path))]
        return not rows or any(row.name == name and row.chosen and fits(self, row) for row in rows)

    def draw_objects(self, layout):
        row = layout.row(align=True)
        row.prop(self, "every_object")
        row.prop(self, "object_name")
        row.prop(self, "object_kind", text="")
        row.prop(self, "object_size")
        layout.template_list("REALMODEL_UL_file_objects", "", self, "objects", self, "active_object", rows=10)
        wanted = sum(row.chosen and fits(self, row) for row in self.objects)
        layout.label(text=f"{wanted} of {counted(len(self.objects), 'object')} to import")


def fits(dialog, row):
    """Whether an object passes the filters of an ObjectDialog."""
    pattern = dialog.object_name.strip().casefold()
    pattern = pattern if set(pattern) & set("*?[") else f"*{pattern}*"
    is_kind = dialog.object_kind in ("ANY", row.kind)
    return is_kind and row.size >= dialog.object_size and fnmatchcase(row.name.casefold(), pattern)


class REALMODEL_UL_file_objects(OfRows, bpy.types.UIList):
    """Objects of files that are to be imported."""

    def draw_row(self, _context, row, item):
        row.prop(item, "chosen", text="")
        row.label(text=item.name)
        row.label(text=item.kind)
        right_label(row, f"{item.size:,}")

    def filter_items(self, _context, data, name):
        return [self.bitflag_filter_item * fits(data, row) for row in getattr(data, name)], []
