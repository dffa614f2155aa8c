# SPDX-License-Identifier: GPL-3.0-or-later
"""Calls of the native module that make meshes from a model."""

from __future__ import annotations

from collections.abc import Callable

from ..base.errors import BuildFailed, InputRefused
from ..base.work import Arguments, Result, Work, native_module


def call_native(
    work: Work,
    function: Callable[Arguments, Result],
    *arguments: Arguments.args,
    **options: Arguments.kwargs,
) -> Result:
    """The result of a native function. Raises InputRefused, BuildFailed."""
    native = native_module()
    try:
        return work.native(function, *arguments, **options)
    except native.InputError as error:
        if error.kind == "nothing":
            raise InputRefused(str(error), advice="use a shorter edge length") from error
        if error.kind == "size":
            raise InputRefused(str(error)) from error
        place = tuple(error.place[:2]) if error.place is not None else None
        raise BuildFailed(f"the mesh cannot be made: {error}" + (f" at {place}" if place else "")) from error
