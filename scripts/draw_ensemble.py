#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of docs/ensembles.md and the README: sections of the examples uncertain_valley and
faulted_dome in the mean colors of their blocks, with the interfaces of many realizations (the cloud), those
of the interpolated model (thicker), and the boreholes beside it.

    PYTHONPATH=addon python scripts/draw_ensemble.py [FOLDER]      (default: docs/images)

Needs the built module.
"""

import csv
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from realmodel.core import build, load_project
from realmodel.core.drawing import save_drawing
from realmodel.core.drawing.drawing import Drawing, Text
from realmodel.core.ensembles import Probabilities, Realizer, draw_probabilities, section_samples
from realmodel.core.results.sections.section_drawing import block_outlines, flattened

ROOT = Path(__file__).resolve().parents[1]
NEAR = 40.0  # of the plane: boreholes that are drawn
CLOUD = (0.1, 0.1, 0.1, 0.12)


@dataclass(frozen=True)
class Picture:
    """sample: an example. plane: a point and a normal. size: of samples, along the section and up.
    resolution: of its series, None: its own. part: the part of the plan that is modeled, and how far down, so
    that little is drawn of what does not vary; None: as in the example."""

    sample: Path
    plane: tuple
    realizations: int
    exaggeration: float
    size: tuple[float, float]
    resolution: float | None = None
    part: tuple[list[list[float]], float] | None = None


SAMPLES = ROOT / "blend_samples"
PICTURES = {
    "ensemble": Picture(
        SAMPLES / "uncertain_valley",
        ((1530.0, 1000.0, 0.0), (1.0, 0.0, 0.0)),
        100,
        10.0,
        (4.0, 0.4),
        part=([[1430.0, 0.0], [1630.0, 0.0], [1630.0, 2000.0], [1430.0, 2000.0]], 325.0),
    ),
    "ensemble_fold": Picture(
        SAMPLES / "faulted_dome", ((0.0, 520.0, 0.0), (0.0, -1.0, 0.0)), 40, 1.0, (3.0, 3.0), 40.0
    ),
}


def draw(picture, path):
    """Writes a picture."""
    project = load_project(picture.sample / "project.toml")
    for series in project.rocks[0].series:
        series.resolution = picture.resolution or series.resolution
    if picture.part is not None:
        project.rocks[0].region, project.rocks[0].base_elevation = picture.part
    model = build(project, cells="blocks")
    samples = section_samples(model, model.section(*picture.plane), picture.size)
    realizer = Realizer(model, seed=1)
    blocks, sections = [], []
    for number in range(picture.realizations):
        realization = realizer.realization(number)
        blocks.append(realization.block_at(samples.places))
        sections.append(realization.section(*picture.plane))
    names = [block.name for block in model.blocks]
    shares = [(np.array(blocks) == number).mean(axis=0) for number in range(len(names))]
    probabilities = Probabilities(names, np.stack(shares, axis=1))
    drawing = draw_probabilities(samples, probabilities, picture.exaggeration)
    last = max(n for n, item in enumerate(drawing.items) if item.layer == "Cells") + 1
    above = Drawing(drawing.width, drawing.height)
    for section in sections:
        for block in np.unique(section.block)[:-1].tolist():  # what lies on the youngest is the ground
            for ring in block_outlines(section, flattened(section), block):
                above.polygon([on_paper(drawing, ring, picture)], None, CLOUD, 0.5)
    holes = list(boreholes(model, picture))
    for y, top, bottom in holes:
        above.line(on_paper(drawing, np.array([[y, top], [y, bottom]]), picture), width=2.2)
    drawing.items[last:last] = above.items
    add_legend(drawing, picture, bool(holes))
    save_drawing(drawing, path)


def add_legend(drawing, picture, has_boreholes):
    """What lines mean, below the legend of the blocks."""
    *_, last = (item for item in drawing.items if isinstance(item, Text) and item.layer == "Legend")
    x, y = last.x - 18.0, last.y - 6.0
    drawing.width += 20.0
    lines = [
        ((0.1, 0.1, 0.1, 0.5), 0.5, f"{picture.realizations} realizations"),
        ((0.0, 0.0, 0.0), 1.0, "interpolated"),
        ((0.0, 0.0, 0.0), 2.2, "boreholes"),
    ]
    for color, width, text in lines if has_boreholes else lines[:2]:
        y -= 12.0
        drawing.line([(x, y + 2.7), (x + 13.0, y + 2.7)], color, width)
        drawing.text(last.x, y, text, last.size)


def on_paper(drawing, places, picture):
    """(N, 2) points of the page of distances and heights."""
    return np.asarray(drawing.origin) + places * drawing.scale * np.array([1.0, picture.exaggeration])


def boreholes(model, picture):
    """(distance, top, bottom) of those near a plane across x."""
    collars = picture.sample / "collars.csv"
    if not collars.exists():
        return
    with collars.open() as file:
        for row in csv.DictReader(file):
            x, y = float(row["x"]), float(row["y"])
            if abs(x - picture.plane[0][0]) < NEAR:
                rock = next(i for i in model.borehole(x, y) if model.blocks[i.block].name == "Bedrock")
                yield y, float(row["z"]), rock.top


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "images"
    for name, picture in PICTURES.items():
        draw(picture, folder / f"{name}.png")
