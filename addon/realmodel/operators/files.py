# SPDX-License-Identifier: GPL-3.0-or-later
"""The model and its report out to files."""

from dataclasses import replace
from pathlib import Path

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
)
from bpy_extras.io_utils import ExportHelper

from ..bl.display import shown_models
from ..bl.jobs.export_job import ExportJob
from ..bl.jobs.mesh_job import MeshJob
from ..bl.project import library_rows, results, settings
from ..bl.scene import live, scene_export
from ..core import BuildFailed, InputRefused, UsageError
from ..core.base.errors import BuildWarning
from ..core.exporters import MESH, MODEL, REPORT
from ..core.exporters.mesh_request import MeshRequest
from ..core.exporters.report import model_report
from .baking import MAPS, PICTURE_SIZE, layout_menu
from .reporting import (
    InBackground,
    Reporting,
    a_model,
    a_model_or_beds,
    chosen_path,
    file_filter,
    not_building,
    object_mode,
)
from .start import invoke

_OUTDATED = "The model is out of date: its input has changed since the build"


def format_menu(formats, default=None):
    items = [(entry.ending[1:].upper(), f"{entry.label} ({entry.ending})", entry.tip) for entry in formats]
    return EnumProperty(
        name="Format",
        description="Format of the file; its ending follows",
        items=items,
        default=default or items[0][0],
        options={"SKIP_SAVE"},
    )


def format_filter(formats):
    return file_filter(*(entry.ending for entry in formats))


class Exporting(Reporting, ExportHelper):
    """Writes a file, by default named after the model. In the file browser the menu of formats gives the
    ending; in a script the ending of `filepath` gives the format."""

    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        if context.scene.realmodel.is_coarse:
            cls.poll_message_set("the blocks are a coarse preview; wait for the full field of Auto, or build")
            return False
        return super().poll(context)

    @property
    def filename_ext(self):
        return f".{self.format.lower()}"

    def of_what(self, _context):
        """Words that the name of the file has after that of the model, so that files of one ending do not
        replace each other."""
        return ()

    def invoke(self, context, event):
        if not self.filepath:
            words = (context.scene.realmodel.name or "model", *self.of_what(context))
            name = bpy.path.clean_name(" ".join(words)) + self.filename_ext
            self.filepath = str(Path(bpy.data.filepath).parent / name) if bpy.data.filepath else name
        return super().invoke(context, event)

    def act(self, context):
        path = self.target()
        self.write(context, path)
        self.report({"INFO"}, f"Wrote {path}")

    def model(self, context):
        """The whole displayed model, after `target`, with the panel's library of now, whose colors are seen;
        where it is out of date, one of its warnings says so."""
        model = shown_models.whole(context.scene)
        project = replace(model.project, library=library_rows.library_of(context.scene))
        model = replace(model, project=project)
        if context.scene.realmodel.is_outdated:
            model = replace(model, warnings=[BuildWarning(_OUTDATED, "outdated"), *model.warnings])
        return model

    def target(self):
        """The path of the output; the window says where the model is out of date. Raises UsageError,
        InputRefused."""
        if live.check(bpy.context.scene):
            self.report({"WARNING"}, _OUTDATED)
        path = chosen_path(self, "the output")
        endings = self.filter_glob.replace("*", "").split(";")
        if path.suffix.lower() not in endings:
            raise UsageError(f"{path}: the name must end in {' or '.join(endings)}")
        return path


class ExportingInBackground(InBackground, Exporting):
    """Writes a file with progress and Esc, once the file browser has given its name. `command`: the operator
    among bpy.ops.realmodel."""

    command = ""

    is_chosen: BoolProperty(options={"HIDDEN", "SKIP_SAVE"})

    _browsed = False  # the file browser was opened; Blender then calls execute alone

    def invoke(self, context, event):
        if self.is_chosen:
            return InBackground.invoke(self, context, event)
        self._browsed = True
        return Exporting.invoke(self, context, event)

    def execute(self, context):
        if not self._browsed or bpy.app.background:
            return super().execute(context)
        keywords = self.as_keywords(ignore=("filter_glob", "check_existing", "is_chosen"))
        try:
            invoke(getattr(bpy.ops.realmodel, self.command), self, is_chosen=True, **keywords)
        except BuildFailed as error:  # what the other operator reported
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}

    def act(self, context):
        InBackground.act(self, context)


class REALMODEL_OT_export(ExportingInBackground, bpy.types.Operator):
    """Export the built model with its cells. Esc cancels"""

    bl_label = "Export Model"
    command = "export"
    needs = (a_model, not_building)

    format: format_menu(MODEL.formats())
    filter_glob: format_filter(MODEL.formats())
    cell_size: FloatVectorProperty(
        name="Cell Size",
        description="Cell size of regular grids (block models, GeoTIFF, ESRI ASCII, GRDECL; OMF, geoh5 and "
        "RESQML), in model units. 0: automatic, and no cells in OMF, geoh5 and RESQML",
        size=3,
        min=0.0,
        default=(0.0, 0.0, 0.0),
        subtype="XYZ",
    )

    grid_layers: IntProperty(
        name="Grid Layers",
        description="Layers of each block in corner-point grids (GRDECL, RESQML)",
        default=1,
        min=1,
    )

    grid_azimuth: FloatProperty(
        name="Grid Azimuth",
        description="Direction of the columns of corner-point grids (GRDECL, RESQML), degrees clockwise "
        "from north",
        default=0.0,
    )

    contour_interval: FloatProperty(
        name="Contour Interval",
        description="Contour interval of maps (GeoPackage, GeoJSON), in model units; 0: automatic",
        min=0.0,
        default=0.0,
    )

    cell_tolerance: FloatProperty(
        name="Cell Tolerance",
        description="For polyhedral cells (VTK, OpenFOAM, Exodus II, DISU), in model units: remove shorter "
        "edges, and thinner faces and cells. 0: the exact cells",
        min=0.0,
        default=0.0,
    )

    surfaces_only: BoolProperty(
        name="Surfaces Only",
        description="Write the input surfaces, each as a part, instead of cells and blocks (OBJ, PLY, STL, "
        "glTF, DXF, GOCAD, VTK, NumPy)",
        default=False,
    )

    def begin(self, context):
        path = self.target()
        return ExportJob(
            self.model(context),
            path,
            surfaces_only=self.surfaces_only,
            cell_size=tuple(map(settings.plain, self.cell_size)) if any(self.cell_size) else None,
            contour_interval=settings.plain(self.contour_interval) or None,
            tolerance=settings.plain(self.cell_tolerance) or None,
            grid_layers=self.grid_layers,
            grid_azimuth=settings.plain(self.grid_azimuth),
        )

    def tell_done(self, path):
        self.report({"INFO"}, f"Wrote {path}")


class REALMODEL_OT_share(ExportingInBackground, bpy.types.Operator):
    """Write the built model as one web page, which opens in any browser, and show it. Esc cancels"""

    bl_label = "Share"
    command = "share"
    needs = (a_model, not_building)

    format: format_menu([MODEL.format("model.html")])
    filter_glob: format_filter([MODEL.format("model.html")])

    def begin(self, context):
        return ExportJob(self.model(context), self.target())

    def tell_done(self, path):
        self.report({"INFO"}, f"Wrote {path}")
        if not bpy.app.background:
            bpy.ops.wm.url_open(url=Path(path).as_uri())


class REALMODEL_OT_export_mesh(ExportingInBackground, bpy.types.Operator):
    """Export a mesh of the built model for solvers, with limits of edge length and thickness. Esc cancels"""

    bl_label = "Export Simulation Mesh"
    command = "export_mesh"
    needs = (a_model, not_building)

    format: format_menu(MESH.formats())
    filter_glob: format_filter(MESH.formats())
    edge_length: FloatProperty(
        name="Edge Length",
        description="Edge length in plan, in model units. Smaller features are removed. 0: a fiftieth of "
        "the model",
        min=0.0,
    )
    minimum_thickness: FloatProperty(
        name="Minimum Thickness",
        description="Layers end where they are thinner. 0: a tenth of the edge length",
        min=0.0,
    )
    layers: IntProperty(
        name="Layers", description="Number of layers of each block. 0: from the layer thickness", min=0
    )
    layer_thickness: FloatProperty(
        name="Layer Thickness",
        description="Largest thickness of a layer. Layers limits their number. 0: any",
        min=0.0,
    )
    elements: EnumProperty(
        name="Elements",
        description="Elements of the mesh",
        items=(
            ("PRISMS", "Prisms", "Prisms, with pyramids and tetrahedra where layers end"),
            ("TETRAHEDRA", "Tetrahedra", "Tetrahedra alone"),
        ),
    )

    def of_what(self, _context):
        return ("mesh",)

    def begin(self, context):
        self._request = MeshRequest(
            self.target(),
            settings.plain(self.edge_length) or None,
            settings.plain(self.minimum_thickness) or None,
            self.layers or None,
            settings.plain(self.layer_thickness) or None,
            self.elements.lower(),
        )
        model = self.model(context)
        return MeshJob(model, self._request, model.project.units)

    def tell_done(self, mesh):
        for warning in mesh.warnings:
            self.report({"WARNING"}, str(warning))
        self.report({"INFO"}, f"Wrote {self._request.line(mesh)}")


class REALMODEL_OT_export_scene(Exporting, bpy.types.Operator):
    """Export what is displayed of the model, and beds of filled meshes, for other 3D programs, with names,
    materials, looks, UV maps, and custom properties"""

    bl_label = "Export Scene"
    needs = (a_model_or_beds, object_mode)

    format: format_menu(scene_export.FORMATS)
    filter_glob: format_filter(scene_export.FORMATS)
    only_selected: BoolProperty(name="Selected Only", description="Export only selected objects of the model")
    bake_looks: BoolProperty(
        name="Bake Looks",
        description="Write textures of looks to pictures; otherwise materials have the color of the property",
        default=True,
    )
    maps: MAPS
    layout: layout_menu("MATERIAL")
    picture_size: PICTURE_SIZE
    levels_of_detail: BoolProperty(
        name="Levels of Detail",
        description="Write each object three times, with all its polygons, 30 % and 10 % of them, named "
        "_LOD0 to _LOD2",
    )
    collision: EnumProperty(
        name="Collision",
        description="Convex hulls for collisions, named UCX_ and the object, as Unreal expects",
        items=scene_export.HULLS,
    )

    def write(self, context, path):
        items = scene_export.displayed(context)
        if self.only_selected:
            items = [obj for obj in items if obj.select_get()]
        if not items:
            raise InputRefused("no object of the model would be exported", advice="display or select blocks")
        size = self.picture_size if self.bake_looks and self.maps else 0
        choices = scene_export.Choices(
            size, tuple(self.maps), self.layout, self.levels_of_detail, self.collision
        )
        scene_export.write(context, items, path, choices)


class REALMODEL_OT_report(Exporting, bpy.types.Operator):
    """Write a report of the model, or the table of blocks"""

    bl_label = "Write Report"
    needs = (a_model,)

    format: format_menu(REPORT.formats())
    filter_glob: format_filter(REPORT.formats())

    def write(self, context, path):
        is_table = path.suffix.lower() == ".csv"
        content = results.as_text(context.scene) if is_table else model_report(self.model(context))
        REPORT.save(content, path)
