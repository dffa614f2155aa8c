# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts a built model into the scene of its settings, in place of the previous one.

Objects whose block or surface still exists are kept: so the user's changes to them (selection, other
materials, constraints, place in the outliner) stay. `scene` describes the tree and the custom properties. The
model's own objects are found by the pointers in the settings, so copies, appended models and other scenes are
not touched.
"""

from dataclasses import dataclass, field

import bpy
import numpy as np

from ...core import BuildFailed
from ...core.base.errors import BuildWarning, place_text
from ...core.base.units import length_text
from ...core.cells.assembly import build_stage
from ...core.display import polygon_mesh
from ...core.results.automatic_library import model_with_library
from .. import display
from ..host import notices
from ..objects import (
    block_shapes,
    built_models,
    exaggeration,
    materials,
    meshes,
    model_tree,
    shapes,
    uncertainty,
    viewports,
    visible,
)
from ..objects.origin import KEY as ORIGIN_KEY
from ..objects.origin import choose_origin, far_from, offsets_from
from ..project import (
    compartments,
    library_rows,
    project_settings,
    results,
    settings,
    structure_settings,
    surface_statistics,
)
from ..shading import looks, weathering
from . import data_objects, planned_holes


@dataclass
class Prepared:
    """A model as Blender takes it: all that can be made without touching Blender.

    interfaces: by place (settings.row_at) (PolygonMesh, digest). blocks: for each block of the model its
    PolygonMesh or None; bounds: of them all. stored: by place the arrays that its row is to store of its
    file, and the stamp of the file. figures: for each surface the text of surface_statistics. attributes: by
    place the attributes of an interface's vertices (Model.surface_attributes). compartments: the text of
    `compartments`. stage: the argument of `shown_models.remember_stage`, or None.
    """

    model: object
    origin: np.ndarray
    interfaces: dict = field(default_factory=dict)
    blocks: list = field(default_factory=list)
    bounds: tuple = ()
    stored: dict = field(default_factory=dict)
    figures: list = field(default_factory=list)
    attributes: dict = field(default_factory=dict)
    compartments: str = ""
    stage: tuple | None = None


def prepare(model, composed, stage=None, threads=0):
    """Prepares the arrays of a model; may run in another thread. stage: the stage that will be shown, if not
    the whole model. threads: as for `build`."""
    origin = composed.origin
    if not composed.has_origin and composed.origin_is_free:
        origin = choose_origin(model.surface_vertices)
    elif (away := far_from(origin, model.surface_vertices)) is not None:
        origin = _other_origin(model, composed, away)
    prepared = Prepared(model, origin)
    for surface, place in enumerate(_places(model.project)):
        if not composed.from_object(place):
            vertices, triangles = model.surface(surface)
            offsets = offsets_from(origin, vertices)
            triangles = meshes.without_repeated_corners(triangles)
            digest = shapes.digest(offsets, triangles)
            is_surface = model.surface_kind[surface] == 0
            shape = polygon_mesh.of_triangles(offsets, triangles, smooth=bool(is_surface))
            prepared.interfaces[place] = (shape, digest)
            if is_surface:
                prepared.attributes[place] = model.surface_attributes(surface)
    prepared.blocks = polygon_mesh.of_blocks(model, origin, threads)
    prepared.bounds = block_shapes.bounds([s.coordinates for s in prepared.blocks if s is not None])
    for place, stamp in composed.read.items():
        if place[1] is None:
            arrays = project_settings.region_arrays(model.project.rocks[place[0]])
        else:
            arrays = project_settings.shape_arrays(project_settings.entry_at(model.project, place))
        prepared.stored[place] = (arrays, stamp)
    for place in composed.edited:  # the digits lost in Blender's 32 bits
        entry = project_settings.entry_at(model.project, place)
        prepared.stored[place] = (project_settings.shape_arrays(entry), "")
    prepared.figures = surface_statistics.of_model(model)
    prepared.compartments = compartments.of_model(model)
    if stage is not None:
        at_stage = build_stage(model, stage, cells="blocks")
        made = polygon_mesh.of_blocks(at_stage, origin, threads, compartments=model.compartment_names)
        named_shapes = block_shapes.by_name(at_stage, made)
        prepared.stage = (stage, at_stage, named_shapes)
    return prepared


def _places(project):
    """The places of all surfaces, faults and bodies, in the model's order."""
    yield from ((r, s) for r, rock in enumerate(project.rocks) for s in range(len(rock.surfaces)))
    yield from (("fault", n) for n in range(len(project.faults)))
    yield from (("body", n) for n in range(len(project.bodies)))


def _other_origin(model, composed, away):
    """The origin of a model that lies far from the one it has, and a warning."""
    text = f"the model lay {length_text(away, model.project.units)} from the zero of the scene"
    if not composed.origin_is_free:
        text += (
            ", where Blender's numbers are coarse: use Start > Units and Origin > Move Model to Scene's Zero"
        )
        model.warnings.append(BuildWarning(text.replace(" lay ", " lies "), "origin"))
        return composed.origin
    origin = choose_origin(model.surface_vertices)
    model.warnings.append(BuildWarning(f"{text}: its origin was moved to {place_text(origin)}", "origin"))
    return origin


def pending_meshes(scene, prepared):
    """(name, PolygonMesh) of each mesh that `put` will make, as the scene stands."""
    for place, row in settings.interface_rows(scene):
        shape, digest = prepared.interfaces.get(place, (None, ""))
        if shape is not None and (_interface(row) is None or digest != row.interface_digest):
            yield row.name, shape
    for block, shape in zip(prepared.model.blocks, prepared.blocks, strict=True):
        if shape is not None:
            yield block.name, shape


def check_rows(scene, project):
    """Raises BuildFailed where the lists of a scene are no longer those that a project was made from."""
    now = [(row.name, [s.name for s in row.surfaces]) for row in scene.realmodel.rocks]
    then = [(rock.name, [s.name for s in rock.surfaces]) for rock in project.rocks]
    if (now, structure_settings.names_in(scene)) != (then, structure_settings.names_of(project)):
        raise BuildFailed("the lists were changed while it was being built; build again")


def check_modes(scene, prepared=None):
    """Raises BuildFailed where an object whose mesh is to be replaced is being edited: Blender would keep its
    mesh as it is. prepared: as for `put`, to look at the interfaces too."""
    for row in scene.realmodel.results:
        obj = row.object
        if obj is not None and obj.mode != "OBJECT":
            raise BuildFailed(
                f"block '{obj.name}' is in {_mode_name(obj)}, and a build replaces the meshes of blocks; "
                "leave the mode (Tab), then build again"
            )
    for place, (_, digest) in prepared.interfaces.items() if prepared is not None else ():
        row = settings.row_at(scene, place)
        obj = _interface(row)
        if obj is not None and obj.mode != "OBJECT" and digest != row.interface_digest:
            raise BuildFailed(
                f"interface '{obj.name}' is in {_mode_name(obj)}, and its elevations have changed; "
                "leave the mode (Tab), then build again"
            )


def _mode_name(obj):
    return obj.bl_rna.properties["mode"].enum_items[obj.mode].name.lower()


def write_model(scene, model, project=None):
    """Puts a model that was built elsewhere into a scene with its settings, in place of the model there. The
    user's objects stay; materials of earlier properties are reused. project: the project that the model was
    built from, if the settings are to name its files beside the stored data."""
    model = model_with_library(model)
    _remove_model(scene)
    project_settings.fill(scene, project or model.project)
    composed = project_settings.compose(scene, viewports.updated_layer(scene).depsgraph)
    put(scene, prepare(model, composed, threads=model.threads), composed)


def put(scene, prepared, composed, in_place=False):
    """Puts a prepared model into a scene, and shows it.

    scene: the bpy.types.Scene. in_place: replace the contents of the blocks' meshes instead of the meshes,
    so that references to them (as of Blender's undo) stay valid; only for updates that cannot fail. If
    anything fails, the scene stays as it was.
    """
    model = prepared.model
    check_rows(scene, model.project)
    check_modes(scene, prepared)
    created = []  # datablocks
    try:
        palette, updates = _palette(scene, model, created)
        interfaces = _new_interfaces(scene, prepared, composed, created)
        blocks = _new_blocks(scene, prepared, created, in_place)
    except BaseException:
        bpy.data.batch_remove(created)
        raise
    group = scene.realmodel
    settings.follow_youngest(scene)
    with settings.filling():
        _settle_edited(scene, composed)
        tree = _tree(scene, model.project)
        _place_interfaces(scene, tree, interfaces)
        _place_blocks(scene, prepared, tree, blocks, palette)
        model_tree.remove_unused_materials(besides=palette.values())  # their names are free then
        for name, color, material in updates:
            model_tree.give_name(bpy.data.materials, material, name)
            materials.set_color(material, color)
        model_tree.remove_unused_materials()
        _keep(scene, prepared)
        moved = project_settings.model_origin(scene) - prepared.origin
        scene[ORIGIN_KEY] = [float(value) for value in prepared.origin]
        if moved.any():
            move_helpers(scene, moved)
        group.exists = True
        group.version = settings.VERSION
        before = group.built_stamp if in_place else None
        group.built_stamp = built_models.remember(model, instead_of=before)
        group.warnings = notices.of_model(model)
        group.built_from = composed.fingerprint
        group.is_outdated = group.is_coarse = False
    display.built(scene, prepared.bounds, prepared.stage)
    planned_holes.update_all(scene)
    looks.follow(scene)
    weathering.follow(scene)


def move_helpers(scene, moved):
    """Moves the objects beside a model with it: its section plane and sections, the objects of its data."""
    items = model_tree.sections(scene)
    if (plane := scene.realmodel.view.plane) is not None and plane.get(model_tree.TAG) == "view":
        items.append(plane)
    for obj in items:
        obj.location = np.array(obj.location) + moved
    data_objects.place(scene)


def _keep(scene, prepared):
    """Stores the data that were read from files in the rows, and the statistics of each surface."""
    for place, (arrays, stamp) in prepared.stored.items():
        row = settings.row_at(scene, place)
        if place[1] is None:
            row.region_stored, row.region_stamp = arrays, stamp
        elif stamp and settings.kind_of(row) == "surface" and project_settings.is_of_ground(row):
            project_settings.keep_ground(settings.rock_of(row), arrays, stamp)
        else:
            project_settings.keep_shape(row, arrays, stamp)
    scene.realmodel.view.compartments = prepared.compartments
    rows = [row for _, row in settings.interface_rows(scene)]
    for row, figures in zip(rows, prepared.figures, strict=True):
        row.figures = figures


def _palette(scene, model, created):
    """The material of each property that a block has, and the materials to be renamed or recolored."""
    palette, updates = {}, []
    for property_id in sorted({int(block.property) for block in model.blocks if block.cells}):
        count = len(bpy.data.materials)
        palette[property_id] = library_rows.material_of(scene, property_id)
        if len(bpy.data.materials) > count:
            created.append(palette[property_id])
        name, color = materials.name_and_color(model.project.library, property_id)
        updates.append((name, color, palette[property_id]))
    return palette, updates


def _interface(row):
    """The object that is a surface's interface, or None."""
    return row.object if row.source == "MESH_OBJECT" else row.interface


def _new_interfaces(scene, prepared, composed, created):
    """For each place the object that will be the interface, with a new mesh if it needs one: (object, mesh or
    None, digest)."""
    interfaces = {}
    for place, row in settings.interface_rows(scene):
        obj = _interface(row)
        if composed.from_object(place):
            interfaces[place] = (obj, None, "")
            continue
        shape, digest = prepared.interfaces[place]
        mesh = None
        if obj is None or digest != row.interface_digest:
            mesh = meshes.new_mesh(row.name, shape)
            created.append(mesh)
            if place in prepared.attributes:
                uncertainty.add_attributes(mesh, prepared.attributes[place])
        if obj is None:
            obj = bpy.data.objects.new(row.name, mesh)
            created.append(obj)
        interfaces[place] = (obj, mesh, digest)
    return interfaces


def _settle_edited(scene, composed):
    """Accepts interfaces that were edited by hand as they are now."""
    for place in composed.edited:
        row = settings.row_at(scene, place)
        row.object = row.interface
        row.source = "MESH_OBJECT"
        row.interface_digest = ""
        structure_settings.forget_extension(row)


def _new_blocks(scene, prepared, created, in_place):
    """For each block of the model (object, new mesh or None to be updated in place), None for absent ones."""
    objects_by_name = {(row.rock, row.name): row.object for row in scene.realmodel.results}
    model, blocks = prepared.model, []
    for block, shape in zip(model.blocks, prepared.blocks, strict=True):
        if shape is None:
            blocks.append(None)
            continue
        obj = objects_by_name.get((model.project.rocks[block.rock].name, block.name))
        if obj is not None and (obj.type != "MESH" or obj.library is not None):
            obj = None
        if obj is not None and in_place and obj.mode == "OBJECT" and obj.data.users == 1:
            blocks.append((obj, None))
            continue
        mesh = meshes.new_mesh(block.name, shape)
        created.append(mesh)
        if obj is None:
            obj = bpy.data.objects.new(block.name, mesh)
            created.append(obj)
        blocks.append((obj, mesh))
    return blocks


def _tree(scene, project):
    """The model's collections, linked where they were taken out, new where there are none: for each rock mass
    (interfaces, blocks), and that of the faults and bodies under None."""
    group = scene.realmodel
    top = _collection(scene, scene.collection, group, "collection", project.name, {model_tree.TAG: "project"})
    rocks = {}
    for number, row in enumerate(group.rocks):
        tags = {model_tree.TAG: "rock", model_tree.ROCK: row.name}
        parent = _collection(scene, top, row, "collection", row.name, tags)
        pair = []
        for kind in ("interfaces", "blocks"):
            kind_tags = tags | {model_tree.TAG: kind}
            pair.append(_collection(scene, parent, row, kind, f"{row.name} {kind}", kind_tags))
        rocks[number] = tuple(pair)
    if len(group.faults) or len(group.bodies):
        rocks[None] = _collection(
            scene, top, group, "structures", "faults and bodies", {model_tree.TAG: "structures"}
        )
    return rocks


def _collection(scene, parent, row, pointer, name, tags):
    collection = getattr(row, pointer)
    if collection is None or collection.library is not None:
        collection = bpy.data.collections.new(name)
        collection.hide_render = tags[model_tree.TAG] in ("interfaces", "structures")
        setattr(row, pointer, collection)
    for key, value in tags.items():
        collection[key] = value
    if not model_tree.is_name_of(collection.name, name):
        model_tree.give_name(bpy.data.collections, collection, name)
    if collection not in list(scene.collection.children_recursive):
        parent.children.link(collection)
    return collection


def _place_interfaces(scene, tree, interfaces):
    for place, (obj, mesh, digest) in interfaces.items():
        row, kind = settings.row_at(scene, place), place[0]
        if mesh is not None and obj.data != mesh:
            _change_mesh(obj, mesh)
        of_surface = not isinstance(kind, str)
        wanted = {model_tree.TAG: "interface" if of_surface else kind, model_tree.SURFACE: row.name}
        if of_surface:
            wanted[model_tree.ROCK] = scene.realmodel.rocks[kind].name
        if kind != "fault":
            wanted[model_tree.PROPERTY] = row.property_id
        adopted = obj.get(model_tree.TAG) == wanted[model_tree.TAG]
        if obj.library is None:
            for key, value in wanted.items():
                obj[key] = value
        _link(scene, tree[kind][0] if of_surface else tree[None], obj, move=not adopted)
        if obj.library is None and not model_tree.is_name_of(obj.name, row.name):
            model_tree.give_name(bpy.data.objects, obj, row.name)
        row.interface = obj
        row.interface_digest = digest
        if row.source in ("MESH_FILE", "POINTS_FILE", "TRACE_FILE"):
            row.object = obj


def _place_blocks(scene, prepared, tree, blocks, palette):
    model = prepared.model
    before = [row.object for row in scene.realmodel.results]
    objects = []
    for block, made, shape in zip(model.blocks, blocks, prepared.blocks, strict=True):
        if made is None:
            objects.append(None)
            continue
        obj, mesh = made
        if mesh is None:
            if not meshes.holds(obj.data, shape):
                meshes.refill(obj.data, shape)
        elif obj.data != mesh:
            _change_mesh(obj, mesh)
        materials.give(obj, palette[int(block.property)])
        rock_name = model.project.rocks[block.rock].name
        obj[model_tree.TAG] = "block"
        obj[model_tree.ROCK] = rock_name
        obj[model_tree.SURFACE] = str(model.surface_names[block.surface])
        obj[model_tree.BLOCK] = block.name
        obj[model_tree.PROPERTY] = int(block.property)
        _link(scene, tree[block.rock][1], obj)
        objects.append(obj)
    model_tree.remove_objects([obj for obj in before if obj is not None and obj not in objects])
    fill_results(scene, model, objects)


def _change_mesh(obj, mesh):
    """Replaces the mesh of an object by another one, with its materials and its name; the old mesh is
    removed."""
    old = obj.data
    if not len(mesh.materials):
        for material in old.materials:
            mesh.materials.append(material)
    obj.data = mesh
    if not old.users:
        name = old.name
        bpy.data.meshes.remove(old)
        model_tree.give_name(bpy.data.meshes, mesh, name)


def _link(scene, collection, obj, move=False):
    """Links an object to its collection if it is in no collection of the scene; an object that becomes part
    of the model now is moved there."""
    if move:
        for other in list(obj.users_collection):
            if other != collection and (
                other == scene.collection or other in list(scene.collection.children_recursive)
            ):
                other.objects.unlink(obj)
    if scene not in obj.users_scene and obj.name not in collection.objects:
        collection.objects.link(obj)


def fill_results(scene, model, objects):
    """The rows of the results for a model's blocks."""
    group = scene.realmodel
    chosen = group.active_result
    group.results.clear()
    total = model.volume
    slivers = results.slivers(model)
    for number, (block, obj) in enumerate(zip(model.blocks, objects, strict=True)):
        row = group.results.add()
        row.name, row.rock = block.name, model.project.rocks[block.rock].name
        row.surface = str(model.surface_names[block.surface])
        row.is_body = bool(model.surface_kind[block.surface] == 2)
        row.property_id = int(block.property)
        row.volume, row.volume_exact = block.volume, repr(block.volume)
        row.share = 100.0 * block.volume / total if total else 0.0
        row.cells, row.components, row.slivers = block.cells, block.components, slivers[number]
        row.object = obj
    group.active_result = min(chosen, max(len(group.results) - 1, 0))


def clear(scene):
    """Removes the blocks from a scene; the interfaces and all settings stay."""
    _clear(scene)
    model_tree.remove_unused_materials()


def _clear(scene):
    objects = [row.object for row in scene.realmodel.results if row.object is not None]
    with settings.filling():
        scene.realmodel.results.clear()
        scene.realmodel.built_stamp = scene.realmodel.built_from = ""
        scene.realmodel.warnings = ""
        scene.realmodel.is_outdated = scene.realmodel.is_coarse = False
        scene.realmodel.view.compartments = ""
        scene.realmodel.left_out_holes.clear()
        scene.realmodel.hole_validation = ""
    model_tree.remove_objects(objects)
    display.cleared(scene)
    planned_holes.update_all(scene)


def remove_model(scene, kept=()):
    """Removes the whole model from a scene: blocks, the interfaces that were made for it, collections,
    settings. The user's objects stay, outside of the model's collections. kept: interfaces that are the
    user's from then on."""
    _remove_model(scene, kept)
    model_tree.remove_unused_materials()


def _remove_model(scene, kept_objects=()):
    _clear(scene)
    group = scene.realmodel
    for _, row in settings.interface_rows(scene):
        obj = row.interface
        if obj is None:
            continue
        if row.interface_digest and obj not in kept_objects:
            row.interface = row.object = None
            model_tree.remove_objects([obj])
        else:
            _release(scene, obj)
    collections = [(row.interfaces, row.blocks, row.collection) for row in group.rocks]
    last = [group.structures, group.collection]
    for key in ("rocks", "faults", "bodies", "results", "library", "planned_holes"):
        getattr(group, key).clear()
    group.structures = group.collection = None
    for collection in [c for three in collections for c in three] + last:
        model_tree.release_collection(collection)
    if ORIGIN_KEY in scene:
        del scene[ORIGIN_KEY]
    exaggeration.apply(scene, [], 0.0)


def _release(scene, obj):
    """An object of the user's that is no interface any more."""
    display.release(obj)
    exaggeration.release(obj)
    for key in (model_tree.TAG, model_tree.ROCK, model_tree.SURFACE, model_tree.PROPERTY):
        if key in obj:
            del obj[key]
    for collection in list(obj.users_collection):
        if collection.get(model_tree.TAG) in ("interfaces", "structures"):
            collection.objects.unlink(obj)
    if scene not in obj.users_scene:
        scene.collection.objects.link(obj)
    visible.show(scene, obj, True)


def remove_rock(scene, row):
    """Removes the blocks, interfaces and collections of a rock mass that is removed from the list."""
    name = row.name
    with settings.filling():
        for surface in row.surfaces:
            release_surface(scene, surface)
        group = scene.realmodel
        gone = [n for n, block in enumerate(group.results) if block.rock == name]
        objects = [group.results[n].object for n in gone]
        for n in reversed(gone):
            group.results.remove(n)
        model_tree.remove_objects([obj for obj in objects if obj is not None])
        model_tree.remove_unused_materials()
        for collection in (row.interfaces, row.blocks, row.collection):
            model_tree.release_collection(collection)


def release_surface(scene, row):
    """Removes the interface of a surface, fault or body that is removed from the list; an object of the user
    stays."""
    obj = row.interface
    row.interface = None
    if obj is None:
        return
    if row.interface_digest and obj.library is None:
        row.object = row.object if row.object != obj else None
        model_tree.remove_objects([obj])
    else:
        _release(scene, obj)
