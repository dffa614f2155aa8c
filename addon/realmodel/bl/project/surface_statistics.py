# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of each surface of a build: its points, its heights, the area that survives erosion."""

import json

import numpy as np

from ...core.results.volumes import plan_areas


def of_model(model):
    """For each surface of a model a JSON text: points, triangles, low, high, area (in plan, of what survives,
    model units squared), deviation (the largest standard deviation of its heights; null where it is not
    known), variogram (as a project file writes it, where one was fitted) and share (of the surface itself;
    null where the region cuts it off). Of faults and bodies, which follow, area and share are null."""
    areas = _surviving_areas(model)
    texts, number = [], 0
    for entry in model.rock_inputs:
        rock = entry.rock
        for surface, data in zip(rock.surfaces, entry.data, strict=True):
            vertices, triangles = model.surface(number)
            heights = vertices[:, 2][triangles] if len(triangles) else np.zeros(1)
            whole = 0.0
            if rock.is_interpolated(surface) or rock.region is None:  # each sheet goes on beyond its faults
                sheets = [triangles] if model.lacks_project else model.sheet_triangles(number)
                whole = max(plan_area(vertices, sheet) for sheet in sheets)
            figures = {
                "points": len(data.points) if surface.has_points else None,
                "triangles": len(triangles),
                "low": float(heights.min()),
                "high": float(heights.max()),
                "area": float(areas[number]),
                "deviation": _most_deviation(model.surface_attributes(number)["variance"]),
                "variogram": _fitted(model.interpolations[number]),
                "share": min(float(areas[number]) / whole, 1.0) if whole else None,
            }
            texts.append(json.dumps(figures))
            number += 1
    for fault_or_body in range(number, len(model.surface_names)):
        vertices, triangles = model.surface(fault_or_body)
        low, high = vertices[:, 2].min(), vertices[:, 2].max()
        figures = {"points": None, "triangles": len(triangles), "low": float(low), "high": float(high)}
        texts.append(json.dumps(figures | {"area": None, "share": None}))
    return texts


def _fitted(result):
    variogram = result.variogram if result is not None else None
    return variogram.settings() if variogram is not None and variogram.fitted else None


def _most_deviation(variance):
    """The largest standard deviation of heights; None where none is known."""
    finite = variance[np.isfinite(variance)]
    return float(np.sqrt(max(finite.max(), 0.0))) if len(finite) else None


def read(row):
    """The figures of a surface's row, or None before a build."""
    return json.loads(row.figures) if row.figures else None


def _surviving_areas(model):
    """(S,) float64: the area in plan of the faces that lie on each surface."""
    on = np.flatnonzero(model.face_surface >= 0)
    return np.bincount(model.face_surface[on], plan_areas(model, on), len(model.surface_names))


def plan_area(vertices, triangles):
    """The area of triangles, seen from above."""
    a, b, c = (vertices[triangles[:, k], :2] for k in range(3))
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    return float(np.abs(ux * vy - uy * vx).sum() / 2)
