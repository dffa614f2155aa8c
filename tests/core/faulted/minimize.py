# SPDX-License-Identifier: GPL-3.0-or-later
"""Greedy reduction of a failing case: fewer faults, bodies, rock masses, surfaces, triangles and points,
rounder numbers."""

import copy
import pickle

import numpy as np


def _subsets(count):
    """Row numbers with one chunk left out: halves first, then smaller chunks, then single rows."""
    chunk = count // 2
    while chunk >= 1:
        for start in range(0, count, chunk):
            yield [i for i in range(count) if not start <= i < start + chunk]
        chunk //= 2


def changed(case, change):
    other = copy.deepcopy(case)
    change(other)
    return other


def _set(of, **values):
    """A change of one entry: of(case) gives it."""

    def change(case):
        for key, value in values.items():
            setattr(of(case), key, value)

    return change


def _keep_rows(case, r, k, key, kept):
    """Leaves out points or triangles of a surface. Without some of the oldest and the youngest the rock need
    not be full."""
    surfaces = case.rocks[r].surfaces
    setattr(surfaces[k], key, getattr(surfaces[k], key)[kept])
    case.is_full = case.is_full and 0 < k < len(surfaces) - 1


def _pop_surface(case, r, k):
    """Leaves out a surface; what names it names the one before or after."""
    surfaces = case.rocks[r].surfaces
    case.is_full = case.is_full and 0 < k < len(surfaces) - 1
    gone = surfaces.pop(k).name
    for entry in (*case.faults, *case.bodies):
        key = "youngest" if hasattr(entry, "youngest") else "after"
        if getattr(entry, key) == gone:
            setattr(entry, key, surfaces[max(0, k - 1)].name)


def _smaller(case):
    """Changes that make a case smaller, the boldest first."""
    for n, fault in enumerate(case.faults):
        if not any(fault.name in other.ends_at for other in case.faults):
            yield lambda c, n=n: c.faults.pop(n)
    for n in range(len(case.bodies)):
        yield lambda c, n=n: c.bodies.pop(n)
    for r, rock in enumerate(case.rocks):
        if len(case.rocks) > 1:
            yield lambda c, r=r: c.rocks.pop(r)
        for k in range(len(rock.surfaces)):
            if len(rock.surfaces) > 1:
                yield lambda c, r=r, k=k: _pop_surface(c, r, k)
    for n, fault in enumerate(case.faults):
        entry = lambda c, n=n: c.faults[n]  # noqa: E731
        for key, value in (("youngest", None), ("rocks", [])):
            if getattr(fault, key) != value:
                yield _set(entry, **{key: value})
    for n, body in enumerate(case.bodies):
        entry = lambda c, n=n: c.bodies[n]  # noqa: E731
        for key, value in (("after", None), ("rock", None), ("void", False)):
            if getattr(body, key) != value:
                yield _set(entry, **{key: value})
    for r, rock in enumerate(case.rocks):
        if len(rock.rings) > 1:
            yield _set(lambda c, r=r: c.rocks[r], rings=rock.rings[:1])
        if rock.edge_length is not None and rock.edge_length < 10:
            yield _set(lambda c, r=r: c.rocks[r], edge_length=2 * rock.edge_length)
        for k, surface in enumerate(rock.surfaces):
            entry = lambda c, r=r, k=k: c.rocks[r].surfaces[k]  # noqa: E731
            if surface.rule != "erosional":
                yield _set(entry, rule="erosional")
            if surface.method is not None:
                yield _set(entry, method=None)
            key = "triangles" if surface.points is None else "points"
            for kept in _subsets(len(getattr(surface, key))):
                if kept:
                    yield lambda c, r=r, k=k, key=key, kept=kept: _keep_rows(c, r, k, key, kept)


def _rounder(case):
    """Changes to rounder numbers."""
    # a fault that ends somewhere ends outside of the rock by its coordinates
    whole = [n for n, fault in enumerate(case.faults) if not len(fault.beyond)]
    meshes = [lambda c, n=n: c.faults[n] for n in whole]
    meshes += [lambda c, n=n: c.bodies[n] for n in range(len(case.bodies))]
    for r, rock in enumerate(case.rocks):
        meshes += [lambda c, r=r, k=k: c.rocks[r].surfaces[k] for k in range(len(rock.surfaces))]
    for digits in (0, 1, 3):
        for entry in meshes:
            own = entry(case)
            key = "points" if getattr(own, "points", None) is not None else "vertices"
            yield _set(entry, **{key: np.round(getattr(own, key), digits)})


def minimize(case, still_fails, steps=300, kinds=(_smaller, _rounder)):
    """The smallest case found by greedy steps for which still_fails(case) holds. kinds: functions that give
    the changes of a case to try."""
    progress = True
    while progress and steps > 0:
        progress = False
        for changes in kinds:
            again = True
            while again and steps > 0:
                again = False
                for change in changes(case):
                    candidate = changed(case, change)
                    if _is_same(case, candidate):
                        continue
                    steps -= 1
                    if still_fails(candidate):
                        case, progress, again = candidate, True, True
                        break
                    if steps <= 0:
                        break
    return case


def _is_same(one, other):
    return pickle.dumps(one) == pickle.dumps(other)
