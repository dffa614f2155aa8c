# SPDX-License-Identifier: GPL-3.0-or-later
"""What Python shows of results that have large arrays."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

_LONG = 6  # elements


class ShortRepr:
    """Of dataclasses with repr=False: the fields, large arrays as their dtype and shape, long lists as their
    length."""

    def __repr__(self) -> str:
        shown = (field for field in fields(self) if field.repr)  # type: ignore[arg-type]
        parts = (f"{field.name}={_short(getattr(self, field.name))}" for field in shown)
        return f"{type(self).__name__}({', '.join(parts)})"


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray) and value.size > _LONG:
        return f"<{value.dtype} {value.shape}>"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key!r}: {_short(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list) and len(value) > _LONG:
        return f"<list of {len(value)}>"
    if isinstance(value, list):
        return f"[{', '.join(map(_short, value))}]"
    return " ".join(repr(value).split())
