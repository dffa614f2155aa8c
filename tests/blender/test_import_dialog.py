# SPDX-License-Identifier: GPL-3.0-or-later
"""The dialogs of imports: what the menus of columns say is what is read, and choices are remembered as
profiles."""

import json
from types import SimpleNamespace
from unittest import mock

import numpy as np
from panel_case import PanelCase, ops
from realmodel.bl.field import field_tables, profiles
from realmodel.bl.project import reading_text
from realmodel.core import InputRefused
from realmodel.core.base.packages import vendored
from realmodel.core.readers import preview_table
from realmodel.operators.boreholes import shown_kind
from realmodel.operators.chosen_tables import ChosenTables
from realmodel.operators.imports import previews
from realmodel.props_import import IGNORED, OF_HOLES
from realmodel.ui.panel import wrapped

LOG = ([0, 4, "Sand"], [4, 6, "Ton"])


def headings(path, columns, of="points"):
    """What the menus of a table say: {column: meaning}."""
    return [
        {"name": "", "file": str(path), "of": of, "column": name, "meaning": meaning or IGNORED}
        for name, meaning in columns.items()
    ]


class Menus(PanelCase):
    def table(self):
        path = self.folder / "t.csv"
        rows = [f"{n},{10 * n},{n % 3},{-n},{'ab'[n % 2]}" for n in range(20)]
        path.write_text("\n".join(["id,a,b,deep,code", *rows]) + "\n")
        return path

    def test_columns_of_points(self):
        path = self.table()
        chosen = {"id": None, "a": "x", "b": "y", "deep": "z", "code": "surface"}
        ops.surface_add(filepath=str(path), headings=headings(path, chosen), z_axis="down", height_unit="ft")
        rows = self.model.rocks[0].surfaces
        self.assertEqual(sorted(row.name for row in rows), ["a", "b"])
        for row in rows:
            self.assertEqual((row.column_x, row.column_y, row.column_z), ("a", "b", "deep"))
            self.assertEqual((row.z_axis, row.height_unit), ("down", "ft"))

    def test_a_missing_column_is_refused(self):
        path = self.table()
        chosen = headings(path, {"a": "x", "b": "y"})
        self.refused(ops.surface_add, "three columns", filepath=str(path), headings=chosen)
        self.assertEqual(len(self.model.rocks), 0)

    def test_columns_of_boreholes(self):
        (self.folder / "c.csv").write_text("BOHRPUNKT,R,H,OK\n1,0,0,9\n2,5,0,9\n")
        (self.folder / "i.csv").write_text(
            "BOHRPUNKT,OBEN,UNTEN,GESTEIN_X\n1,0,4,Sand\n1,4,6,Ton\n2,0,3,Sand\n"
        )
        tables = {
            "c.csv": {"BOHRPUNKT": "hole", "R": "x", "H": "y", "OK": "z"},
            "i.csv": {"BOHRPUNKT": "hole", "OBEN": "from", "UNTEN": "to", "GESTEIN_X": "block"},
        }
        columns = "; ".join(f"{m} = {c}" for table in tables.values() for c, m in table.items())
        ops.boreholes_read(
            directory=str(self.folder), files=[{"name": name} for name in tables], columns=columns
        )
        self.assertEqual([row.name for row in self.model.rocks[0].surfaces], ["Ton", "Sand"])

    def workbook(self, **more):
        openpyxl = vendored("openpyxl", "openpyxl", "writing a workbook", by_its_name=True)
        book = openpyxl.Workbook()
        book.remove(book.active)
        sheets = {
            "Notes": [["drilled in May"], ["by two rigs"]],
            "Holes": [["BHID", "X", "Y", "Z"], ["B1", 0, 0, 9], ["B2", 5, 0, 9]],
            "Logs": [["BHID", "From", "To", "Code"], *[[h, *i] for h in ("B1", "B2") for i in LOG]],
        }
        for name, rows in {**sheets, **more}.items():
            sheet = book.create_sheet(name)
            for row in rows:
                sheet.append(row)
        path = self.folder / "site.xlsx"
        book.save(path)
        return path

    def test_sheets_of_a_workbook(self):
        """Each has its own menus, and they are read together."""
        path = self.workbook()
        self.assertEqual(field_tables.hole_sheets(path), {"Holes": "collars", "Logs": "intervals"})
        shown = list(previews(SimpleNamespace(filepath=str(path), files=[], directory=""), OF_HOLES))
        self.assertEqual([preview.title for preview in shown], ["site.xlsx[Holes]", "site.xlsx[Logs]"])
        self.assertEqual(field_tables.columns_of(shown[1])["block"], "Code")
        said = shown_kind(path, "")
        self.assertEqual(said[0], "boreholes")
        self.assertEqual(list(said[2]), ["Holes: collars", "Logs: intervals"])
        ops.boreholes_read(filepath=str(path))
        self.assertEqual([row.name for row in self.model.rocks[0].surfaces], ["Ton", "Sand"])

    def test_a_row_of_a_sheet_is_left_out(self):
        path = self.workbook(Logs=[["BHID", "From", "To", "Code"], ["B1", 0, 4, "Sand"], ["B2", 0, 3, "Ton"]])
        ops.boreholes_read(filepath=str(path), left_out="site.xlsx[Logs]:3")
        self.assertEqual([row.name for row in self.model.rocks[0].surfaces], ["Sand"])

    def test_sheets_are_chosen(self):
        path = self.workbook(Other=[["BHID", "From", "To", "Code"], ["B1", 0, 4, "Sand"]])
        self.refused(ops.boreholes_read, "both have intervals", filepath=str(path))
        ops.boreholes_read(filepath=str(path), layer="Holes; Other")
        self.assertEqual([row.name for row in self.model.rocks[0].surfaces], ["Sand"])

    def test_an_ignored_column_of_field_data(self):
        """Whichever it is, it is not read; one that another table has is not ignored in silence."""
        path = self.folder / "i.csv"
        path.write_text("hole,from,to,block,dip\nB,0,4,Sand,10\n")
        dialog = ChosenTables.__new__(ChosenTables)
        dialog.columns, dialog._previews = "", [preview_table(path)]
        usual = field_tables.columns_of(dialog._previews[0])
        for ignored in usual:
            chosen = [(c, m if m != ignored else IGNORED) for m, c in usual.items()]
            dialog.headings = [SimpleNamespace(file=str(path), key=c, meaning=m) for c, m in chosen]
            self.assertEqual(dialog.named_columns(), {ignored: False})
            text = reading_text.of_named(dialog.named_columns())
            self.assertEqual(reading_text.named_columns(text), {ignored: False})
        other = self.folder / "c.csv"
        other.write_text("hole,x,y,z\nB,0,0,9\n")
        dialog._previews.append(preview_table(other))
        dialog.headings = [
            SimpleNamespace(file=str(file), key=c, meaning=IGNORED if (file, m) == (path, "hole") else m)
            for file in (path, other)
            for m, c in field_tables.columns_of(preview_table(file)).items()
        ]
        with self.assertRaisesRegex(InputRefused, "'hole' is column hole in one table, and ignored"):
            dialog.named_columns()

    def test_values_of_a_column_go_to_the_surfaces_of_their_names(self):
        path = self.folder / "t.csv"
        path.write_text(
            "x,y,z,horizon\n0,0,1,top_sand\n1,0,1,top_sand\n0,1,1,top_sand\n0,0,0,Clay\n1,1,0,Clay\n"
        )
        ops.surface_add(name="Top Sand", empty=True)
        ops.surface_add(filepath=str(path), split=True)
        self.assertEqual([row.name for row in self.model.rocks[0].surfaces], ["Top Sand", "Clay"])
        ops.surface_add(filepath=str(path), split=True)
        self.assertEqual(len(self.model.rocks[0].surfaces), 2)


class Profiles(PanelCase):
    def setUp(self):
        super().setUp()
        place = mock.patch.object(profiles, "file", lambda: self.folder / "own.json")
        place.start()
        self.addCleanup(place.stop)

    def test_remembered_renamed_saved_and_loaded(self):
        made = profiles.ImportProfile(
            "tops", "points", ("E", "N", "H (m)"), {"x": "E", "y": 2}, {"units": "ft"}
        )
        profiles.add(made, profiles.ImportProfile("tops", "points", ("a", "b"), {"x": "a"}))
        self.assertEqual([profile.name for profile in profiles.all_of_user()], ["tops", "tops 2"])
        self.assertEqual(profiles.of_header("points", ["e", "n", "h (m)"]), made)
        self.assertIsNone(profiles.of_header("field data", ["e", "n", "h (m)"]))
        ops.profile_rename(name="tops 2", new_name="others")
        self.refused(ops.profile_rename, "already", name="others", new_name="tops")
        ops.profiles_export(filepath=str(self.folder / "sent.json"))
        ops.profile_remove(name="tops")
        self.assertEqual([profile.name for profile in profiles.all_of_user()], ["others"])
        ops.profiles_import(filepath=str(self.folder / "sent.json"))
        self.assertEqual(profiles.of_header("points", made.header), made)
        self.assertEqual(len(profiles.all_of_user()), 2)

    def test_damaged_files(self):
        """Of any kind: those of the user are none, others are refused, and nothing is lost."""
        made = profiles.ImportProfile("tops", "points", ("E", "N"), {"x": "E"})
        profiles.add(made)
        whole = json.loads(profiles.file().read_text())
        bad = self.folder / "bad.json"
        entry = whole["profiles"][0]
        for content in (
            *("", "{", "[]", "{}", '"text"', json.dumps({**whole, "format": "other"})),
            *(json.dumps({**whole, "profiles": [{**entry, key: 3}]}) for key in entry),
            *(json.dumps({**whole, "profiles": [{**entry, "columns": {"x": x}}]}) for x in (None, [1], {})),
            json.dumps({**whole, "profiles": [{**entry, "more": 1}]}),
        ):
            bad.write_text(content)
            with self.assertRaises(InputRefused, msg=content):
                profiles.read(bad)
            self.refused(ops.profiles_import, "bad.json", filepath=str(bad))
        self.assertEqual(profiles.all_of_user(), [made])
        profiles.file().write_text("{")
        self.assertEqual(profiles.all_of_user(), [])


class Messages(PanelCase):
    def test_no_line_is_longer_than_the_width(self):
        """Whatever the words; nothing of the text is lost."""
        rng = np.random.default_rng(7)
        for _ in range(300):
            words = ["x" * int(n) for n in rng.integers(1, 60, rng.integers(1, 20))]
            most = int(rng.integers(12, 80))
            lines = wrapped(" ".join(words), most=most)
            self.assertLessEqual(max(map(len, lines)), most)
            self.assertEqual("".join(lines).replace(" ", ""), "".join(words))
