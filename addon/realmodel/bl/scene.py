# SPDX-License-Identifier: GPL-3.0-or-later
"""A model as a Blender scene: collections, interfaces, blocks, and what says which is which.

    <project>                     collection, realmodel = "project"
      <rock>                      collection, realmodel = "rock"; one per rock mass
        <rock> interfaces         collection, realmodel = "interfaces"
          <surface>               mesh object, realmodel = "interface": the input triangulation
        <rock> blocks             collection, realmodel = "blocks"
          <block>                 mesh object, realmodel = "block": closed boundary of the block

Names are unique in a .blend file, so Blender may add ".001" to them; the custom properties keep the
names that the project gives: `realmodel_rock`, `realmodel_surface` (for a block the surface it was
deposited beneath), `realmodel_block`, and `realmodel_property`, the library ID.
"""

from dataclasses import dataclass, field

import bpy

from ..core import polygon_mesh
from . import materials, meshes, origin, stored_project, uncertainty, units, versions

TAG = "realmodel"
ROCK = "realmodel_rock"
SURFACE = "realmodel_surface"
BLOCK = "realmodel_block"
PROPERTY = "realmodel_property"
OBJECT_KINDS = ("interface", "block")


@dataclass
class Created:
    """Datablocks made so far; whatever goes wrong, they can be taken back."""

    objects: list = field(default_factory=list)
    meshes: list = field(default_factory=list)
    materials: list = field(default_factory=list)
    collections: list = field(default_factory=list)

    def remove(self):
        for made, store in (
            (self.objects, bpy.data.objects),
            (self.meshes, bpy.data.meshes),
            (self.materials, bpy.data.materials),
            (self.collections, bpy.data.collections),
        ):
            for datablock in reversed(made):
                store.remove(datablock)
            made.clear()


@dataclass
class _RockObjects:
    """The new objects of one rock mass with the names they are to have."""

    name: str
    interfaces: list = field(default_factory=list)  # (object, name)
    blocks: list = field(default_factory=list)


def write_model(scene, model):
    """Put a model into a scene, in place of the one that is there.

    scene: bpy.types.Scene. model: realmodel.core.Model.
    Returns the project's collection. Objects that are not the model's are left alone, also those
    that stand in its collections; materials of the earlier model are kept and renamed or
    recoloured where the library changed. If anything fails the scene is as it was before.
    """
    stored = stored_project.pack(model.project)
    model_origin = origin.choose_origin(model.surface_vertices)
    old = model_objects(scene)
    earlier_names = {_identity(item): item.name for item in old}
    created = Created()
    try:
        palette, updates = _materials(scene, model, created)
        rocks = _rock_objects(model, model_origin, palette, created)
        project = _collection_tree(scene, model, rocks, created)
    except BaseException:
        created.remove()
        raise
    # What can fail is behind us: from here on only links, removes and names.
    if model_collection(scene) is None:
        scene.collection.children.link(project)
        _hide_interfaces(scene)
    remove_objects(old)
    _remove_stale(project, {rock.name for rock in rocks})
    give_name(bpy.data.collections, project, model.project.name)
    for name, colour, material in updates:
        give_name(bpy.data.materials, material, name)
        materials.set_colour(material, colour)
    for rock in rocks:
        for made, name in (*rock.interfaces, *rock.blocks):
            earlier = earlier_names.get(_identity(made), name)
            give_name(bpy.data.objects, made, earlier if is_name_of(earlier, name) else name)
            give_name(bpy.data.meshes, made.data, made.name)
    units.set_up(scene, model.project.units)
    scene[stored_project.KEY] = stored
    scene[origin.KEY] = [float(value) for value in model_origin]
    return project


def _identity(item):
    """What an object is in its model, whatever its name."""
    return tuple(item.get(key) for key in (TAG, ROCK, SURFACE, BLOCK))


def is_name_of(name, wanted):
    """Whether a name is the wanted one or what Blender makes of it where it is taken ("S0.001")."""
    base, _, number = name.rpartition(".")
    return name == wanted or (base == wanted and number.isdecimal())


def give_name(store, datablock, name):
    """Name a datablock where the name is free. Blender would take it away from another one's."""
    if datablock.name != name and name not in store:
        datablock.name = name


def model_collection(scene):
    """The collection of the model in a scene, wherever the user may have moved it, or None."""
    return next((c for c in scene.collection.children_recursive if c.get(TAG) == "project"), None)


def model_objects(scene, kind=None):
    """The model's objects in a scene, interfaces and blocks or only one kind, oldest first."""
    project = model_collection(scene)
    if project is None:
        return []
    kinds = OBJECT_KINDS if kind is None else (kind,)
    found = []
    for rock in project.children:
        for collection in rock.children:
            found += [o for o in collection.objects if o.get(TAG) in kinds]
    return found


def remove_model(scene):
    """Take the model out of a scene: its objects, its collections and the stored project."""
    project = model_collection(scene)
    if project is not None:
        remove_objects(model_objects(scene))
        for rock in list(project.children):
            for collection in list(rock.children):
                _remove_if_empty(collection)
            _remove_if_empty(rock)
        _remove_if_empty(project)
    for key in (stored_project.KEY, origin.KEY):
        if key in scene:
            del scene[key]


def _materials(scene, model, created):
    """Material of each property ID that a block has, and what is to be renamed or recoloured."""
    earlier = {}
    for item in model_objects(scene, "block"):
        for material in item.data.materials:
            if material is not None and materials.KEY in material:
                earlier[int(material[materials.KEY])] = material
    palette, updates = {}, []
    for property_id in sorted({int(block.property) for block in model.blocks if block.cells}):
        name, colour = materials.name_and_colour(model.project.library, property_id)
        material = earlier.get(property_id)
        if material is None:
            material = materials.new_material(name, property_id, colour)
            created.materials.append(material)
        updates.append((name, colour, material))
        palette[property_id] = material
    return palette, updates


def _rock_objects(model, model_origin, palette, created):
    """New objects of every rock mass, not yet in any collection."""
    rocks = []
    shapes = polygon_mesh.of_blocks(model, model_origin)
    surface = 0  # global index
    for rock in model.project.rocks:
        made = _RockObjects(rock.name)
        for given in rock.surfaces:
            made.interfaces.append(_interface(model, surface, rock, given, model_origin, created))
            surface += 1
        rocks.append(made)
    for number, block in enumerate(model.blocks):
        if block.cells:
            rock = rocks[block.rock]
            rock.blocks.append(_block(model, number, rock.name, shapes[number], palette, created))
    return rocks


def _interface(model, surface, rock, given, model_origin, created):
    vertices, triangles = model.surface(surface)
    offsets = origin.offsets_from(model_origin, vertices)
    mesh = meshes.triangle_mesh(given.name, offsets, triangles, smooth=True)
    made = _object(mesh, given.name, created)
    uncertainty.add_attributes(mesh, model.surface_attributes(surface))
    made[TAG] = "interface"
    made[ROCK] = rock.name
    made[SURFACE] = given.name
    made[PROPERTY] = int(given.property)
    return made, given.name


def _block(model, number, rock_name, shape, palette, created):
    block = model.blocks[number]
    mesh = meshes.new_mesh(block.name, shape)
    made = _object(mesh, block.name, created)
    mesh.materials.append(palette[int(block.property)])
    made[TAG] = "block"
    made[ROCK] = rock_name
    made[SURFACE] = str(model.surface_names[block.surface])
    made[BLOCK] = block.name
    made[PROPERTY] = int(block.property)
    return made, block.name


def _object(mesh, name, created):
    created.meshes.append(mesh)
    made = bpy.data.objects.new(name, mesh)
    created.objects.append(made)
    return made


def _collection_tree(scene, model, rocks, created):
    """The project's collection with the new objects linked; earlier collections are used again."""
    project = model_collection(scene)
    if project is None:
        project = _new_collection(model.project.name, "project", created)
    links = []
    for rock in rocks:
        parent = _child(project, rock.name, "rock", rock.name, links, created)
        for kind, made in (("interfaces", rock.interfaces), ("blocks", rock.blocks)):
            collection = _child(parent, f"{rock.name} {kind}", kind, rock.name, links, created)
            links += [(collection.objects, item) for item, _ in made]
    for place, item in links:
        place.link(item)
    return project


def _child(parent, name, kind, rock_name, links, created):
    """The child collection of a kind for a rock mass, new where there is none."""
    for collection in parent.children:
        if collection.get(TAG) == kind and collection.get(ROCK) == rock_name:
            return collection
    collection = _new_collection(name, kind, created)
    collection[ROCK] = rock_name
    links.append((parent.children, collection))
    return collection


def _new_collection(name, kind, created):
    collection = bpy.data.collections.new(name)
    created.collections.append(collection)
    collection[TAG] = kind
    collection.hide_render = kind == "interfaces"
    return collection


def _hide_interfaces(scene):
    """Close the eye of the interfaces: they lie exactly on the blocks' faces and would flicker."""
    for view_layer in scene.view_layers:
        layers = versions.layer_collections(view_layer).children
        project = next(c for c in layers if c.collection.get(TAG) == "project")
        for rock in project.children:
            for layer in rock.children:
                layer.hide_viewport = layer.collection.get(TAG) == "interfaces"


def remove_objects(objects):
    """Remove objects with their meshes, and the materials of the model that nothing uses now."""
    used = []
    for item in objects:
        mesh = item.data
        used += [m for m in mesh.materials if m is not None and materials.KEY in m]
        bpy.data.objects.remove(item)
        if not mesh.users:
            bpy.data.meshes.remove(mesh)
    for material in {m.name: m for m in used}.values():
        if not material.users:
            bpy.data.materials.remove(material)


def _remove_stale(project, names):
    """Remove the collections of rock masses that the model no longer has."""
    for rock in list(project.children):
        if rock.get(TAG) == "rock" and rock.get(ROCK) not in names:
            for collection in list(rock.children):
                _remove_if_empty(collection)
            _remove_if_empty(rock)


def _remove_if_empty(collection):
    if not len(collection.objects) and not len(collection.children):
        bpy.data.collections.remove(collection)
