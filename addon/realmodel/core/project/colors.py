# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors as they are written, "#rrggbb" in sRGB, and as numbers from 0 to 1."""

from __future__ import annotations

from collections.abc import Iterable

RGB = tuple[float, float, float]


def rgb(code: str) -> RGB:
    """Red, green, blue of "#rrggbb", sRGB encoded."""
    red, green, blue = (int(code[at : at + 2], 16) / 255.0 for at in (1, 3, 5))
    return red, green, blue


def hex_color(color: Iterable[float]) -> str:
    """The "#rrggbb" of three sRGB encoded numbers, which are clipped to 0 and 1."""
    return "#" + "".join(f"{round(255 * min(max(channel, 0.0), 1.0)):02x}" for channel in color)


def linear(channel: float) -> float:
    """The scene-linear value of an sRGB encoded one (IEC 61966-2-1)."""
    return channel / 12.92 if channel <= 0.04045 else ((channel + 0.055) / 1.055) ** 2.4


def encoded(channel: float) -> float:
    """The sRGB encoded value of a scene-linear one, which is clipped to 0 and 1."""
    channel = min(max(channel, 0.0), 1.0)
    return 12.92 * channel if channel <= 0.0031308 else 1.055 * channel ** (1 / 2.4) - 0.055
