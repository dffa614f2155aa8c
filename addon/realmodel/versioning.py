# SPDX-License-Identifier: GPL-3.0-or-later
"""Migration of older .blend files, one step for each version of the settings.

Version 0 is a scene that build_model.py wrote: it had a stored project and the objects, but no settings.
tests/data/versions has a file of each version.
"""

import json

from .bl import built_scene, method_settings, plan_mesh, reading_text, settings, stored_project, units
from .bl import scene as model_tree
from .core import build


def _from_0(scene):
    """The model is built again, in the place of the objects of batch; its settings are of today."""
    model = build(stored_project.unpack(scene[stored_project.KEY]))
    model_tree.remove_tree(scene)
    built_scene.write_model(scene, model)


def _from_1(scene):
    """Before, nested variograms and local edge lengths had no rows of their own."""
    with settings.filling():
        for rock in scene.realmodel.rocks:
            plan_mesh.take_up_sizes(rock)
            for surface in rock.surfaces:
                method_settings.take_up_nested_variogram(surface)


def _from_2(scene):
    """Before, scenes had Blender's default unit, whatever the unit of the model; entries of the library had
    one ID."""
    units.set_up(scene, scene.realmodel.units)
    with settings.filling():
        for entry in scene.realmodel.library:
            entry.known_id = entry.id


def _from_3(scene):
    """Before, import options and the size of triangles were stored as texts."""
    with settings.filling():
        for rock in scene.realmodel.rocks:
            given = json.loads(rock.mesh_options) if rock.mesh_options and not rock.edge_length > 0.0 else {}
            length = settings.number(rock, "edge_length") or None
            plan_mesh.set_edges(rock, given.get("edge_length", length), given.get("triangles"))
            rock.mesh_options = ""
            for surface in rock.surfaces:
                reading_text.fill(surface, json.loads(surface.reading) if surface.reading else {})
                surface.reading = ""


def _from_4(_scene):
    """Before, there were no faults and bodies."""


_STEPS = (_from_0, _from_1, _from_2, _from_3, _from_4)  # step n makes version n + 1 of version n


def needs_migration(scene):
    group = scene.realmodel
    if group.exists:
        return group.version < settings.VERSION
    return stored_project.KEY in scene


def migrate(scene):
    """Migrates the settings of a scene. Raises RealModelError where they are damaged; then they stay as they
    were."""
    if not needs_migration(scene) or scene.library is not None:
        return
    steps = _STEPS[scene.realmodel.version :] if scene.realmodel.exists else _STEPS[:1]
    for step in steps:
        step(scene)
    scene.realmodel.version = settings.VERSION
    scene.pop(stored_project.KEY, None)
