# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports the displayed model to other 3D programs by Blender's exporters, with names, materials and custom
properties.

Other programs cannot read the nodes of a look (looks.py), so looks are baked (bake.py). The export is made
from temporary copies with the names of the objects; afterward the scene is as before.
"""

import contextlib
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

import bmesh
import bpy

from ...core import InputRefused
from ...core.base.atomic import Outputs, writable_target
from ...core.base.formats import Format, by_ending
from ..display import bodies
from ..objects import filled_beds, model_tree, placing
from .bake import Baking, pictures
from .temporary_copies import copied

HULLS = (  # items of an enum
    ("NONE", "None", "No collision meshes"),
    ("EACH", "One for Each Object", "The convex hull of each object"),
    ("WHOLE", "One for All", "One convex hull around all objects"),
)
_LEVELS = (0.3, 0.1)  # of the polygons, at levels of detail 1 and 2


@dataclass(frozen=True)
class Choices:
    """What a file has. size: of the pictures of looks, pixels; 0: materials have the color of their property.
    kinds, layout: as of bake.Baking. has_levels: of detail, named _LOD0 to _LOD2. hulls: a key of HULLS,
    meshes for collisions, named UCX_ as Unreal expects."""

    size: int
    kinds: tuple = ("COLOR",)
    layout: str = "MATERIAL"
    has_levels: bool = False
    hulls: str = "NONE"


def displayed(context):
    """The objects of the model of the scene, and beds of filled meshes, that are displayed and that other
    programs can show."""
    project = model_tree.model_collection(context.scene)
    items = [] if project is None else [*project.all_objects]
    items += [obj for obj in filled_beds.of_scene(context.scene) if obj not in items]
    return [obj for obj in items if obj.type == "MESH" and obj.visible_get() and _shows_rock(obj)]


def _shows_rock(obj):
    is_part = obj.get(bodies.KIND, bodies.PLANE) != bodies.PLANE or filled_beds.BED in obj
    return (is_part or obj.get(model_tree.TAG) in model_tree.OBJECT_KINDS) and len(obj.data.polygons) > 0


def write(context, items, path, choices):
    """Writes mesh objects to a file of one of FORMATS, and what belongs to it beside it, all or nothing.
    choices: Choices. Raises InputRefused where this Blender cannot, OutputFailed."""
    file_format, path = by_ending(path, FORMATS, "scenes are not written as {}"), writable_target(path)
    _require_exporter(file_format.write)
    with tempfile.TemporaryDirectory() as place, Outputs() as outputs:
        folder, target = Path(place), Path(place) / path.name
        with copied(context, items) as copies:
            if choices.size:
                baking = Baking(choices.kinds, choices.layout, choices.size, folder, f"{path.stem}_")
                baking.prepare(context.scene, copies)
                if baking.steps:
                    baking.fit(copies)
                for step in baking.steps:
                    baking.make(context, copies, step)
                copies.made += baking.show(copies, folder, same_names=True)
            shown = list(copies.items)
            if choices.has_levels:
                shown += _with_levels(copies)
            shown += _with_hulls(copies, choices.hulls)
            placing.select(shown)
            with _pictures_in(folder, copies):
                file_format.write(str(target))
        for made in sorted(folder.iterdir()):
            if file_format.write is _write_gltf and made != target:
                continue  # packed pictures
            with outputs.file(path.parent / made.name) as file:
                file.write(made.read_bytes())


@contextlib.contextmanager
def _pictures_in(folder, copies):
    """For a while the pictures of copies, which Bake Looks may have put elsewhere, are in a folder."""
    before = []
    try:
        materials = {material for item in copies.items for material in item.data.materials}
        for image in {node.image for material in materials for node in pictures(material)}:
            file = Path(bpy.path.abspath(image.filepath))
            if file.is_file() and file.parent != folder:
                there = folder / file.name
                there = there.with_stem(f"{len(before)}_{file.stem}") if there.exists() else there
                shutil.copyfile(file, there)
                before.append((image, image.filepath_raw))
                image.filepath_raw = str(there)
        yield
    finally:
        for image, path in before:
            image.filepath_raw = path


def _with_levels(copies):
    """Copies become level of detail 0; returns the objects of the others, by Decimate."""
    added = []
    for item in list(copies.items):
        name = item.name
        item.name = f"{name}_LOD0"
        for level, ratio in enumerate(_LEVELS, 1):
            made = copies.add(f"{name}_LOD{level}", item.data.copy(), item.matrix_world)
            decimate = made.modifiers.new("Decimate", "DECIMATE")
            decimate.ratio = ratio
            depsgraph = bpy.context.evaluated_depsgraph_get()
            mesh = bpy.data.meshes.new_from_object(
                made.evaluated_get(depsgraph), preserve_all_data_layers=True, depsgraph=depsgraph
            )
            made.modifiers.clear()
            made.data = mesh
            copies.made.append(mesh)
            added.append(made)
    return added


def _with_hulls(copies, hulls):
    """Objects that are convex hulls, named after those that they are of."""
    parts = {"NONE": [], "EACH": [[item] for item in copies.items], "WHOLE": [copies.items]}[hulls]
    added = []
    for items in parts:
        shape = bmesh.new()
        to_first = items[0].matrix_world.inverted_safe()
        for item in items:
            begin = len(shape.verts)
            shape.from_mesh(item.data)
            shape.verts.ensure_lookup_table()
            bmesh.ops.transform(shape, matrix=to_first @ item.matrix_world, verts=shape.verts[begin:])
        bmesh.ops.delete(shape, geom=shape.edges, context="EDGES_FACES")
        found = bmesh.ops.convex_hull(shape, input=shape.verts)
        inside = {*found["geom_interior"], *found["geom_unused"]}.intersection(shape.verts)
        bmesh.ops.delete(shape, geom=list(inside), context="VERTS")
        name = f"UCX_{items[0].name}_00"
        mesh = bpy.data.meshes.new(name)
        shape.to_mesh(mesh)
        shape.free()
        added.append(copies.add(name, mesh, items[0].matrix_world))
    return added


def _require_exporter(export):
    """Before looks are baked, which takes a while."""
    if export is _write_gltf and "gltf" not in dir(bpy.ops.export_scene):
        raise InputRefused("Blender's add-on for glTF is off", advice="enable glTF 2.0 in the preferences")
    if export is _write_fbx and "fbx" not in dir(bpy.ops.export_scene):
        raise InputRefused("Blender's add-on for FBX is off", advice="enable FBX in the preferences")
    if export is _write_usd and not bpy.app.build_options.usd:
        raise InputRefused("this Blender cannot write USD", advice="use glTF, or Blender of blender.org")


def _write_gltf(path):
    options = bpy.ops.export_scene.gltf.get_rna_type().properties
    # viewers multiply the colors of vertices with those of the material, which are the same
    colors = {"export_colors": False} if "export_colors" in options else {"export_vertex_color": "NONE"}
    bpy.ops.export_scene.gltf(
        filepath=path,
        export_format="GLB",
        use_selection=True,
        export_extras=True,
        check_existing=False,
        **colors,
    )


def _write_usd(path):
    options = bpy.ops.wm.usd_export.get_rna_type().properties
    wanted = {"export_custom_properties": True, "relative_paths": True}
    wanted |= (
        {"export_textures_mode": "KEEP"} if "export_textures_mode" in options else {"export_textures": False}
    )
    wanted = {name: value for name, value in wanted.items() if name in options}
    bpy.ops.wm.usd_export(filepath=path, selected_objects_only=True, check_existing=False, **wanted)


def _write_fbx(path):
    bpy.ops.export_scene.fbx(
        filepath=path,
        use_selection=True,
        use_custom_props=True,
        mesh_smooth_type="FACE",
        path_mode="STRIP",
        check_existing=False,
    )


def _write_obj(path):
    bpy.ops.wm.obj_export(
        filepath=path, export_selected_objects=True, path_mode="STRIP", check_existing=False
    )


_OBJECTS = ("objects",)  # selected ones; Blender writes them to a path
FORMATS = (
    Format(
        ".glb",
        "glTF Binary",
        _OBJECTS,
        "For web pages and game engines; pictures are in the file",
        _write_gltf,
    ),
    Format(".usdc", "USD", _OBJECTS, "For film and visualization; pictures are beside the file", _write_usd),
    Format(".usda", "USD as Text", _OBJECTS, "The same, as text", _write_usd),
    Format(".fbx", "FBX", _OBJECTS, "For Unreal and Unity; pictures are beside the file", _write_fbx),
    Format(".obj", "Wavefront OBJ", _OBJECTS, "For other programs; no custom properties", _write_obj),
)
