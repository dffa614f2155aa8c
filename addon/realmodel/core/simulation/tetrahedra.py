# SPDX-License-Identifier: GPL-3.0-or-later
"""Prisms and pyramids divided into tetrahedra, so that neighbors divide their common faces alike.

Every quadrilateral is divided by the diagonal at its vertex of the least number (J. Dompierre et al., How to
subdivide pyramids, prisms and hexahedra into tetrahedra, 1999).
"""

from __future__ import annotations

import numpy as np

# a prism turned so that its least vertex comes first
_TURNED_PRISM = np.array(
    [
        [0, 1, 2, 3, 4, 5],
        [1, 2, 0, 4, 5, 3],
        [2, 0, 1, 5, 3, 4],
        [3, 5, 4, 0, 2, 1],
        [4, 3, 5, 1, 0, 2],
        [5, 4, 3, 2, 1, 0],
    ]
)
# by the diagonal of the quadrilateral across from the first vertex: 1 - 5, or 2 - 4
_TETRAHEDRA_OF_PRISM = np.array(
    [[[0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3]], [[0, 1, 2, 4], [0, 4, 2, 5], [0, 4, 5, 3]]]
)


def divided_prisms(corners: np.ndarray) -> np.ndarray:
    """(3 E, 4) tetrahedra of prisms (E, 6), those of one prism together."""
    turned = np.take_along_axis(corners, _TURNED_PRISM[corners.argmin(axis=1)], axis=1)
    other = turned[:, [1, 5]].min(axis=1) > turned[:, [2, 4]].min(axis=1)
    rows = _TETRAHEDRA_OF_PRISM[other.astype(np.intp)].reshape(len(corners), 12)
    return np.take_along_axis(turned, rows, axis=1).reshape(-1, 4)


def divided_pyramids(corners: np.ndarray) -> np.ndarray:
    """(2 E, 4) tetrahedra of pyramids (E, 5), those of one pyramid together."""
    sides = divided_quadrilaterals(corners[:, :4])
    return np.column_stack([sides, np.repeat(corners[:, 4], 2)])


def divided_quadrilaterals(corners: np.ndarray) -> np.ndarray:
    """(2 F, 3) triangles of quadrilaterals (F, 4), the two of one together, in its direction."""
    least = corners.argmin(axis=1)
    turned = np.take_along_axis(corners, (least[:, None] + np.arange(4)) % 4, axis=1)
    return turned[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


_DIVIDED = {
    "tetrahedron": (1, lambda corners: corners),
    "pyramid": (2, divided_pyramids),
    "prism": (3, divided_prisms),
}


def divided(of_kind: dict[str, dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """Elements by kind (one at least), each a dict of `corners` and of rows with a number for each, as
    tetrahedra alone: a dict with the same rows."""
    parts = []
    for kind, rows in of_kind.items():
        count, division = _DIVIDED[kind]
        parts.append(
            {
                name: division(values) if name == "corners" else np.repeat(values, count)
                for name, values in rows.items()
            }
        )
    return {name: np.concatenate([part[name] for part in parts]).astype(np.int32) for name in parts[0]}
