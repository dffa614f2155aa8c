# SPDX-License-Identifier: GPL-3.0-or-later
"""The lists of faults and of bodies."""

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..bl import changes
from ..bl.objects import shapes
from ..bl.project import library_rows, project_settings, series_settings, settings, surface_dips
from ..bl.scene import built_scene, data_objects, live
from ..core import Dips, InputRefused, MapLayer, MeshFile, SpaceDips
from ..core.base.errors import HeightsMissing
from ..core.base.triangles import open_edges
from ..core.project.series import SERIES
from ..core.readers import (
    gradient_of,
    is_mesh_file,
    normal_of,
    objects_in,
    read_mesh,
    read_shapes,
)
from ..core.readers.fault_input import read_fault_points
from ..core.readers.formats import MESH, OBJECTS, SHAPES, STICKS, TABLE, endings
from ..core.readers.objects.geo_object import SURFACE
from ..core.settings.data_files import PointFile
from ..core.settings.series_kinds import FIELD
from ..core.structures.shapes.fitted import VERTICAL
from ..props_schema import items
from ..registration import drop_handler
from .imports import FilesImportHelper, arrived
from .reporting import (
    Reporting,
    a_body,
    a_fault,
    a_rock,
    a_structure,
    a_surface,
    file_filter,
    place_property,
    remove_row,
    require_file,
    row_number,
    selected_shapes,
)
from .surfaces import library_items
from .view import edit_interface

_KINDS = (
    ("AUTO", "By Shape", "A closed mesh is a body, an open one a fault, and so are points"),
    ("FAULT", "Faults", "All are faults"),
    ("BODY", "Bodies", "All are bodies"),
)


def _surface_of(row):
    """The object with the shape of a fault or a body; None before there is one."""
    return row.object if row.source == "MESH_OBJECT" else row.interface


def _its_surface(context):
    obj = _surface_of(settings.active_structure(context.scene))
    is_shown = obj is not None and obj.name in context.view_layer.objects
    return None if is_shown else "it has no surface in the scene yet; choose its object, or press Build first"


def _is_surface(scene, obj):
    """Whether an object is a surface of the model already, or of its structures."""
    return any(obj in (row.object, row.interface) for _, row in settings.interface_rows(scene))


def _active_in_its_list(scene):
    """(kind, list, number in it) of the active fault or body."""
    row = settings.active_structure(scene)
    kind = settings.kind_of(row)
    rows = settings.structures_of(scene, kind)
    return kind, rows, list(rows).index(row)


def _add(scene, kind, name, source):
    """A row for a fault or a body, which becomes the active one."""
    rows = settings.structures_of(scene, kind)
    with settings.filling():
        if not scene.realmodel.exists:
            settings.begin(scene.realmodel)
        row = rows.add()
        row.name = settings.free_name(rows, name, own=row)
        row.source = source
        if kind == "body":
            row.property_id = library_rows.for_surface(scene, row.name)
        scene.realmodel.structure_kind = kind.upper()
        setattr(scene.realmodel, f"active_{kind}", len(rows) - 1)
    return row


def _shapes_in(path):
    """A file as a MeshFile, or each of the surfaces in a file of objects. Raises InputRefused."""
    require_file(path)
    if not (objects := objects_in(path)):
        return [MeshFile(path)]
    surfaces = [obj.name for obj in objects if obj.kind == SURFACE and not obj.is_part]
    if not surfaces:
        raise InputRefused("it has no surfaces", file=path)
    return [MeshFile(path)] if len(surfaces) == 1 else [MeshFile(path, layer=name) for name in surfaces]


def _kind_of_shape(wanted, vertices, triangles):
    if wanted != "AUTO":
        return wanted.lower()
    return "fault" if len(open_edges(vertices, triangles)) else "body"


def _counts_text(kinds):
    """The numbers of faults and bodies, as text."""
    counts = [(kinds.count("fault"), "fault", "faults"), (kinds.count("body"), "body", "bodies")]
    return ", ".join(f"{count} {one if count == 1 else many}" for count, one, many in counts if count)


class REALMODEL_OT_fault_body_from_selected(Reporting, bpy.types.Operator):
    """Add the selected objects: a closed mesh as a body, an open mesh as a fault, and a curve or a mesh of
    edges as the trace of a vertical fault. Set its dip afterward"""

    bl_label = "From Selected Meshes"
    needs = (selected_shapes,)

    kind: EnumProperty(name="Kind", description="What they are", items=_KINDS, options={"SKIP_SAVE"})

    def act(self, context):
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        chosen = [
            obj
            for obj in context.selected_objects
            if settings.is_region_object(None, obj) and not _is_surface(scene, obj)
        ]
        if not chosen:
            raise InputRefused(
                "the selected meshes are in the model already", advice="select other mesh objects"
            )
        kinds = [self._looked_at(obj, depsgraph) for obj in chosen]
        for obj, (kind, source) in zip(chosen, kinds, strict=True):
            row = _add(scene, kind, obj.name, source)
            with settings.filling():
                row.object = obj
                if source == "TRACE_OBJECT":
                    settings.set_number(row, "dip", VERTICAL)
        live.touch(scene)
        self.report({"INFO"}, f"Added {_counts_text([kind for kind, _ in kinds])}")

    def _looked_at(self, obj, depsgraph):
        """(kind, source) of an object. Raises InputRefused."""
        vertices, triangles = shapes.triangulation(obj, depsgraph)
        if obj.type == "MESH" and len(triangles):
            return _kind_of_shape(self.kind, vertices, triangles), "MESH_OBJECT"
        if self.kind == "BODY" or not shapes.has_edges(obj, depsgraph):
            raise InputRefused(f"object '{obj.name}' has no faces", advice="select meshes with faces")
        shapes.lines(obj, depsgraph)
        return "fault", "TRACE_OBJECT"


class REALMODEL_OT_fault_body_add(Reporting, bpy.types.Operator, FilesImportHelper):
    """Add faults and bodies from files: meshes (TSurf, OFF, OBJ, ...); fault sticks and points, through which
    a surface is fitted; or lines of a map, which continue along their dip"""

    bl_label = "Import Faults and Bodies"

    filepath: StringProperty(
        name="File",
        description="File with the mesh, the fault sticks, or the points",
        subtype="FILE_PATH",
        options={"SKIP_SAVE"},
    )
    kind: EnumProperty(name="Kind", description="What they are", items=_KINDS, options={"SKIP_SAVE"})
    empty: BoolProperty(
        name="Empty", description="Choose the source afterwards", options={"SKIP_SAVE", "HIDDEN"}
    )
    filter_glob: file_filter(*endings(MESH, OBJECTS, STICKS, TABLE, SHAPES))

    def invoke(self, context, event):
        if self.empty or self.paths():
            return self.execute(context)
        return ImportHelper.invoke(self, context, event)

    def check(self, _context):
        return True

    def act(self, context):
        scene = context.scene
        if self.empty:
            kind = scene.realmodel.structure_kind.lower() if self.kind == "AUTO" else self.kind.lower()
            _add(scene, kind, kind, "MESH_OBJECT")
            return
        meshes = [mesh for path in self.paths() for mesh in _shapes_in(path)]
        structures = [self._looked_at(mesh, scene.realmodel.units) for mesh in meshes]
        if not structures:
            raise InputRefused("no file was given", advice="choose a file")
        for kind, source, mesh, places in structures:
            data_objects.begin(scene, places)
            row = _add(scene, kind, mesh.layer or mesh.file.stem, source)
            with settings.filling():
                row.filepath, row.layer = str(mesh.file), mesh.layer or ""
        of_data = ("POINTS_FILE", "TRACE_FILE")
        arrived(context, None, [places for _, source, _, places in structures if source in of_data])
        self.report({"INFO"}, f"Added {_counts_text([kind for kind, *_ in structures])}")

    def _looked_at(self, mesh_file, units):
        """(kind, source, MeshFile, vertices or points) of a file, or of an object in one. Raises
        InputRefused."""
        path = mesh_file.file
        if mesh_file.layer is None and not is_mesh_file(path):
            if self.kind == "BODY":
                raise InputRefused(f"{path.name} has no triangles", advice="give a closed mesh for a body")
            try:
                points, _ = read_fault_points(PointFile(path), None, units)
            except HeightsMissing:
                lines = [line for _, line in read_shapes(MapLayer(path), units).lines]
                if not lines:
                    raise
                plan = np.concatenate(lines)
                return "fault", "TRACE_FILE", mesh_file, np.column_stack([plan, np.zeros(len(plan))])
            whole = points if isinstance(points, np.ndarray) else np.concatenate(points)
            return "fault", "POINTS_FILE", mesh_file, whole
        mesh = read_mesh(mesh_file)
        vertices, _ = mesh.in_model(mesh_file, units)
        return _kind_of_shape(self.kind, vertices, mesh.triangles), "MESH_FILE", mesh_file, vertices


class REALMODEL_OT_fault_body_remove(Reporting, bpy.types.Operator):
    """Remove the active fault or body. Your own mesh stays in the scene"""

    bl_label = "Remove Fault or Body"
    needs = (a_structure,)

    def act(self, context):
        scene = context.scene
        kind, rows, number = _active_in_its_list(scene)
        row = rows[number]
        with settings.filling():
            if kind == "body":
                library_rows.remove_made(scene, row)
            else:
                for other in rows:
                    for at in reversed([n for n, end in enumerate(other.ends_at) if end.name == row.name]):
                        other.ends_at.remove(at)
            built_scene.release_surface(scene, row)
            rows.remove(number)
            setattr(scene.realmodel, f"active_{kind}", max(0, min(number, len(rows) - 1)))
        data_objects.update(scene)
        live.touch(scene)


class REALMODEL_OT_fault_body_copy(Reporting, bpy.types.Operator):
    """Add a copy of the active fault or body just below it in the list, from the same source"""

    bl_label = "Copy Fault or Body"
    needs = (a_structure,)

    def act(self, context):
        scene = context.scene
        kind, rows, number = _active_in_its_list(scene)
        row = rows.add()
        source = rows[number]
        settings.copy_row(source, row)
        with settings.filling():
            row.name = settings.free_name(rows, source.name, own=row)
            row.interface, row.interface_digest, row.figures = None, "", ""
            if row.source not in settings.OF_OBJECTS:
                row.object = None
            rows.move(len(rows) - 1, number + 1)
            setattr(scene.realmodel, f"active_{kind}", number + 1)
        data_objects.update(scene)
        live.touch(scene)


class REALMODEL_OT_fault_body_move(Reporting, bpy.types.Operator):
    """Move the active fault or body in its list. Where bodies overlap, the lower one in the list counts"""

    bl_label = "Move Fault or Body"
    needs = (a_structure,)

    direction: EnumProperty(
        name="Direction",
        description="Which way it moves in the list",
        items=(("UP", "Up", "Up in the list"), ("DOWN", "Down", "Down in the list")),
    )

    def act(self, context):
        scene = context.scene
        kind, rows, number = _active_in_its_list(scene)
        target = number + (-1 if self.direction == "UP" else 1)
        if not 0 <= target < len(rows):
            return {"CANCELLED"}
        rows.move(number, target)
        setattr(scene.realmodel, f"active_{kind}", target)
        live.touch(scene)
        return {"FINISHED"}


class REALMODEL_OT_fault_body_hide(Reporting, bpy.types.Operator):
    """Hide the surface of the active fault or body in the viewport, or show it again. Builds still use it"""

    bl_label = "Hide or Show Fault or Body"
    needs = (a_structure,)

    def act(self, context):
        row = settings.active_structure(context.scene)
        row.hide = not row.hide


class REALMODEL_OT_fault_body_edit(Reporting, bpy.types.Operator):
    """Edit the surface of the active fault or body: show the blocks with it and enter Edit Mode"""

    bl_label = "Edit Fault or Body"
    needs = (a_structure, _its_surface)

    def act(self, context):
        edit_interface(context, _surface_of(settings.active_structure(context.scene)))


class REALMODEL_OT_body_property(Reporting, bpy.types.Operator):
    """Choose the property of the active body from the library"""

    bl_label = "Property of the Body"
    needs = (a_body,)

    property_id: EnumProperty(name="Property", description="The entry of the library", items=library_items)

    def act(self, context):
        settings.active_structure(context.scene).property_id = int(self.property_id)


_LISTS = (
    ("ENDS_AT", "Faults", "The faults at which it ends"),
    ("ROCKS", "Rock Masses", "The rock masses that it displaces"),
)


class REALMODEL_OT_fault_list_add(Reporting, bpy.types.Operator):
    """Add a row for a fault at which the active one ends, or for a rock mass that it displaces"""

    bl_label = "Add"
    needs = (a_fault,)

    of: EnumProperty(name="List", description="Which list", items=_LISTS)

    def act(self, context):
        getattr(settings.active_structure(context.scene), self.of.lower()).add()


class REALMODEL_OT_fault_list_remove(Reporting, bpy.types.Operator):
    """Remove a row from the faults at which the active one ends, or from its rock masses"""

    bl_label = "Remove"
    needs = (a_fault,)

    of: EnumProperty(name="List", description="Which list", items=_LISTS)
    index: row_number()

    def act(self, context):
        rows = getattr(settings.active_structure(context.scene), self.of.lower())
        remove_row(rows, self.index, "row")
        live.touch(context.scene)


REALMODEL_FH_faults_and_bodies = drop_handler(
    "REALMODEL_FH_faults_and_bodies",
    "Meshes and fault sticks that are dropped into the viewport become faults and bodies",
    "RealModel faults and bodies",
    ("realmodel.fault_body_add", endings(MESH, OBJECTS, STICKS)),
)


def a_series(context):
    rock = settings.active_rock(context.scene)
    has_series = rock is not None and len(rock.series)
    return None if has_series else "the rock mass has no series; add one first (Series, +)"


def dips_of_fault(context):
    row = settings.active_structure(context.scene)
    return None if settings.kind_of(row) == "fault" and row.dips else "the fault has no dips"


class REALMODEL_OT_fault_dips_remove(Reporting, bpy.types.Operator):
    """Remove the dips of the active fault"""

    bl_label = "Remove Dips of Fault"
    needs = (a_fault, dips_of_fault)

    def act(self, context):
        row = settings.active_structure(context.scene)
        surface_dips.keep(row, None)
        changes.reading(row, context)


def dips_of_series(context):
    rock = settings.active_rock(context.scene)
    row = None if rock is None else series_settings.active(rock)
    return None if row is not None and row.dips else "the series has no dips"


def dips_to_give(context):
    row = settings.active_surface(context.scene)
    has_dips = row is not None and row.dips and series_settings.is_level_set(row)
    return None if has_dips else "the surface has no dips that a field could take"


class REALMODEL_OT_series_add(Reporting, bpy.types.Operator):
    """Add a series of consecutive surfaces that share their structure. It begins with the active surface.
    Choose its youngest and its oldest surface afterward"""

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
    """Remove the active series with its dips. Its surfaces stay as single surfaces"""

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
    """Make all surfaces of the active series younger (up) or older (down), past the next surface or the
    entire next series"""

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
    """Give the dips of the active surface, which is a level set, to the field of its series. Dips without an
    elevation get the mean elevation of the surface's points"""

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
    """Add a dip at the 3D cursor: to the series of the active surface, or to the surface if it has none. In a
    field the dip may have any angle"""

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
