# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of surfaces from files, with a preview of tables, and from objects."""

import contextlib
import os
from dataclasses import dataclass, field
from pathlib import Path

import bpy
import numpy as np
from bpy.props import BoolProperty, CollectionProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..bl.display import bodies
from ..bl.objects import shapes, viewports
from ..bl.project import library_rows, method_settings, plan_mesh, project_settings, reading_text, settings
from ..bl.scene import data_objects, live
from ..core import InputRefused, MeshFile, PointFile
from ..core.base.errors import HeightsMissing, counted
from ..core.base.triangles import open_edges
from ..core.readers import (
    is_mesh_file,
    objects_in,
    preview_table,
    read_mesh,
    read_point_file,
)
from ..core.readers.contents import column_values
from ..core.readers.formats import ARRAY, MESH, OBJECTS, RASTER, SHAPES, TABLE, endings
from ..core.readers.objects.geo_object import LINES, POINTS, SURFACE
from ..core.settings.method_options import OptionRefused
from ..core.surfaces.age_order import age_order
from ..registration import drop_handler
from .reporting import Reporting, file_filter, require_file
from .rocks import add_rock
from .start import invoke

_SHOWN = 8  # columns of a preview
_PREVIEWED = 3  # files
_ENDINGS = endings(MESH, TABLE, RASTER, ARRAY, SHAPES, OBJECTS)


@dataclass
class _Given:
    """A surface to add. places: its points or vertices (N, 3), or None where they are not known yet."""

    name: str
    source: str = ""
    path: Path | None = None
    item: object = None
    reading: dict = field(default_factory=dict)
    places: np.ndarray | None = None


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


def _looked_at(properties):
    """Previews of the tables among the chosen files."""
    for path in chosen_files(properties):
        if os.path.isfile(path) and path.suffix.lower() in endings(TABLE):
            with contextlib.suppress(InputRefused):  # files that are no tables are refused when they are read
                if not is_mesh_file(path):
                    yield preview_table(path)


class REALMODEL_OT_surface_add(Reporting, bpy.types.Operator, FilesImportHelper):
    """Add surfaces above the youngest one: from one or more files of points or meshes, or a mesh object"""

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
    empty: BoolProperty(
        name="Empty", description="Choose the source afterwards", options={"SKIP_SAVE", "HIDDEN"}
    )
    columns: StringProperty(
        name="x, y, z",
        description="The columns of x, y and z in tables, by name or by number from 1; empty: those named "
        "so, or the first three",
        options={"SKIP_SAVE"},
    )
    split: BoolProperty(
        name="One Surface for Each Value",
        description="Make one surface for each value in a column of the table",
        options={"SKIP_SAVE"},
    )
    split_column: StringProperty(
        name="Column",
        description="The column whose values name the surfaces; empty: the first one that may",
        search=lambda properties, _context, _text: [
            name for preview in _looked_at(properties) for name in preview.splits
        ],
        options={"SKIP_SAVE"},
    )
    filter_glob: file_filter(*_ENDINGS)
    _browses = False
    _folder = ""  # of the last files that were chosen
    _previews = ()

    def act(self, context):
        if self._browses:
            type(self)._folder = os.path.dirname(self.filepath)
            chosen = {"filepath": self.filepath, "directory": self.directory}
            chosen["files"] = [{"name": file.name} for file in self.files]
            invoke(bpy.ops.realmodel.surface_add, self, **chosen)
            return
        scene = context.scene
        surfaces, warnings = self._given(context)
        rock = settings.active_rock(scene) or add_rock(scene)
        read = {}
        with settings.filling():
            for surface in surfaces:
                row = rock.surfaces.add()
                row.name = settings.free_name(rock.surfaces, surface.name, own=row)
                row.property_id = library_rows.for_surface(scene, row.name)
                if surface.item is not None:
                    row.source, row.object = "MESH_OBJECT", surface.item
                elif surface.path is not None:
                    row.source, row.filepath = surface.source, str(surface.path)
                    kind = MeshFile if surface.source == "MESH_FILE" else PointFile
                    method_settings.fill_reading(row, kind(surface.path, **surface.reading))
                    if surface.source == "POINTS_FILE" and surface.places is not None:
                        read[data_objects.file_key(row)] = surface.places
            rock.active_surface = len(rock.surfaces) - 1
        arrived(context, rock, [s.places for s in surfaces if s.item is None and s.places is not None], read)
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
        self._previews = list(_looked_at(self))
        if not self._previews:
            return self.execute(context)
        self.split = self._previews[0].is_plain
        self.split_column = next(iter(self._previews[0].splits), "")
        return context.window_manager.invoke_props_dialog(self, width=560)

    def check(self, _context):
        return True  # a file of any ending; the dialog is drawn anew

    def draw(self, context):
        layout = self.layout
        if context.space_data is not None and context.space_data.type == "FILE_BROWSER":
            layout.label(text="One file, or several")
            return
        for preview in self._previews[:_PREVIEWED]:
            _draw_preview(layout.box(), preview)
        if len(self._previews) > _PREVIEWED:
            layout.label(text=f"and {len(self._previews) - _PREVIEWED} more tables")
        layout.prop(self, "columns")
        values = next(
            (p.splits[self.split_column] for p in self._previews if self.split_column in p.splits), []
        )
        if any(p.splits for p in self._previews):
            layout.prop(self, "split", text=f"One Surface for Each Value of {self.split_column or '...'}")
            column = layout.column()
            column.enabled = self.split
            column.prop(self, "split_column")
            column.label(text=f"{counted(len(values), 'value')}: {', '.join(values)}"[:90])

    def _given(self, context):
        """The surfaces to add, the oldest first, and warnings about them. Raises InputRefused."""
        if self.use_object:
            obj = context.active_object
            if obj is None or obj.type != "MESH":
                raise InputRefused("the active object is no mesh", advice="make a mesh object active")
            shapes.require_open(obj)
            return [_Given(self.name.strip() or obj.name, item=obj)], []
        paths = [] if self.empty else self.paths()
        if not paths:
            return [_Given(self.name.strip() or "surface")], []
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
        """The surfaces of a file: one, or one for each value of a column."""
        require_file(path)
        objects = [obj for obj in objects_in(path) if not obj.is_part]
        if len(objects) > 1:
            return self._of_objects(path, objects)
        if is_mesh_file(path):
            return [_Given(path.stem, "MESH_FILE", path)]
        reading = {}
        if self.columns.strip() and path.suffix.lower() in endings(TABLE):
            reading["columns"] = [reading_text.column(name) for name in self.columns.split(",")]
        whole = _Given(path.stem, "POINTS_FILE", path, reading=reading)
        if not (self.split or self.split_column) or path.suffix.lower() not in endings(TABLE):
            return [whole]
        if not self.split and self.options.is_invoke:  # unticked in the dialog
            return [whole]
        column = self.split_column or next(iter(preview_table(path).splits), "")
        if not column or (len(self.files) > 1 and column not in preview_table(path).names):
            return [whole]
        values = dict.fromkeys(reading_text.value(text) for text in column_values(path, column))
        return [
            _Given(
                value if isinstance(value, str) else f"{path.stem} {value}",
                "POINTS_FILE",
                path,
                reading={**reading, "where": {column: value}},
            )
            for value in values
        ]

    def _of_objects(self, path, objects):
        """The surfaces of a file of objects, each by its name: its open surfaces, and sets of points and
        lines. Closed ones are blocks of another model."""
        surfaces = []
        for obj in objects:
            layer = {"layer": obj.name}
            if obj.kind in (POINTS, LINES):
                surfaces.append(_Given(obj.name, "POINTS_FILE", path, reading=layer))
            elif obj.kind == SURFACE:
                mesh = read_mesh(MeshFile(path, **layer))
                if len(open_edges(mesh.vertices, mesh.triangles)):
                    surfaces.append(_Given(obj.name, "MESH_FILE", path, reading=layer))
        if not surfaces:
            raise InputRefused("it has neither open surfaces nor points", file=path)
        return surfaces


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


def _draw_preview(box, preview):
    """The first rows of a table, a box for each column, with what is taken for x, y and z."""
    box.label(text=preview.file.name, icon="FILE")
    row = box.row(align=True)
    for number, name in enumerate(preview.names[:_SHOWN]):
        column = row.column(align=True)
        axis = "xyz"[preview.xyz.index(name)] if name in preview.xyz else ""
        text = name if not axis or name.casefold() == axis else f"{axis}: {name}"
        column.label(text=text, icon="CHECKMARK" if axis else "BLANK1")
        cells = column.box().column(align=True)
        cells.active = bool(axis)
        for entries in preview.rows:
            cells.label(text=entries[number] if number < len(entries) else "")
    if preview.problem:
        box.label(text=preview.problem[:100], icon="ERROR")


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
