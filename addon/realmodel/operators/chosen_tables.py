# SPDX-License-Identifier: GPL-3.0-or-later
"""What the operators about field data share: the chosen tables, and what is said of them."""

import os

from bpy.props import EnumProperty, FloatProperty, StringProperty

from ..bl.field import field_tables
from ..bl.project import imported, project_settings, reading_text, settings
from ..core import InputRefused, RealModelError
from ..core.readers import contents
from ..core.readers.formats import HOLES, OBJECTS, RASTER, SHAPES, TABLE, endings
from ..core.settings.data_files import READING
from ..props_import import OF_HOLES
from ..props_schema import items
from .import_dialog import TableDialog
from .imports import FilesImportHelper, chosen_files
from .reporting import chosen_path, file_filter, require_file


def _of_map(properties, ask, *arguments):
    """The contents of the first of the chosen maps; none where it cannot be read."""
    path = _first_map(properties)
    try:
        return [] if path is None else ask(path, *arguments)
    except RealModelError:
        return []


def _first_map(properties):
    return next((path for path in chosen_files(properties) if field_tables.is_map(path)), None)


def _surfaces(context):
    row = settings.active_rock(context.scene)
    return [] if row is None else [surface.name for surface in reversed(row.surfaces)]


def _rasters(properties):
    """The names of the rasters beside the first of the chosen maps."""
    path = _first_map(properties)
    beside = sorted(path.parent.iterdir()) if path is not None and os.path.isdir(path.parent) else []
    return [file.name for file in beside if file.suffix.lower() in endings(RASTER)]


class ChosenTables(TableDialog, FilesImportHelper):
    """An operator about tables of field data, and how they are read."""

    filepath: StringProperty(
        name="File", description="One of the tables", subtype="FILE_PATH", options={"SKIP_SAVE"}
    )
    filter_glob: file_filter(*endings(TABLE, OBJECTS, SHAPES, HOLES))
    map_layer: StringProperty(
        name="Map Layer",
        description="Layer of a GeoPackage that has the polygons; empty: its only one",
        search=lambda properties, _context, _text: _of_map(properties, contents.layer_names),
    )
    map_block: StringProperty(
        name="Block Column",
        description="Attribute of the polygons with the name or the code of the block. Empty: the only "
        "attribute, or the one with a usual name",
        search=lambda properties, _context, _text: _of_map(
            properties, contents.column_names, properties.map_layer or None
        ),
    )
    map_ground: StringProperty(
        name="Ground",
        description="Ground of the map: a surface of the list, or a file (raster, points or mesh). Empty: "
        "the youngest surface",
        search=lambda properties, context, _text: [*_surfaces(context), *_rasters(properties)],
    )
    map_accuracy: FloatProperty(
        name="Accuracy",
        description="Standard deviation of the positions of lines on the map. 0: a two-hundredth of the "
        "diagonal of the region",
        min=0.0,
        subtype="DISTANCE",
    )
    layer: StringProperty(
        name="Layer",
        description="Object of an OMF or geoh5 file with the boreholes, or the sheets of a workbook, with "
        "semicolons. Empty: all boreholes of the file",
    )
    collars: StringProperty(
        name="Collars",
        description="Table with hole, x, y and z of each borehole. Empty: it is among the chosen files, or "
        "the rows of picks and intervals have x, y and z",
    )
    survey: StringProperty(
        name="Survey",
        description="Table with hole, depth along it, azimuth, and dip or inclination. Empty: it is among "
        "the chosen files, or holes have the direction in the collars, or go straight down",
    )
    downward_dip: EnumProperty(
        name="Downward Dip",
        description="Sign of the dips of holes that point down",
        items=[
            ("TABLE", "As in the table", "All dips of a table have one sign, and point down"),
            ("NEGATIVE", "Negative", "-90 is straight down"),
            ("POSITIVE", "Positive", "90 is straight down"),
        ],
    )
    columns: StringProperty(
        name="Columns",
        description="Columns with other names, in any of the tables, such as hole = BHID; "
        "depth = FROM; dip = (nothing: not read). There are " + ", ".join(field_tables.ALL_COLUMNS),
    )
    units: EnumProperty(
        name="Unit",
        description="Unit of all the tables",
        items=items(READING["units"].parts["z"].words),
    )
    names: StringProperty(
        name="Names",
        description="Meaning of the codes in the tables: surfaces, blocks or bodies, such as SST = "
        "Sandstone; Qal* = Alluvium; /^Q[0-9]/ = Alluvium; LC = (empty: ignored, as for lost core)",
    )
    unrepaired: StringProperty(
        name="Unrepaired",
        description="Rows of tables of boreholes that are used as they are written, such as collars.csv:17; "
        "survey.csv:3",
        options={"SKIP_SAVE"},
    )
    left_out: StringProperty(
        name="Left Out",
        description="Rows of tables of boreholes that are not used, such as collars.csv:17; survey.csv:3",
        options={"SKIP_SAVE"},
    )
    of = OF_HOLES

    def understood(self, preview):
        return field_tables.columns_of(preview)

    def tables(self, context):
        """FieldTables of the chosen files, and of those that are named. Raises InputRefused."""
        paths = self.paths() or [chosen_path(self, "the tables")]
        named = {
            kind: path
            for kind, text in (("collars", self.collars), ("survey", self.survey))
            if (path := _beside(paths[0], text)) is not None
        }
        for file in (*paths, *named.values()):
            require_file(file)
        return field_tables.sorted_out(
            paths,
            self.named_columns(),
            None if self.units == "NONE" else self.units,
            of_maps=self._of_maps(context, paths),
            downward_dip=None if self.downward_dip == "TABLE" else self.downward_dip.lower(),
            layer=self.layer.strip() or None,
            unrepaired=imported.rows_of(self.unrepaired),
            left_out=imported.rows_of(self.left_out),
            **named,
        )

    def called(self):
        """The properties of an operator for the same files, but for what codes mean."""
        ignored = ("filter_glob", "check_existing", "headings", "names", "files", "propose", "only_try")
        properties = self.as_keywords(ignore=ignored)
        paths = [str(path) for path in self.paths()]
        if paths:
            properties |= {"filepath": paths[0], "directory": os.path.dirname(paths[0])}
        properties["files"] = [{"name": file.name} for file in self.files]
        return properties | {"columns": reading_text.of_named(self.named_columns())}

    def named_columns(self):
        """{meaning: column} of those that are called otherwise than usually, as they were typed or chosen in
        the menus; False for what is ignored. Raises InputRefused where tables contradict one another."""
        columns = reading_text.named_columns(self.columns)
        chosen = [(self.columns_of(p.key), self.understood(p)) for p in self._previews]
        for of_table, usual in chosen:
            columns |= {m: name for m, name in of_table.items() if usual.get(m) != name}
        columns |= {m: False for of_table, usual in chosen for m in usual if m not in of_table}
        for of_table, _ in chosen:
            for meaning, column in of_table.items():
                if columns.get(meaning) is False:
                    what = f"'{meaning}' is column {column} in one table, and ignored in another"
                    raise InputRefused(what, advice="import the tables one after another")
                if columns.get(meaning, column) != column and "azimuth" not in of_table:
                    what = f"'{meaning}' is column {column} in one table and {columns[meaning]} in another"
                    raise InputRefused(what, advice="give the column the same name in all tables")
        return columns

    def _of_maps(self, context, paths):
        """The keys of MapFile. Raises InputRefused where the column of blocks is not said."""
        maps = [path for path in paths if field_tables.is_map(path)]
        names = _of_map(self, contents.column_names, self.map_layer or None)
        block = self.map_block.strip() or field_tables.block_attribute(names)
        if maps and not block:
            advice = f"choose Block Column: it has {', '.join(map(str, names))}" if names else None
            raise InputRefused("no attribute is known to name the blocks", file=maps[0], advice=advice)
        ground = self.map_ground.strip()
        if ground and ground not in _surfaces(context) and maps:
            path = _beside(maps[0], ground)
            require_file(path)
            ground = str(path)
        return {
            "block": block,
            "layer": self.map_layer.strip() or None,
            "ground": ground or None,
            "accuracy": settings.plain(self.map_accuracy) or None,
        }


def _beside(table, filepath):
    """The path of another table, which may stand beside one; None where none is given."""
    path = project_settings.absolute(filepath)
    return table.parent / filepath.strip() if path is not None and not os.path.isfile(path) else path
