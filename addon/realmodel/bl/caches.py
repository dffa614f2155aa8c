# SPDX-License-Identifier: GPL-3.0-or-later
"""What is kept in memory beside the scenes: each module has caches of its own, and all are cleared here when
another file is opened or the add-on is disabled."""

_caches = []


def new(kind=dict):
    """An empty cache, a dict or a list."""
    cache = kind()
    _caches.append(cache)
    return cache


def clear():
    """Clears all caches."""
    for cache in _caches:
        cache.clear()
