# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings for a model that was built in batch, so that the panel can go on with it."""

from ..core import InputRefused
from . import built_models, project_settings, scene, settings, shapes, stored_project, versions
from .origin import KEY as ORIGIN_KEY


def can_be_adopted(current):
    """Whether a scene has a model of batch and no settings yet."""
    return stored_project.KEY in current and not current.realmodel.exists and ORIGIN_KEY in current


def adopt(current):
    """Fills in the settings from the stored project, and points them to the objects. Raises InputRefused."""
    project = stored_project.project_from_scene(current)
    if project is None:
        raise InputRefused("the scene has no stored project")
    objects = {_identity(item): item for item in scene.model_objects(current)}
    top = scene.model_collection(current)
    project_settings.fill(current, project)
    with settings.filling():
        group = current.realmodel
        group.collection = top
        for row in group.rocks:
            _point_to_collections(row, top)
            for surface in row.surfaces:
                _point_to_interface(surface, objects.get(("interface", row.name, surface.name)))
        _results(current, objects)
        group.built_stamp = built_models.new_stamp()
    _open_interfaces(current)


def _identity(item):
    kind = item.get(scene.TAG)
    return kind, item.get(scene.ROCK), item.get(scene.BLOCK if kind == "block" else scene.SURFACE)


def _point_to_collections(row, top):
    parent = next((c for c in top.children if c.get(scene.ROCK) == row.name), None) if top else None
    row.collection = parent
    for child in parent.children if parent else ():
        if child.get(scene.TAG) in ("interfaces", "blocks"):
            setattr(row, child[scene.TAG], child)


def _point_to_interface(surface, item):
    if item is None:
        return
    surface.interface = item
    if surface.source != "MESH_OBJECT":
        surface.object = item
        triangles = shapes.mesh_triangles(item.data)
        surface.interface_digest = shapes.digest(shapes.offsets(item, item.data), triangles)


def _results(current, objects):
    """Rows for the blocks; their volumes are those of the meshes until the model is built again."""
    group = current.realmodel
    found = []
    for rock in group.rocks:
        for number, surface in enumerate(rock.surfaces):
            name = surface.block or (f"{surface.name} block" if number else "base block")
            item = objects.get(("block", rock.name, name))
            if item is not None:
                found.append((rock, surface, name, item))
    volumes = [shapes.enclosed_volume(item.data) for *_, item in found]
    total = sum(volumes)
    for (rock, surface, name, item), volume in zip(found, volumes, strict=True):
        row = group.results.add()
        row.name, row.rock, row.surface = name, rock.name, surface.name
        row.property_id, row.object = surface.property_id, item
        row.volume, row.volume_exact = volume, repr(volume)
        row.share = 100.0 * volume / total if total else 0.0


def _open_interfaces(current):
    """Batch closes the eye of the collection of interfaces; the panel hides the interfaces themselves."""
    for view_layer in current.view_layers:
        for layer in _all_layers(versions.layer_collections(view_layer)):
            if layer.collection.get(scene.TAG) == "interfaces" and layer.hide_viewport:
                layer.hide_viewport = False
    for rock in current.realmodel.rocks:
        for surface in rock.surfaces:
            for view_layer in current.view_layers:
                item = surface.interface
                if item is not None and item.name in view_layer.objects:
                    item.hide_set(True, view_layer=view_layer)


def _all_layers(layer):
    yield layer
    for child in layer.children:
        yield from _all_layers(child)
