# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks baked to files, picture by picture in the main thread: the window is updated between two of them.

Each picture is made from copies of its own, so that in between the scene is as it was.
"""

import tempfile
from pathlib import Path

import bpy

from ...core import BuildFailed, Cancelled, InputRefused
from ...core.base.atomic import Outputs, make_folder
from ..host.thread_job import ThreadJob
from ..scene.bake import UV_MAP, Baking
from ..scene.temporary_copies import copied
from ..shading import rock_layers


class BakeJob(ThreadJob):
    """`run` and `finish` return the names of the files.

    items: mesh objects. folder: of the pictures. kinds, layout, size: as of bake.Baking. is_plain: objects
    get one plain material with the pictures in place of their own, and their modifiers are applied; otherwise
    they get only the UV map of the pictures.
    """

    done = True  # there is no thread

    def __init__(self, context, items, folder, kinds, layout, size, is_plain):
        """Raises InputRefused where an object cannot get the UV map."""
        modified = next((obj for obj in items if obj.modifiers), None)
        if modified is not None and not is_plain:
            raise InputRefused(
                "it has modifiers, which pictures without a new material would not fit",
                item=modified.name,
                advice="switch Plain Materials on, or apply its modifiers",
            )
        self._scene, self._names = context.scene.name, [obj.name for obj in items]
        self._folder, self._is_plain = folder, is_plain
        self._place = tempfile.TemporaryDirectory()
        self._baking = Baking(kinds, layout, size, Path(self._place.name))
        self._steps, self._at = None, 0
        self._is_cancelled = False

    def run(self):
        while not self.hand_over(0.0):
            pass
        return self.finish()

    def start(self, is_short=False):
        """Nothing starts before `hand_over`."""

    def wait(self):
        """Nothing goes on by itself."""

    def state(self):
        if not self._steps:
            return 0.0, "laying out UV maps"
        kind, _ = self._steps[min(self._at, len(self._steps) - 1)]
        return self._at / len(self._steps), f"baking {kind.lower()}"

    def cancel(self):
        self._is_cancelled = True

    def leave(self):
        self._place.cleanup()

    def hand_over(self, _seconds):
        """Bakes a picture."""
        if self._is_cancelled:
            return True
        try:
            with copied(bpy.context, self._items()) as copies:
                if self._steps is None:
                    self._baking.prepare(bpy.context.scene, copies)
                    self._steps = self._baking.steps
                    if not self._steps:
                        raise InputRefused("no material has anything to bake", advice="give the rocks looks")
                    return False
                self._baking.fit(copies)
                self._baking.make(bpy.context, copies, self._steps[self._at])
        except BaseException:
            self.leave()
            raise
        self._at += 1
        return self._at == len(self._steps)

    def finish(self):
        try:
            if self._is_cancelled:
                raise Cancelled("cancelled")
            items, names = self._items(), self._baking.files()
            make_folder(self._folder)
            with Outputs() as outputs:
                for name in names:
                    with outputs.file(self._folder / name) as file:
                        file.write((Path(self._place.name) / name).read_bytes())
            if self._is_plain:
                self._replace(items)
            else:
                self._add_maps(items)
            return names
        finally:
            self.leave()

    def _items(self):
        """The objects. Raises BuildFailed where they cannot be baked any more."""
        context = bpy.context
        items = [context.scene.objects.get(name) for name in self._names]
        for name, obj in zip(self._names, items, strict=True):
            if context.scene.name != self._scene or obj is None or obj.type != "MESH":
                raise BuildFailed(f"object '{name}' is gone; nothing was changed")
        if context.mode != "OBJECT":
            raise BuildFailed("an object is being edited; nothing was changed")
        return items

    def _add_maps(self, items):
        for number, obj in enumerate(items):
            uv, layers = self._baking.uv(number), obj.data.uv_layers
            if uv is not None:
                active = layers.active.name if layers.active else UV_MAP
                rock_layers.set_uv(obj.data, UV_MAP, uv)
                layers[active].active = layers[active].active_render = True

    def _replace(self, items):
        """Objects get the shape and the material of their copies."""
        old = []
        with copied(bpy.context, items) as copies:
            self._baking.fit(copies)
            self._baking.show(copies, self._folder)
            for obj, copy in zip(items, copies.items, strict=True):
                if self._baking.uv(items.index(obj)) is None:
                    continue
                old.append((obj, obj.data, copy.data.name))
                obj.modifiers.clear()
                obj.data = copy.data
                copies.keep(copy.data)
        for obj, mesh, name in old:
            if not mesh.users:
                bpy.data.meshes.remove(mesh)
            obj.data.name = name
