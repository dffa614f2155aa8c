# SPDX-License-Identifier: GPL-3.0-or-later
"""Codes of units in field data get other meanings: their files are read again."""

import bpy
from bpy.props import StringProperty

from ..bl.project import borehole_picks, codes, library_rows, observed_blocks, reading_text, settings
from ..bl.scene import borehole_points, built_scene, live
from ..core import InputRefused
from .reporting import Reporting, a_rock, require_file
from .start import invoke


def with_codes(context):
    row = settings.active_rock(context.scene)
    has_codes = row is not None and len(row.codes)
    return None if has_codes else "no field data with codes were imported; import some first"


class _Regrouping(Reporting):
    """An operator that gives the chosen codes, or those that a pattern fits, another meaning. `unit_of(row)`:
    the unit of a code."""

    needs = (a_rock, with_codes)

    pattern: StringProperty(
        name="Pattern",
        description="The codes that this fits, in place of the chosen ones: Qal*, or several with commas",
        options={"SKIP_SAVE"},
    )

    def act(self, context):
        rock = settings.active_rock(context.scene)
        ticked = [row for row in rock.codes if row.chosen]
        rows = codes.fitting(rock, self.pattern) if self.pattern.strip() else ticked
        if not rows:
            advice = "tick codes in the list, or give a pattern such as Qal*"
            raise InputRefused("no code is chosen", advice=advice)
        for entry in codes.imports(rock):
            for file in codes.files_of(entry["properties"]):
                require_file(file)
        before = {row.unit for row in rock.codes}
        known, count = observed_blocks.units_of(context.scene, rock), len(rows)
        for row in rows:
            row.unit, row.chosen = known.surface(self.unit_of(row)), False
        borehole_points.forget(rock, borehole_picks.of_rock(rock))
        _give_way(context.scene, rock, before)
        for entry in codes.imports(rock):
            names = reading_text.of_named(codes.names(rock))
            invoke(bpy.ops.realmodel.boreholes_read, self, **entry["properties"], names=names)
        live.touch(context.scene)
        units = {row.unit for row in rock.codes if row.unit}
        self.report({"INFO"}, f"Codes changed: {count}; {len(rock.codes)} codes mean {len(units)} units")


def _give_way(scene, rock, before):
    """Surfaces without data of their own that no code means any more are removed; the oldest of them becomes
    the new unit, so that this has its place and its settings. before: the units that codes meant."""
    now = {row.unit for row in rock.codes}
    gone = [
        row.name
        for row in rock.surfaces
        if row.name in before - now and row.source == "NONE" and not row.dips
    ]
    known = observed_blocks.units_of(scene, rock)
    new = [unit for unit in now - before if unit and known.block(unit) is None]
    if gone and len(new) == 1:
        row = rock.surfaces[gone.pop(0)]
        is_own_block = row.block == row.name
        row.name = new[0]
        row.block = new[0] if is_own_block else row.block
        row.property_id = library_rows.for_surface(scene, row.name)
    with settings.filling():
        for name in gone:
            row = rock.surfaces[name]
            library_rows.remove_made(scene, row)
            built_scene.release_surface(scene, row)
            rock.surfaces.remove(rock.surfaces.find(name))
        rock.active_surface = max(0, min(rock.active_surface, len(rock.surfaces) - 1))


class REALMODEL_OT_codes_assign(_Regrouping, bpy.types.Operator):
    """Give the chosen codes of field data, or those that a pattern fits, a unit: a surface, a body, or a new
    one. Their files are read again"""

    bl_label = "Assign to Unit"

    unit: StringProperty(
        name="Unit",
        description="Surface or body that the codes mean; any other name makes a new unit",
        search=lambda _properties, context, _text: _units(context),
    )

    def invoke(self, context, event):
        return context.window_manager.invoke_props_dialog(self)

    def unit_of(self, _row):
        unit = self.unit.strip()
        if not unit:
            raise InputRefused("no unit is given", advice="give its name, or use Ignore Codes")
        return unit


def _units(context):
    scene, rock = context.scene, settings.active_rock(context.scene)
    names = [] if rock is None else [row.name for row in reversed(rock.surfaces)]
    return [*names, *(body.name for body in scene.realmodel.bodies)]


class REALMODEL_OT_codes_ignore(_Regrouping, bpy.types.Operator):
    """The chosen codes of field data, or those that a pattern fits, say nothing, as lost core. Their files
    are read again"""

    bl_label = "Ignore Codes"

    def unit_of(self, _row):
        return ""


class REALMODEL_OT_codes_reset(_Regrouping, bpy.types.Operator):
    """The chosen codes of field data, or those that a pattern fits, mean the units that are called as they
    are. Their files are read again"""

    bl_label = "Reset Codes"

    def unit_of(self, row):
        return row.name


class REALMODEL_OT_codes_choose(Reporting, bpy.types.Operator):
    """Tick the codes that a pattern fits"""

    bl_label = "Choose Codes"
    needs = (a_rock, with_codes)

    pattern: StringProperty(
        name="Pattern",
        description="Of codes: Qal*, or several with commas; empty: none are ticked, or all where none were",
        options={"SKIP_SAVE"},
    )

    def act(self, context):
        rock = settings.active_rock(context.scene)
        had_any = any(row.chosen for row in rock.codes)
        fitting = [row.name for row in codes.fitting(rock, self.pattern)]
        for row in rock.codes:
            row.chosen = row.name in fitting if self.pattern.strip() else not had_any
