# SPDX-License-Identifier: GPL-3.0-or-later
"""The displayed model: the built one, or a stage of it. Requested stages are cached.

A stage costs about as much as building the surfaces up to it with whole blocks as cells; to show it, only the
blocks that differ are transferred to Blender.
"""

import bpy

from ...core import BuildFailed, InputRefused, build
from ...core.cells.assembly import build_stage
from ...core.display import polygon_mesh
from ..host import caches
from ..host.threads import threads
from ..objects import block_shapes, built_models, viewports
from ..project import compartments, project_settings, settings

BUILT = 0.1  # share of the progress for the model, which is built again if it is not cached
_MOST_CORNERS = 20_000_000  # of the faces of all stages that are kept: about 0.6 GB with their shapes
_stages = caches.new()  # (stamp, stage, cells) -> realmodel.core.Model, the one that was used last at the end
_shapes = caches.new()  # (stamp, stage) -> {(rock mass, block): PolygonMesh}


class StageRequest:
    """Makes the model of a scene at a stage: just after surface `stage` of each rock mass.

    cells: "columns" or "blocks"; None: whole blocks for a stage, and the cells in the cache for the whole
    model. The main thread makes the request from the scene, any thread runs it (`make`), and the main thread
    caches the result (`keep`). Without a model in the cache (after a .blend was opened) the model is built
    from the settings; the scene does not change. Raises InputRefused.
    """

    def __init__(self, scene, stage, cells=None):
        self._scene = scene.name
        self.stamp, self.stage = scene.realmodel.built_stamp, stage
        self.is_whole = stage >= settings.last_stage(scene)
        self.cells = cells if self.is_whole else cells or "blocks"
        self.origin = project_settings.model_origin(scene)
        self.model = self._known(scene)
        self._base = None if self.model else built_models.current(scene)
        self._project = None if self.model or self._base else _composed(scene)
        self._is_new = self.model is None
        self._compartments = compartments.names(scene)

    def _known(self, scene):
        if self.is_whole:
            return built_models.current(scene, self.cells)
        return _stages.get((self.stamp, self.stage, self.cells))

    def scene(self):
        """The scene, which still shows the model that it showed. Raises BuildFailed."""
        scene = bpy.data.scenes.get(self._scene)
        if scene is None:
            raise BuildFailed(f"scene '{self._scene}' is gone; nothing was changed")
        if scene.realmodel.built_stamp != self.stamp or not len(scene.realmodel.results):
            raise BuildFailed("another model was built at the same time; nothing was changed: start again")
        return scene

    def make(self):
        """The realmodel.core.Model. Raises InputRefused, BuildFailed, Cancelled."""
        if self.model is None and self._base is None:
            kind = self.cells or "blocks"
            self._base = build(self._project, cells=kind, threads=threads())
            if self.is_whole:
                self.model = self._base
        if self.model is None:
            last = max(len(rock.surfaces) for rock in self._base.project.rocks) - 1
            stage = last if self.is_whole else self.stage
            self.model = build_stage(self._base, stage, cells=self.cells)
        return self.model

    def make_shapes(self):
        """{(rock mass, block): PolygonMesh} of the model's blocks."""
        named_shapes = _shapes.get((self.stamp, self.stage))
        if named_shapes is None:
            model = self.make()
            made = polygon_mesh.of_blocks(
                model, self.origin, threads(), compartments=self._compartments or None
            )
            named_shapes = block_shapes.by_name(model, made)
        return named_shapes

    def keep(self, shapes=None):
        """Caches the result."""
        if not self.stamp:
            return
        if shapes is not None:
            _shapes[self.stamp, self.stage] = shapes
        if self.model is None:
            return  # the shapes were at hand already
        if self._is_new and self._base is not None and self._project is not None:
            built_models.remember(self._base, self.stamp)
        if self.is_whole:
            if self._is_new:
                built_models.remember(self.model, self.stamp)
            return
        _stages.pop((self.stamp, self.stage, self.cells), None)
        _stages[self.stamp, self.stage, self.cells] = self.model
        _make_room()


def at_stage(scene, stage, cells=None):
    """The realmodel.core.Model just after surface `stage` of each rock mass, made in this thread. cells: as
    for `StageRequest`. Raises InputRefused, BuildFailed."""
    request = StageRequest(scene, stage, cells)
    model = request.make()
    request.keep()
    return model


def whole(scene, cells="columns"):
    """The whole realmodel.core.Model of a scene, built in this thread if it is not cached. Raises as
    `at_stage`."""
    return at_stage(scene, settings.last_stage(scene), cells)


def shapes_at_stage(scene, stage):
    """{(rock mass, block): PolygonMesh} at a stage, made in this thread. Raises as `at_stage`."""
    request = StageRequest(scene, stage)
    shapes = request.make_shapes()
    request.keep(shapes)
    return shapes


def has_shapes(scene, stage):
    """Whether the shapes of the blocks at a stage are in the cache."""
    return (scene.realmodel.built_stamp, stage) in _shapes


def remember_stage(scene, stage, model, shapes):
    """Caches a stage that was made together with the model."""
    stamp = scene.realmodel.built_stamp
    _stages[stamp, stage, model.cell_kind] = model
    _shapes[stamp, stage] = shapes


def _composed(scene):
    """The project of the displayed model. Raises InputRefused where the settings are no longer those that it
    was built from."""
    composed = project_settings.compose(scene, viewports.updated_layer(scene).depsgraph, whole=False)
    built_from = scene.realmodel.built_from
    if built_from and built_from.split()[0] != composed.fingerprint.split()[0]:
        what = "the model is out of date, and not in memory any more since the file was opened"
        raise InputRefused(what, advice="press Build first")
    return composed.project


def _make_room():
    while len(_stages) > 1 and sum(len(m.face_vertices) for m in _stages.values()) > _MOST_CORNERS:
        stamp, stage, _ = next(iter(_stages))
        _stages.pop(next(iter(_stages)))
        if not any(key[:2] == (stamp, stage) for key in _stages):
            _shapes.pop((stamp, stage), None)


def forget():
    """Clears all cached stages."""
    _stages.clear()
    _shapes.clear()
