#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes all numbers, outputs and pictures of docs/real_case/README.md: runs its commands, and writes what
they print, and the tables, between the comments of the page and to results.json beside it.

    python3 blend_samples/kai_tak/fetch.py build/kai_tak
    build/venv/bin/python scripts/real_case.py [FOLDER] [--page PAGE]

(default: build/kai_tak, docs/real_case)

FOLDER has the fetched file. Needs the built module, Dask, Matplotlib, Pillow and Debian's chromium; takes
some ten minutes.
"""

import argparse
import csv
import itertools
import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
SAMPLE = ROOT / "blend_samples" / "kai_tak"
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "scripts"), str(SAMPLE)]

from fetch import NAME  # noqa: E402
from read_units import unit_of  # noqa: E402
from realmodel.core import build, count_codes, load_project, read_boreholes  # noqa: E402

COMMAND = "import sys; sys.argv[0] = 'realmodel'; from realmodel.batch.command import command; command()"
PLANE = "838230,820637,0,0,-1,0"
STEPS = {  # in this order; each prints to a block of the page
    "first": f"realmodel new {NAME} --out first",
    "check": "realmodel check-data first/project.toml",
    "units": f"python3 {SAMPLE / 'read_units.py'} {NAME} .",
    "proposed": "realmodel new --collars collars.csv --intervals intervals.csv --crs EPSG:2326 "
    "--out proposed",
    "doubts": "realmodel proposed/project.toml --cross-validate 10",
    "model": "realmodel model.toml --check-model --cross-validate 10 --export kai_tak.html "
    f"--section {PLANE}=section.png --hole-width 20 --exaggeration 2 --report report.json",
    "ensemble": f"realmodel model.toml --ensemble 100 --seed 1 --out ensemble "
    f"--section {PLANE}=probability.png --exaggeration 2",
}
SHOWN = {  # of what a step prints, where it is not all
    "doubts": r"warning: .*",
    "model": r"warning: .*|Validation of .*|block .*|-+|(Fill|Alluvium|Saprolite|Granite|total) .*"
    r"|observed: .*|cross-validation: .*|hole .*|BH.*",
    "ensemble": r"block .*|-+|(Fill|Alluvium|Saprolite|Granite) .*",
}
VIEWS = {
    "page": "s=y,0.657,1&v=3&t=light&l=B&c=-310,-1020,440,75,30,-20",
    "rockhead": "h=1,2,3&v=3&t=light&l=B&c=-450,-1000,620,30,0,-130",
}
BASELINES = {  # method and options of all surfaces
    "each contact flat, at its mean height": {"method": "constant", "tie": False},
    "each contact an inclined plane": {"method": "plane", "tie": False},
    "each contact as in the nearest hole": {
        "method": "idw",
        "options": {"neighbours": 1},
        "tie": False,
    },
    "kriging, as in the model": {},
}
WORST = 5  # holes that the page lists
GROUPS = 10  # of holes that are left out together
BLOCK = re.compile(r"(<!-- (\w+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def printed(step: str, folder: Path) -> str:
    """What a command prints, without the lines of its progress."""
    program, *words = shlex.split(STEPS[step])
    start = [sys.executable] if program == "python3" else [sys.executable, "-c", COMMAND]
    paths = os.pathsep.join([str(ROOT / "addon"), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run(
        [*start, *words],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": paths},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if run.returncode not in (0, 1 if step == "check" else 0):
        sys.exit(f"{STEPS[step]}:\n{run.stdout[-2000:]}")
    lines = [line.rstrip() for line in run.stdout.splitlines() if not re.match(r" *\d+ %  ", line)]
    lines = [line for line in lines if re.fullmatch(SHOWN.get(step, ".*"), line)]
    holes = [number for number, line in enumerate(lines) if line.startswith("BH")]
    return "\n".join(lines[: holes[WORST]] if len(holes) > WORST else lines)


def table(headings, rows) -> str:
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(map(str, cells)) + " |" for cells in lines)


def codes_of(project: Path) -> str:
    """The codes of a project's intervals: in how many holes, how many intervals, and how long."""
    rock = load_project(project).rocks[0]
    return table(
        ["unit", "holes", "intervals", "length (m)"],
        [[code.code, code.holes, code.rows, f"{code.length:,.1f}"] for code in count_codes(rock.boreholes)],
    )


def wrong_codes(file: Path) -> str:
    """The intervals whose code and description are of different rock."""
    coded, described = (
        read_boreholes(file, columns={"block": name}).intervals for name in ("GEOL_GEOL", "GEOL_DESC")
    )
    soils = ("Fill", "Alluvium", "Marine Deposit")
    rows = []
    for number, (code, text) in enumerate(zip(coded["block"], described["block"], strict=True)):
        unit = unit_of(text)
        if unit and (code == "Q") != (unit in soils):
            words = re.search(r"[a-z]+ decomposed.*?GRANITE", text).group()
            top, end = (f"{described[name][number]:.2f}" for name in ("from", "to"))
            rows.append([described["hole"][number], top, end, code, words])
    return table(["hole", "from", "to", "code", "description"], rows)


def steepest(folder: Path) -> str:
    """Between which holes less than 100 m apart the top of granite differs most."""
    with open(folder / "collars.csv", encoding="utf-8") as file:
        collars = {row["hole"]: [float(row[name]) for name in "xyz"] for row in csv.DictReader(file)}
    with open(folder / "intervals.csv", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["block"] == "Granite"]
    tops = {row["hole"]: collars[row["hole"]][2] - float(row["from"]) for row in reversed(rows)}
    pairs = [
        (abs(tops[a] - tops[b]), math.dist(collars[a][:2], collars[b][:2]), a, b)
        for a, b in itertools.combinations(tops, 2)
    ]
    drop, distance, a, b = max(pair for pair in pairs if pair[1] < 100)
    low, high = sorted((a, b), key=tops.get)
    return f"Between {low} and {high}, {distance:.0f} m apart, the top of granite rises by {drop:.0f} m."


def baselines(file: Path) -> str:
    """How much of left-out holes several ways to predict them have right, and how far off contacts are."""
    rows = []
    for name, changes in BASELINES.items():
        project = load_project(file)
        surfaces = project.rocks[0].surfaces[:-1]
        for surface in surfaces:
            for key, value in changes.items():
                setattr(surface, key, value)
        found = build(project).cross_validate_holes(GROUPS)
        contacts = [contact for hole in found.holes for contact in hole.contacts]
        errors = [np.array([c.error for c in contacts if c.surface == s.name], float) for s in surfaces]
        off = [f"{np.sqrt((some**2).mean()):.1f}" for some in errors]
        rows.append([name, f"{100 * found.share:.1f} %", *off])
    names = [surface.name for surface in surfaces]
    return table(["between holes", "right block", *(f"{name} off by (m)" for name in names)], rows)


# -- pictures


def draw_map(model, picture: Path) -> None:
    """The height of the top of granite, and the holes."""
    import matplotlib.pyplot as plot
    from matplotlib.patheffects import withStroke

    top = model.to_xarray(cell_size=4).top.isel(block=0)
    figure, axes = plot.subplots(figsize=(8.6, 9.2), layout="constrained")
    levels = np.arange(-90, 1, 10)
    filled = axes.contourf(top.x, top.y, top, levels, cmap="viridis")
    axes.contour(top.x, top.y, top, levels, colors="white", linewidths=0.7, linestyles="solid")
    with open(picture.parent / "collars.csv", encoding="utf-8") as file:
        holes = list(csv.DictReader(file))
    x, y = ([float(hole[name]) for hole in holes] for name in "xy")
    axes.scatter(x, y, 16, "white", edgecolors="black", linewidths=0.8, zorder=3)
    for hole, at_x, at_y in zip(holes, x, y, strict=True):
        label = axes.annotate(
            hole["hole"].replace("BH", "").strip(), (at_x, at_y), (4, 3), textcoords="offset points"
        )
        label.set(fontsize=8.5, zorder=4, path_effects=[withStroke(linewidth=2.5, foreground="white")])
    section = float(PLANE.split(",")[1])
    axes.axhline(section, color="black", linestyle="--", linewidth=1)
    axes.annotate("section", (837970, section), (0, 4), textcoords="offset points", fontsize=9)
    axes.set(aspect="equal", xlabel="Easting (m)", ylabel="Northing (m)")
    axes.ticklabel_format(useOffset=False, style="plain")
    axes.tick_params(axis="y", rotation=90)
    figure.colorbar(filled, label="Height of the top of granite (m above Principal Datum)", shrink=0.6)
    figure.savefig(picture, dpi=120)


def draw_volumes(folder: Path, colors: dict[str, str], picture: Path) -> None:
    """Bars of the volumes above granite with their percentiles."""
    import matplotlib.pyplot as plot

    rows = [row for row in volumes(folder) if row["name"] != "Granite"]
    figure, axes = plot.subplots(figsize=(8.6, 2.9), layout="constrained")
    for number, row in enumerate(rows):
        low, middle, high = (row[name] / 1e6 for name in ("p10", "p50", "p90"))
        axes.barh(number, middle, color=colors[row["name"]], edgecolor="0.3", height=0.6)
        axes.errorbar(
            middle, number, xerr=[[middle - low], [high - middle]], color="black", capsize=6, linewidth=1.5
        )
        axes.plot(row["interpolated"] / 1e6, number, "D", color="white", markeredgecolor="black")
        axes.annotate(
            f"{low:.2f} to {high:.2f}", (high, number), (10, -4), textcoords="offset points", fontsize=10
        )
    axes.set_yticks(range(len(rows)), [row["name"] for row in rows])
    axes.set(xlabel="Volume (million m³)", xlim=(0, 1.18 * max(row["p90"] for row in rows) / 1e6))
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(picture, dpi=120)


def volumes(folder: Path) -> list[dict]:
    """Of each block of an ensemble: name, interpolated volume, and percentiles."""
    return json.loads((folder / "ensemble" / "ensemble.json").read_text(encoding="utf-8"))["blocks"]


# -- the page


def written(page: str, blocks: dict[str, str]) -> str:
    """The page with its blocks. Raises KeyError where one is not known."""
    return BLOCK.sub(lambda match: f"{match[1]}{blocks[match[2]]}\n{match[4]}", page)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, nargs="?", default=ROOT / "build" / "kai_tak")
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "real_case")
    options = parser.parse_args()
    folder = options.folder.resolve()
    from draw_guide import shrink
    from draw_page import draw

    for name in ("first", "proposed", "ensemble"):
        shutil.rmtree(folder / name, ignore_errors=True)
    for name in ("model.toml", "library.toml"):
        shutil.copyfile(SAMPLE / name, folder / name)
    blocks = {step: f"```text\n{printed(step, folder)}\n```" for step in STEPS}
    blocks["wrong"] = wrong_codes(folder / NAME)
    blocks["codes"] = codes_of(folder / "proposed" / "project.toml")
    blocks["steepest"] = steepest(folder)
    blocks["baselines"] = baselines(folder / "model.toml")
    model = build(load_project(folder / "model.toml"))
    library = model.project.library
    colors = {block.name: library.get(block.property).color for block in model.blocks}
    draw_map(model, folder / "map.png")
    draw_volumes(folder, colors, folder / "volumes.png")
    for name, view in VIEWS.items():
        draw(folder / "kai_tak.html", view, folder / f"{name}.png")
    for name in ("map", "volumes", "section", "probability", *VIEWS):
        shrink(folder / f"{name}.png", options.page / f"{name}.png")
    text = json.dumps(blocks, indent=1, ensure_ascii=False) + "\n"
    (options.page / "results.json").write_text(text, encoding="utf-8")
    page = options.page / "README.md"
    page.write_text(written(page.read_text(encoding="utf-8"), blocks), encoding="utf-8")


if __name__ == "__main__":
    main()
