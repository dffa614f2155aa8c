# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the compiled part is there, asked once."""

from functools import lru_cache

from ...core import BuildFailed
from ...core.base.work import native_module


@lru_cache(maxsize=1)
def missing():
    """The message about a missing native module, with advice, or None."""
    try:
        native_module()
    except BuildFailed as error:
        return str(error)
    return None
