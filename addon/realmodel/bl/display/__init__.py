# SPDX-License-Identifier: GPL-3.0-or-later
"""How a built model is shown: the display modes, the stage, the blocks moved apart, the colours.

The settings call one function here when they change, the build calls `built` and `cleared`.
"""

from .. import built_models  # noqa: F401 - what is drawn is taken from there


def register():
    """Called when the add-on is enabled."""


def unregister():
    """Called when the add-on is disabled: no handler of drawing may stay."""


def mode_changed(scene):
    """Another display mode: interfaces are hidden where blocks are shown, and the other way round."""
    interfaces = scene.realmodel.display == "SURFACES"
    for rock in scene.realmodel.rocks:
        for surface in rock.surfaces:
            show(scene, surface.interface, interfaces and not surface.hide)
    for block in scene.realmodel.results:
        show(scene, block.object, not interfaces)


def stage_changed(scene):
    """Another stage."""


def explode_changed(scene):
    """The blocks moved apart, farther or less."""


def colours_changed(scene):
    """Another rule of colouring, or another colour in the library."""


def built(scene):
    """A model was built anew: `built_models.current(scene)` has it."""
    for layer in scene.view_layers:
        layer.update()  # or it would not know the new objects, and show them all when it learns of them
    mode_changed(scene)


def cleared(scene):
    """The blocks are gone."""


def frame_changed(scene):
    """Another frame of an animation: keyframed settings have changed without their callbacks."""


def show(scene, item, shown):
    """Shows or hides an object in the view layers of a scene."""
    if item is None:
        return
    for layer in scene.view_layers:
        if item.name in layer.objects and item.hide_get(view_layer=layer) == shown:
            item.hide_set(not shown, view_layer=layer)
