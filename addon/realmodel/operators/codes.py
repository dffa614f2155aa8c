# SPDX-License-Identifier: GPL-3.0-or-later
"""Codes of units in field data get other meanings, and repairs of boreholes are refused: the files are read
again."""

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty

from ..bl.field import hole_validation
from ..bl.project import borehole_picks, imported, library_rows, observed_blocks, reading_text, settings
from ..bl.scene import borehole_points, built_scene, live
from ..core import BuildFailed, InputRefused
from .reporting import Reporting, a_rock, require_file
from .start import run


def with_codes(context):
    row = settings.active_rock(context.scene)
    has_codes = row is not None and len(row.codes)
    return None if has_codes else "no field data with codes were imported; import some first"


def require_files(rock):
    """Raises InputRefused where a file of the imports of a rock mass is not there any more."""
    for entry in imported.imports(rock):
        for file in imported.files_of(entry["properties"]):
            require_file(file)


def read_again(rock, changed=None, only_try=False):
    """Reads the files of the imports of a rock mass again, with the present meanings of its codes. changed:
    {code: unit} of others. only_try: nothing is changed. Raises BuildFailed."""
    for entry in imported.imports(rock):
        names = reading_text.of_named(imported.names(rock, changed or {}))
        run(bpy.ops.realmodel.boreholes_read, **entry["properties"], names=names, only_try=only_try)


class _Regrouping(Reporting):
    """An operator that gives the chosen codes, or those that a pattern fits, another meaning. `unit_of(row)`:
    the unit of a code."""

    needs = (a_rock, with_codes)

    pattern: StringProperty(
        name="Pattern",
        description="Use the codes that match, instead of the ticked ones: Qal*, several with commas, or a "
        "regular expression such as /^Q[0-9]/",
        options={"SKIP_SAVE"},
    )

    def act(self, context):
        rock = settings.active_rock(context.scene)
        ticked = [row for row in rock.codes if row.chosen]
        rows = imported.fitting(rock, self.pattern) if self.pattern.strip() else ticked
        if not rows:
            advice = "tick codes in the list, or give a pattern such as Qal*"
            raise InputRefused("no code is chosen", advice=advice)
        require_files(rock)
        before = {row.unit for row in rock.codes}
        known, count = observed_blocks.units_of(context.scene, rock), len(rows)
        changed = {row.name: known.surface(self.unit_of(row)) for row in rows}
        read_again(rock, changed, only_try=True)
        for row in rows:
            row.unit, row.chosen = changed[row.name], False
        borehole_points.forget(rock, borehole_picks.of_rock(rock))
        _give_way(context.scene, rock, before)
        read_again(rock)
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
    """Assign the ticked codes of field data, or those that match a pattern, to a unit: a surface, a body, or
    a new one. Their files are read again"""

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
    """Ignore the ticked codes of field data, or those that match a pattern, as for lost core. Their files are
    read again"""

    bl_label = "Ignore Codes"

    def unit_of(self, _row):
        return ""


class REALMODEL_OT_codes_reset(_Regrouping, bpy.types.Operator):
    """Make each ticked code of field data, or each that matches a pattern, a unit of its own name. Their
    files are read again"""

    bl_label = "Reset Codes"

    def unit_of(self, row):
        return row.name


class REALMODEL_OT_codes_move(_Regrouping, bpy.types.Operator):
    """Move the ticked codes of field data, those that match a pattern, or the active one, to the next younger
    or older unit of the list of surfaces. Their files are read again"""

    bl_label = "Move Codes"

    direction: EnumProperty(
        name="Direction",
        description="The unit that they move to",
        items=(("UP", "Up", "The next younger unit"), ("DOWN", "Down", "The next older unit")),
    )

    def act(self, context):
        rock = settings.active_rock(context.scene)
        if not self.pattern.strip() and not any(row.chosen for row in rock.codes):
            rock.codes[rock.active_code].chosen = True
        super().act(context)

    def unit_of(self, row):
        surfaces = [surface.name for surface in settings.active_rock(bpy.context.scene).surfaces]
        if row.unit not in surfaces:
            what = f"code '{row.name}' means no surface"
            raise InputRefused(what, advice="assign it to a unit, or reset it")
        place = surfaces.index(row.unit) + (1 if self.direction == "UP" else -1)
        if not 0 <= place < len(surfaces):
            age = "youngest" if self.direction == "UP" else "oldest"
            raise InputRefused(f"code '{row.name}' is of the {age} unit", advice="move it the other way")
        return surfaces[place]


class REALMODEL_OT_codes_choose(Reporting, bpy.types.Operator):
    """Tick the codes that match a pattern"""

    bl_label = "Choose Codes"
    needs = (a_rock, with_codes)

    pattern: StringProperty(
        name="Pattern",
        description="Pattern of codes: Qal*, several with commas, or a regular expression such as "
        "/^Q[0-9]/. Empty: untick all, or tick all if none is ticked",
        options={"SKIP_SAVE"},
    )

    def act(self, context):
        rock = settings.active_rock(context.scene)
        had_any = any(row.chosen for row in rock.codes)
        fitting = [row.name for row in imported.fitting(rock, self.pattern)]
        for row in rock.codes:
            row.chosen = row.name in fitting if self.pattern.strip() else not had_any


def with_problems(context):
    row = settings.active_rock(context.scene)
    has_some = row is not None and len(row.hole_problems)
    return None if has_some else "the tables of boreholes had no problems"


class _OfAProblem(Reporting):
    needs = (a_rock, with_problems)

    index: IntProperty(
        name="Index",
        description="Number of the problem in the list, from 0; -1: the active one",
        default=-1,
        options={"SKIP_SAVE"},
    )

    def problem(self, context):
        """The row of the problem. Raises InputRefused."""
        rock = settings.active_rock(context.scene)
        number = rock.active_hole_problem if self.index < 0 else self.index
        if not 0 <= number < len(rock.hole_problems):
            raise InputRefused("no row of the list is active", advice="choose a problem in the list")
        rock.active_hole_problem = number
        return rock, rock.hole_problems[number]


class REALMODEL_OT_hole_problem_decide(_OfAProblem, bpy.types.Operator):
    """Use a row of a table of boreholes as it is written, leave it out, or repair it again. The files are
    read again"""

    bl_label = "Decide on Row"

    decision: EnumProperty(
        name="Decision",
        description="What becomes of the row",
        items=(
            ("REPAIR", "Repair", "RealModel repairs the row or leaves it out"),
            ("WRITTEN", "Use as Written", "The row is used as written"),
            ("LEFT_OUT", "Leave Out", "The row is not used"),
        ),
    )

    def act(self, context):
        rock, problem = self.problem(context)
        row, before = f"{problem.file}:{problem.line}", rock.imports
        require_files(rock)
        imported.decide(rock, problem.file, row, self.decision)
        try:
            read_again(rock, only_try=True)
        except BuildFailed:
            rock.imports = before
            raise
        read_again(rock)
        live.touch(context.scene)
        self.report({"INFO"}, f"{row}: {self.decision.lower().replace('_', ' ')}")


class REALMODEL_OT_hole_problem_show(_OfAProblem, bpy.types.Operator):
    """Turn the viewport to the hole of a problem, and show the boreholes with their names"""

    bl_label = "Show Hole"

    def act(self, context):
        rock, problem = self.problem(context)
        if not hole_validation.show_hole(context, rock, problem.hole):
            raise InputRefused(f"hole '{problem.hole}' has no place", advice="it has no collar, or no data")
