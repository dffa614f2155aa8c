# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a series of a rock mass: consecutive surfaces that share their structure."""

import bpy
from bpy.props import StringProperty

from .bl import changes
from .bl.objects.stored_arrays import ArraysProperty
from .bl.project import choices, series_settings, settings
from .core.project.series import SERIES
from .props_schema import properties_of


def _end(name, description, at):
    """The field of the name of a series' youngest or oldest surface. at: its number among those of the
    series."""

    def get(row):
        rock = settings.rock_of(row)
        numbers = series_settings.members(rock, row)
        return rock.surfaces[numbers[at]].name if numbers else ""

    def set_name(row, wanted):
        rock = settings.rock_of(row)
        numbers = series_settings.members(rock, row)
        chosen = rock.surfaces.find(wanted)
        if chosen < 0:
            return
        ends = sorted((chosen, numbers[-1 - at])) if numbers else (chosen, chosen)
        passed = numbers and (chosen < numbers[0] if at else chosen > numbers[-1])
        changes.series_run(row, *((chosen, chosen) if passed else ends))

    return StringProperty(
        name=name,
        description=description,
        get=get,
        set=set_name,
        search=choices.surfaces_of_rock,
        options={"SKIP_SAVE"},
    )


class RealModelSeries(properties_of(SERIES, name=changes.name), bpy.types.PropertyGroup):
    """A series: level sets of one field in space, or sheets that are interpolated together."""

    known_name: StringProperty(options={"HIDDEN"})
    youngest: _end(
        "Youngest", "Youngest surface of the series: it and all down to the oldest belong to it", -1
    )
    oldest: _end("Oldest", "Oldest surface of the series: it and all up to the youngest belong to it", 0)
    dips = ArraysProperty()  # of realmodel.core.SpaceDips, or Dips of sheets
    exact = ArraysProperty()
