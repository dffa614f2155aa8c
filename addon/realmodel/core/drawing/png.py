# SPDX-License-Identifier: GPL-3.0-or-later
"""PNG files (Portable Network Graphics, ISO/IEC 15948)."""

from __future__ import annotations

import struct
import zlib
from typing import BinaryIO

import numpy as np

from ..base.text import Step, no_step
from .drawing import Drawing
from .raster import rasterize

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
