# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of the compartments and the faults of a model, stored with the scene as text."""

import functools
import json

import numpy as np

from ...core.results.displacements import displacements


def of_model(model):
    """The JSON text that `scene.realmodel.view.compartments` keeps of a model; "" for one without structures.

    names: of the compartments. volumes: {block: [its volume in each compartment]}. centers: (x, y, z) of each
    in model coordinates. faults: [[fault, surface, mean throw, None where none is found, mean heave]].
    """
    if not model.structures.is_divided:
        return ""
    count = len(model.compartment_names)
    table = {
        "names": model.compartment_names,
        "volumes": {
            block.name: np.bincount(model.cell_compartment[rows], model.cell_volumes[rows], count).tolist()
            for number, block in enumerate(model.blocks)
            if (rows := np.flatnonzero(model.cell_block == number)).size
        },
        "centers": [_center(model, number) for number in range(count)],
        "faults": [
            [
                displacement.fault,
                displacement.surface,
                displacement.mean_throw if displacement.is_found else None,
                displacement.mean_heave,
            ]
            for displacement in displacements(model)
        ],
    }
    return json.dumps(table)


def _center(model, compartment):
    """The middle of the box around a compartment."""
    inside = np.append(model.cell_compartment == compartment, False)
    faces = np.flatnonzero(inside[model.face_cells].any(axis=1))
    _, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    places = model.vertices[corners]
    return ((places.min(axis=0) + places.max(axis=0)) / 2).tolist()


def read(scene):
    """The statistics of the last build, as of `of_model`, not to be changed; None for a model without
    structures."""
    text = scene.realmodel.view.compartments
    return _table(text) if text else None


@functools.lru_cache(maxsize=2)  # panels ask several times at each redraw
def _table(text):
    return json.loads(text)


def shifts(scene, amount):
    """(N, 3) float64: the displacement of each compartment in an exploded view. amount: 1 doubles the
    distance of each center from the center of the model."""
    centers = np.array(read(scene)["centers"], np.float64)
    return amount * (centers - (centers.min(axis=0) + centers.max(axis=0)) / 2)


def names(scene):
    """The names of the compartments of a scene's model, in the order of their numbers."""
    table = read(scene)
    return [] if table is None else table["names"]
