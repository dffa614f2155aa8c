# SPDX-License-Identifier: GPL-3.0-or-later
"""The real case of docs/real_case: the page shows what its script wrote, the scripts of the example read logs
as they say, and where the file is, its commands print what the page has."""

import csv
import hashlib
import importlib.util
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from realmodel.core import InputRefused

ROOT = Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "blend_samples" / "kai_tak"
PAGE = ROOT / "docs" / "real_case"


def module(path):
    specification = importlib.util.spec_from_file_location(path.stem, path)
    found = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(found)
    return found


fetch, read_units = module(SAMPLE / "fetch.py"), module(SAMPLE / "read_units.py")
FOLDERS = ROOT / "build" / "kai_tak", ROOT.parent / "shared" / "data" / "kai_tak"


@pytest.fixture(scope="module")
def script():
    """scripts/real_case.py, which finds its neighbors by sys.path."""
    before = sys.path[:]
    yield module(ROOT / "scripts" / "real_case.py")
    sys.path[:] = before


@pytest.fixture(scope="module")
def results():
    return json.loads((PAGE / "results.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the file, as fetch.py brings it."""
    source = next((place for place in FOLDERS if (place / fetch.NAME).exists()), None)
    if source is None:
        pytest.skip(f"{fetch.NAME} is not here: python3 blend_samples/kai_tak/fetch.py build/kai_tak")
    made = tmp_path_factory.mktemp("kai_tak")
    command = [sys.executable, SAMPLE / "fetch.py", made, "--from", source]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert "Apache License 2.0" in run.stdout
    for name in ("model.toml", "library.toml"):
        shutil.copyfile(SAMPLE / name, made / name)
    return made


# -- without the file


def test_the_page_has_what_the_script_wrote(script, results):
    page = (PAGE / "README.md").read_text(encoding="utf-8")
    shown = {name: text.rstrip("\n") for _, name, text, _ in script.BLOCK.findall(page)}
    assert shown == results


def test_the_commands_of_the_page_are_those_that_ran(script):
    page = " ".join((PAGE / "README.md").read_text(encoding="utf-8").replace("\\\n", " ").split())
    for command in script.STEPS.values():
        assert command.replace(f"{SAMPLE}/", "../../blend_samples/kai_tak/") in page


def test_what_the_page_says_of_its_numbers_is_so(results):
    """The sentences below the tables."""
    flat, plane, nearest, kriging = (
        [float(cell.split()[0]) for cell in line.strip("| ").split(" | ")[1:]]
        for line in results["baselines"].splitlines()[2:]
    )
    assert flat[0] < plane[0] < nearest[0] < kriging[0]
    assert 5.5 < 100 / (100 - kriging[0]) < 6.5  # one meter in six
    assert max(kriging[1:]) == kriging[1]  # the top of granite is the hardest to predict
    assert max(range(1, 4), key=lambda n: nearest[n] - kriging[n]) == 1  # and gains most
    assert plane[3] == pytest.approx(kriging[3], abs=0.2)  # of the base of the fill
    worst = re.findall(r"^BH ?\d+", results["model"], re.MULTILINE)
    assert worst[:3] == ["BH12", "BH 6", "BH 7"]
    assert "| Marine Deposit | 6 | 6 |" in results["codes"]
    assert all(f"| {unit} | 80 |" in results["codes"] for unit in ("Fill", "Granite"))
    assert results["units"].startswith("```text\n80 holes, 1603 intervals, 3 of them without a unit")
    assert len(results["wrong"].splitlines()) == 2 + 3


def test_another_file_is_refused(tmp_path):
    (tmp_path / fetch.NAME).write_text("another")
    command = [sys.executable, SAMPLE / "fetch.py", tmp_path / "out", "--from", tmp_path]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 1
    assert "the checksum differs" in run.stderr
    assert not (tmp_path / "out").exists()


def test_the_file_of_the_repository_is_written(tmp_path, monkeypatch, capsys):
    (tmp_path / "remote").write_bytes(b"the file")
    monkeypatch.setattr(fetch, "ADDRESS", (tmp_path / "remote").as_uri())
    monkeypatch.setattr(fetch, "SHA256", hashlib.sha256(b"the file").hexdigest())
    monkeypatch.setattr(sys, "argv", ["fetch.py", str(tmp_path / "new")])
    assert fetch.main() == 0
    assert (tmp_path / "new" / fetch.NAME).read_bytes() == b"the file"
    assert "8 bytes, checksum right" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("description", "unit"),
    [
        ("Very soft, dark grey CLAY with shell fragments. (MARINE DEPOSIT)", "Marine Deposit"),
        ("Stiff, sandy SILT. (ALLUVIUM / completely decomposed GRANITE)", "Alluvium"),
        ("BITUMEN layer.", "Fill"),
        ("No sample recovered. Inferred as FILL.", "Fill"),
        ("No sample recovered.", ""),
        ("Wash boring, no sample recovered. Inferred as completely decomposed GRANITE.", "Saprolite"),
        ("Strong, pink, slightly decomposed GRANITE with joints.", "rock"),
    ],
)
def test_the_unit_of_a_description(description, unit):
    assert read_units.unit_of(description) == unit


def test_a_description_without_a_unit_is_refused():
    with pytest.raises(InputRefused, match="no unit is known for 'LIMESTONE'"):
        read_units.unit_of("LIMESTONE")


@pytest.mark.parametrize(
    ("log", "units"),
    [
        ([("Saprolite", 9), ("rock", 2), ("Saprolite", 3), ("rock", 4), ("rock", 2)], "SSSGG"),
        ([("Fill", 9), ("Saprolite", 3), ("rock", 4)], "FSS"),  # too thin to be proved
        ([("rock", 6)], "G"),
        ([("Fill", 6), ("Alluvium", 1)], "FA"),
    ],
)
def test_granite_is_the_rock_that_a_hole_ends_in(log, units):
    depth, rows = 0.0, []
    for unit, thickness in log:
        rows.append(["H", depth, depth + thickness, unit])
        depth += thickness
    assert "".join(row[3][0] for row in read_units.with_granite(rows)) == units


AGS = """\
"**PROJ"
"*PROJ_ID","*PROJ_AGS"
"P","3"

"**HOLE"
"*HOLE_ID","*HOLE_NATE","*HOLE_NATN","*HOLE_GL","*HOLE_FDEP"
"<UNITS>","m","m","m","m"
"A","0","0","5","20"

"**GEOL"
"*HOLE_ID","*GEOL_TOP","*GEOL_BASE","*GEOL_DESC","*GEOL_GEOL"
"<UNITS>","m","m","",""
"A","0","4","COBBLES. (FILL)","Q"
"A","4","9","Extremely weak, completely ","L"
"<CONT>","","","decomposed GRANITE.",""
"A","9","11","slightly decomposed GRANITE","L"
"A","11","12","Wash boring. Inferred as completely decomposed GRANITE.","L"
"A","12","20","slightly decomposed GRANITE","L"
"""


def test_an_ags_file_becomes_two_tables(tmp_path, capsys):
    (tmp_path / "site.ags").write_text(AGS)
    read_units.main(tmp_path / "site.ags", tmp_path)
    with open(tmp_path / "intervals.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["block"] for row in rows] == ["Fill", "Saprolite", "Saprolite", "Saprolite", "Granite"]
    with open(tmp_path / "collars.csv", encoding="utf-8") as file:
        assert [float(value) for value in list(csv.reader(file))[1][1:]] == [0, 0, 5, 20]
    assert capsys.readouterr().out.splitlines() == [
        "1 holes, 5 intervals, 0 of them without a unit",
        "corestones: 25.0 % of the length in saprolite",
    ]


# -- with the file


def test_the_first_commands_print_what_the_page_has(script, results, folder):
    for step in ("first", "check", "units"):
        assert f"```text\n{script.printed(step, folder)}\n```" == results[step]
    assert script.wrong_codes(folder / fetch.NAME) == results["wrong"]


def test_the_model_has_the_volumes_of_the_page(script, results, folder):
    read_units.main(folder / fetch.NAME, folder)
    model = script.build(script.load_project(folder / "model.toml"))
    for block in model.blocks:
        assert f"{block.volume:.0f}" in results["model"]
    assert script.steepest(folder) == results["steepest"]
