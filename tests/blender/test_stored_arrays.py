# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays in the .blend: nothing of them is lost, they go with the scene, no drawing reads them, and those of
version 6 are taken over."""

import base64
import io
import json
from unittest import mock

import bpy
import numpy as np
from blender_state import empty_file
from panel_case import PanelCase, ops
from realmodel.bl.display import coordinates, modes
from realmodel.bl.field import map_settings
from realmodel.bl.objects.stored_arrays import StoredArrays
from realmodel.bl.project import (
    borehole_picks,
    interval_values,
    method_settings,
    observed_blocks,
    settings,
    surface_dips,
)
from realmodel.bl.scene import planned_holes
from realmodel.core import Dips, InputRefused, Observations
from realmodel.core.readers.tables.interval_values import IntervalValues
from recording_layout import draw_tab

GIVEN = {
    "doubles": np.array([[0.1, np.nan, -0.0], [np.pi * 1e300, 5e-324, -np.inf]]),
    "whole": np.arange(6, dtype=np.int32).reshape(2, 3),
    "long": np.array([2**40, -1]),
    "short": np.array([[-1], [3]], np.int16),
    "truths": np.array([True, False]),
    "texts": np.array(["", "Quarzit\nä", "c" * 99]),
    "no rows": np.empty((0, 3)),
    "no texts": np.empty(0, str),
    "empty text": np.array([""]),
    "number": np.float64(0.1),
    "word": np.array("clay"),
}
SMALL = {"exact", "collar"}  # a few numbers that the panel shows


class Arrays(PanelCase):
    def setUp(self):
        super().setUp()
        ops.rock_add()
        self.rock.map = GIVEN

    @property
    def rock(self):
        return self.model.rocks[0]

    def assert_given(self, arrays):
        self.assertEqual(set(arrays), set(GIVEN))
        for name, expected in GIVEN.items():
            self.assertEqual((arrays[name].dtype, arrays[name].shape), (expected.dtype, expected.shape), name)
            self.assertEqual(arrays[name].tobytes(), expected.tobytes(), name)

    def test_all_bits_shapes_and_types_stay(self):
        self.assert_given(self.rock.map)
        self.assertEqual((self.rock.map.count("whole"), self.rock.map.count("no rows")), (2, 0))
        self.save_and_open()
        self.assert_given(self.rock.map)

    def test_digests_tell_them_apart(self):
        self.assertFalse(self.rock.dips)
        self.assertEqual((len(self.rock.dips), self.rock.dips.digest), (0, ""))
        first = self.rock.map.digest
        self.rock.map = {**GIVEN, "word": np.array("sand")}
        self.assertNotEqual(self.rock.map.digest, first)
        self.rock.map = GIVEN
        self.assertEqual(self.rock.map.digest, first)
        self.rock.map = {}
        self.assertFalse(self.rock.map)

    def test_undo_and_redo_take_them_along(self):
        bpy.ops.ed.undo_push(message="with a map")
        self.rock.map = {"other": np.arange(3.0)}
        bpy.ops.ed.undo_push(message="with another")
        bpy.ops.ed.undo()
        self.assert_given(self.rock.map)
        bpy.ops.ed.redo()
        self.assertEqual(list(self.rock.map), ["other"])

    def test_copies_of_scenes_and_rows_have_their_own(self):
        copy = self.scene.copy()
        ops.rock_copy()
        self.rock.map = {}
        self.assert_given(copy.realmodel.rocks[0].map)
        self.assert_given(self.model.rocks[1].map)

    def test_a_scene_that_is_appended_or_linked_has_them(self):
        path = str(self.save_and_open())
        for link in (False, True):
            empty_file()
            with bpy.data.libraries.load(path, link=link) as (known, wanted):
                wanted.scenes = known.scenes
            self.assert_given(wanted.scenes[0].realmodel.rocks[0].map)

    def test_what_is_damaged_is_refused(self):
        for damage in ({"values": "few"}, {"shape": [7]}, {"kind": "V9999999999"}, {"kind": "none"}, {}):
            self.rock.map = GIVEN
            part = self.rock["map"]["arrays"]["whole"].to_dict() | damage
            del self.rock["map"]["arrays"]["whole"]
            self.rock["map"]["arrays"]["whole"] = part if damage else {}
            with self.assertRaisesRegex(InputRefused, "data stored in the .blend file are damaged"):
                self.rock.map["whole"]
        del self.rock["map"]
        self.rock["map"] = "UEsDBA=="  # as version 6 had it, and damaged
        with self.assertRaisesRegex(InputRefused, "data stored in the .blend file are damaged"):
            map_settings.of_rock(self.rock)
        self.assertEqual(self.rock.map.digest, "damaged")

    def test_no_drawing_reads_what_may_be_large(self):
        rock = self.rock
        ops.surface_add(name="top", empty=True)
        rock.map = {}
        surface_dips.keep(rock, Dips(np.zeros((2, 2)), np.ones((2, 2))))
        surface_dips.keep(rock.surfaces[0], Dips(np.zeros((2, 2)), np.ones((2, 2))))
        observed_blocks.keep(rock, Observations([[0, 0, 5], [0, 0, 2]], ["top", "top"], ["A", "A"]))
        borehole_picks.keep(rock, {"A": (None, [("top", (0.0, 0.0, 5.0))])})
        rock.constraints_stored = {"constraint0": np.zeros((2, 2)), "constraint1": np.zeros((1, 2))}
        rock.region_stored = {"ring0": np.zeros((4, 2))}
        rock.surfaces[0].stored = {"points": np.zeros((3, 3))}
        rock.surfaces[0].left_out = {"points": np.zeros((1, 3))}
        ops.series_add(kind="sheets")
        rock.series[0].oldest = "top"
        surface_dips.keep(rock.series[0], Dips(np.zeros((3, 2)), np.ones((3, 2))))
        read, get = set(), StoredArrays.__getitem__

        def watched(arrays, name):
            read.add(arrays._key)
            return get(arrays, name)

        draw_tab(bpy.context)  # what is counted is counted once
        with mock.patch.object(StoredArrays, "__getitem__", watched):
            drawn = draw_tab(bpy.context)
        self.assertLessEqual(read, SMALL)
        labels = " ".join(drawn.labels)
        self.assertIn("1 line, 1 point from files", labels)
        self.assertIn("3 dips", labels)

    def test_columns_may_have_long_names(self):
        name = "Au_ppm by fire assay, screened, in the second laboratory of three " * 2
        values = IntervalValues(
            np.array(["A"]), np.zeros((1, 3)), np.ones((1, 3)), np.array([[0.0, 1.0]]), {name: np.ones(1)}
        )
        interval_values.add(self.rock, values)
        self.assertEqual(list(interval_values.of_rock(self.rock).columns), [name])

    def test_a_thickness_above_a_triangulated_surface_is_kept(self):
        ops.surface_add(name="top", empty=True)
        row = self.rock.surfaces[0]
        vertices, triangles = np.arange(12.0).reshape(4, 3), np.array([(0, 1, 2)], np.int32)
        for given in ([1.5, 2.5], (vertices, triangles)):
            method_settings.set_options(row, "parallel", {"to": given})
            found = method_settings.options_of(row)["to"]
            for one, other in zip(found, given, strict=True):
                np.testing.assert_array_equal(one, other)


def _npz(**arrays):
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    return base64.b64encode(file.getvalue()).decode()


class OfVersion6(PanelCase):
    """Arrays as text, as a .blend of version 6 has them."""

    def test_all_of_them_are_taken_over(self):
        ops.rock_add()
        ops.surface_add(name="top", empty=True)
        ops.series_add(kind="field")
        rock = self.model.rocks[0]
        top, places = rock.surfaces[0], np.array([[0.1, 0.2, 1 / 3], [4e5 + 0.1, 5e6, 7.0]])
        rock.sizes.add()["stored"] = "[[0.1, 2.0], [3.0, 4.0]]"
        collar, ends = [1.5, 2.5, 30.1], {"A": [0.0, 0.0, -9.5]}
        picks = {"A": [collar, [["top", [1.5, 2.5, 0.1]]]], "B": [None, []]}
        rock["hole_picks"], rock["hole_ends"] = json.dumps(picks), json.dumps(ends)
        rock["edge_length"], rock["exact"] = 0.1, json.dumps({"edge_length": 0.1 + 1e-12})
        rock["region_stored"] = _npz(ring0=places[:, :2], ring1=places[:1, :2])
        rock["observations"] = _npz(places=places, blocks=["top", "B"], used=[True, False], on=["", "top"])
        rock["dips"] = _npz(
            positions=places[:, :2], gradients=places[:, 1:], surfaces=["top", ""], blocks=["", "B"]
        )
        rock["map"] = _npz(
            vertices=places, triangles=np.array([[0, 1, 0]], np.int32), unit=[0], names=["sand"]
        )
        columns = {"column:Au, ppm": [0.1, np.nan], "column:note": ["", "ä"]}
        rock["interval_values"] = _npz(
            holes=["A", "B"], begins=places, ends=places, depths=places[:, :2], **columns
        )
        rock.series[0]["dips"] = _npz(positions=places, normals=-places)
        top["stored"], top["left_out"] = _npz(points=places), _npz(points=places[:1])
        top["stored_mesh"], top["dips"] = "", "UEsDBA=="
        top["method"] = top.bl_rna.properties["method"].enum_items["parallel"].value
        top["other_options"] = json.dumps({"to": [0.1, 0.2]})
        hole = self.model.planned_holes.add()
        hole["collar"] = json.dumps(collar)
        view, misfit = self.model.view, self.model.misfits.add()
        view["hidden"], view["zero"], misfit["place"] = "[3, 7]", json.dumps(collar), json.dumps(collar)
        self.model.version = 6
        self.save_and_open()

        rock = self.model.rocks[0]
        top = rock.surfaces[0]
        self.assertEqual(self.model.version, settings.VERSION)
        self.assertEqual(rock.sizes[0].stored["values"].tolist(), [[0.1, 2.0], [3.0, 4.0]])
        self.assertEqual(borehole_picks.of_rock(rock), picks)
        self.assertEqual(borehole_picks.ends_of(rock), ends)
        self.assertEqual(settings.number(rock, "edge_length"), 0.1 + 1e-12)
        self.assertEqual(
            [ring.tolist() for ring in rock.region_stored.values()],
            [places[:, :2].tolist(), places[:1, :2].tolist()],
        )
        observations = observed_blocks.of_rock(rock)
        self.assertEqual(observations.places.tolist(), places.tolist())
        self.assertEqual(
            (observations.blocks.tolist(), observations.used.tolist()), (["top", "B"], [True, False])
        )
        self.assertEqual(
            [names.tolist() for names in surface_dips.of_row(rock).named], [["top", ""], ["", "B"]]
        )
        self.assertEqual(surface_dips.of_row(rock.series[0]).normals.tolist(), (-places).tolist())
        self.assertEqual(map_settings.of_rock(rock).names, ["sand"])
        values = interval_values.of_rock(rock)
        self.assertEqual(values.columns["note"].tolist(), ["", "ä"])
        self.assertEqual(values.columns["Au, ppm"][0], 0.1)
        self.assertEqual(top.stored["points"].tolist(), places.tolist())
        self.assertEqual(top.left_out["points"].tolist(), places[:1].tolist())
        self.assertEqual(method_settings.options_of(top)["to"].tolist(), [0.1, 0.2])
        self.assertEqual(planned_holes.collar(self.model.planned_holes[0]), collar)
        self.assertEqual(modes.hidden_properties(self.scene), {3, 7})
        for place in (coordinates.zero(self.scene), self.model.misfits[0].place["values"]):
            self.assertEqual(place.tolist(), collar)
        self.assertFalse(top.stored_mesh)
        with self.assertRaisesRegex(InputRefused, "data stored in the .blend file are damaged"):
            surface_dips.of_row(top)  # it was damaged
