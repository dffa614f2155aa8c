# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of boreholes, observed blocks and dips: what a rock mass is made from, in several tables at once."""

import os
from collections import Counter

import bpy
import numpy as np
from bpy.props import BoolProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..bl.field import boreholes, field_tables, map_settings
from ..bl.host import caches, notices
from ..bl.objects import stored_arrays
from ..bl.project import (
    borehole_picks,
    imported,
    interval_values,
    method_settings,
    observed_blocks,
    plan_mesh,
    reading_text,
    series_settings,
    settings,
    surface_dips,
)
from ..bl.scene import borehole_points, data_objects, live
from ..core import InputRefused, RealModelError
from ..core.base.errors import counted
from ..core.readers import contents, table_contents, table_kind
from ..core.readers.borehole_input import read_repaired
from ..core.readers.code_counts import count_codes
from ..core.readers.hole_values import is_log
from ..core.readers.object_input import is_object_file
from ..core.settings.series_kinds import FIELD
from ..core.surfaces.field_data import left_out_texts
from ..ui.panel import message
from .chosen_tables import ChosenTables
from .import_dialog import LETTERS, SHOWN, WIDTH
from .imports import arrived, previews
from .reporting import Reporting, a_rock, a_surface
from .rocks import add_rock
from .start import invoke

_SHOWN = ("collars", "survey", "downward_dip", "columns", "units", "layer", "names")
_OF_IMPORTS = ("add_surfaces",)  # a proposal has all units
_OF_MAPS = ("map_layer", "map_block", "map_ground", "map_accuracy")
_MOST_DETAILED = 8  # chosen files of which columns and codes are shown
_MOST_CODES = 20
_LARGEST = 1 << 24  # bytes of tables that are read for what the dialog says of them
_kinds = caches.new(most=64)  # by file and columns: what is shown of chosen tables


def _series(context):
    row = settings.active_rock(context.scene)
    return [] if row is None else [series.name for series in row.series]


class REALMODEL_OT_boreholes_read(Reporting, ChosenTables, bpy.types.Operator):
    """Read field data, all files at once: boreholes as tables of collars, surveys, picks, intervals and
    assays, LAS files, and drillholes of OMF or geoh5 files; observations of blocks, such as outcrops; dips;
    geological maps. The columns show the type of each table. Dips apply to the surfaces or blocks that their
    rows name, otherwise to the active surface or its series. Surfaces keep the data that they have; missing
    surfaces are added"""

    bl_label = "Import Field Data"

    series: StringProperty(
        name="Dips Of Series",
        description="Series that gets the dips, at any angle and with polarity, whatever their rows name. "
        "Empty: rows without a name go to the series of the active surface, if it is a field",
        search=lambda _properties, context, _text: _series(context),
        options={"SKIP_SAVE"},
    )
    add_surfaces: BoolProperty(
        name="Add Surfaces",
        description="Add surfaces that are in the tables but not in the list, the oldest first. A unit of "
        "intervals becomes the block beneath its surface",
        default=True,
    )

    propose: BoolProperty(
        name="Propose Project",
        description="Make a project from these data, and replace the model: the order of units, erosion, "
        "lenses, region, base and ground, each with its reason",
        options={"SKIP_SAVE"},
    )

    only_try: BoolProperty(
        name="Only Try",
        description="Read the files, and change nothing",
        options={"SKIP_SAVE", "HIDDEN"},
    )

    _browses = False

    def invoke(self, context, event):
        if not self.paths():
            self._browses = True
            return ImportHelper.invoke(self, context, event)
        reading = self.begin_tables(list(previews(self, self.of)))
        self.units = reading.get("units", self.units)
        if not self.properties.is_property_set("propose"):
            self.propose = not settings.has_rows(context.scene) and self._may_propose(context)
        return context.window_manager.invoke_props_dialog(self, width=WIDTH)

    def act(self, context):
        if self._browses:
            invoke(bpy.ops.realmodel.boreholes_read, self, **self.called())
            return
        if self.propose:
            self._remember()
            invoke(bpy.ops.realmodel.propose_project, self, **self._of_proposal())
            return
        scene = context.scene
        tables = self.tables(context)
        series = _series_for_dips(scene, self.series)
        is_of_sheets = series is not None and series.kind != FIELD
        if series is not None and not is_of_sheets:
            tables.give_dips_to_series(every=bool(self.series))
        surface = _surface_for_dips(scene).name if tables.dips and series is None else ""
        rock = settings.active_rock(scene)
        data = field_tables.read(scene, rock, tables, reading_text.named_texts(self.names), self.add_surfaces)
        if self.only_try:
            return
        rock = rock or add_rock(scene)
        field_tables.forget(rock, data)
        warnings = [*data.picks.warnings, *data.warnings, *left_out_texts(data.left_out).values()]
        if data.picks.points or data.picks.switched_off or data.new:
            warnings += borehole_points.give(scene, rock, data.picks, self.add_surfaces, data.new)
        places = list(data.picks.points.values())
        if len(data.observations):
            observed_blocks.add(rock, data.observations)
            places.append(data.observations.places)
        if surface:
            row = rock.surfaces[surface]  # it may have moved where surfaces were added
            surface_dips.add(row, data.dips)
            warnings += method_settings.dips_unused(row)
        if is_of_sheets:
            data.give_dips_to_sheets()
        if data.rock_dips is not None:
            surface_dips.add(rock, data.rock_dips)
        if data.series_dips is not None:
            surface_dips.add(series, data.series_dips)
        borehole_picks.keep(rock, data.picks.holes)
        borehole_picks.keep_ends(rock, data.picks.ends)
        for draped, file in zip(data.maps, tables.maps, strict=True):
            map_settings.keep(rock, draped)
            places.append(draped.vertices)
            if ground := map_settings.take_ground(rock, file):
                text = "is made from the ground, as the youngest surface; check the order of the surfaces"
                warnings.append(f"'{ground}' {text}")
        for values in data.values:
            interval_values.add(rock, values)
            places.append(values.begins)
        if data.new and places:
            plan_mesh.propose_base(rock, np.concatenate(places), is_of_map=bool(data.maps))
        with settings.filling():
            view = scene.realmodel.view
            logs = data.picks.logs
            view.show_boreholes = view.show_boreholes or bool(data.picks.holes) or logs is not None
            if logs is not None:
                view.boreholes_by = boreholes.column(scene) or next(iter(logs.columns), "")
                view.show_hole_curves = True
            view.show_dips = view.show_dips or bool(tables.dips or tables.rock_dips or tables.series_dips)
            view.show_map = view.show_map or bool(data.maps)
        counts = count_codes(*tables.coded, units=scene.realmodel.units)
        known = observed_blocks.units_of(scene, rock, reading_text.named_texts(self.names))
        imported.record(rock, self.called(), counts, data.picks.problems, known)
        arrived(context, rock, places)
        self._remember()
        for text in warnings:
            self.report({"WARNING"}, text)
        self.report({"INFO"}, _summary(data, surface or (series.name if series is not None else "")))

    def _remember(self):
        self.remember({} if self.units == "NONE" else {"units": self.units})

    def _may_propose(self, context):
        """Whether there is enough for a proposal in the chosen files."""
        try:
            tables = self.tables(context)
        except RealModelError:
            return False
        return tables.boreholes is not None or any(file.ground for file in tables.maps)

    def _of_proposal(self):
        called = self.called()
        others = {key: called[key] for key in called if key not in ("series", "add_surfaces")}
        return others | {"names": self.names}

    def draw(self, context):
        layout = self.layout
        shown = [path for path in self.paths() if os.path.isfile(path)]
        if context.space_data is not None and context.space_data.type == "FILE_BROWSER":
            box = layout.box().column(align=True)
            self._draw_kinds(box, shown, most=None)
            if not shown:
                box.label(text="Choose all tables at once", icon="INFO")
            return
        try:
            columns, problem = reading_text.of_named(self.named_columns()), ""
        except InputRefused as error:
            columns, problem = self.columns, str(error)
        self.draw_tables(layout, lambda preview: self._said(preview.file, columns, preview.sheet))
        drawn = [preview.file for preview in self._previews[:SHOWN]]
        self._draw_kinds(layout.column(align=True), [path for path in shown if path not in drawn], LETTERS)
        for text, icon in [(problem, "ERROR")] if problem else self._said_of_all(context):
            message(layout.column(align=True), text, icon=icon, most=LETTERS)
        self._draw_options(context, layout.column(align=True), shown)

    def _draw_kinds(self, box, paths, most):
        """What files are taken for. most: letters in a line."""
        for path in paths:
            said = self._said(path, self.columns)
            message(box, f"{path.name}: {said[0][0]}", icon=said[0][1], most=most)
            for text, icon in said[1:] if len(paths) <= _MOST_DETAILED else ():
                lines = box.column(align=True)
                lines.active = False
                message(lines, text, icon=icon, most=most)

    def _said(self, path, columns, sheet=None):
        """(text, icon) of what a file, or a sheet of it, is taken for, and of what is read of it."""
        text, icon, contained = shown_kind(path, columns, self.map_layer, self.map_block, sheet)
        return [(text, icon), *((part, "BLANK1") for part in contained)]

    def _said_of_all(self, context):
        """(text, icon) of what reading the boreholes says: warnings, and how many problems are repaired; or
        why they are refused."""
        try:
            boreholes = self.tables(context).boreholes
            if boreholes is None or any(is_object_file(file) for file in boreholes.files):
                return []
            stamps = [stored_arrays.file_stamp(file) for file in boreholes.files]
            key = repr((stamps, boreholes, context.scene.realmodel.units))
            if key not in _kinds:
                if sum(os.path.getsize(file) for file in boreholes.files) > _LARGEST:
                    return []
                tables = read_repaired(boreholes, context.scene.realmodel.units)
                kinds = Counter(problem.kind for problem in tables.problems)
                said = [f"{count} x {kind}" for kind, count in kinds.items()]
                _kinds[key] = [(text, "INFO") for text in (*tables.warnings, *said)]
            return _kinds[key]
        except RealModelError as error:
            return [(notices.in_panel_words(str(error)), "ERROR")]

    def _draw_options(self, context, layout, shown):
        layout.prop(self, "propose", icon="SHADERFX", toggle=True)
        if self.propose and settings.has_rows(context.scene):
            layout.label(text=f"It takes the place of {context.scene.realmodel.name}", icon="QUESTION")
        layout.use_property_split = True
        has_maps = any(field_tables.is_map(path) for path in shown)
        of_series = ("series",) if _series(context) else ()
        of_imports = () if self.propose else (*of_series, *_OF_IMPORTS)
        for name in (*(_OF_MAPS if has_maps else ()), *_SHOWN, *of_imports):
            if name != "columns" or not self._previews:  # else the menus say it
                layout.prop(self, name)

    def check(self, _context):
        self.settle_columns()
        return True  # a file of any ending; what the chosen tables are is drawn anew


def shown_kind(path, columns, map_layer="", map_block="", sheet=None):
    """What a chosen file, or a sheet of it, is taken for, an icon, and sentences of what is read of it."""
    key = stored_arrays.file_stamp(path), columns, map_layer, map_block, sheet
    if key not in _kinds:
        try:
            named = reading_text.named_columns(columns)
            kind = "boreholes" if field_tables.has_holes(path) else None
            kind = "log" if kind and is_log(path) else kind
            kind = "map" if field_tables.is_map(path) else kind
            sheets = {} if sheet is not None else field_tables.hole_sheets(path)
            if sheets:
                kind, contained = "boreholes", [f"{name}: {of}" for name, of in sheets.items()]
            elif kind == "map":
                contained = _map_contents(path, map_layer.strip() or None, map_block.strip())
            else:
                contained = () if kind else _contained(*table_contents(path, named, sheet))
            _kinds[key] = kind or table_kind(path, named, sheet), "CHECKMARK", contained
        except RealModelError as error:
            _kinds[key] = error.what, "ERROR", ()
    return _kinds[key]


def _map_contents(path, layer, block):
    names = contents.column_names(path, layer)
    block = block or field_tables.block_attribute(names)
    if not block:
        return [f"choose Block Column: {', '.join(names)}"]
    return _contained({"block": block}, sorted(contents.column_values(path, block, layer)))


def _contained(columns, codes):
    """Sentences: the columns of a table, as Columns has them, and its codes, for Names."""
    named = [
        f"{meaning}\u00a0=\u00a0{name}" for meaning, name in columns.items() if name not in ("", meaning)
    ]
    more = len(codes) - _MOST_CODES
    listed = ", ".join(codes[:_MOST_CODES]) + (f" and {more} more" if more > 0 else "")
    return [text for text in ("; ".join(named), listed and f"codes {listed}") if text]


def _surface_for_dips(scene):
    """The row of the active surface. Raises InputRefused where dips cannot be of it."""
    row = settings.active_surface(scene)
    if row is None:
        advice = "import the surface first, and make it the active one"
        raise InputRefused("there is no surface that the dips could be of", advice=advice)
    if row.source in method_settings.READY_MESHES:
        what = f"'{row.name}' is made of an object or a mesh, and takes no dips"
        raise InputRefused(what, advice="make a surface from points the active one")
    return row


def _series_for_dips(scene, name):
    """The row of the series of this name or, without one, that of the active surface, where it is a level
    set; None where it is none. Raises InputRefused."""
    rock, surface = settings.active_rock(scene), settings.active_surface(scene)
    if not name:
        is_of_field = surface is not None and series_settings.is_level_set(surface)
        return series_settings.of_surface(surface) if is_of_field else None
    rows = [] if rock is None else list(rock.series)
    series = next((row for row in rows if row.name == name), None)
    if series is None:
        advice = f"there are {', '.join(row.name for row in rows)}" if rows else "add one first (Series, +)"
        raise InputRefused(f"there is no series '{name}'", advice=advice)
    return series


def _summary(data, of):
    """What was read, in one sentence. of: the name of the surface or of the series whose dips were read."""
    said = []
    names = dict.fromkeys((*data.picks.points, *data.new))
    if data.picks.points:
        said.append(f"points for {counted(len(data.picks.points), 'surface')}")
    elif data.new:
        said.append(counted(len(data.new), "new surface"))
    if len(data.observations):
        said.append(f"{counted(len(data.observations), 'observation')} of blocks")
    if data.maps:
        said.append(f"{counted(sum(len(draped.triangles) for draped in data.maps), 'triangle')} of a map")
    if data.dips is not None:
        said.append(f"{counted(len(data.dips), 'dip')} of '{of}'")
    if data.series_dips is not None:
        said.append(f"{counted(len(data.series_dips), 'dip')} of series '{of}'")
    columns = dict.fromkeys(name for values in data.values for name in values.columns)
    if columns:
        said.append(f"{'column' if len(columns) == 1 else 'columns'} {', '.join(columns)} to color by")
    if data.rock_dips is not None:
        said.append(f"{counted(len(data.rock_dips), 'dip')} of the rock mass")
    text = ", ".join(said) or "nothing that could be used"
    text = text[0].upper() + text[1:]
    return f"{text}: {', '.join(names)}" if names else text


def observed(context):
    row = settings.active_rock(context.scene)
    return None if row is not None and row.observations else "the rock mass has no observations of blocks"


def dips_of_rock(context):
    row = settings.active_rock(context.scene)
    return None if row is not None and row.dips else "the rock mass has no dips"


def with_dips(context):
    row = settings.active_surface(context.scene)
    return None if row is not None and row.dips else "the surface has no dips"


class REALMODEL_OT_observations_remove(Reporting, bpy.types.Operator):
    """Remove the observations of the rock mass, including logged intervals. Points and picks stay"""

    bl_label = "Remove Observations"
    needs = (a_rock, observed)

    def act(self, context):
        row = settings.active_rock(context.scene)
        borehole_picks.remove_at(row, observed_blocks.places_of(row))
        observed_blocks.keep(row, None)
        data_objects.update(context.scene)
        live.touch(context.scene)


class REALMODEL_OT_dips_remove(Reporting, bpy.types.Operator):
    """Remove the dips of the active surface"""

    bl_label = "Remove Dips"
    needs = (a_surface, with_dips)

    def act(self, context):
        surface_dips.keep(settings.active_surface(context.scene), None)
        live.touch(context.scene)


class REALMODEL_OT_rock_dips_remove(Reporting, bpy.types.Operator):
    """Remove the dips of the rock mass. The dips of single surfaces stay"""

    bl_label = "Remove Dips of Rock Mass"
    needs = (a_rock, dips_of_rock)

    def act(self, context):
        surface_dips.keep(settings.active_rock(context.scene), None)
        live.touch(context.scene)
