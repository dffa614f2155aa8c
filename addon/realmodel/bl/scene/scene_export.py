# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports the displayed model to other 3D programs by Blender's exporters, with names, materials and custom
properties.

Other programs cannot read the nodes of a look (looks.py), so looks are baked: Cycles writes the colors to a
picture for each material. The export is made from temporary copies with the names of the objects; afterward
the scene is as before.
"""

import contextlib
import tempfile
from pathlib import Path

import bpy
import numpy as np

from ...core import InputRefused
from ...core.base.atomic import Outputs, writable_target
from ...core.base.formats import Format, by_ending
from ..display import bodies
from ..host import versions
from ..objects import model_tree
from ..project import library_rows, settings
from ..shading import looks

_KEPT = (model_tree.TAG, model_tree.ROCK, model_tree.SURFACE, model_tree.BLOCK, model_tree.PROPERTY)
_SAMPLES = 2  # of a pixel
_STEEPEST = 1.15  # radians between the faces of a part of a picture
_GAP = 1 / 256  # between parts of a picture, of its width; half of it is filled from either side


def displayed(context):
    """The objects of the model of the scene that are displayed and that other programs can show."""
    project = model_tree.model_collection(context.scene)
    items = () if project is None else project.all_objects
    return [obj for obj in items if obj.type == "MESH" and obj.visible_get() and _shows_rock(obj)]


def _shows_rock(obj):
    is_part = obj.get(bodies.KIND, bodies.PLANE) != bodies.PLANE
    return (is_part or obj.get(model_tree.TAG) in model_tree.OBJECT_KINDS) and len(obj.data.polygons) > 0


def write(context, items, path, size):
    """Writes mesh objects to a file of one of FORMATS, and what belongs to it beside it, all or nothing.

    size: of the pictures of looks, pixels; 0: materials have the color of their property. Raises InputRefused
    where this Blender cannot, OutputFailed.
    """
    file_format, path = by_ending(path, FORMATS, "scenes are not written as {}"), writable_target(path)
    _require_exporter(file_format.write)
    with tempfile.TemporaryDirectory() as place, Outputs() as outputs:
        target = Path(place) / path.name
        with _copies(context, items, target if size else None, size):
            file_format.write(str(target))
        for made in sorted(Path(place).iterdir()):
            if file_format.write is _write_gltf and made != target:
                continue  # packed pictures
            with outputs.file(path.parent / made.name) as file:
                file.write(made.read_bytes())


def _require_exporter(export):
    """Before looks are baked, which takes a while."""
    if export is _write_gltf and "gltf" not in dir(bpy.ops.export_scene):
        raise InputRefused("Blender's add-on for glTF is off", advice="enable glTF 2.0 in the preferences")
    if export is _write_usd and not bpy.app.build_options.usd:
        raise InputRefused("this Blender cannot write USD", advice="use glTF, or Blender of blender.org")


def _write_gltf(path):
    bpy.ops.export_scene.gltf(
        filepath=path, export_format="GLB", use_selection=True, export_extras=True, check_existing=False
    )


def _write_usd(path):
    options = bpy.ops.wm.usd_export.get_rna_type().properties
    wanted = {"export_custom_properties": True, "relative_paths": True}
    wanted |= (
        {"export_textures_mode": "KEEP"} if "export_textures_mode" in options else {"export_textures": False}
    )
    wanted = {name: value for name, value in wanted.items() if name in options}
    bpy.ops.wm.usd_export(filepath=path, selected_objects_only=True, check_existing=False, **wanted)


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
    Format(".obj", "Wavefront OBJ", _OBJECTS, "For other programs; no custom properties", _write_obj),
)


@contextlib.contextmanager
def _copies(context, items, beside, size):
    """Adds copies of some objects to the scene for a while; only the copies are selected, and they have the
    names of the objects. beside: the path that the pictures of looks are named after, or None: none are
    made."""
    layer = context.view_layer
    selected, active = list(context.selected_objects), layer.objects.active
    collection = bpy.data.collections.new("RealModel export")
    names, made = [], []
    try:
        context.scene.collection.children.link(collection)
        depsgraph = context.evaluated_depsgraph_get()
        shown = [(obj, obj.evaluated_get(depsgraph)) for obj in items]
        new = [
            bpy.data.meshes.new_from_object(seen, preserve_all_data_layers=True, depsgraph=depsgraph)
            for _, seen in shown
        ]
        made += new
        copies = [_copy(context.scene, obj, mesh, names) for obj, mesh in zip(items, new, strict=True)]
        made += copies
        for copy in copies:
            collection.objects.link(copy)
        layer.update()
        if beside is not None:
            _bake(context, copies, beside, size, names, made)
        _select(layer, copies)
        yield
    finally:
        bpy.data.batch_remove([collection, *made])
        for datablock, name in reversed(names):
            datablock.name = name
        _select(layer, selected, active)


def _take_name(datablock, names):
    """The name of a datablock, which is free from now on; names of other files are no hindrance."""
    name = datablock.name
    if datablock.library is None:
        names.append((datablock, name))
        datablock.name = f"~{len(names)}"
    return name


def _copy(scene, obj, mesh, names):
    """An object that shows the mesh as an object does, with its name and its custom properties."""
    mesh.name = _take_name(obj.data, names)
    copy = bpy.data.objects.new(_take_name(obj, names), mesh)
    copy.matrix_world = obj.matrix_world
    for key in obj.keys():  # noqa: SIM118 - objects of Blender are not iterable
        if key in _KEPT or not key.startswith(model_tree.TAG):
            copy[key] = obj[key]
    row = library_rows.find(scene, obj.get(model_tree.PROPERTY))
    if row is not None:
        copy[f"{model_tree.TAG}_name"] = row.name
        for key in ("rock", "age", "structure", "description"):
            if getattr(row, key):
                copy[f"{model_tree.TAG}_property_{key}"] = getattr(row, key)
        for key in ("density", "porosity", "permeability"):
            if settings.number(row, key):
                copy[f"{model_tree.TAG}_property_{key}"] = settings.number(row, key)
    return copy


def _baked_slots(obj):
    """The slots of an object whose material is a look to bake, where polygons have it."""
    material_indices = np.empty(len(obj.data.polygons), np.int32)
    obj.data.polygons.foreach_get("material_index", material_indices)
    slots = [int(slot) for slot in np.unique(material_indices) if slot < len(obj.data.materials)]
    return [slot for slot in slots if _is_baked(obj.data.materials[slot])]


def _is_baked(material):
    return material is not None and material.get(looks.KEY, "FLAT") != "FLAT"


def _bake(context, copies, beside, size, names, made):
    """Assigns to copies new materials with pictures of the looks. New data are appended to `made`."""
    by_material = {}
    for copy in copies:
        for slot in _baked_slots(copy):
            by_material.setdefault(copy.data.materials[slot], []).append((copy, slot))
    if not by_material:
        return
    if not versions.cycles_available(context.scene):
        raise InputRefused("this Blender has no Cycles, which bakes looks", advice="switch Bake Looks off")
    baked = [copy for copy in copies if _baked_slots(copy)]
    for copy in baked:
        uvs = copy.data.uv_layers
        while len(uvs):
            uvs.remove(uvs[0])
        uvs.new(name="UVMap")
    pictures = {}
    for material, users in by_material.items():
        _unwrap(context, users)
        new_material = material.copy()
        made.append(new_material)
        new_material.name = _take_name(material, names)
        looks.level(new_material)
        pictures[new_material] = image = bpy.data.images.new(new_material.name, size, size)
        made.append(image)
        node = new_material.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        new_material.node_tree.nodes.active = node
        for copy, slot in users:
            copy.data.materials[slot] = new_material
    _select(context.view_layer, baked)
    with _renderer(context.scene):
        bpy.ops.object.bake(
            type="DIFFUSE",
            pass_filter={"COLOR"},
            target="IMAGE_TEXTURES",
            save_mode="INTERNAL",
            margin=max(1, int(size * _GAP / 2)),
            margin_type="EXTEND",  # neighboring faces may be in another picture
            use_clear=True,
            use_selected_to_active=False,
        )
    for number, (material, image) in enumerate(pictures.items()):
        name = f"{beside.stem}_{number}_{bpy.path.clean_name(material.name)}.png"
        image.filepath_raw = str(beside.with_name(name))
        image.file_format = "PNG"
        image.save()
        looks.show_picture(material, image)


def _unwrap(context, users):
    """Unwraps the polygons of some slots of objects into one picture that they share. users: (object,
    slot)."""
    settings = context.scene.tool_settings
    before = tuple(settings.mesh_select_mode)
    settings.mesh_select_mode = (False, False, True)
    _select(context.view_layer, [obj for obj, _ in users])
    for obj, slot in users:
        polygons = obj.data.polygons
        material_indices = np.empty(len(polygons), np.int32)
        polygons.foreach_get("material_index", material_indices)
        polygons.foreach_set("hide", np.zeros(len(polygons), bool))
        polygons.foreach_set("select", material_indices == slot)
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        bpy.ops.uv.smart_project(angle_limit=_STEEPEST, island_margin=_GAP)
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
        settings.mesh_select_mode = before


@contextlib.contextmanager
def _renderer(scene):
    """Cycles with few samples."""
    engine, had_settings = scene.render.engine, "cycles" in scene.keys()  # noqa: SIM118
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    before = cycles.samples, cycles.use_denoising
    cycles.samples, cycles.use_denoising = _SAMPLES, False  # a build without a denoiser would bake nothing
    try:
        yield
    finally:
        cycles.samples, cycles.use_denoising = before
        scene.render.engine = engine
        if not had_settings:
            scene.pop("cycles", None)


def _select(layer, items, active=None):
    for obj in layer.objects:
        obj.select_set(False, view_layer=layer)
    for obj in items:
        obj.select_set(True, view_layer=layer)
    layer.objects.active = active or (items[0] if items else None)
