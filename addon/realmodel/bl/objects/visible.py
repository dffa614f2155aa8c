# SPDX-License-Identifier: GPL-3.0-or-later
"""Showing and hiding the model's objects, without taking back what the user hides or shows by hand."""

WANTED = "realmodel_shown"  # on an object: whether the view last showed it in the viewport
RENDER_HIDDEN = "realmodel_render_hidden"  # on an object that the view excluded from renders


def show(scene, item, shown):
    """Shows or hides an object in the view layers of a scene."""
    if item is None:
        return
    for layer in scene.view_layers:
        if item.name in layer.objects and item.hide_get(view_layer=layer) == shown:
            item.hide_set(not shown, view_layer=layer)


def want(scene, item, shown, rendered):
    """Shows or hides an object for the view, and renders it or not. It acts only where this has changed, so
    an object that the user hid stays hidden. An object in an edit mode stays visible."""
    if item is None or item.library is not None:
        return
    if item.mode != "OBJECT" and not shown:
        return
    if item.get(WANTED) != shown:
        show(scene, item, shown)
        item[WANTED] = shown
    if rendered and RENDER_HIDDEN in item:
        item.hide_render = False
        del item[RENDER_HIDDEN]
    elif not rendered and not item.hide_render:
        item.hide_render = True
        item[RENDER_HIDDEN] = True


def select_alone(context, item):
    """Selects an object and nothing else, and makes it the active one."""
    for other in context.selected_objects:
        other.select_set(False)
    item.select_set(True)
    context.view_layer.objects.active = item
