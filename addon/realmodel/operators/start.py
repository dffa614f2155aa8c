# SPDX-License-Identifier: GPL-3.0-or-later
"""The start of a model: empty, from a project file or a built model, from meshes; and saving a project."""

from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ..bl.display import cuts
from ..bl.field import map_settings
from ..bl.host.threads import threads
from ..bl.objects import model_tree, shapes, viewports
from ..bl.objects.origin import KEY as ORIGIN_KEY
from ..bl.project import library_rows, plan_mesh, project_settings, settings
from ..bl.scene import built_scene, data_objects, live, region_size, samples
from ..core import BuildFailed, Model, load_project
from ..core.base.errors import counted
from ..core.project.project_writer import save_project
from ..core.surfaces.prepare import with_arrays
from ..registration import drop_handler
from .reporting import (
    Reporting,
    any_surface,
    chosen_path,
    file_filter,
    is_sheet,
    not_building,
    selected_sheets,
)

_MODEL_ENDING = ".npz"


def _begin(scene, name, interfaces=()):
    """An empty model in a scene, in place of the one that is there with its sections. interfaces: those that
    stay."""
    built_scene.remove_model(scene, interfaces)
    if cuts.plane_of(scene) is not None:
        cuts.remove_plane(scene)
    model_tree.remove_objects(model_tree.sections(scene))
    group = scene.realmodel
    with settings.filling():
        settings.begin(group)
        group.name, group.project_file, group.library_path = name, "", ""
        group.active_rock = group.stage = group.active_property = group.active_result = 0
        group.explode = 0.0
        group.show_data = False
        group.proposal.clear()
    data_objects.update(scene)


def invoke(call, operator, **arguments):
    """Continues with another operator: with its window where the first one was invoked. Raises
    BuildFailed."""
    run(call, "INVOKE_DEFAULT" if operator.options.is_invoke else "EXEC_DEFAULT", **arguments)


def run(call, way="EXEC_DEFAULT", **arguments):
    """Runs another operator as a part of one. Raises BuildFailed."""
    try:
        call(way, **arguments)
    except RuntimeError as error:
        raise BuildFailed(str(error).removeprefix("Error: ").strip()) from error


class Replacing(Reporting):
    """An operator that replaces the model of the scene, and asks first where it is invoked. `comes(context)`
    says by what, such as "open Haut-Barr"."""

    _asked = False

    needs = (not_building,)

    def ask(self, context):
        """Continues, or shows the question first."""
        group = context.scene.realmodel
        if not (settings.has_rows(context.scene) or len(group.results)):
            return self.execute(context)
        self._asked = True
        return context.window_manager.invoke_props_dialog(self, width=360)

    def invoke(self, context, event):
        return self.ask(context)

    def draw(self, context):
        column = self.layout.column(align=True)
        group = context.scene.realmodel
        what = "blocks" if len(group.results) else "surfaces"
        column.label(text=f"Remove the {what} of {group.name}", icon="QUESTION")
        column.label(text=f"and {self.comes(context)}?", icon="BLANK1")


class REALMODEL_OT_new(Replacing, bpy.types.Operator):
    """Begin an empty model in this scene, and remove the blocks of the earlier one. Your own meshes stay"""

    bl_label = "New Model"

    def act(self, context):
        _begin(context.scene, "Model")

    def comes(self, _context):
        return "begin an empty model"


class REALMODEL_OT_open_project(Replacing, bpy.types.Operator, ImportHelper):
    """Open a RealModel project file (TOML), or a built model (NPZ), in this scene, in place of its model"""

    bl_label = "Open RealModel Project"

    _browses = False
    filename_ext = ".toml"
    # not kept from one time to the next: with a path, as of a dropped file, no file browser opens
    filepath: StringProperty(
        name="File Path",
        description="The project file, or the model",
        maxlen=1024,
        subtype="FILE_PATH",
        options={"SKIP_SAVE"},
    )
    filter_glob: file_filter(".toml", _MODEL_ENDING)

    build: BoolProperty(
        name="Build",
        description="Build the model of a project as soon as it is opened",
        options={"SKIP_SAVE"},
    )

    def act(self, context):
        path = chosen_path(self, "the project")
        if self._browses and not self._asked:  # the file was chosen: now it can be named in the question
            invoke(bpy.ops.realmodel.open_project, self, filepath=self.filepath, build=self.build)
            return
        is_model = path.suffix.lower() == _MODEL_ENDING
        if is_model:
            for warning in _open_model(context, path):
                self.report({"WARNING"}, str(warning))
        else:
            _open(context.scene, path)
        self.report({"INFO"}, f"Opened {path.name}")
        if self.build and not is_model:
            invoke(bpy.ops.realmodel.build, self)

    def comes(self, _context):
        return f"open {Path(self.filepath).name}"

    def invoke(self, context, event):
        if not self.properties.is_property_set("build"):
            self.build = True
        if Path(self.filepath).suffix.lower() in (".toml", _MODEL_ENDING):
            return self.ask(context)  # a file that was dropped, or chosen before
        self._browses = True
        return ImportHelper.invoke(self, context, event)

    def draw(self, context):
        if context.space_data is not None and context.space_data.type == "FILE_BROWSER":
            self.layout.prop(self, "build")
        else:
            super().draw(context)


def _open(scene, path):
    project = load_project(path)
    show(scene, project, with_arrays(project))


def show(scene, file_project, project):
    """Shows a project in place of the model of a scene. project: the same with its data read into arrays, see
    `with_arrays`."""
    _begin(scene, project.name)
    project_settings.fill(scene, project)
    map_settings.keep_of_project(scene, file_project)
    map_settings.take_ground_of_project(scene, file_project)
    data_objects.update(scene)
    region_size.ask()
    live.touch(scene)


def _open_model(context, path):
    """Shows a model from its file, its project as settings whose data are stored; returns its warnings."""
    model = Model.load(path, threads=threads())
    library = model.project.library
    # the files of the project are where it was built, if anywhere
    model.project = replace(model.project, path=None, library=library and replace(library, path=None))
    current = context.scene
    _begin(current, model.project.name)
    built_scene.write_model(current, model)
    data_objects.update(current)
    viewports.frame(current, viewports.spaces(context))
    return model.warnings


class REALMODEL_OT_open_sample(Replacing, bpy.types.Operator):
    """Open and build one of the examples that come with RealModel"""

    bl_label = "Open Example"

    sample: EnumProperty(name="Example", description="Which of them", items=samples.enum_items)
    build: BoolProperty(name="Build", description="Build the model as soon as it is opened", default=True)

    @classmethod
    def description(cls, _context, properties):
        return samples.description(properties.sample) if properties.is_property_set("sample") else ""

    def act(self, context):
        _open(context.scene, samples.project_file(self.sample))
        if self.build:
            invoke(bpy.ops.realmodel.build, self)

    def comes(self, _context):
        return f"open the example {samples.label(self.sample)}"


class REALMODEL_OT_save_project(Reporting, bpy.types.Operator, ExportHelper):
    """Save the model as a project file (TOML), with its library, meshes and points beside it. build_model.py
    builds the same model from it"""

    bl_label = "Save RealModel Project"
    needs = (any_surface,)

    filename_ext = ".toml"
    filter_glob: file_filter(".toml")

    def act(self, context):
        path = chosen_path(self, "the project")
        depsgraph = context.evaluated_depsgraph_get()
        composed = project_settings.compose(context.scene, depsgraph)
        project = project_settings.read_as_given(context.scene, composed)
        written = save_project(project, path)
        context.scene.realmodel.project_file = str(path)
        self.report({"INFO"}, f"Saved {path.name} and {counted(len(written) - 1, 'file')} beside it")

    def invoke(self, context, event):
        if not self.filepath:
            self.filepath = context.scene.realmodel.project_file or f"{context.scene.realmodel.name}.toml"
        return ExportHelper.invoke(self, context, event)


class REALMODEL_OT_from_selected(Replacing, bpy.types.Operator):
    """Make a rock mass from the selected mesh objects. The lowest becomes the oldest surface"""

    bl_label = "Model from Selected Meshes"
    needs = (not_building, selected_sheets)

    add_base: BoolProperty(
        name="Base",
        description="Add a block beneath the oldest surface, down to a fifth of the height of all below it",
        options={"SKIP_SAVE"},
    )

    def act(self, context):
        chosen = _chosen(context)
        for obj in chosen:
            shapes.require_open(obj)
        depsgraph = context.evaluated_depsgraph_get()
        ordered = project_settings.oldest_first(chosen, depsgraph)
        scene = context.scene
        origin = project_settings.model_origin(scene)  # the objects stand where it says
        had_one = ORIGIN_KEY in scene
        points = np.concatenate([shapes.points(obj, depsgraph) for obj in chosen]) + origin
        _begin(scene, "Model", chosen)
        if had_one:
            scene[ORIGIN_KEY] = [float(value) for value in origin]
        with settings.filling():
            rock = scene.realmodel.rocks.add()
            rock.name = "rock mass"
            for obj in ordered:
                row = rock.surfaces.add()
                row.name = settings.free_name(rock.surfaces, obj.name, own=row)
                row.property_id = library_rows.for_surface(scene, row.name)
                row.source = "MESH_OBJECT"
                row.object = obj
            rock.active_surface = len(ordered) - 1
            settings.set_number(rock, "base_elevation", plan_mesh.base_below(points))
            rock.use_base = self.add_base
        live.touch(scene)
        self.report(
            {"INFO"},
            f"{counted(len(ordered), 'surface')}, oldest first: {', '.join(i.name for i in ordered)}",
        )

    def comes(self, _context):
        return "make one from the selected meshes"

    def invoke(self, context, event):
        self.add_base = len(_chosen(context)) < 3  # of two sheets one block is all there is without it
        return self.ask(context)


def _chosen(context):
    return [obj for obj in context.selected_objects if is_sheet(obj)]


REALMODEL_FH_project = drop_handler(
    "REALMODEL_FH_project",
    "A project file, or a model, that is dropped into the viewport is opened",
    "RealModel project",
    ("realmodel.open_project", (".toml", _MODEL_ENDING)),
)


# Beside the add-on's files where it was installed, as text above them where it runs from its repository.
_GUIDES = ("docs/guide/index.html", "../../docs/guide/README.md")
_PACKAGE = Path(__file__).resolve().parents[1]


def guide():
    """The first page of the guide, or None where it was not installed."""
    return next((path for path in map(_PACKAGE.joinpath, _GUIDES) if path.is_file()), None)


def _a_guide(_context):
    return "this copy of RealModel has no documentation" if guide() is None else None


class REALMODEL_OT_documentation(Reporting, bpy.types.Operator):
    """Open the user guide in the web browser"""

    bl_label = "RealModel Documentation"
    bl_options = {"REGISTER"}
    needs = (_a_guide,)

    def act(self, _context):
        return bpy.ops.wm.url_open(url=guide().resolve().as_uri())


def _help_menu(self, _context):
    self.layout.operator(REALMODEL_OT_documentation.bl_idname, icon="HELP")


def _manual_map():
    """Links for F1 and "Online Manual" over a button of the tab."""
    page = guide()
    folder = "" if page is None else page.resolve().parents[1].as_uri() + "/reference/"
    panel = f"panel{page.suffix}" if folder else ""
    patterns = ("bpy.ops.realmodel.*", "bpy.types.realmodel*")
    return folder, tuple((pattern, panel) for pattern in patterns) if folder else ()


def register():
    bpy.types.TOPBAR_MT_help.append(_help_menu)
    bpy.utils.register_manual_map(_manual_map)


def unregister():
    bpy.utils.unregister_manual_map(_manual_map)
    bpy.types.TOPBAR_MT_help.remove(_help_menu)
