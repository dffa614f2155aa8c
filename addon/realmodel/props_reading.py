# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a surface that say how its file of points or mesh is read, where it does not tell that."""

from bpy.props import EnumProperty, StringProperty

from .bl import reading_text


def _text(key, name, description):
    return StringProperty(
        name=name,
        description=description,
        options={"SKIP_SAVE"},  # it is kept in `reading`
        get=lambda row: reading_text.text(row, key),
        set=lambda row, given: reading_text.set_text(row, key, given),
    )


def _choice(key, items, name, description):
    return EnumProperty(
        name=name,
        description=description,
        items=[(item[0] or "NONE", *item[1:]) for item in items],
        options={"SKIP_SAVE"},
        get=lambda row: reading_text.choice(row, key, items),
        set=lambda row, number: reading_text.set_choice(row, key, items, number),
    )


class ReadingSettings:
    """For the property group of a surface. They are kept together, in its `reading`."""

    columns: _text(
        "columns",
        "Columns",
        "Columns of x, y and z, by name or by number from 1, such as X, Y, Z or 2, 3, 5; empty: detected "
        "from their names, else the first three",
    )
    where: _text(
        "where",
        "Filter",
        "Only rows with these values are read, such as horizon = top clay; year = 2019, 2020. Text in "
        "quotes is taken as it is",
    )
    separator: _text(
        "separator",
        "Separator",
        "Character between the columns, or tab, or blank; empty: detected from the file",
    )
    decimal: _choice(
        "decimal", reading_text.DECIMALS, "Decimal Separator", "Decimal separator of the numbers in the file"
    )
    nodata: _text(
        "nodata", "NoData Value", "Value that marks missing data, such as -9999; such points are skipped"
    )
    height_attribute: _text(
        "height",
        "Elevation Field",
        "Attribute with the elevation of each feature, such as a contour line; empty: z of the coordinates",
    )
    layer: _text("layer", "Layer", "Layer of a GeoPackage with several layers")
    plan_unit: _choice("xy", reading_text.UNITS, "Unit of X, Y", "Unit of the plan coordinates in the file")
    height_unit: _choice("z", reading_text.UNITS, "Unit of Z", "Unit of the elevations in the file")
