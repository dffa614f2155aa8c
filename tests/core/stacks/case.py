# SPDX-License-Identifier: GPL-3.0-or-later
"""A stack of surfaces as one test case, and the small files the corpus is made of."""

import json
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


@dataclass
class Stack:
    """Surfaces oldest first, each (vertices (V, 3) float64, triangles (T, 3) int32).

    region: None or (vertices (R, 2) float64, triangles (Q, 3) int32). rules: one for each surface,
    empty for "all erosional". label: how it was made.
    """

    surfaces: list
    region: tuple | None = None
    base_elevation: float | None = None
    rules: list = field(default_factory=list)
    label: str = ""

    def all_rules(self):
        return list(self.rules) or ["erosional"] * len(self.surfaces)

    def triangle_count(self):
        return sum(len(triangles) for _, triangles in self.surfaces)

    def region_rings(self):
        """Rings whose even-odd inside is the region: its triangles, one by one. [] without a region."""
        if self.region is None:
            return []
        vertices, triangles = self.region
        return list(np.asarray(vertices)[np.asarray(triangles)])

    def copy(self):
        region = None if self.region is None else tuple(np.array(a) for a in self.region)
        surfaces = [(np.array(v), np.array(t)) for v, t in self.surfaces]
        return Stack(surfaces, region, self.base_elevation, list(self.rules), self.label)


def as_surface(vertices, triangles):
    """The dtypes and memory order that build_stack takes."""
    vertices = np.ascontiguousarray(vertices, np.float64).reshape(-1, 3)
    return vertices, np.ascontiguousarray(triangles, np.int32).reshape(-1, 3)


def as_region(vertices, triangles):
    """The same for a region's plan triangulation."""
    vertices = np.ascontiguousarray(vertices, np.float64).reshape(-1, 2)
    return vertices, np.ascontiguousarray(triangles, np.int32).reshape(-1, 3)


def _number(value):
    """An integer where the double is a small one, else its exact hexadecimal form."""
    value = float(value)
    if value.is_integer() and abs(value) < 2**53 and not (value == 0 and np.signbit(value)):
        return int(value)
    return value.hex()


def _double(text):
    return float.fromhex(text) if isinstance(text, str) else float(text)


def _mesh_rows(mesh):
    vertices, triangles = mesh
    return {
        "vertices": [[_number(x) for x in row] for row in vertices],
        "triangles": [[int(i) for i in row] for row in triangles],
    }


def _rock_rows(stack):
    data = {}
    if stack.rules:
        data["rules"] = list(stack.rules)
    if stack.base_elevation is not None:
        data["base_elevation"] = _number(stack.base_elevation)
    if stack.region is not None:
        data["region"] = _mesh_rows(stack.region)
    data["surfaces"] = [_mesh_rows(surface) for surface in stack.surfaces]
    return data


def save_stack(case, path, why=""):
    """Writes a case, one Stack or a list of them, as JSON; doubles that are no integers as exact hexadecimal
    strings. native/fuzz reads and writes the same files."""
    if isinstance(case, Stack):
        data = {"why": why, "label": case.label, **_rock_rows(case)}
    else:
        data = {"why": why, "label": case[0].label, "rocks": [_rock_rows(stack) for stack in case]}
    text = json.dumps(data, indent=1)
    # one row of numbers a line reads better than one number a line
    text = re.sub(r"\[\s*([^\[\]{}]*?)\s*\]", lambda row: "[" + " ".join(row.group(1).split()) + "]", text)
    Path(path).write_text(text + "\n", encoding="utf-8")


def load_stack(path):
    """Reads what save_stack wrote: a Stack, or a list of them where there are several rock masses."""
    data = json.loads(Path(path).read_text(encoding="utf-8"))
    label = data.get("label", "")
    if "rocks" in data:
        return [_rock(rows, label) for rows in data["rocks"]]
    return _rock(data, label)


def _rock(data, label):
    surfaces = [
        as_surface([[_double(x) for x in row] for row in s["vertices"]], s["triangles"])
        for s in data["surfaces"]
    ]
    region = None
    if "region" in data:
        rows = data["region"]["vertices"]
        region = as_region([[_double(x) for x in row] for row in rows], data["region"]["triangles"])
    base = data.get("base_elevation")
    return Stack(surfaces, region, None if base is None else _double(base), data.get("rules", []), label)
