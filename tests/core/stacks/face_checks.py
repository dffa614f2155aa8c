# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls and faces on surfaces, for stacks with features far smaller than those the outside check expects.

check_model.py steps 1e-4 of a wall's size to either side, and asks for the surface's height at the
middle of a face. Where slivers of 1e-9, steep needles or walls of 1e6 beside plans of 1 are part of
the input, that lands on a neighbour. These tests ask the same, at several distances and with the
slope in mind; they need NumPy and the outside check's closed form.
"""

import numpy as np

from . import places

STEPS = (1e-2, 1e-4, 1e-6, 1e-8)  # of a wall's length in plan


def wall_failures(m, rocks):
    """Sides of walls at which the closed form names another block, whatever the distance."""
    form = places.closed_form()
    surfaces = m.surfaces()
    walls = np.flatnonzero(m.face_surface == -1)
    if not len(walls):
        return
    rows = [_wall_frame(m, w) for w in walls]
    step = np.spacing(np.abs(m.vertices[:, :2]).max(initial=1.0))
    extent = np.ptp(m.vertices, axis=0)
    shortest, lowest = max(1e6 * step, 1e-6 * extent[:2].max()), 1e-7 * extent[2]
    known = [
        (w, row)
        for w, row in zip(walls, rows, strict=True)
        if row is not None and row[2] > shortest and row[3] > lowest
    ]
    if not known:
        return
    walls = np.array([w for w, _ in known])
    middle, plan, length, height = (np.array([row[i] for _, row in known]) for i in range(4))
    margin = 0.02 * height + 64 * np.spacing(np.abs(middle[:, 2])) + 1e-9 * extent[2]
    for side, sign in ((0, -1.0), (1, 1.0)):
        named = m.face_cells[walls, side]
        named = np.where(named >= 0, m.cell_block[np.maximum(named, 0)], -1)
        wrong = np.ones(len(walls), bool)
        for share in STEPS:
            points = middle[:, :2] + sign * np.maximum(share * length, 256 * step)[:, None] * plan
            wrong &= ~_agrees(form, surfaces, rocks, points, middle[:, 2], named, margin)
        for i in np.flatnonzero(wrong):
            hair = 1e-7 * length[i] + 16384 * step
            wrong[i] = not (
                _is_sliver(m, m.face_cells[walls[i], side], known[i][1], hair)
                or _has_a_wall_beside(m, walls[i], middle[i], hair)
            )
        if wrong.sum() > max(2, len(walls) // 50):
            i = np.flatnonzero(wrong)[0]
            yield (
                f"{wrong.sum()} of {len(walls)} wall sides differ at every distance; first face {walls[i]} "
                f"at {middle[i].tolist()}, side {side}, block {named[i]}"
            )


def _agrees(form, surfaces, rocks, points, z, named, margin):
    """Whether the closed form has the block named at plan points and heights z, or a boundary that near."""
    found = np.full(len(z), -1)
    near = np.zeros(len(z), bool)
    for members, rules, base, blocks, rings in rocks:
        lower, upper = form.columns(form.heights_of(surfaces, members, rings, points), rules, base)
        with np.errstate(invalid="ignore"):
            for k, block in enumerate(blocks):
                found = np.where((lower[k] < z) & (z < upper[k]), block, found)
                near |= (np.abs(z - lower[k]) < margin) | (np.abs(z - upper[k]) < margin)
    return near | (found == named)


def _wall_frame(m, face):
    """(a point inside, outward plan normal, plan length, height) of a wall; None where it has no area."""
    corners = m.vertices[m.face_vertices[m.face_offsets[face] : m.face_offsets[face + 1]]]
    inside = places.checker().wall_interior(corners)
    if inside is None:
        return None
    following = np.roll(corners, -1, axis=0)
    normal = np.cross(corners - corners[0], following - corners[0]).sum(axis=0)[:2]
    size = np.hypot(*normal)
    spread = corners[:, :2] - corners[0, :2]
    if size == 0:
        return None
    return inside, normal / size, np.hypot(*spread.T).max(), np.ptp(corners[:, 2])


def _has_a_wall_beside(m, face, middle, hair):
    """Whether another wall passes within a hair: the gap or sliver between them cannot be asked."""
    for other in np.flatnonzero(m.face_surface == -1):
        corners = m.vertices[m.face_vertices[m.face_offsets[other] : m.face_offsets[other + 1]]]
        if other == face or not corners[:, 2].min() <= middle[2] <= corners[:, 2].max():
            continue
        reach = np.hypot(*(corners[:, :2] - corners[0, :2]).T)
        start, along = corners[0, :2], corners[reach.argmax(), :2] - corners[0, :2]
        share = np.clip((middle[:2] - start) @ along / max(along @ along, 1e-300), 0, 1)
        if np.hypot(*(start + share * along - middle[:2])) < hair:
            return True
    return False


def _is_sliver(m, cell, frame, hair):
    """Whether a cell stays within a hair of the wall's own plane: nothing can be asked beyond it."""
    if cell < 0:
        return False
    faces = np.flatnonzero((m.face_cells == cell).any(axis=1))
    corners = np.concatenate(
        [m.vertices[m.face_vertices[m.face_offsets[f] : m.face_offsets[f + 1]]] for f in faces]
    )
    away = np.abs((corners[:, :2] - frame[0][:2]) @ frame[1])
    return away.max() < hair


def surface_failures(m):
    """Faces whose middle lies on no plane of a triangle, nearby in plan, of the surface that they name."""
    total = np.add.reduceat(m.vertices[m.face_vertices], m.face_offsets[:-1], axis=0)
    center = total / m.face_size[:, None]
    for s, surface in enumerate(m.surfaces()):
        faces = np.flatnonzero(m.face_surface == s)
        if not len(faces):
            continue
        corners = surface.vertices[surface.triangles]
        off = [f for f in faces if not _on_some_plane(corners, center[f])]
        if off:
            f = off[0]
            yield f"{len(off)} of {len(faces)} faces lie off surface {s}; first {f} at {center[f].tolist()}"


def _on_some_plane(corners, point):
    step = np.spacing(max(np.abs(corners[:, :, :2]).max(), np.abs(point[:2]).max()))
    reach = 64 * step
    low, high = corners[:, :, :2].min(axis=1) - reach, corners[:, :, :2].max(axis=1) + reach
    near = corners[((low <= point[:2]) & (point[:2] <= high)).all(axis=1)]
    for a, b, c in near:
        u, v, w = b - a, c - a, point - a
        area = u[0] * v[1] - u[1] * v[0]
        longest = max(np.abs(u[:2]).max(), np.abs(v[:2]).max())
        if abs(area) <= 64 * step * longest:
            return True  # thinner than rounding: any height between its corners may result
        normal = np.cross(u, v)
        slope = np.hypot(normal[0], normal[1]) / abs(area)
        z = a[2] - (normal[0] * w[0] + normal[1] * w[1]) / area
        height = np.ptp((a[2], b[2], c[2])), np.abs((a[2], b[2], c[2])).max()
        if abs(z - point[2]) <= 1e-6 * height[0] + 64 * np.spacing(height[1]) + slope * reach:
            return True
    return False
