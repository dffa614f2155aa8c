# SPDX-License-Identifier: GPL-3.0-or-later
"""A model as one page of HTML, which opens in any browser without a network.

Input: `ModelData`, the objects of a model. Output: the text of the page.

three.js 0.111 draws it (MIT; license.txt); page.js is what the page does, page.css its looks. Each triangle
is stored once, with the block on each of its sides. Coordinates are relative to a place near the middle of
the model and have 32 bits, the arrays are compressed (deflate) and written as Base64.
"""

from __future__ import annotations

import base64
import json
import re
import zlib
from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ...base.units import number_text
from ...cells.model_data import ModelData
from ...results.automatic_library import model_with_library
from ...results.sections.section_data import rgb_bytes
from ...results.tables import block_entry
from ..objects.object_contents import Contents, Hole

_FOLDER = Path(__file__).parent
_SCRIPTS = ("three.min.js", "orbit_controls.js", "page.js")
_MOST_POINTS = 20_000


def write_page(model: ModelData, file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes a model."""
    file.write(page_of(model, step).encode())
    step(1.0)


def page_of(model: ModelData, step: Callable[[float], None] = lambda _share: None) -> str:
    """The text of the page of a model."""
    model.require_project("a page")
    model = model_with_library(model)
    arrays = _Arrays(model)
    contents = Contents.of(model)
    step(0.3)
    data = {
        "name": model.project.name,
        "units": model.project.units,
        "crs": model.project.crs,
        "origin": arrays.origin.tolist(),
        "volume": model.volume,
        "volume_text": number_text(model.volume),
        "blocks": _blocks(model, contents),
        "positions": arrays.floats(model.vertices),
        "corners": arrays.integers(contents.triangles.corners),
        "sides": arrays.integers(contents.triangles.blocks),
        "faults": [
            {
                "name": shape.part.name,
                "positions": arrays.floats(shape.part.vertices),
                "corners": arrays.integers(shape.part.triangles),
            }
            for shape in contents.surfaces
            if shape.group == "Faults"
        ],
        "holes": [_hole(hole, arrays) for hole in contents.holes],
        "points": arrays.floats(_points(model)),
    }
    step(0.8)
    texts = {name: (_FOLDER / name).read_text(encoding="utf-8") for name in (*_SCRIPTS, "page.css")}
    # "<" is written otherwise, so that no name ends the script
    record = json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
    parts = {
        "title": escape(model.project.name or "Model"),
        "style": texts["page.css"],
        "scripts": "\n".join(f"<script>{texts[name]}</script>" for name in _SCRIPTS),
        "data": record,
    }
    page = (_FOLDER / "page.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda place: parts[place[1]], page)


def _blocks(model: ModelData, contents: Contents) -> list[dict[str, Any]]:
    """The entry of each existing block in the page, as in the report."""
    total, colors = model.volume, rgb_bytes(model.block_colors).tolist()
    blocks = []
    for shell in contents.blocks:
        entry = block_entry(model, shell.number, total)
        blocks.append(
            {
                "number": shell.number,
                "name": entry["name"],
                "rock": entry["rock"],
                "material": entry["property_name"],
                "volume": entry["volume"],
                "volume_text": number_text(entry["volume"]),
                "share": entry["share"],
                "parts": entry["components"],
                "color": f"#{bytes(colors[shell.number]).hex()}",
            }
        )
    return blocks


def _hole(hole: Hole, arrays: _Arrays) -> dict[str, Any]:
    return {"name": hole.name, "places": arrays.floats(hole.places), "blocks": list(hole.blocks)}


def _points(model: ModelData) -> np.ndarray:
    """(N, 3): the points and contacts of all surfaces; of very many every second, or third, ..."""
    places = [np.empty((0, 3))]
    for entry in model.rock_inputs:
        for surface, data in zip(entry.rock.surfaces, entry.data, strict=True):
            places += [surface.points] if isinstance(surface.points, np.ndarray) else []
            places.append(np.asarray(data.contacts, np.float64).reshape(-1, 3))
    points = np.concatenate(places)
    return points[:: -(-len(points) // _MOST_POINTS) or 1]


class _Arrays:
    """Arrays as text. origin: the point to which coordinates are relative, in whole units."""

    def __init__(self, model: ModelData):
        has_vertices = len(model.vertices) > 0
        ends = (model.vertices.min(axis=0), model.vertices.max(axis=0)) if has_vertices else np.zeros((2, 3))
        self.origin = np.rint((ends[0] + ends[1]) / 2)

    def floats(self, places: np.ndarray) -> str:
        """Coordinates (N, 3), as numbers of 32 bits."""
        return _text((np.asarray(places, np.float64) - self.origin).astype("<f4"))

    def integers(self, numbers: np.ndarray) -> str:
        """Whole numbers, each less the one before it: neighbors are small numbers, which compress well."""
        flat = np.asarray(numbers, np.int32).ravel()
        return _text(np.diff(flat, prepend=np.int32(0)).astype("<i4"))


def _text(array: np.ndarray) -> str:
    """The array's first bytes, then its second ones, ..., compressed."""
    planes = np.ascontiguousarray(array).view(np.uint8).reshape(-1, 4).T
    return base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode()
