# SPDX-License-Identifier: GPL-3.0-or-later
"""Caches in memory beside the scenes. Each module has its own; all are cleared here when another file is
opened or the add-on is disabled."""

_caches = []


class _Bounded(dict):
    """Drops the oldest entry where there would be more than `most`."""

    def __init__(self, most):
        super().__init__()
        self._most = most

    def __setitem__(self, key, value):
        self.pop(key, None)
        super().__setitem__(key, value)
        if len(self) > self._most:
            del self[next(iter(self))]


def new(kind=dict, most=None):
    """An empty cache, a dict or a list. most: entries that a dict holds; None: any number."""
    cache = kind() if most is None else _Bounded(most)
    _caches.append(cache)
    return cache


def clear():
    """Clears all caches."""
    for cache in _caches:
        cache.clear()
