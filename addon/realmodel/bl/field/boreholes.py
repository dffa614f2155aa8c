# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes as tubes: in the colors of the blocks of their intervals or, of a hole with picks alone, of the
layers beneath these; or by a column of the tables of intervals. Where the model is cut, those within a width
of the plane, on it. And the names of the holes."""

import functools
from itertools import pairwise

import numpy as np

from ...core.drawing import color_scale
from ...core.drawing.overlay import ColorKey
from ...core.project.looks import hex_color, rgb
from ...core.results.sections.hole_curves import limits_of, seen_values, shares_of
from ...core.results.sections.section_holes import near_plane
from ..display import bodies, colors, cuts
from ..host import caches
from ..objects import marks
from ..project import borehole_picks, interval_values, observed_blocks, project_settings
from . import heights

BOREHOLES = "boreholes"
RADIUS = 0.005  # of the size of all
_SIDES = 8
_STEPS = 15  # of the color scale: each is a material, which all ways of shading show
_MOST_WORDS = 24  # of a column of words that have a color of their own
_OTHERS = "#b0b0b0"  # words beyond these
_scales = caches.new(most=8)  # by column and the texts of the values: viewports ask at each redraw


def show(scene):
    """Shows the boreholes of a scene, in place of those that are shown."""
    bodies.remove(scene, BOREHOLES)
    tubes = list(_colored(scene) if column(scene) else _by_block(scene))
    begin, end = (np.array([tube[side] for tube in tubes], np.float64).reshape(-1, 3) for side in (1, 2))
    indices, begin, end = near_cut(scene, begin, end)
    if not len(indices):
        return
    places = np.stack([begin, end], axis=1).reshape(-1, 3) - project_settings.model_origin(scene)
    pairs = np.arange(len(places)).reshape(-1, 2)
    shape = marks.lines(places, pairs, RADIUS * heights.extent(scene), _SIDES)
    mesh = bodies.add(scene, BOREHOLES, "Boreholes", shape).data
    bodies.give_materials(mesh, [tubes[number][0] for number in indices.tolist()], _SIDES)


def near_cut(scene, begin, end):
    """The numbers of the lines from begin to end, (N, 3) each, that are shown, and both ends of them: all in
    their places or, on a cut, what is near the section plane, on it."""
    indices = np.flatnonzero((begin != end).any(axis=1))
    begin, end = begin[indices], end[indices]
    if not is_on_cut(scene):
        return indices, begin, end
    on_plane, begin, end = near_plane(begin, end, cuts.plane_in_model(scene), scene.realmodel.view.hole_width)
    return indices[on_plane], begin, end


def is_on_cut(scene):
    """Whether only what is near the section plane is shown, on it."""
    return cuts.is_on(scene) and scene.realmodel.view.hole_width > 0.0


def column(scene):
    """The column by which the tubes are colored; empty: by their blocks."""
    wanted = scene.realmodel.view.boreholes_by
    return wanted if wanted in columns(scene) else ""


def columns(scene):
    """The columns of the tables of intervals, and the curves of logs, that there are."""
    tables = (interval_values.of_rock(rock) for rock in scene.realmodel.rocks)
    return list(dict.fromkeys(name for values in tables if values is not None for name in values.columns))


def limits(scene):
    """(low, high) of the column that the tubes show; None where it is not one of numbers."""
    name = column(scene)
    return _scale(scene, name)[0] if name else None


def key(scene):
    """The core's ColorKey of the column that the tubes show, or None."""
    name = column(scene)
    if not (name and scene.realmodel.view.show_boreholes):
        return None
    between, words = _scale(scene, name)
    if between is None:
        return ColorKey(name, [(word, rgb(colors.hue(n))) for n, word in enumerate(words)])
    if not between[1] > between[0]:
        return None
    shades = color_scale.colors(np.linspace(0.0, 1.0, _STEPS), (0.0, 1.0))
    return ColorKey(name, limits=between, colors=shades)


def labels(scene):
    """(name, (x, y, z) in model coordinates) of each hole, at its upper end."""
    if not scene.realmodel.view.show_hole_names:
        return []
    near = cuts.plane_in_model(scene) if is_on_cut(scene) else None
    named_places = []
    for rock in scene.realmodel.rocks:
        for name, line in borehole_picks.named_paths(rock).items():
            line = np.array(line)
            if near is not None and len(line) > 1:
                _, line, _ = near_plane(line[:-1], line[1:], near, scene.realmodel.view.hole_width)
            if len(line):
                named_places.append((name, tuple(line[0].tolist())))
    return named_places


def _by_block(scene):
    """(material, begin, end) of the tubes."""
    material_of = functools.cache(lambda number: colors.of_property(scene, number))
    for rock in scene.realmodel.rocks:
        for layer, begin, end in parts_of(scene, rock):
            yield material_of(layer or 0), begin, end


def parts_of(scene, rock, hole=None):
    """(property, begin, end) of the parts of a hole of a rock mass that something is known of; None: of all
    holes."""
    logs, _ = observed_blocks.shown(rock)
    chosen = logs.values() if hole is None else [logs[hole]] if hole in logs else []
    yield from _of_logs(scene, rock, chosen)
    yield from _of_picks(rock, logs, hole)


def _colored(scene):
    for values, materials in by_column(scene):
        yield from zip(materials, values.begins.tolist(), values.ends.tolist(), strict=True)


def by_column(scene):
    """For each rock mass the IntervalValues of the column that the tubes show, as far as they can be seen,
    and their materials."""
    name = column(scene)
    between, words = _scale(scene, name)
    for rock in scene.realmodel.rocks:
        values = interval_values.of_rock(rock)
        if values is None or name not in values.columns:
            continue
        values = values.some(values.has(name)) if between is None else seen_values(values, name)
        column_values = values.columns[name]
        codes = _hues(column_values, words) if between is None else _shades(column_values, between)
        materials = {code: colors.plain_material(f"{name} {code}", code) for code in sorted(set(codes))}
        yield values, [materials[code] for code in codes]


def _scale(scene, name):
    """The range (low, high) of a column of numbers and no words; or None, and the words of another, the most
    frequent first."""
    scale_key = name, *(rock.interval_values.digest for rock in scene.realmodel.rocks)
    if scale_key not in _scales:
        _scales[scale_key] = _scale_of(scene, name)
    return _scales[scale_key]


def _scale_of(scene, name):
    parts = []
    for rock in scene.realmodel.rocks:
        values = interval_values.of_rock(rock)
        if values is not None and name in values.columns:
            parts.append(values.columns[name])
    if all(part.dtype.kind == "f" for part in parts):
        return limits_of(np.concatenate(parts)), []
    words, counts = np.unique(np.concatenate([part.astype(str) for part in parts]), return_counts=True)
    order = np.argsort(-counts, kind="stable")
    return None, [word for word in words[order].tolist() if word][:_MOST_WORDS]


def _shades(values, between):
    steps = np.rint(shares_of(values, between) * (_STEPS - 1))
    shades = color_scale.colors(np.linspace(0.0, 1.0, _STEPS), (0.0, 1.0))[:, :3].tolist()
    codes = [hex_color(shade) for shade in shades]
    return [codes[int(step)] for step in steps.tolist()]


def _hues(values, words):
    numbers = {word: number for number, word in enumerate(words)}
    return [colors.hue(numbers[word]) if word in numbers else _OTHERS for word in values.astype(str).tolist()]


def _of_picks(rock, logs, only):
    """(property, begin, end) of the tubes of holes that have no intervals. only: the hole that is meant."""
    ids = [surface.property_id for surface in rock.surfaces]
    below = {surface.name: number for surface, number in zip(rock.surfaces, ids, strict=True)}
    above = {surface.name: number for surface, number in zip(rock.surfaces, ids[1:], strict=False)}
    ends = borehole_picks.ends_of(rock)
    for hole, (collar, picks) in borehole_picks.of_rock(rock).items():
        if hole in logs or not picks or only not in (None, hole):
            continue
        stops = [] if collar is None else [(above.get(picks[0][0]), collar)]
        stops += [(below.get(name), place) for name, place in picks]
        stops += [(None, ends[hole])] if hole in ends else []
        for (layer, begin), (_, end) in pairwise(stops):
            yield layer, begin, end


def _of_logs(scene, rock, logs):
    """(property, begin, end) of the tubes of intervals; between two of them there are none."""
    rows = {row.name: row.property_id for row in (*rock.surfaces, *scene.realmodel.bodies)}
    units = observed_blocks.units_of(scene, rock)
    for log in logs:
        blocks, places = log.blocks.tolist(), log.places.tolist()
        for row in np.flatnonzero(log.goes_on).tolist():
            yield rows.get(units.block(blocks[row])), places[row - 1], places[row]
