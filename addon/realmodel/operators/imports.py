# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of surfaces from files, with a preview of tables, and from objects."""

import contextlib
import os
from dataclasses import dataclass, field, replace
from pathlib import Path

import bpy
import numpy as np
from bpy.props import BoolProperty, CollectionProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..bl.display import bodies
from ..bl.field import field_tables
from ..bl.host import caches, notices
from ..bl.objects import shapes, viewports
from ..bl.objects.stored_arrays import file_stamp
from ..bl.project import (
    library_rows,
    method_settings,
    observed_blocks,
    plan_mesh,
    project_settings,
    reading_text,
    settings,
)
from ..bl.scene import data_objects, live
from ..core import InputRefused, MeshFile, PointFile, RealModelError, UsageError
from ..core.base.errors import HeightsMissing, counted
from ..core.base.triangles import open_edges
from ..core.project.terrain import NAME as TERRAIN
from ..core.project.terrain import terrain_shape
from ..core.readers import (
    is_mesh_file,
    objects_in,
    preview_table,
    read_mesh,
    read_point_file,
)
from ..core.readers.contents import column_values, layer_names
from ..core.readers.formats import ARRAY, MESH, OBJECTS, RASTER, SHAPES, TABLE, endings
from ..core.readers.object_input import read_objects
from ..core.readers.objects.geo_object import LINES, POINTS, SURFACE
from ..core.readers.tables.hole_tables import normalized_name
from ..core.settings.data_files import MESH_READING, READING
from ..core.settings.method_options import OptionRefused
from ..core.surfaces.age_order import age_order
from ..props_import import AXES, OF_HOLES, OF_POINTS, UNITS
from ..props_schema import properties_of
from ..registration import drop_handler
from ..ui import panel
from .import_dialog import WIDTH, ObjectDialog, TableDialog
from .reporting import Reporting, file_filter, require_file
from .rocks import add_rock
from .start import invoke

_OTHERS = {key: READING[key] for key in ("units", "z_axis", "decimal", "nodata")}  # in the dialog
_Options = properties_of(_OTHERS, None)
_LARGEST = 1 << 26  # bytes of a file that is read for what the dialog says of it
_ENDINGS = endings(MESH, TABLE, RASTER, ARRAY, SHAPES, OBJECTS)
_said = caches.new(most=32)  # by file and import options: what the dialog says of them


@dataclass
class _NewSurface:
    """A surface to add. places: its points or vertices (N, 3), or None where they are not known yet.
    is_named: by something in its file, so that a surface of this name takes it."""

    name: str
    source: str = ""
    path: Path | None = None
    item: object = None
    reading: dict = field(default_factory=dict)
    places: np.ndarray | None = None
    is_named: bool = False


def chosen_files(properties):
    """The paths of the files that an operator with `files` was given; of its properties alone, which is all
    that Blender gives to the function that proposes texts for one of them."""
    names = [file.name for file in properties.files if file.name]
    if names and properties.directory:
        return [project_settings.absolute(os.path.join(properties.directory, name)) for name in names]
    path = project_settings.absolute(properties.filepath)
    return [] if path is None else [path]


class FilesImportHelper(ImportHelper):
    """Chooses one file, or several; with a path, as of a dropped file, no file browser opens."""

    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"})
    filename_ext = ""

    paths = chosen_files


def previews(properties, of=OF_POINTS):
    """Previews of the tables among the chosen files, and with OF_HOLES of the sheets of workbooks with
    boreholes."""
    for path in chosen_files(properties):
        sheets = field_tables.hole_sheets(path) if of == OF_HOLES and os.path.isfile(path) else ()
        yield from (preview_table(path, sheet=sheet) for sheet in sheets)
        if sheets:
            continue
        if os.path.isfile(path) and path.suffix.lower() in endings(TABLE):
            with contextlib.suppress(InputRefused):  # files that are no tables are refused when they are read
                if not (is_mesh_file(path) or objects_in(path)):
                    yield preview_table(path)


class REALMODEL_OT_file_choose(Reporting, bpy.types.Operator, ImportHelper):
    """Choose another file, or none"""

    bl_label = "Choose File"

    row: StringProperty(
        name="Row", description="Path of the settings in the scene", options={"HIDDEN", "SKIP_SAVE"}
    )
    key: StringProperty(
        name="Setting", description="Setting that has the path of the file", options={"HIDDEN", "SKIP_SAVE"}
    )
    filepath: StringProperty(name="File", description="The file", subtype="FILE_PATH", options={"SKIP_SAVE"})
    none: BoolProperty(name="None", description="Take no file", options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def description(cls, context, properties):
        if properties.none:
            return "Take no file"
        return f"{_of_setting(context, properties)}\nClick to choose another file"

    def invoke(self, context, event):
        if self.none or not self.row:  # without a row it is refused
            return self.execute(context)
        self.filepath = str(project_settings.absolute(_of_setting(context, self)))
        return ImportHelper.invoke(self, context, event)

    def act(self, context):
        before = _of_setting(context, self)
        path = "" if self.none else self.filepath
        if path:
            require_file(project_settings.absolute(path))
            if before.startswith("//"):
                with contextlib.suppress(ValueError):  # on another drive of Windows
                    path = bpy.path.relpath(path)
        setattr(context.scene.path_resolve(self.row), self.key, path)


def _of_setting(context, properties):
    """The path that a setting has now. Raises UsageError where there is no such setting."""
    try:
        return getattr(context.scene.path_resolve(properties.row), properties.key)
    except (ValueError, AttributeError) as error:
        raise UsageError(f"the scene has no setting '{properties.row}.{properties.key}'") from error


class REALMODEL_OT_surface_add(
    Reporting,
    TableDialog,
    ObjectDialog,
    _Options,
    bpy.types.Operator,
    FilesImportHelper,
):
    """Add surfaces above the youngest one, from files of points or meshes, or from a mesh object"""

    bl_label = "Import Surfaces"

    name: StringProperty(
        name="Name",
        description="Name of the surface; empty: that of its file or object",
        options={"SKIP_SAVE"},
    )
    filepath: StringProperty(
        name="File",
        description="File with its points or its mesh",
        subtype="FILE_PATH",
        options={"SKIP_SAVE"},  # with a path, as of a dropped file, no file browser opens
    )
    use_object: BoolProperty(
        name="Active Object",
        description="Take the active mesh object as the surface instead of a file",
        options={"SKIP_SAVE", "HIDDEN"},
    )
    as_terrain: BoolProperty(
        name="Terrain",
        description="Make it the terrain, the boundary above all other surfaces. Replaces an earlier one",
        options={"SKIP_SAVE", "HIDDEN"},
    )
    empty: BoolProperty(
        name="Empty", description="Choose the source afterwards", options={"SKIP_SAVE", "HIDDEN"}
    )
    columns: StringProperty(
        name="x, y, z",
        description="Columns of x, y and z in tables, by name or by number from 1. Empty: the columns with "
        "these names, or the first three",
        options={"SKIP_SAVE"},
    )
    split: BoolProperty(
        name="One Surface for Each Value",
        description="Make one surface for each value in a column of the table",
        options={"SKIP_SAVE"},
    )
    split_column: StringProperty(
        name="Column",
        description="Column whose values name the surfaces. Empty: the first suitable one",
        search=lambda properties, _context, _text: [
            name for preview in previews(properties) for name in preview.splits
        ],
        options={"SKIP_SAVE"},
    )
    filter_glob: file_filter(*_ENDINGS)
    of = OF_POINTS
    _browses = False
    _folder = ""  # of the last files that were chosen

    def act(self, context):
        if self._browses:
            type(self)._folder = os.path.dirname(self.filepath)
            chosen = {"filepath": self.filepath, "directory": self.directory}
            chosen["files"] = [{"name": file.name} for file in self.files]
            chosen["as_terrain"] = self.as_terrain
            invoke(bpy.ops.realmodel.surface_add, self, **chosen)
            return
        scene = context.scene
        surfaces, warnings = self._new_surfaces(context)
        if self.as_terrain:
            if len(surfaces) > 1:
                raise InputRefused("a terrain is one surface", advice="choose one file with one surface")
            surfaces[0].name = self.name.strip() or TERRAIN
        rock = settings.active_rock(scene) or add_rock(scene)
        units = observed_blocks.units_of(scene, rock)
        read = {}
        with settings.filling():
            for surface in surfaces:
                row = _terrain_row(rock) if self.as_terrain else None
                if row is None:
                    row = _row_of(scene, rock, surface, units, warnings)
                    row.is_terrain = self.as_terrain
                if surface.item is not None:
                    row.source, row.object = "MESH_OBJECT", surface.item
                elif surface.path is not None:
                    row.source, row.filepath = surface.source, str(surface.path)
                    kind = MeshFile if surface.source == "MESH_FILE" else PointFile
                    given = kind(surface.path, **surface.reading)
                    method_settings.fill_reading(row, given)
                    if self.as_terrain:
                        shape = terrain_shape(given)
                        method_settings.set_options(row, shape.get("method"), shape.get("options", {}))
                    if surface.source == "POINTS_FILE" and surface.places is not None:
                        read[data_objects.file_key(row)] = surface.places
            rock.active_surface = len(rock.surfaces) - 1
        arrived(context, rock, [s.places for s in surfaces if s.item is None and s.places is not None], read)
        self.remember(self._other_reading())
        for text in warnings:
            self.report({"WARNING"}, text)

    def invoke(self, context, event):
        if self.use_object or self.empty:
            return self.execute(context)
        if not self.paths():
            self._browses = True
            folder = self._folder or os.path.dirname(bpy.data.filepath) or os.path.expanduser("~")
            self.filepath = os.path.join(folder, "")  # no name of a .blend as a proposal
            return ImportHelper.invoke(self, context, event)
        try:
            self.begin_objects(_objects_of(self.paths()))
        except (RealModelError, OSError):  # it is reported where the file is read
            return self.execute(context)
        reading = self.begin_tables(list(previews(self)))
        for key in _OTHERS:
            method_settings.set_value(self.properties, key, _OTHERS, reading.get(key, _OTHERS[key].default))
        if not self.headings and len(self.objects) < 2:
            return self.execute(context)
        return context.window_manager.invoke_props_dialog(self, width=WIDTH)

    def check(self, _context):
        self.settle_columns()
        self.settle_objects()
        return True  # the dialog is drawn anew

    def understood(self, preview):
        columns = dict(preview.axes)
        named = next(iter(preview.splits), "") if preview.is_plain else ""
        columns |= {UNITS: named} if named else {}
        return {meaning: reading_text.column(name) for meaning, name in columns.items()}

    def draw(self, context):
        layout = self.layout
        if context.space_data is not None and context.space_data.type == "FILE_BROWSER":
            layout.label(text="One file, or several")
            return
        if len(self.objects) > 1:
            self.draw_objects(layout)
        self.draw_tables(layout, lambda preview: self._said(context, preview.file))
        layout.use_property_split = True
        for key in _OTHERS:
            if self._previews or key != "decimal":
                panel.draw(layout, self, key, _OTHERS)

    def _said(self, context, path):
        """What is to be said of a table as it would be read: its extent and warnings, or why it is
        refused."""
        surfaces = [replace(surface, places=None) for surface in self._of_table(path)]
        key = file_stamp(path), context.scene.realmodel.units, repr([s.reading for s in surfaces])
        if key not in _said:
            names = ", ".join(surface.name for surface in surfaces)
            _said[key] = [(f"{counted(len(surfaces), 'surface')}: {names}", "BLANK1")]
            whole = {name: option for name, option in surfaces[0].reading.items() if name != "where"}
            if os.path.getsize(path) <= _LARGEST:
                _said[key] += _reading_says(replace(surfaces[0], reading=whole), key[1])
        return _said[key]

    def _new_surfaces(self, context):
        """The surfaces to add, the oldest first, and warnings about them. Raises InputRefused."""
        if self.use_object:
            obj = context.active_object
            if obj is None or obj.type != "MESH":
                raise InputRefused("the active object is no mesh", advice="make a mesh object active")
            shapes.require_open(obj)
            return [_NewSurface(self.name.strip() or obj.name, item=obj)], []
        paths = [] if self.empty else self.paths()
        if not paths:
            return [_NewSurface(self.name.strip() or "surface")], []
        surfaces, warnings = [], []
        for path in paths:
            for surface in self._of_file(path):
                texts = _read(surface, context.scene.realmodel.units)
                warnings += [text for text in texts if text not in warnings]
                surfaces.append(surface)
        if len(surfaces) == 1:
            surfaces[0].name = self.name.strip() or surfaces[0].name
            return surfaces, warnings
        names = [surface.name for surface in surfaces]
        order = age_order(names, [surface.places for surface in surfaces])
        warnings += [text] if (text := order.warning(names)) else []
        return [surfaces[number] for number in order.order], warnings

    def _of_file(self, path):
        """The surfaces of a file: one, or one for each of its objects, or for each value of a column."""
        require_file(path)
        objects = [obj for obj in objects_in(path) if not obj.is_part]
        if len(objects) > 1:
            return self._of_objects(path, objects)
        if not objects and (layers := [row.name for row in self.objects if row.file == str(path)]):
            return self._of_layers(path, layers)
        if is_mesh_file(path):
            return [_NewSurface(path.stem, "MESH_FILE", path, reading=self._other_reading(*MESH_READING))]
        if path.suffix.lower() in endings(TABLE):
            return self._of_table(path)
        reading = self._other_reading("units", "z_axis", "nodata")
        return [_NewSurface(path.stem, "POINTS_FILE", path, reading=reading)]

    def _of_layers(self, path, layers):
        """The chosen layers of a GeoPackage, or sheets of a workbook."""
        reading = self._other_reading("units", "z_axis", "nodata")
        return [
            _NewSurface(name, "POINTS_FILE", path, reading={**reading, "layer": name}, is_named=True)
            for name in layers
            if self.wants(path, name)
        ]

    def _of_table(self, path):
        """The surfaces of a table: one, or one for each value of a column."""
        columns, reading = self.columns_of(path), self._other_reading()
        if columns:
            axes = [columns.get(axis) for axis in AXES]
            if axes != [self._understood(path).get(axis) for axis in AXES]:
                reading["columns"] = [axis for axis in axes if axis is not None]
        elif self.columns.strip():
            reading["columns"] = [reading_text.column(name) for name in self.columns.split(",")]
        whole = _NewSurface(path.stem, "POINTS_FILE", path, reading=reading)
        column = str(columns.get(UNITS, "")) if columns else self._split_column(path)
        if not column:
            return [whole]
        values = dict.fromkeys(reading_text.value(text) for text in column_values(path, column))
        return [
            replace(
                whole,
                name=value if isinstance(value, str) else f"{path.stem} {value}",
                reading={**reading, "where": {column: value}},
                is_named=True,
            )
            for value in values
        ]

    def _understood(self, path):
        return next((self.understood(p) for p in self._previews if p.file == path), {})

    def _split_column(self, path):
        """The column of a table whose values name surfaces, as a script gives it; "" for none."""
        if not (self.split or self.split_column):
            return ""
        column = self.split_column or next(iter(preview_table(path).splits), "")
        return "" if len(self.files) > 1 and column not in preview_table(path).names else column

    def _other_reading(self, *keys):
        """The import options of the dialog beside columns, or some of them, that are not at their default."""
        keys = [key for key in keys or _OTHERS if key in _OTHERS]
        chosen = {key: method_settings.value(self, key, _OTHERS) for key in keys}
        return {key: option for key, option in chosen.items() if option not in (None, _OTHERS[key].default)}

    def _of_objects(self, path, objects):
        """The chosen surfaces of a file of objects, each by its name: its open surfaces, and sets of points
        and lines. Closed ones are blocks of another model."""
        surfaces = []
        for obj in objects:
            if not self.wants(path, obj.name):
                continue
            if obj.kind in (POINTS, LINES):
                source, reading = "POINTS_FILE", self._other_reading("units", "z_axis", "nodata")
            elif obj.kind == SURFACE and _is_open(read_mesh(MeshFile(path, layer=obj.name))):
                source, reading = "MESH_FILE", self._other_reading(*MESH_READING)
            else:
                continue
            reading["layer"] = obj.name
            surfaces.append(_NewSurface(obj.name, source, path, reading=reading, is_named=True))
        if not surfaces:
            what = "no object of it is chosen" if self.objects else "it has neither open surfaces nor points"
            raise InputRefused(what, file=path)
        return surfaces


def _is_open(mesh):
    return len(open_edges(mesh.vertices, mesh.triangles)) > 0


def _objects_of(paths):
    """(path, name, kind, size) of the objects, layers and sheets of files that can be surfaces; the size of
    the latter is not known, 0. Raises InputRefused."""
    kinds = (SURFACE, POINTS, LINES)
    for path in paths:
        if not objects_in(path) and len(layers := layer_names(path)) > 1:
            yield from ((path, name, POINTS, 0) for name in layers)
        whole = [obj.name for obj in objects_in(path) if obj.kind in kinds and not obj.is_part]
        for obj in read_objects(path, None, kinds) if whole else ():
            if obj.name not in whole:
                continue
            if obj.triangles is None:
                yield path, obj.name, obj.kind, len(obj.vertices)
            elif _is_open(obj):
                yield path, obj.name, obj.kind, len(obj.triangles)


def _row_of(scene, rock, surface, units, warnings):
    """The row that takes a new surface: that of its name, where it has no data yet, or is named in a file;
    else another one."""
    alike = [row for row in rock.surfaces if _letters(row.name) == _letters(surface.name)]
    row = rock.surfaces.get(units.surface(surface.name)) or (alike[0] if len(alike) == 1 else None)
    has_data = row is not None and (row.object or row.filepath or row.stored or row.stored_mesh)
    if row is not None and (surface.is_named or not has_data) and surface.path is not None:
        if has_data:
            warnings.append(f"surface '{row.name}' is made from {surface.path.name} now")
        project_settings.forget_shape(row)
        row.stored_mesh, row.object = {}, None
        return row
    row = rock.surfaces.add()
    row.name = settings.free_name(rock.surfaces, surface.name, own=row)
    row.property_id = library_rows.for_surface(scene, row.name)
    return row


def _terrain_row(rock):
    """The row that becomes the terrain: the one that is, or the youngest where it has no data; None where a
    new one is needed."""
    row = settings.terrain_of(rock)
    youngest = rock.surfaces[-1] if len(rock.surfaces) else None
    if row is None and youngest is not None and project_settings.is_free(youngest) and not youngest.series:
        row = youngest
    if row is not None:
        project_settings.forget_shape(row)
        row.is_terrain = True
    return row


def _letters(name):
    return normalized_name(name).replace("_", "")


def _read(surface, unit):
    """Reads the points or the mesh of a surface, and returns warnings. Raises InputRefused where no import
    options could make the file readable. Missing heights of shapes are no error: their source can be chosen
    once the surface is there."""
    if surface.source == "MESH_FILE":
        mesh_file = MeshFile(surface.path, **surface.reading)
        surface.places, warnings = read_mesh(mesh_file).in_model(mesh_file, unit)
        return warnings
    point_file = PointFile(surface.path, **surface.reading)
    try:
        point_file.check()
    except OptionRefused as error:
        raise InputRefused(error.what, file=surface.path, advice=error.advice) from error
    with contextlib.suppress(HeightsMissing):
        surface.places, warnings = read_point_file(point_file, unit)
        return warnings
    return []


def _reading_says(surface, unit):
    """(text, icon) of what reading a surface says: where its points are, and warnings; or why it is
    refused."""
    try:
        warnings = _read(surface, unit)
    except RealModelError as error:
        return [(notices.in_panel_words(str(error)), "ERROR")]
    low, high = surface.places.min(axis=0), surface.places.max(axis=0)
    ranges = ", ".join(f"{axis} {a:,.1f} to {b:,.1f}" for axis, a, b in zip(AXES, low, high, strict=True))
    said = f"{counted(len(surface.places), 'point')}, in {unit}: {ranges}"
    return [(said, "CHECKMARK"), *((notices.in_panel_words(text), "INFO") for text in warnings)]


def arrived(context, rock, places, read=None):
    """Updates the scene for new data of a rock mass (None: of a fault): the origin if there is none, an edge
    length, the display and the view. places: arrays (N, 3) in model coordinates. read: as for
    data_objects.update."""
    scene = context.scene
    if places:
        points = np.concatenate(places)
        data_objects.begin(scene, points)
        if rock is not None:
            plan_mesh.propose_edge_length(rock, points)
    with settings.filling():
        scene.realmodel.show_data = scene.realmodel.show_data or bool(places)
    data_objects.update(scene, read)
    if places and not len(scene.realmodel.results):
        context.view_layer.update()
        shown = data_objects.objects(scene) + project_settings.user_objects(scene)
        shown += bodies.listed(scene, "map")
        viewports.frame_items(shown, viewports.spaces(context))
    live.touch(scene)


REALMODEL_FH_surfaces = drop_handler(
    "REALMODEL_FH_surfaces",
    "Tables, meshes, grids, and maps that are dropped into the viewport become surfaces",
    "RealModel surfaces",
    ("realmodel.surface_add", _ENDINGS),
)
