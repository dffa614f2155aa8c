# SPDX-License-Identifier: GPL-3.0-or-later
"""The outside of a mesh in named patches, as boundary conditions want it, and names that solvers take."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

TOP, BASE, SIDES, CUT = "top", "base", "sides", "cut"
_ROLES = (TOP, BASE, SIDES, CUT)
_OF_NO_SURFACE = {-1: SIDES, -2: BASE, -3: CUT}


@dataclass(frozen=True)
class Patch:
    """Faces of the outside. name: no other patch has it. group: top, base, sides or cut, or the name of the
    fault or body that they lie on; several patches may have one. surface: as of face_surface."""

    name: str
    group: str
    surface: int


def boundary_patches(
    surface: np.ndarray, rise: np.ndarray, surface_names: list[str], surface_kind: np.ndarray
) -> tuple[list[Patch], np.ndarray]:
    """The patches of outside faces, and the patch of each face, (F,) int64.

    surface: (F,), what each face lies on (face_surface). rise: (F,), the upward part of its normal.
    The faces of a group on one surface are a patch with the name of the group; on several surfaces each of
    them has a patch GROUP_SURFACE (base_flat, where there is a flat base beside).
    """
    kinds = np.append(np.asarray(surface_kind, np.int64), 0)
    is_interface = (surface >= 0) & (kinds[np.maximum(surface, -1)] == 0)
    group = np.select(
        [surface == -1, surface == -2, surface == -3, is_interface & (rise > 0), is_interface & (rise < 0)],
        [2, 1, 3, 0, 1],
        default=2,
    )
    group = np.where((surface >= 0) & ~is_interface, len(_ROLES) + surface, group)
    lowest, wide = -3, len(surface_names) + 3
    key = group * wide + (surface - lowest)
    is_present = np.bincount(key) > 0
    number = (np.cumsum(is_present) - 1)[key]
    present, above_lowest = divmod(np.flatnonzero(is_present), wide)
    surfaces: list[int] = (above_lowest + lowest).tolist()
    groups = [_ROLES[g] if g < len(_ROLES) else surface_names[g - len(_ROLES)] for g in present]
    named = []
    for name, on in zip(groups, surfaces, strict=True):
        if groups.count(name) > 1:
            name = f"{name}_{surface_names[on]}" if on >= 0 else f"{name}_flat"
        named.append(name)
    names, plain = solver_names(named), dict(zip(groups, solver_names_of(groups), strict=True))
    patches = [Patch(name, plain[group], on) for name, group, on in zip(names, groups, surfaces, strict=True)]
    return patches, number


def solver_names_of(names: Iterable[str]) -> list[str]:
    """As solver_names, but equal names stay equal."""
    different = list(dict.fromkeys(names := list(names)))
    plain = dict(zip(different, solver_names(different), strict=True))
    return [plain[name] for name in names]


def solver_names(names: Iterable[str], longest: int = 64) -> list[str]:
    """Names of ASCII letters, digits and _ that begin with a letter, all different regardless of case."""
    identifiers: list[str] = []
    taken: set[str] = set()
    for name in names:
        plain = unicodedata.normalize("NFKD", name).replace("ß", "ss")
        plain = "".join(letter for letter in plain if not unicodedata.combining(letter))
        word = re.sub(r"[^A-Za-z0-9]+", "_", plain).strip("_") or "unnamed"
        word = (word if word[0].isalpha() else f"n{word}")[:longest]
        free, number = word, 1
        while free.lower() in taken:
            number += 1
            free = f"{word[: longest - 1 - len(str(number))]}_{number}"
        taken.add(free.lower())
        identifiers.append(free)
    return identifiers
