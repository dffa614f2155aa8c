# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings as pixels, with antialiasing, and PNG files (Portable Network Graphics, ISO/IEC 15948)."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from typing import BinaryIO

import numpy as np

from ..base.algebra import ranks_in_runs
from ..base.text import Step, no_step
from .drawing import (
    ANCHORS,
    WHITE,
    Color,
    Dots,
    Drawing,
    DrawingItem,
    FilledRings,
    Line,
    Text,
    text_rings,
    text_width,
)

_SUBROWS = 5  # of a row of pixels, in which the covered part is exact
_CORNERS = 20  # of a dot
_SHARPEST = 0.3  # 1 + cosine of the turn beyond which a line's corner is cut off


def rasterize(drawing: Drawing, scale: float, background: Color | None = WHITE) -> np.ndarray:
    """(H, W, 4) float32 RGBA from 0 to 1, alpha not multiplied in, the top row first.

    scale: pixels for a point. background: a color, or None for a transparent one.
    """
    height, width = round(drawing.height * scale), round(drawing.width * scale)
    pixels = np.zeros((height, width, 4), np.float32)
    if background is not None:
        pixels[:] = _rgba(background)
        pixels[..., :3] *= pixels[..., 3:]
    for item in drawing.items:
        for rings, color in item_shapes(item):
            _fill(pixels, [(0.0, height) + ring * (scale, -scale) for ring in rings], _rgba(color))
    alpha = pixels[..., 3:]
    np.divide(pixels[..., :3], alpha, out=pixels[..., :3], where=alpha > 0)
    return pixels


def over(below: np.ndarray, above: np.ndarray, x: int, y: int) -> None:
    """Composites the pixels `above`, as of `rasterize`, over opaque ones `below`, their upper left corner at
    column x and row y."""
    part = below[y : y + above.shape[0], x : x + above.shape[1]]
    above = above[: part.shape[0], : part.shape[1]]
    part[..., :3] += above[..., 3:] * (above[..., :3] - part[..., :3])


def _rgba(color: Color) -> np.ndarray:
    return np.array([*color, 1.0][:4], np.float32)


def item_shapes(item: DrawingItem) -> Iterator[tuple[list[np.ndarray], Color]]:
    """The shapes of an item, as (rings, color): rings (N, 2) in points."""
    if isinstance(item, FilledRings):
        if item.fill is not None:
            yield item.rings, item.fill
        if item.stroke is not None:
            yield [side for ring in item.rings for side in _closed_stroke(ring, item.width)], item.stroke
    elif isinstance(item, Line):
        pieces = [item.points] if item.dash is None else _dashes(item.points, item.dash)
        yield [_stroke(piece, item.width) for piece in pieces if len(piece) > 1], item.color
    elif isinstance(item, Dots):
        angle = np.linspace(0, 2 * np.pi, _CORNERS, endpoint=False)
        circle = np.column_stack([np.cos(angle), np.sin(angle)])
        yield [place + r * circle for place, r in zip(item.points, item.radii, strict=True)], item.color
    elif isinstance(item, Text):
        begin = np.array([-ANCHORS[item.anchor] * text_width(item.text, item.size), 0.0])
        c, s = np.cos(np.radians(item.angle)), np.sin(np.radians(item.angle))
        turn = np.array([[c, s], [-s, c]])
        rings = text_rings(item.text, item.size)
        yield [(ring + begin) @ turn + (item.x, item.y) for ring in rings], item.color


def _normals(steps: np.ndarray) -> np.ndarray:
    lengths = np.hypot(*steps.T)[:, None]
    return np.column_stack([-steps[:, 1], steps[:, 0]]) / np.where(lengths > 0, lengths, 1.0)


def _miters(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Offsets from the corners of a line to its edge, for normals before and after them."""
    return (before + after) / np.maximum(1 + (before * after).sum(axis=1), _SHARPEST)[:, None]


def _stroke(points: np.ndarray, width: float) -> np.ndarray:
    """The outline of a line."""
    normals = _normals(np.diff(points, axis=0))
    away = np.concatenate([normals[:1], _miters(normals[:-1], normals[1:]), normals[-1:]]) * width / 2
    return np.concatenate([points + away, (points - away)[::-1]])


def _closed_stroke(ring: np.ndarray, width: float) -> list[np.ndarray]:
    normals = _normals(np.roll(ring, -1, axis=0) - ring)
    away = _miters(np.roll(normals, 1, axis=0), normals) * width / 2
    return [ring + away, (ring - away)[::-1]]


def _dashes(points: np.ndarray, length: float) -> list[np.ndarray]:
    steps = np.hypot(*np.diff(points, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    dashes = []
    for begin in np.arange(0.0, along[-1], 2 * length):
        end = min(begin + length, along[-1])
        inner = along[(along > begin) & (along < end)]
        at = np.concatenate([[begin], inner, [end]])
        dashes.append(np.column_stack([np.interp(at, along, points[:, axis]) for axis in range(2)]))
    return dashes


def _fill(pixels: np.ndarray, rings: list[np.ndarray], color: np.ndarray) -> None:
    """Blends a color in where the rings, in pixels from the upper left, wind around.

    Along each of a few lines in a row of pixels the rings are crossed at exact positions. A crossing adds its
    direction to all pixels to the right, and to its own the part to the right of it; a running sum then gives
    the share of each pixel inside.
    """
    if not rings:
        return
    begin = np.concatenate(rings)
    end = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    height, width = pixels.shape[:2]
    low = np.maximum(np.floor(begin.min(axis=0)).astype(np.int64), 0)
    high = np.minimum(np.ceil(begin.max(axis=0)).astype(np.int64) + 1, (width, height))
    if (high <= low).any():
        return
    columns, rows = (high - low).tolist()
    begin, end = ((at - low) * (1.0, _SUBROWS) for at in (begin, end))
    first = np.clip(np.ceil(np.minimum(begin[:, 1], end[:, 1]) - 0.5), 0, rows * _SUBROWS).astype(np.int64)
    last = np.clip(np.ceil(np.maximum(begin[:, 1], end[:, 1]) - 0.5), 0, rows * _SUBROWS).astype(np.int64)
    count = last - first
    edge = np.repeat(np.arange(len(count)), count)
    row = ranks_in_runs(count) + first[edge]
    step = end - begin
    share = (row + 0.5 - begin[edge, 1]) / step[edge, 1]
    x = np.clip(begin[edge, 0] + share * step[edge, 0], 0.0, columns)
    direction = np.sign(step[edge, 1])
    column = np.floor(x).astype(np.int64)
    covered = 1.0 - (x - column)
    at = row * (columns + 2) + column
    size = rows * _SUBROWS * (columns + 2)
    sums = np.bincount(at, direction * covered, size) + np.bincount(at + 1, direction * (1.0 - covered), size)
    lines = np.cumsum(sums.reshape(rows * _SUBROWS, columns + 2), axis=1)[:, :columns]
    inside = np.minimum(np.abs(lines), 1.0).reshape(rows, _SUBROWS, columns).mean(axis=1)
    amount = (inside * color[3]).astype(np.float32)[..., None]
    part = pixels[low[1] : high[1], low[0] : high[0]]
    part *= 1.0 - amount
    part += amount * [*color[:3], 1.0]


_DOTS_PER_INCH = 200


def write_png(drawing: Drawing, file: BinaryIO, _step: Step = no_step) -> None:
    write_pixels(rasterize(drawing, _DOTS_PER_INCH / 72), file, _DOTS_PER_INCH)


def write_pixels(pixels: np.ndarray, file: BinaryIO, dots_per_inch: float = 72.0) -> None:
    """pixels: (H, W, 4) from 0 to 1, as `rasterize` returns them. Opaque ones are written without alpha."""
    values = np.rint(np.clip(pixels, 0.0, 1.0) * 255).astype(np.uint8)
    if (values[..., 3] == 255).all():
        values = values[..., :3]
    height, width, channels = values.shape
    rows = np.zeros((height, 1 + width * channels), np.uint8)
    flat = values.reshape(height, -1)
    rows[:, 0] = 2  # of each row: it is stored as the difference from the one above
    rows[0, 1:] = flat[0]
    rows[1:, 1:] = flat[1:] - flat[:-1]
    meter = round(dots_per_inch / 0.0254)
    file.write(b"\x89PNG\r\n\x1a\n")
    _chunk(file, b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0))
    _chunk(file, b"pHYs", struct.pack(">IIB", meter, meter, 1))
    _chunk(file, b"IDAT", zlib.compress(rows.tobytes(), 6))
    _chunk(file, b"IEND", b"")


def _chunk(file: BinaryIO, kind: bytes, data: bytes) -> None:
    file.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))
