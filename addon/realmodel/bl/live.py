# SPDX-License-Identifier: GPL-3.0-or-later
"""Building again on its own after a change, when the hand rests (`scene.realmodel.live`).

A handler of Blender's dependency graph tells of changed objects, the settings of changed rows. A timer waits
until nothing has changed for a moment, builds in a thread, and puts the result into the meshes that are
there.
"""


def touch(scene):
    """Something that the model of a scene depends on was changed."""


def switched():
    """`live` was switched on or off in some scene."""


def stop_work():
    """Stops a build that is under way, and waits for its end."""


def undone():
    """Blender has undone or redone something: what is on the screen may be of another build."""


def changed(scene, depsgraph):
    """Blender has evaluated changed objects."""


def stop():
    """Ends everything: the add-on is disabled."""
    stop_work()
