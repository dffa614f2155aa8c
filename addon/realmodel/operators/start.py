# SPDX-License-Identifier: GPL-3.0-or-later
"""How a model begins: empty, from a project file, from meshes; and how it goes to a project file."""

from pathlib import Path

import bpy
from bpy.props import EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ..bl import built_scene, live, project_settings, region_size, samples, settings
from ..bl.origin import KEY as ORIGIN_KEY
from ..core import load_project
from ..core.project_writer import save_project
from ..core.rock_input import with_arrays
from .reporting import Reporting, any_surface, needed_path, selected_meshes


def _begin(scene, name):
    """An empty model in a scene, in place of the one that is there."""
    built_scene.remove_model(scene)
    group = scene.realmodel
    with settings.filling():
        settings.begin(group)
        group.name, group.project_file, group.library_path = name, "", ""
        group.active_rock = group.stage = group.active_property = group.active_result = 0
        group.explode = 0.0


class REALMODEL_OT_new(Reporting, bpy.types.Operator):
    """Begin an empty model in this scene. The blocks of an earlier one are removed, your own meshes stay"""

    bl_idname = "realmodel.new"
    bl_label = "New Model"

    def act(self, context):
        _begin(context.scene, "Model")

    def invoke(self, context, event):
        if settings.has_rows(context.scene):
            return context.window_manager.invoke_confirm(self, event)
        return self.execute(context)


class REALMODEL_OT_open_project(Reporting, bpy.types.Operator, ImportHelper):
    """Open a RealModel project file (TOML) in this scene, in place of the model that is there"""

    bl_idname = "realmodel.open_project"
    bl_label = "Open RealModel Project"

    filename_ext = ".toml"
    # not kept from one time to the next: with a path, as of a dropped file, no file browser opens
    filepath: StringProperty(
        name="File Path",
        description="The project file",
        maxlen=1024,
        subtype="FILE_PATH",
        options={"SKIP_SAVE"},
    )
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})

    def act(self, context):
        path = project_settings.absolute(needed_path(self.filepath, "the project"))
        _open(context.scene, path)
        self.report({"INFO"}, f"Opened {path.name}; press Build to see the model")

    def invoke(self, context, event):
        if self.filepath and self.options.is_invoke and Path(self.filepath).suffix.lower() == ".toml":
            return self.execute(context)  # a file that was dropped
        return ImportHelper.invoke(self, context, event)


def _open(scene, path):
    project = with_arrays(load_project(path))
    _begin(scene, project.name)
    project_settings.fill(scene, project)
    region_size.ask()
    live.touch(scene)


class REALMODEL_OT_open_sample(Reporting, bpy.types.Operator):
    """Open one of the examples that come with RealModel"""

    bl_idname = "realmodel.open_sample"
    bl_label = "Open Example"

    sample: EnumProperty(name="Example", description="Which of them", items=samples.enum_items)

    def act(self, context):
        _open(context.scene, samples.project_file(self.sample))
        self.report({"INFO"}, "Opened the example; press Build to see the model")


class REALMODEL_OT_save_project(Reporting, bpy.types.Operator, ExportHelper):
    """Save the model as a project file (TOML) with its library, meshes and points beside it: build_model.py
    builds the same model from it"""

    bl_idname = "realmodel.save_project"
    bl_label = "Save RealModel Project"
    needs = (any_surface,)

    filename_ext = ".toml"
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})

    def act(self, context):
        path = project_settings.absolute(needed_path(self.filepath, "the project"))
        depsgraph = context.evaluated_depsgraph_get()
        project = project_settings.read_project(project_settings.compose(context.scene, depsgraph))
        written = save_project(project, path)
        context.scene.realmodel.project_file = str(path)
        self.report({"INFO"}, f"Saved {path.name} and {len(written) - 1} files beside it")

    def invoke(self, context, event):
        if not self.filepath:
            self.filepath = context.scene.realmodel.project_file or f"{context.scene.realmodel.name}.toml"
        return ExportHelper.invoke(self, context, event)


class REALMODEL_OT_from_selected(Reporting, bpy.types.Operator):
    """Make a model with one rock mass from the selected mesh objects: the lowest is taken as the oldest"""

    bl_idname = "realmodel.from_selected"
    bl_label = "Model from Selected Meshes"
    needs = (selected_meshes,)

    def act(self, context):
        depsgraph = context.evaluated_depsgraph_get()
        chosen = [item for item in context.selected_objects if item.type == "MESH"]
        ordered = project_settings.oldest_first(chosen, depsgraph)
        scene = context.scene
        origin = project_settings.model_origin(scene)  # the objects stand where it says
        had_one = ORIGIN_KEY in scene
        _begin(scene, "Model")
        if had_one:
            scene[ORIGIN_KEY] = [float(value) for value in origin]
        with settings.filling():
            rock = scene.realmodel.rocks.add()
            rock.name = "rock mass"
            for item in ordered:
                row = rock.surfaces.add()
                row.name = settings.free_name(rock.surfaces, item.name, own=row)
                row.source = "MESH_OBJECT"
                row.object = item
            rock.active_surface = len(ordered) - 1
        live.touch(scene)
        self.report({"INFO"}, f"{len(ordered)} surfaces, oldest first: {', '.join(i.name for i in ordered)}")


CLASSES = (
    REALMODEL_OT_new,
    REALMODEL_OT_open_project,
    REALMODEL_OT_open_sample,
    REALMODEL_OT_save_project,
    REALMODEL_OT_from_selected,
)


if hasattr(bpy.types, "FileHandler"):  # from Blender 4.1 on

    class REALMODEL_FH_project(bpy.types.FileHandler):
        """A project file that is dropped into the viewport is opened"""

        bl_idname = "REALMODEL_FH_project"
        bl_label = "RealModel project"
        bl_import_operator = "realmodel.open_project"
        bl_file_extensions = ".toml"

        @classmethod
        def poll_drop(cls, context):
            return context.area is not None and context.area.type == "VIEW_3D"

    CLASSES = (*CLASSES, REALMODEL_FH_project)
