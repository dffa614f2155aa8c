# SPDX-License-Identifier: GPL-3.0-or-later
"""The library omf, which reads and writes OMF 1."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from .packages import extra


def omf_library(purpose: str) -> Any:
    """The library. Raises UsageError where it is missing."""
    with quiet():
        return extra("omf", purpose, "omf")


@contextmanager
def quiet() -> Iterator[None]:
    """Within it Python says nothing of what it will no longer have, which the library, of 2019, uses."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
