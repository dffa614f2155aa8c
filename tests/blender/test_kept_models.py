# SPDX-License-Identifier: GPL-3.0-or-later
"""What is kept in memory is bounded by its size."""

import unittest
from types import SimpleNamespace
from unittest import mock

import numpy as np
from realmodel.bl.host import caches
from realmodel.bl.objects import built_models
from realmodel.core import Project, Rock, Surface, build


class _Model:
    cell_kind = "columns"

    def __init__(self, size):
        self.complex = SimpleNamespace(vertices=np.zeros(size, np.uint8))
        self.surface_arrays = SimpleNamespace()


class KeptModels(unittest.TestCase):
    def setUp(self):
        caches.clear()
        self.addCleanup(caches.clear)

    def kept(self):
        return [model.complex.vertices.nbytes for model in built_models._models.values()]

    def test_the_oldest_go_where_all_are_too_large(self):
        with mock.patch.object(built_models._models, "_most", 100):
            for size in (40, 50, 30):
                built_models.remember(_Model(size))
            self.assertEqual(self.kept(), [50, 30])
            built_models.remember(_Model(1000))  # the newest stays, however large
            self.assertEqual(self.kept(), [1000])

    def test_the_cells_and_surfaces_of_a_model_count(self):
        square = np.array([(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)
        surface = Surface("top", square, np.array([(0, 1, 2), (0, 2, 3)]))
        model = build(Project("one", [Rock("rock", [surface], base_elevation=0.0)]))
        arrays = (model.vertices, model.face_vertices, model.face_cells, model.surface_vertices)
        self.assertGreater(built_models._bytes_of(model), sum(array.nbytes for array in arrays))

    def test_many_small_ones_stay(self):
        for _ in range(20):
            built_models.remember(_Model(1))
        self.assertEqual(len(self.kept()), 20)
