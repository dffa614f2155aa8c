# SPDX-License-Identifier: GPL-3.0-or-later
"""The quality of the surfaces of the built model, on request: computed in a thread, kept for this session of
Blender, and shown as charts."""

import bpy
import bpy.utils.previews
import numpy as np

from ...core import Cancelled, InputRefused, RealModelError, plots
from ...core.base.work import Job
from ...core.drawing.drawing import text_width
from ...core.drawing.png import rasterize
from ...core.results.surface_quality import surface_quality
from ...core.results.volumes import volume_deviations
from ..display import shown_models
from ..host import caches, notices
from ..host.threads import threads
from ..objects import viewports
from ..project import settings

CHARTS = (
    ("VARIOGRAM", "Variogram", "Semivariance over distance: pairs of points, and the fitted curve"),
    ("CROSS_VALIDATION", "Points", "Cross-validation: each point predicted from the others"),
    ("MESH", "Mesh", "Smallest angles of the triangles"),
)
_LOOK_SECONDS = 0.05
_MOST = 64  # pictures in the cache
_PAGE = 220.0  # points: of a chart in a wide sidebar
_PIXELS = 1.2  # for a point, at least: the texts stay legible

_found = caches.new(most=64)  # key -> SurfaceQuality
# Stamp of a model -> {(rock mass, block): upper bound of its volume's standard deviation}.
_deviations = caches.new()
_working = {}  # the job, its request, and its key, while there is one
_pictures = None  # previews of charts, by their key


def _key(scene, rock, surface):
    return scene.realmodel.built_stamp, rock.name, surface.name


def found(scene):
    """The SurfaceQuality of the active surface, or None."""
    rock, surface = settings.active_rock(scene), settings.active_surface(scene)
    return None if surface is None else _found.get(_key(scene, rock, surface))


def volume_deviation(scene, row):
    """An upper bound of the standard deviation of a block's volume (a row of the results), model units cubed;
    None where it was not requested, or is not known."""
    deviation = _deviations.get(scene.realmodel.built_stamp, {}).get((row.rock, row.name))
    return deviation if deviation is not None and np.isfinite(deviation) else None


def check(scene):
    """Computes the quality of the active surface, in this thread. Raises RealModelError."""
    key, request, task = _asked(scene)
    _keep(key, request, Job(task).result())


def start(scene):
    """Starts to compute it in another thread. Raises InputRefused."""
    stop()
    key, request, task = _asked(scene)
    _working.update(key=key, request=request, job=Job(task))
    bpy.app.timers.register(_look, first_interval=_LOOK_SECONDS)


def state():
    """(fraction done, text) of the running job, else None."""
    return _working["job"].state() if _working else None


def stop():
    """Stops the running job."""
    if _working:
        _working["job"].cancel()
        _working.clear()
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)


def _asked(scene):
    rock, surface = settings.active_rock(scene), settings.active_surface(scene)
    request = shown_models.StageRequest(scene, settings.last_stage(scene))

    def task(_work):
        text_width("0", 1.0)  # loads the letters of charts now, not while a panel is drawn
        model = request.make()
        names = [(r.name, s.name) for r in model.project.rocks for s in r.surfaces]
        if wanted not in names:
            raise InputRefused(f"surface '{wanted[1]}' is not in the built model", advice="press Build first")
        quality = surface_quality(model, names.index(wanted), threads())
        blocks = [(model.project.rocks[block.rock].name, block.name) for block in model.blocks]
        return quality, dict(zip(blocks, volume_deviations(model).tolist(), strict=True))

    wanted = rock.name, surface.name
    return _key(scene, rock, surface), request, task


def _keep(key, request, made):
    request.keep()
    quality, deviations = made
    _deviations.clear()  # of one model at a time
    _deviations[key[0]] = deviations
    _found[key] = quality
    if _pictures is not None:
        _pictures.clear()


def _look():
    """The timer: takes the results of jobs."""
    job = _working["job"]
    viewports.redraw_sidebars()
    if not job.done:
        return _LOOK_SECONDS
    key, request = _working["key"], _working["request"]
    _working.clear()
    try:
        _keep(key, request, job.result())
    except Cancelled:
        pass
    except RealModelError as error:
        bpy.context.window_manager.realmodel.problem = notices.in_panel_words(str(error))
    return None


def drawing(quality, chart, unit, page=None, words=True):
    """The Drawing of a chart, or None where the surface has none. page, words: as in core.plots."""
    options = {} if page is None else {"page": page}
    if chart == "VARIOGRAM" and quality.variogram is not None:
        return plots.variogram(quality.variogram, unit, words=words, **options)
    if chart == "CROSS_VALIDATION" and quality.cross_validation is not None:
        return plots.cross_validation(quality.cross_validation, unit, words=words, **options)
    if chart == "MESH":
        return plots.mesh_quality(quality.angles, words=words, **options)
    return None


def lines(quality, chart, unit):
    """A chart in words."""
    if chart == "VARIOGRAM":
        none = ["This surface has no variogram."]
        if quality.variogram is None:
            return none
        remarks = [notices.in_panel_words(text) for text in quality.remarks]
        return plots.variogram_lines(quality.variogram, unit) + remarks
    if chart == "CROSS_VALIDATION":
        if quality.cross_validation is None:
            return [f"No cross-validation: {quality.missing}."]
        return plots.cross_validation_lines(quality.cross_validation, unit)
    return plots.mesh_quality_lines(quality.angles)


def icon(scene, chart, pixels):
    """The icon of a chart of the active surface as a picture of this size in pixels, or None."""
    global _pictures
    quality = found(scene)
    key = f"{_key(scene, settings.active_rock(scene), settings.active_surface(scene))} {chart} {pixels}"
    if _pictures is None:
        _pictures = bpy.utils.previews.new()
    if key not in _pictures:
        page = min(_PAGE, pixels / _PIXELS)
        drawn = drawing(quality, chart, scene.realmodel.units, (page, page), words=False)
        if drawn is None:
            return None
        if len(_pictures) >= _MOST:
            _pictures.clear()
        picture = _pictures.new(key)
        shown = rasterize(drawn, pixels / page)
        picture.image_size = shown.shape[1], shown.shape[0]
        picture.image_pixels_float.foreach_set(np.ascontiguousarray(shown[::-1]).ravel())
    return _pictures[key].icon_id


def forget():
    """Clears all results: the add-on is disabled, or another file was opened."""
    global _pictures
    stop()
    _found.clear()
    _deviations.clear()
    if _pictures is not None:
        bpy.utils.previews.remove(_pictures)
        _pictures = None
