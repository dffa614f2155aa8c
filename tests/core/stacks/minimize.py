# SPDX-License-Identifier: GPL-3.0-or-later
"""Greedy reduction of a failing stack: fewer surfaces, fewer triangles, rounder numbers."""

import numpy as np

from .case import Stack, as_region, as_surface


def compacted(stack):
    """The same stack without vertices that nothing uses; None where a surface or the region is empty."""
    surfaces = []
    for vertices, triangles in stack.surfaces:
        if not len(triangles):
            return None
        used, inverse = np.unique(triangles, return_inverse=True)
        surfaces.append(as_surface(vertices[used], inverse.reshape(-1, 3)))
    region = stack.region
    if region is not None:
        if not len(region[1]):
            return None
        used, inverse = np.unique(region[1], return_inverse=True)
        region = as_region(region[0][used], inverse.reshape(-1, 3))
    return Stack(surfaces, region, stack.base_elevation, list(stack.rules), stack.label)


def _without_surface(stack, k):
    rules = [r for i, r in enumerate(stack.rules) if i != k]
    surfaces = [s for i, s in enumerate(stack.surfaces) if i != k]
    return Stack(surfaces, stack.region, stack.base_elevation, rules, stack.label)


def _with_surface(stack, k, surface):
    surfaces = list(stack.surfaces)
    surfaces[k] = surface
    return Stack(surfaces, stack.region, stack.base_elevation, list(stack.rules), stack.label)


def _with_region(stack, region):
    return Stack(list(stack.surfaces), region, stack.base_elevation, list(stack.rules), stack.label)


def _smaller(stack):
    """Stacks a step smaller, the boldest steps first."""
    if stack.region is not None:
        yield _with_region(stack, None)
    if stack.base_elevation is not None:
        yield Stack(list(stack.surfaces), stack.region, None, list(stack.rules), stack.label)
    for k in range(len(stack.surfaces)):
        if len(stack.surfaces) > 1:
            yield _without_surface(stack, k)
    for k, (vertices, triangles) in enumerate(stack.surfaces):
        for rows in _subsets(len(triangles)):
            yield _with_surface(stack, k, (vertices, triangles[rows]))
    if stack.region is not None:
        for rows in _subsets(len(stack.region[1])):
            yield _with_region(stack, (stack.region[0], stack.region[1][rows]))


def _subsets(count):
    """Row numbers with one chunk left out: halves first, then smaller chunks, then single rows."""
    chunk = count // 2
    while chunk >= 1:
        for start in range(0, count, chunk):
            rows = [i for i in range(count) if not start <= i < start + chunk]
            if rows:
                yield rows
        chunk //= 2


def _rounder(stack):
    """Stacks with rounder numbers: all coordinates moved near the origin, or single ones rounded."""
    corners = np.concatenate([v for v, _ in stack.surfaces])
    shift = np.floor(corners.min(axis=0))
    if np.abs(shift).max() > 0:
        yield _moved(stack, shift)
    for digits in (0, 1, 3):
        yield _rounded_all(stack, digits)
    for k, (vertices, triangles) in enumerate(stack.surfaces):
        for digits in (0, 1):
            for column in (2, 0, 1):
                rounded = vertices.copy()
                rounded[:, column] = np.round(rounded[:, column], digits)
                yield _with_surface(stack, k, (rounded, triangles))
        for digits in (0, 1, 2):
            for i, j in np.ndindex(vertices.shape):
                rounded = vertices.copy()
                rounded[i, j] = np.round(rounded[i, j], digits)
                if rounded[i, j] != vertices[i, j]:
                    yield _with_surface(stack, k, (rounded, triangles))


def _moved(stack, shift):
    region = None if stack.region is None else (stack.region[0] - shift[:2], stack.region[1])
    base = None if stack.base_elevation is None else stack.base_elevation - shift[2]
    return Stack([(v - shift, t) for v, t in stack.surfaces], region, base, list(stack.rules), stack.label)


def _rounded_all(stack, digits):
    region = None if stack.region is None else (np.round(stack.region[0], digits), stack.region[1])
    base = None if stack.base_elevation is None else float(np.floor(stack.base_elevation))
    surfaces = [(np.round(v, digits), t) for v, t in stack.surfaces]
    return Stack(surfaces, region, base, list(stack.rules), stack.label)


def _same(one, other):
    def parts(stack):
        arrays = [a for surface in stack.surfaces for a in surface] + list(stack.region or ())
        return [(a.shape, a.tobytes()) for a in arrays] + [stack.base_elevation]

    return parts(one) == parts(other)


def minimize(stack, still_fails, acceptable, steps=2000):
    """The smallest stack found by greedy steps for which still_fails(stack) holds.

    acceptable(stack): whether a stack is valid input at all (a step that makes it refused proves nothing).
    """
    best = compacted(stack) or stack
    if not still_fails(best):
        best = stack
    progress = True
    while progress and steps > 0:
        progress = False
        for candidates in (_smaller, _rounder):
            again = True
            while again and steps > 0:
                again = False
                for candidate in candidates(best):
                    candidate = compacted(candidate)
                    if candidate is None or _same(candidate, best) or not acceptable(candidate):
                        continue
                    steps -= 1
                    if still_fails(candidate):
                        best, progress, again = candidate, True, True
                        break
                    if steps <= 0:
                        break
    return best
