# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators of the panel, `bpy.ops.realmodel.*`, also for scripts and F3."""

from ..registration import modules_in, register_modules, unregister_modules


def register():
    register_modules(modules_in(__name__, __path__))


def unregister():
    unregister_modules(modules_in(__name__, __path__))
