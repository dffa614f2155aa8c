# SPDX-License-Identifier: GPL-3.0-or-later
"""The model that a scene shows, built again where it is not at hand."""

from ..core import build
from . import built_models, project_settings


def model_of(context, cells="columns"):
    """The realmodel.core.Model of the context's scene with these cells.

    It is kept since the last build; after a .blend was opened, or with other cells, it is built again from
    the settings, without touching the scene. Raises InputRefused, BuildFailed.
    """
    current = context.scene
    model = built_models.current(current, cells)
    if model is None:
        composed = project_settings.compose(current, context.evaluated_depsgraph_get(), whole=False)
        model = build(composed.project, cells=cells)
        if current.realmodel.built_stamp:
            built_models.remember(model, current.realmodel.built_stamp)
    return model
