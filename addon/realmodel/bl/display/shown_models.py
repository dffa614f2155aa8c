# SPDX-License-Identifier: GPL-3.0-or-later
"""The model that is drawn: the built one, or a stage of it. Stages are kept once they were asked for.

A stage costs about as much as building the surfaces up to it anew with whole blocks as cells; to show it,
only the blocks that differ go to Blender.
"""

from ...core import build
from ...core.build import build_stage
from .. import built_models, settings

_MOST_CORNERS = 20_000_000  # of the faces of all stages that are kept: about 0.3 GB
_stages = {}  # (stamp, stage, cells) -> realmodel.core.Model, the one that was used last at the end


def whole(scene, cells=None):
    """The realmodel.core.Model that a scene was built to.

    cells: "columns" or "blocks"; None: whichever is at hand. Where it is not at hand - a .blend was opened -
    it is built again from the settings, without touching the scene. Raises InputRefused, BuildFailed.
    """
    model = built_models.current(scene, cells)
    if model is not None:
        return model
    at_hand = built_models.current(scene)
    if at_hand is not None:
        model = build_stage(at_hand, settings.last_stage(scene), cells=cells)
    else:
        model = build(_composed(scene, cells), cells=cells or "blocks")
    if scene.realmodel.built_stamp:
        built_models.remember(model, scene.realmodel.built_stamp)
    return model


def _composed(scene, cells):
    from .. import build_job  # which tells this package of its builds

    layer = scene.view_layers[0]
    layer.update()
    return build_job.BuildJob(scene, layer.depsgraph, cells or "blocks", whole=False).composed.project


def at_stage(scene, stage, cells=None):
    """The realmodel.core.Model just after surface `stage` of each rock mass. Raises as `whole`.

    cells: as for `whole`; None: whole blocks, unless the stage is the last.
    """
    if stage >= settings.last_stage(scene):
        return whole(scene, cells)
    kind = cells or "blocks"
    stamp = scene.realmodel.built_stamp
    model = _stages.pop((stamp, stage, kind), None)
    if model is None:
        model = build_stage(whole(scene), stage, cells=kind)
    if stamp:
        _stages[stamp, stage, kind] = model
        _make_room()
    return model


def _make_room():
    while len(_stages) > 1 and sum(len(m.face_vertices) for m in _stages.values()) > _MOST_CORNERS:
        _stages.pop(next(iter(_stages)))


def forget():
    """Lets go of all stages."""
    _stages.clear()
