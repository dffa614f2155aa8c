# SPDX-License-Identifier: GPL-3.0-or-later
"""Styles of layers in QML, the form of QGIS (qgis.dtd), as its table `layer_styles` of GeoPackages has
them."""

from __future__ import annotations

from collections.abc import Sequence
from xml.sax.saxutils import quoteattr

import numpy as np

from ..drawing.color_scale import RISING, colors

_HEAD = "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"
_AREA, _LINE = ("fill", "SimpleFill"), ("line", "SimpleLine")
_BORDER = "60,60,60,255"
_LABEL = (
    '<labeling type="simple"><settings calloutType="simple"><text-style fieldName={field} fontSize="7" '
    'textColor={color}/><placement placement="2" placementFlags="9"/></settings></labeling>'
)


def areas_style(attribute: str, values: Sequence[tuple[str, str]]) -> str:
    """Areas by a text. values: of it, with the color "#rrggbb" of each."""
    symbols = [
        _symbol(_AREA, n, color=rgb, outline_color=_BORDER, outline_width="0.2")
        for n, rgb in _numbered(values)
    ]
    return _categories(attribute, [value for value, _ in values], symbols)


def lines_style(
    attribute: str, values: Sequence[str], width: float, color: str, shown: int | None = None
) -> str:
    """Lines of one color with their attribute `elevation`, or the text itself, along them. values: of the
    text; shown: how many of these are switched on, None: all."""
    symbols = [_symbol(_LINE, n, line_color=color, line_width=f"{width:g}") for n in range(len(values))]
    label = "elevation" if attribute == "surface" else attribute
    return _categories(
        attribute, values, symbols, shown, _LABEL.format(field=quoteattr(label), color=quoteattr(color))
    )


def classes_style(classes: Sequence[tuple[float, float]]) -> str:
    """Areas by classes from `low` to `high`, from dark to bright."""
    limits = (0.0, float(max(len(classes) - 1, 1)))
    shades = np.rint(255 * colors(np.arange(len(classes)), limits, RISING)[:, :3]).astype(int).tolist()
    symbols = [
        _symbol(_AREA, n, color="{},{},{},255".format(*shade), outline_style="no")
        for n, shade in enumerate(shades)
    ]
    ranges = "".join(
        f'<range lower="{low!r}" upper="{high!r}" symbol="{n}" label="{low:g} - {high:g}" render="true"/>'
        for n, (low, high) in enumerate(classes)
    )
    return _style(
        '<renderer-v2 type="graduatedSymbol" attr="(low + high) / 2" graduatedMethod="GraduatedColor" '
        f'symbollevels="0"><ranges>{ranges}</ranges><symbols>{"".join(symbols)}</symbols></renderer-v2>'
    )


def _numbered(values: Sequence[tuple[str, str]]) -> list[tuple[int, str]]:
    return [
        (n, ",".join(str(int(color[k : k + 2], 16)) for k in (1, 3, 5)) + ",255")
        for n, (_, color) in enumerate(values)
    ]


def _symbol(kind: tuple[str, str], number: int, **keys: str) -> str:
    """A symbol of one layer. keys: what is not as QGIS has it."""
    parts = "".join(f"<prop k={quoteattr(key)} v={quoteattr(value)}/>" for key, value in keys.items())
    return (
        f'<symbol type="{kind[0]}" name="{number}" alpha="1" clip_to_extent="1" force_rhr="0">'
        f'<layer class="{kind[1]}" enabled="1" locked="0" pass="0">{parts}</layer></symbol>'
    )


def _categories(
    attribute: str, values: Sequence[str], symbols: list[str], shown: int | None = None, labels: str = ""
) -> str:
    rows = "".join(
        f'<category value={quoteattr(value)} label={quoteattr(value)} symbol="{n}" '
        f'render="{"true" if shown is None or n < shown else "false"}"/>'
        for n, value in enumerate(values)
    )
    return _style(
        f'<renderer-v2 type="categorizedSymbol" attr={quoteattr(attribute)} symbollevels="0"><categories>'
        f"{rows}</categories><symbols>{''.join(symbols)}</symbols></renderer-v2>",
        labels,
    )


def _style(renderer: str, labels: str = "") -> str:
    return f'{_HEAD}<qgis version="3.22" labelsEnabled="{int(bool(labels))}">{renderer}{labels}</qgis>\n'
