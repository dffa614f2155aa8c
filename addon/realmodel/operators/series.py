# SPDX-License-Identifier: GPL-3.0-or-later
"""The series of the active rock mass, and dips that are given by hand."""

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty

from ..bl.project import project_settings, series_settings, settings, surface_dips
from ..bl.scene import data_objects, live
from ..core import Dips, InputRefused, SpaceDips
from ..core.project.series import SERIES
from ..core.readers import gradient_of, normal_of
from ..core.settings.series import FIELD
from ..props_schema import items
from .reporting import Reporting, a_rock, a_surface, place_property


def a_series(context):
    rock = settings.active_rock(context.scene)
    has_series = rock is not None and len(rock.series)
    return None if has_series else "the rock mass has no series; add one first (Series, +)"


def dips_of_series(context):
    rock = settings.active_rock(context.scene)
    row = None if rock is None else series_settings.active(rock)
    return None if row is not None and row.dips else "the series has no dips"


def dips_to_give(context):
    row = settings.active_surface(context.scene)
    has_dips = row is not None and row.dips and series_settings.is_level_set(row)
    return None if has_dips else "the surface has no dips that a field could take"


class REALMODEL_OT_series_add(Reporting, bpy.types.Operator):
    """Add a series of consecutive surfaces that share their structure. It begins with the active surface;
    choose its youngest and its oldest one then"""

    bl_label = "Add Series"
    needs = (a_rock, a_surface)

    kind: EnumProperty(name="Kind", description=SERIES["kind"].tip, items=items(SERIES["kind"].words))

    def act(self, context):
        rock, surface = settings.active_rock(context.scene), settings.active_surface(context.scene)
        with settings.filling():
            row = rock.series.add()
            row.name = settings.free_name(rock.series, "series", own=row)
            row.kind = self.kind
            if not surface.series:
                surface.series = row.name
            rock.active_series = len(rock.series) - 1
        live.touch(context.scene)


class REALMODEL_OT_series_remove(Reporting, bpy.types.Operator):
    """Remove the active series with its dips; its surfaces stay, each by itself"""

    bl_label = "Remove Series"
    needs = (a_rock, a_series)

    def act(self, context):
        rock = settings.active_rock(context.scene)
        row = series_settings.active(rock)
        number = list(rock.series).index(row)
        with settings.filling():
            for surface in rock.surfaces:
                surface.series = "" if surface.series == row.name else surface.series
            rock.series.remove(number)
            rock.active_series = max(0, min(number, len(rock.series) - 1))
        data_objects.update(context.scene)
        live.touch(context.scene)


class REALMODEL_OT_series_move(Reporting, bpy.types.Operator):
    """Make all surfaces of the active series younger (up) or older (down): past the next surface, or past all
    of the next series"""

    bl_label = "Move Series"
    needs = (a_rock, a_series)

    direction: EnumProperty(
        name="Direction",
        description="Which way it moves among the surfaces",
        items=(
            ("UP", "Up", "Make it younger: up in the list of surfaces"),
            ("DOWN", "Down", "Make it older: down in the list of surfaces"),
        ),
    )

    def act(self, context):
        rock = settings.active_rock(context.scene)
        row = series_settings.active(rock)
        members = series_settings.members(rock, row)
        is_up = self.direction == "UP"
        at = (members[-1] + 1 if is_up else members[0] - 1) if members else -1
        if not 0 <= at < len(rock.surfaces):
            return {"CANCELLED"}
        passed = series_settings.of_surface(rock.surfaces[at])
        others = [at] if passed is None else series_settings.members(rock, passed)
        active = rock.surfaces[rock.active_surface].name
        for step, other in enumerate(others if is_up else reversed(others)):
            rock.surfaces.move(other, members[0] + step if is_up else members[-1] - step)
        rock.active_surface = rock.surfaces.find(active)
        if passed is not None:
            first, second = (list(rock.series).index(series) for series in (row, passed))
            rock.series.move(first, second)
            rock.active_series = second
        live.touch(context.scene)
        return {"FINISHED"}


class REALMODEL_OT_series_dips_remove(Reporting, bpy.types.Operator):
    """Remove the dips of the active series"""

    bl_label = "Remove Dips of Series"
    needs = (a_rock, dips_of_series)

    def act(self, context):
        surface_dips.keep(series_settings.active(settings.active_rock(context.scene)), None)
        data_objects.update(context.scene)
        live.touch(context.scene)


class REALMODEL_OT_series_take_dips(Reporting, bpy.types.Operator):
    """Give the dips of the active surface, which is a level set, to the field of its series. Where they have
    no height they lie at that of the mean of its points"""

    bl_label = "Give to Series"
    needs = (a_surface, dips_to_give)

    def act(self, context):
        scene, row = context.scene, settings.active_surface(context.scene)
        dips = surface_dips.of_row(row)
        z = dips.heights
        if np.isnan(z).any():
            points = data_objects.row_points(scene, row, context.evaluated_depsgraph_get())
            if points is None or not len(points):
                raise InputRefused("dips of a field need a height", advice="give them a column z")
            z = np.where(np.isnan(z), points[:, 2].mean(), z)
        normals = np.column_stack([-dips.gradients, np.ones(len(dips))])
        space_dips = SpaceDips(np.column_stack([dips.positions, z]), normals, dips.used)
        surface_dips.add(series_settings.of_surface(row), space_dips)
        surface_dips.keep(row, None)
        data_objects.update(scene)
        live.touch(scene)


class REALMODEL_OT_dip_add(Reporting, bpy.types.Operator):
    """Add a dip at the 3D cursor: of the active surface's series, in a field at any angle, or of the active
    surface, where it is in none"""

    bl_label = "Add Dip at Cursor"
    needs = (a_surface,)

    location: place_property("Where the dip was measured, in the coordinates of the scene")
    dip: FloatProperty(
        name="Dip", description="Degrees below the horizontal", default=30.0, min=0.0, max=90.0, precision=1
    )
    dip_direction: FloatProperty(
        name="Dip Direction",
        description="Degrees clockwise from north (+y)",
        default=90.0,
        soft_min=0.0,
        soft_max=360.0,
        precision=1,
    )
    overturned: BoolProperty(
        name="Overturned", description="The older rock is above: for series that are fields alone"
    )

    def act(self, context):
        scene, row = context.scene, settings.active_surface(context.scene)
        place = self.location if self.properties.is_property_set("location") else scene.cursor.location
        place = np.array(place, np.float64) + project_settings.model_origin(scene)
        dip, direction = settings.plain(self.dip), settings.plain(self.dip_direction)
        series = series_settings.of_surface(row)
        if series is not None:
            if series.kind != FIELD:
                self._require_sheet(series)
            normal = normal_of(dip, direction, self.overturned)
            surface_dips.add(series, SpaceDips(place[None], normal[None]))
        else:
            self._require_sheet(row)
            gradient = gradient_of(dip, direction)
            surface_dips.add(row, Dips(place[None, :2], gradient[None], place[2:]))
        with settings.filling():
            scene.realmodel.view.show_dips = True
        data_objects.update(scene)
        live.touch(scene)

    def _require_sheet(self, row):
        """Raises InputRefused for a dip that no sheet has."""
        if self.overturned or self.dip == 90.0:
            advice = "put it into a series of the kind Field, or give another dip"
            raise InputRefused(f"'{row.name}' has one height at each position", advice=advice)

    def invoke(self, context, _event):
        self.location = context.scene.cursor.location
        return context.window_manager.invoke_props_dialog(self)
