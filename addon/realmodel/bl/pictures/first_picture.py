# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether light and camera may be set up for a scene without being asked: where the user has set up none.

That is a scene that has nothing but what Blender's own startup file brings along: its camera and its lamp
where they stand there, its world, its renderer; or what was added here before, as long as nobody changed it.
"""

import numpy as np

from ..objects import filled_beds, meshes, model_tree
from . import picture

_STARTUP = {  # name, location and rotation of what the startup file has
    "CAMERA": ("Camera", (7.358891, -6.925791, 4.958309), (1.109319, 0.0, 0.814928)),
    "LIGHT": ("Light", (4.076245, 1.005454, 5.903862), (0.650328, 0.055217, 1.866391)),
    "MESH": ("Cube", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
}
_STARTUP_WORLD = "World"
_STARTUP_SKY = (0.050876, 0.050876, 0.050876, 1.0, 1.0)  # its color and strength
_STARTUP_ENGINE = "BLENDER_EEVEE"  # how its name begins in each version
_PLAIN_TRANSFORMS = ("Filmic", "AgX", "Standard")  # of the startup file, by version, and of a picture
_NOT_RENDERED = ("EMPTY", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE")


def is_free(scene):
    """Whether no camera, lamp, world or renderer of a scene is of the user's making."""
    picture_objects = [obj for obj in scene.objects if picture.KEY in obj]
    others = [obj for obj in scene.objects if obj.type in ("CAMERA", "LIGHT") and obj not in picture_objects]
    if not all(map(_is_of_startup, others)):
        return False
    if picture_objects:
        camera = scene.camera
        return camera in picture_objects and _same(
            camera.get(picture.UNASKED, ()), _numbers(scene, picture_objects)
        )
    return _is_startup_world(scene.world) and scene.render.engine.startswith(_STARTUP_ENGINE)


def is_empty(scene):
    """Whether a scene has no light, camera, world, renderer, view transform or rendered object but those of
    RealModel and of the startup file."""
    ours = {row.object for rock in scene.realmodel.rocks for row in rock.surfaces}
    ours.update(filled_beds.shown(scene))
    for obj in scene.objects:
        keys = {key for key, _ in obj.items()} - {"realmodel_strata"}  # any object may have the last one
        is_ours = obj in ours or any(key.startswith(model_tree.TAG) for key in keys)
        if is_ours or obj.hide_render or obj.type in _NOT_RENDERED:
            continue
        if not (_is_startup_cube(obj) if obj.type not in ("CAMERA", "LIGHT") else _is_of_startup(obj)):
            return False
    has_picture = any(picture.KEY in obj for obj in scene.objects)
    is_plain = _is_startup_world(scene.world) or picture.KEY in scene.world
    is_plain &= has_picture or scene.render.engine.startswith(_STARTUP_ENGINE)
    return is_plain and scene.view_settings.view_transform in _PLAIN_TRANSFORMS


def keep(scene):
    """Remembers how light and camera were set up, and leaves the startup file's lamp and cube out of
    pictures: on a small model the lamp is brighter than the sun."""
    picture_objects = [obj for obj in scene.objects if picture.KEY in obj]
    scene.camera[picture.UNASKED] = _numbers(scene, picture_objects)
    for obj in scene.objects:
        if obj not in picture_objects and (obj.type == "LIGHT" or _is_startup_cube(obj)):
            obj.hide_render = True


def _is_startup_world(world):
    return world is None or (world.name == _STARTUP_WORLD and _same(_sky(world), _STARTUP_SKY))


def _is_of_startup(obj):
    name, location, rotation = _STARTUP[obj.type]
    is_plain = obj.name == name and obj.parent is None and obj.animation_data is None
    return is_plain and _same(obj.location, location) and _same(obj.rotation_euler, rotation)


def _is_startup_cube(obj):
    if obj.type != "MESH" or not _is_of_startup(obj) or len(obj.modifiers) or len(obj.data.vertices) != 8:
        return False
    return _same(np.abs(meshes.mesh_coordinates(obj.data)).ravel(), np.ones(24))


def _sky(world):
    """Color and strength of a world's background; nothing where it has another kind of sky."""
    nodes = world.node_tree.nodes if world.use_nodes else ()
    if {node.type for node in nodes} != {"OUTPUT_WORLD", "BACKGROUND"}:
        return ()
    sky = next(node for node in nodes if node.type == "BACKGROUND")
    return (*sky.inputs["Color"].default_value, sky.inputs["Strength"].default_value)


def _numbers(scene, picture_objects):
    """What users change of light and camera."""
    numbers = [*(() if scene.world is None else _sky(scene.world)), float(scene.render.engine == "CYCLES")]
    for obj in picture_objects:
        numbers += np.ravel(obj.matrix_basis).tolist()
        if obj.type == "LIGHT":
            numbers += [obj.data.energy, *obj.data.color]
        elif obj.type == "CAMERA":
            numbers += [obj.data.lens, float(obj.data.type == "PERSP")]
    return numbers


def _same(one, other):
    return len(one) == len(other) and bool(np.allclose(one, other, rtol=1e-5, atol=1e-5))
