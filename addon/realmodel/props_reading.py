# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a surface that say how its file of points or mesh is read, where it does not tell that."""

from bpy.props import EnumProperty, StringProperty

from .bl import changes, reading_text


def _text(key, name, description):
    return StringProperty(
        name=name,
        description=description,
        options={"SKIP_SAVE"},  # it is kept in `reading`
        get=lambda row: reading_text.text(row, key),
        set=lambda row, given: reading_text.set_text(row, key, given),
        update=changes.reading,
    )


def _choice(key, items, name, description):
    return EnumProperty(
        name=name,
        description=description,
        items=[(item[0] or "NONE", *item[1:]) for item in items],
        options={"SKIP_SAVE"},
        get=lambda row: reading_text.choice(row, key, items),
        set=lambda row, number: reading_text.set_choice(row, key, items, number),
        update=changes.reading,
    )


class ReadingSettings:
    """For the property group of a surface. They are kept together, in its `reading`."""

    columns: _text(
        "columns",
        "Columns",
        "The columns of x, y and z, by name or by number from 1, such as X, Y, Z or 2, 3, 5; empty: those "
        "named so, or the first three",
    )
    where: _text(
        "where",
        "Only rows",
        "Only rows whose columns hold this count, such as horizon = top clay; year = 2019, 2020. Text in "
        "quotes is taken as it is",
    )
    separator: _text(
        "separator",
        "Separator",
        "The character between the columns, or tab, or blank; empty: told from the file",
    )
    decimal: _choice(
        "decimal", reading_text.DECIMALS, "Decimals", "What stands between whole numbers and decimals"
    )
    nodata: _text("nodata", "No value", "What stands for no value, such as -9999; such points are left out")
    height_attribute: _text(
        "height",
        "Height is",
        "Of contour lines and the like: the attribute that holds their height; empty: z of the positions",
    )
    layer: _text("layer", "Layer", "The layer of a GeoPackage that has several")
    plan_unit: _choice("xy", reading_text.UNITS, "x, y in", "Unit of the coordinates in plan in the file")
    height_unit: _choice("z", reading_text.UNITS, "Heights in", "Unit of the heights in the file")
