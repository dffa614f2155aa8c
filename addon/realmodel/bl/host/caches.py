# SPDX-License-Identifier: GPL-3.0-or-later
"""Caches in memory beside the scenes. Each module has its own; all are cleared here when another file is
opened or the add-on is disabled."""

import functools
import weakref

_MOST_ANSWERS = 32  # about one model, of one function
_caches = []


class _Bounded(dict):
    """Drops the oldest entries where there would be more than `most`; the newest stays, however large."""

    def __init__(self, most, size_of):
        super().__init__()
        self._most, self._size_of = most, size_of

    def __setitem__(self, key, value):
        self.pop(key, None)
        super().__setitem__(key, value)
        total = sum(map(self._size_of, self.values()))
        while total > self._most and len(self) > 1:
            total -= self._size_of(self.pop(next(iter(self))))


def new(kind=dict, most=None, size_of=lambda _: 1):
    """An empty cache, such as a dict or a list. most: entries that a dict holds, or their sizes together;
    None: any number."""
    cache = kind() if most is None else _Bounded(most, size_of)
    _caches.append(cache)
    return cache


def of_model(function):
    """A function of a model, and of what else it takes, whose results stay as long as the model does: the
    thread of a build may call it first."""
    model_answers = new(weakref.WeakKeyDictionary)

    @functools.wraps(function)
    def asked(model, *others):
        results = model_answers.setdefault(model, _Bounded(_MOST_ANSWERS, lambda _: 1))
        if others not in results:
            results[others] = function(model, *others)
        return results[others]

    return asked


def clear():
    """Clears all caches."""
    for cache in _caches:
        cache.clear()
