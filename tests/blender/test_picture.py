# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture: every block is seen in its colour, and the scene is left alone."""

import colorsys
import tempfile
from pathlib import Path

import numpy as np
from blender_state import empty_file, inventory, pixels
from made_projects import LIBRARY, other_rock, surface, two_rocks
from panel_case import PanelCase
from realmodel.bl import arrangement, batch, cutaway, picture
from realmodel.core import OutputFailed, Project, Rock, build


def share_of_hue(image, colour, tolerance=0.05):
    """Part of a picture's pixels that have the hue of "#rrggbb" and are not grey."""
    wanted = colorsys.rgb_to_hsv(*(int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)))[0]
    flat = image.reshape(-1, 3)
    hsv = np.array([colorsys.rgb_to_hsv(*(float(c) for c in pixel)) for pixel in flat])
    away = np.abs((hsv[:, 0] - wanted + 0.5) % 1.0 - 0.5)
    return float(np.mean((away < tolerance) & (hsv[:, 1] > 0.3)))


class Render(PanelCase):
    def render(self, model, size=(240, 150)):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "picture.png.part"
            batch.write_scene(model)
            before = inventory()
            result = batch.render(path, size, samples=8)
            self.assertEqual(inventory(), before, "rendering changed the file")
            self.assertEqual([p.name for p in Path(folder).iterdir()], ["picture.png.part"])
            self.assertEqual(path.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
            image = pixels(path)
        self.assertEqual(image.shape, (size[1], size[0], 3))
        return result, image

    def assert_all_seen(self, model, image):
        for number in {block.property for block in model.blocks if block.cells} - {0}:
            colour = LIBRARY.get(number).color
            self.assertGreater(share_of_hue(image, colour), 0.002, f"property {number}, {colour}")

    def test_every_block_is_seen_in_its_colour(self):
        empty_file()
        model = build(two_rocks())
        result, image = self.render(model)
        self.assertEqual(result.hidden_blocks, [])
        self.assertEqual(result.exaggeration, 1.0)
        self.assert_all_seen(model, image)

    def test_the_model_fills_the_frame(self):
        empty_file()
        _, image = self.render(build(two_rocks()))
        coloured = np.ptp(image, axis=2) > 0.15
        columns, rows = coloured.any(axis=0), coloured.any(axis=1)
        self.assertGreater(max(columns.mean(), rows.mean()), 0.7)
        for edge in (coloured[0], coloured[-1], coloured[:, 0], coloured[:, -1]):
            self.assertFalse(edge.any(), "the model is cut off by the frame")

    def test_a_lens_deep_inside_is_brought_to_light(self):
        empty_file()

        def lens(x, y):
            return 9.0 + 6.0 * max(0.0, 1.0 - ((x - 30.0) ** 2 + (y - 55.0) ** 2) / 150.0)

        rock = Rock(
            "r",
            [
                surface("S0", lambda x, y: 10.0, property=1),
                surface("S1", lens, property=3, grid={"columns": 40, "rows": 30}),
                surface("S2", lambda x, y: 20.0, property=2),
            ],
            base_elevation=0.0,
        )
        model = build(Project("Lens", [rock], LIBRARY))
        result, image = self.render(model)
        self.assertEqual(result.hidden_blocks, [])
        self.assert_all_seen(model, image)

    def test_a_flat_model_is_exaggerated(self):
        empty_file()
        flat = other_rock()
        for given in flat.surfaces:
            given.vertices[:, 2] *= 0.02
        result, _ = self.render(build(Project("Flat", [flat], LIBRARY)), (160, 100))
        self.assertEqual(result.exaggeration, 50.0)  # 0.3 high, 80 wide
        self.assertEqual(result.hidden_blocks, [])

    def test_an_empty_scene_is_refused(self):
        empty_file()
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(OutputFailed, "no block"):
                batch.render(Path(folder) / "p.png")
            self.assertEqual(list(Path(folder).iterdir()), [])

    def test_a_folder_that_is_not_there(self):
        batch.write_scene(build(two_rocks()))
        before = inventory()
        with self.assertRaises(OutputFailed):
            batch.render("/nowhere/p.png", (16, 10), samples=1)
        with self.assertRaises(OutputFailed):
            batch.save_blend("/nowhere/m.blend")
        self.assertEqual(inventory(), before)

    def test_sizes_of_any_shape_frame_the_model(self):
        points = np.random.default_rng(3).random((500, 3)) * (80.0, 50.0, 20.0)
        for size in ((1600, 1000), (400, 900), (500, 500)):
            matrix, distance = picture.camera_matrix(points, size)
            self.assertGreater(distance, 0.0)
            inverse = np.array(matrix.inverted())
            local = points @ inverse[:3, :3].T + inverse[:3, 3]
            tangents = np.array(size) / max(size) * np.tan(picture.FIELD_OF_VIEW / 2.0)
            reach = np.abs(local[:, :2] / -local[:, 2:]) / tangents
            self.assertLess(reach.max(), 1.0)
            self.assertGreater(reach.max(), 0.85)


class Cutaway(PanelCase):
    """Cut solids stay solid: the volume of what is kept is known."""

    def volume(self, triangles):
        a, b, c = triangles.transpose(1, 0, 2)
        return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)

    def bodies(self):
        batch.write_scene(build(two_rocks()))
        return [arrangement.Body.of(row.object) for row in self.model.results if row.object]

    def test_two_halves_make_the_whole(self):
        for body in self.bodies():
            for angle in (0.1, 1.3, 2.9):
                normal = np.array([np.cos(angle), np.sin(angle), 0.0])
                middle = float(np.median(body.triangles @ normal))
                halves = [
                    cutaway.keep_behind(body.triangles, n, n @ normal * middle) for n in (normal, -normal)
                ]
                volumes = [self.volume(half) for half in halves]
                self.assertGreater(min(volumes), 0.0)
                whole = self.volume(body.triangles)
                self.assertAlmostEqual(sum(volumes) / whole, 1.0, delta=1e-4, msg=body.name)

    def test_a_plane_through_vertices(self):
        corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
        faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
        cube = np.array([corners[[f[0], f[i], f[i + 1]]] for f in faces for i in (1, 2)])
        diagonal = np.array([1.0, -1.0, 0.0]) / np.sqrt(2.0)
        self.assertAlmostEqual(self.volume(cutaway.keep_behind(cube, diagonal, 0.0)), 0.5)
        self.assertAlmostEqual(self.volume(cutaway.keep_behind(cube, np.array([1.0, 0, 0]), 0.25)), 0.25)
        self.assertAlmostEqual(self.volume(cutaway.keep_behind(cube, np.array([1.0, 0, 0]), 1.0)), 1.0)
