#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the scripts of docs/examples: each draws its picture. What it prints goes into its docstring, and
the first sentences make the gallery of docs/examples/README.md.

    PYTHONPATH=addon python scripts/draw_examples.py [NAME ...]      (default: all)

Needs the built module, PyVista, matplotlib, Dask and OpenGeoSys (scripts/requirements/test.txt).
"""

import ast
import re
import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "examples"
PAGE = FOLDER / "README.md"
NAMES = (  # in the order of the gallery
    *("points_to_solid", "wells", "geological_map"),
    *("fold", "fault", "intrusion"),
    *("section", "ensemble", "solver"),
    *("boolean", "strata_in_mesh", "tiles"),
)
PRINTS = re.compile(r'(?<=\nIt prints\n\n).*?(?=""")', re.DOTALL)
GALLERY = re.compile(r"(?<=<!-- gallery -->\n).*?(?=<!-- end -->)", re.DOTALL)
_COLUMNS = 3


def script_of(name):
    return FOLDER / f"{name}.py"


def picture_of(name):
    """Where the picture of an example is. Drawings of sections have formats of their own."""
    return FOLDER / "images" / f"{name}{'.png' if name == 'section' else '.webp'}"


def printed(name):
    """What an example prints, by its docstring."""
    lines = PRINTS.search(script_of(name).read_text(encoding="utf-8"))[0].splitlines()
    return "".join(f"{line[4:]}\n" for line in lines)


def gallery():
    """The table of pictures, each with the first sentence of its script."""
    cells = []
    for name in NAMES:
        docstring = ast.get_docstring(ast.parse(script_of(name).read_text(encoding="utf-8")))
        title, sentence = " ".join(docstring.split("\n\n")[0].split()).split(": ", 1)
        picture = f"[![{title}](images/{picture_of(name).name})]({name}.py)"
        cells.append(f"{picture}<br>[{title}]({name}.py): {sentence}")
    rows = [cells[n : n + _COLUMNS] for n in range(0, len(cells), _COLUMNS)]
    head = ["|" + "   |" * _COLUMNS, "|" + "---|" * _COLUMNS]
    return "\n".join([*head, *("| " + " | ".join(row) + " |" for row in rows), ""])


def run(name, picture):
    """What an example prints when it draws a picture."""
    command = [sys.executable, script_of(name), picture]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


if __name__ == "__main__":
    for name in sys.argv[1:] or NAMES:
        lines = run(name, picture_of(name)).splitlines()
        text = script_of(name).read_text(encoding="utf-8")
        text = PRINTS.sub(lambda _, lines=lines: "".join(f"    {line}\n" for line in lines), text, count=1)
        script_of(name).write_text(text, encoding="utf-8")
        print(picture_of(name), flush=True)
    PAGE.write_text(GALLERY.sub(lambda _: gallery(), PAGE.read_text(encoding="utf-8")), encoding="utf-8")
