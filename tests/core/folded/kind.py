# SPDX-License-Identifier: GPL-3.0-or-later
"""Models with folds, as a hunt takes them."""

from functools import partial

from faulted.hunted import Hunted
from faulted.minimize import minimize

from .case import CORPUS, SheetCase, load_case, save_case
from .generate import random_case
from .judge import failures_of

_PLAIN = {"places": 0, "holes": 0, "noise": 0.0, "rounded": False, "cells": "columns", "scale": 1.0}


def _pop_event(case, n):
    """Leaves out a sheet or a series; what names a surface of it names the ground."""
    case.events.pop(n)
    for entry, key in [(each, "youngest") for each in case.faults] + [
        (each, "after") for each in case.bodies
    ]:
        if getattr(entry, key) not in case.names():
            setattr(entry, key, case.names()[-1])


def _pop_level(case, n, k):
    series = case.events[n]
    gone = series.surfaces()[-1]
    series.levels.pop(k)
    series.rules.pop(k)
    for fault in case.faults:
        if fault.youngest == gone:
            fault.youngest = series.surfaces()[-1]
    for body in case.bodies:
        if body.after == gone:
            body.after = series.surfaces()[-1]


def smaller(case):
    """Changes that make a case smaller, the boldest first."""
    for key in ("faults", "bodies"):
        for n in range(len(getattr(case, key))):
            yield lambda c, key=key, n=n: getattr(c, key).pop(n)
    for n, event in enumerate(case.events[:-1]):
        if isinstance(event, SheetCase) or len(case.series()) > 1:
            yield lambda c, n=n: _pop_event(c, n)
    for n, event in enumerate(case.events):
        if not isinstance(event, SheetCase):
            for k in range(len(event.levels) if len(event.levels) > 1 else 0):
                yield lambda c, n=n, k=k: _pop_level(c, n, k)
            if event.fold.again:
                yield lambda c, n=n: setattr(c.events[n].fold, "again", 0.0)
            if set(event.rules) != {"erosional"}:
                yield lambda c, n=n: setattr(c.events[n], "rules", ["erosional"] * len(c.events[n].levels))
        elif event.bend or any(event.slope):
            yield lambda c, n=n: vars(c.events[n]).update(bend=0.0, slope=[0.0, 0.0])
    for key, value in _PLAIN.items():
        if getattr(case, key) != value:
            yield lambda c, key=key, value=value: setattr(c, key, value)
    if any(case.shift):
        yield lambda c: setattr(c, "shift", [0.0, 0.0, 0.0])
    for key in ("contacts", "dips", "places", "holes"):
        for share in (2, 1.3):
            less = int(getattr(case, key) / share)
            if less < getattr(case, key):
                yield lambda c, key=key, less=less: setattr(c, key, less)
    if case.resolution < 2:
        yield lambda c: setattr(c, "resolution", 1.5 * c.resolution)


HUNTED = Hunted(random_case, failures_of, partial(minimize, kinds=(smaller,)), load_case, save_case, CORPUS)
