# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists whose entries have names, and functions whose arguments have."""

from __future__ import annotations

import functools
import inspect
import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Generic, ParamSpec, TypeVar, overload

from .errors import UsageError

T = TypeVar("T")
P = ParamSpec("P")
R = TypeVar("R")


def number_of(key: int | str, names: Sequence[str], noun: str) -> int:
    """The number, from 0, of the entry with `key`, its name or number. noun: what the entries are.

    Raises UsageError for an unknown one, and for a name of several.
    """
    if isinstance(key, str):
        matches = [number for number, name in enumerate(names) if name == key]
    else:
        matches = [int(key)] if key in range(len(names)) and not isinstance(key, bool) else []
    if len(matches) == 1:
        return matches[0]
    if matches:
        raise UsageError(f"there are {len(matches)} {noun}s named '{key}': give its number")
    missing = f"no {noun} named '{key}'" if isinstance(key, str) else f"no {noun} {key!r}"
    names_text = f"{noun}s are {', '.join(names)}, numbered from 0" if names else f"there are no {noun}s"
    raise UsageError(f"there is {missing}; {names_text}")


class NamedList(list[T], Generic[T]):
    """A list whose entries are found by their names, too: `model.blocks["sand"]`.

    noun: what the entries are, for messages. A slice is a plain list.
    """

    def __init__(self, entries: Iterable[T], names: Iterable[str], noun: str):
        super().__init__(entries)
        self.names = list(names)
        self.noun = noun

    @overload  # type: ignore[override]  # names come beside what a list takes
    def __getitem__(self, key: int | str) -> T: ...
    @overload
    def __getitem__(self, key: slice) -> list[T]: ...
    def __getitem__(self, key: int | str | slice) -> T | list[T]:
        return super().__getitem__(number_of(key, self.names, self.noun) if isinstance(key, str) else key)


def keyword_only(function: Callable[P, R]) -> Callable[P, R]:
    """Takes arguments after the `*` of a function by position, too, as RealModel 0.1 did, with a warning."""
    parameters = inspect.signature(function).parameters.values()
    by_name = [entry.name for entry in parameters if entry.kind is entry.KEYWORD_ONLY]
    count = len(parameters) - len(by_name)

    @functools.wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        old = dict(zip(by_name, args[count:], strict=False))
        if count < len(args) <= count + len(by_name) and not old.keys() & kwargs.keys():
            text = f"{function.__name__}: pass {', '.join(old)} by name; the next release requires it"
            warnings.warn(text, DeprecationWarning, stacklevel=2)
            args, kwargs = args[:count], old | kwargs
        return function(*args, **kwargs)

    return call
