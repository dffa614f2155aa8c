# SPDX-License-Identifier: GPL-3.0-or-later
"""The polyhedral cells of blocks as meshes in which each stands by itself, drawn a little smaller; or the
parts of the blocks in each compartment, which can move apart."""

import json

from ...core.display import polygon_mesh
from ..host import caches
from ..host.threads import threads
from ..objects import block_shapes
from ..project import compartments, project_settings
from . import cuts, shown_models

SHRINK = 0.88  # of a cell's size: the gaps let each be seen
_kept = caches.new(most=1)  # by the state that they are made from: {(rock mass, block): PolygonMesh}


def made_of(scene, stage, apart=False):
    """The state that the cells of a scene are made from, as text: model, stage, settings. apart: whether
    compartments are separate parts."""
    cut = scene.realmodel.view.cut if cuts.is_shown(scene) else ""
    return json.dumps([scene.realmodel.built_stamp, stage, cut] + ["apart"] * bool(apart))


class CellRequest:
    """Makes the meshes of cells: of the model at a stage, or of its half where the cut is shown. Used like
    `shown_models.StageRequest`. Raises InputRefused."""

    def __init__(self, scene, stage, apart=False):
        self.made_of = made_of(scene, stage, apart)
        self._shrink, kind = (None, None) if apart else (SHRINK, "columns")
        self._compartments = compartments.names(scene) or None
        self.shapes = _kept.get(self.made_of)
        self._half = self._plane = None
        if cuts.is_shown(scene):
            self._half = cuts.known_half(scene.realmodel.view.cut, kind)
            self._plane = json.loads(scene.realmodel.view.cut)[:2]
        self._model = shown_models.StageRequest(scene, stage, kind) if self._half is None else None
        self._origin = project_settings.model_origin(scene)

    @property
    def is_ready(self):
        return self.shapes is not None

    def make(self):
        """{(rock mass, block): PolygonMesh}, in offsets from the model origin. Raises RealModelError."""
        if self.shapes is None:
            model = self._half
            if model is None:
                model = self._model.make()
                if self._plane is not None:
                    model = model.cut_by_plane(*self._plane).below
            shapes = polygon_mesh.of_cells(
                model, self._origin, self._shrink, threads(), compartments=self._compartments
            )
            self.shapes = block_shapes.by_name(model, shapes)
        return self.shapes

    def keep(self):
        """Caches the result until other cells are requested."""
        _kept[self.made_of] = self.shapes
        if self._model is not None:
            self._model.keep()


def of_scene(scene, stage, apart=False):
    """The meshes of the cells, made in this thread if they are not in the cache. Raises RealModelError."""
    request = CellRequest(scene, stage, apart)
    shapes = request.make()
    request.keep()
    return shapes


def forget():
    """Clears the cached cells: they are in the scene, or no longer wanted."""
    _kept.clear()
