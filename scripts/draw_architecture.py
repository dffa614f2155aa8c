#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws docs/images/architecture.svg: the parts, who may know whom, and how a stack is built.

    python3 scripts/draw_architecture.py

Needs Python only; the same bytes on every run.
"""

import textwrap
from pathlib import Path

from svg_drawing import BLUE, CREAM, GREY, INK, PALE, RED, SAND, STONE, Drawing

OUTPUT = Path(__file__).resolve().parent.parent / "docs" / "images" / "architecture.svg"
WIDTH, HEIGHT = 1476, 850

# (x, y, width, height), name, what it holds (| parts the lines), colour
PARTS = (
    ((0, 58, 150, 56), "build_model.py", "command line", PALE),
    ((170, 58, 220, 56), "operators, ui", "the panel in the sidebar", PALE),
    (
        (0, 160, 390, 72),
        "addon/realmodel/bl",
        "alone knows bpy: scene, materials, origin, picture,|every difference between Blender's versions",
        CREAM,
    ),
    (
        (0, 278, 390, 90),
        "addon/realmodel/core",
        "NumPy only: project file, library, readers, heights,"
        "|build, model arrays, writers (.npz, .vtu, report),"
        "|progress, errors in the user's names",
        CREAM,
    ),
    ((0, 414, 390, 56), "native/bindings", "realmodel._native: arrays without copies, GIL released", PALE),
    ((0, 516, 84, 104), "strata", "repair, tile,|overlay,|conform,|cells", SAND),
    ((94, 516, 84, 104), "cutting", "and shells,|validation:|finished|models", SAND),
    ((188, 516, 84, 104), "meshing", "outlines,|planar|meshes|(CGAL)", SAND),
    ((282, 516, 108, 104), "interpolation", "variogram,|kriging, dsi|(Eigen, CGAL)", SAND),
    ((0, 666, 122, 72), "exact", "all exact|arithmetic (GMP)", SAND),
    ((134, 666, 122, 72), "arrangement", "triangles|in any position", SAND),
    ((268, 666, 122, 72), "spatial", "what is near|(nanoflann)", SAND),
    ((0, 764, 390, 56), "base", "errors, progress, memory, parallel loops, sorts, tables", STONE),
)


def draw_parts(drawing):
    """Left: the parts; an arrow goes to what a part may know."""
    drawing.at(30, 0)
    drawing.text(0, 38, "Parts, and who may know whom", 16, bold=True)
    for (x, y, width, height), name, holds, fill in PARTS:
        drawing.rect(x, y, width, height, fill)
        drawing.text(x + 10, y + 19, name, 13.5, bold=True)
        drawing.lines_of_text(x + 10, y + 37, holds.split("|"), 11.5)

    def arrow(*points):
        drawing.path(points, end="ink")

    arrow((75, 114), (75, 158))
    arrow((280, 114), (280, 158))
    arrow((195, 232), (195, 276))
    # build_model.py knows core too, past bl
    arrow((0, 86), (-14, 86), (-14, 320), (-2, 320))
    arrow((195, 368), (195, 412))
    for x in (42, 136, 230, 336):
        arrow((x, 470), (x, 514))
    arrow((42, 620), (42, 664))
    arrow((115, 620), (80, 664))
    arrow((150, 620), (180, 664))
    arrow((210, 620), (108, 664))
    arrow((250, 620), (300, 664))
    arrow((345, 620), (345, 664))
    arrow((134, 702), (124, 702))
    arrow((256, 702), (266, 702))
    arrow((290, 738), (290, 750), (95, 750), (95, 740))
    for x in (61, 195, 329):
        arrow((x, 738), (x, 762))


# --- the six steps

PANEL_W, PANEL_H = 324, 374
CAPTIONS = {
    1: """A surface covers part of the plan with triangles. Void triangles fill the rest of a frame around all
    input, so every position lies in one polygon of every tiling. Two heights at one position are refused
    here. Where a rule does not cut, the surface is first raised to the top, or the protected floor, that
    it meets.""",
    2: """E is the lower envelope of the surfaces seen so far and begins as the youngest. Where the next older
    one, S, lies below E, cells close between the two and S becomes the envelope. Elsewhere S was eroded
    away and E stays. Nothing that was built is cut again.""",
    3: """A facet of E over the triangles of S: convex pieces, cut where the two planes are equally high
    (red). Every question is on which side of one line two others cross: the sign of a 3 x 3 determinant
    that comes straight from the input, in whole numbers where doubles cannot tell.""",
    4: """Crossings at one position become one plan vertex, however many lines meet there; edges on one
    line are collected with its vertices in order. A face takes up every vertex on its edges (red), so that
    neighbors that were cut apart share their corners.""",
    5: """Above a line stand the edges of the faces on its left and right. Sorted by height, each two
    neighbors bound one wall if the cells left and right of it differ. Where heights cross (red) the
    line gets one more vertex, and steps 4 and 5 run again.""",
    6: """Every position and every height becomes the nearest double, the same however it was named. Those
    that fall together take neighboring doubles, heights in their order. Cells, faces and walls are already
    decided: rounding changes no neighbor. Volumes are summed last.""",
}


def panel(drawing, number, title, caption):
    """The frame of one step; what follows is placed in its picture, 258 x 200."""
    column, row = (number - 1) % 3, (number - 1) // 3
    x, y = 462 + column * (PANEL_W + 10), 58 + row * (PANEL_H + 16)
    drawing.at(x, y)
    drawing.rect(0, 0, PANEL_W, PANEL_H, "white", "#cfcac4")
    drawing.add(f'<circle cx="{x + 20}" cy="{y + 20}" r="12" fill="{BLUE}"/>')
    drawing.text(20, 25, str(number), 13, bold=True, fill="white", anchor="middle")
    drawing.text(40, 25, title, 14, bold=True)
    drawing.lines_of_text(16, 268, textwrap.wrap(" ".join(caption.split()), 47), 11)
    drawing.at(x + 33, y + 46)


def clipped(polygon, line):
    """What of a convex polygon lies where a x + b y + c >= 0."""
    a, b, c = line
    value = [a * x + b * y + c for x, y in polygon]
    result = []
    for i, p in enumerate(polygon):
        j = (i + 1) % len(polygon)
        if value[i] >= 0:
            result.append(p)
        if value[i] * value[j] < 0:
            t = value[i] / (value[i] - value[j])
            q = polygon[j]
            result.append((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
    return result


def left_of(p, q):
    """The line through two points, positive where a clockwise polygon on the page has its inside."""
    return (p[1] - q[1], q[0] - p[0], p[0] * q[1] - q[0] * p[1])


def intersection(polygon, window):
    for i, p in enumerate(window):
        polygon = clipped(polygon, left_of(p, window[(i + 1) % len(window)]))
    return polygon


def draw_tiling(d):
    panel(d, 1, "Surfaces tile the frame", CAPTIONS[1])
    corner = dict(zip("ABCD", [(4, 4), (254, 4), (254, 192), (4, 192)], strict=True))
    corner |= zip("abcdef", [(70, 50), (140, 34), (205, 72), (196, 140), (120, 164), (62, 118)], strict=True)
    corner |= {"m": (112, 92), "n": (152, 100)}
    for fill, triangles in (
        (PALE, "Aaf ABb Aba Bcb BCc Cdc Ced CDe Dfe DAf"),
        (SAND, "abm bnm bcn cdn den emn efm fam"),
    ):
        for triangle in triangles.split():
            d.polygon([corner[name] for name in triangle], fill, "#b8b2aa" if fill == PALE else INK)
    d.polygon([corner[name] for name in "ABCD"], "none", INK, 2)
    d.text(20, 184, "void", 11.5, fill=GREY)
    d.text(204, 172, "surface", 11.5)
    d.path([(212, 161), (186, 132)], INK, 1, end="ink")


def crossing(a, b, c, d):
    """Where the line a b over an interval crosses the line c d over the same interval."""
    t = (a[1] - c[1]) / ((a[1] - c[1]) - (b[1] - d[1]))
    return (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]))


def draw_overlay(d):
    panel(d, 2, "Overlay, youngest first", CAPTIONS[2])
    xs = [0, 26, 52, 78, 104, 130, 156, 182, 208, 234, 258]
    e = list(zip(xs, [64, 56, 50, 58, 84, 112, 118, 100, 72, 60, 58], strict=True))
    s = list(zip(xs, [132, 126, 116, 104, 96, 92, 94, 102, 116, 124, 126], strict=True))
    west, east = crossing(e[4], e[5], s[4], s[5]), crossing(e[6], e[7], s[6], s[7])
    d.polygon([*e[:5], west, *s[4::-1]], SAND, "none")
    d.polygon([east, *e[7:], *s[:6:-1]], SAND, "none")
    for i in (1, 2, 3, 4, 7, 8, 9):
        d.path([e[i], s[i]], "white", 1.2)
    d.path(e, INK, 2)
    d.path([*s[:5], west], INK, 1.5)
    d.path([east, *s[7:]], INK, 1.5)
    d.path([west, *s[5:7], east], INK, 1.3, "4 4")
    d.path([(x, y + 5) for x, y in (*s[:5], west, *e[5:7], east, *s[7:])], RED, 2.6)
    d.text(4, 44, "E", 13, bold=True)
    d.text(112, 84, "S, eroded", 11.5)
    d.text(22, 94, "cells", 11.5)
    d.text(212, 98, "cells", 11.5)
    d.text(56, 168, "the envelope from here on", 11.5, fill=RED)
    d.path([(130, 155), (136, 126)], RED, 1, end="red")


def draw_facet(d):
    panel(d, 3, "One facet at a time", CAPTIONS[3])
    facet = [(36, 36), (226, 22), (238, 150), (96, 182)]
    a, b, c, e, g = (10, 96), (118, 4), (150, 108), (256, 74), (120, 204)
    h, k = (4, 8), (252, 4)
    triangles = [(h, b, a), (a, b, c), (b, e, c), (b, k, e), (a, c, g), (c, e, g), (e, (252, 200), g)]
    trace = (-0.55, -1.0, 164.0)
    for t in triangles:
        common = intersection(facet, t)
        if len(common) < 3:
            continue
        below, above = clipped(common, tuple(-v for v in trace)), clipped(common, trace)
        if len(below) > 2:
            d.polygon(below, SAND, "white", 1.4)
        if len(above) > 2:
            d.polygon(above, PALE, "white", 1.4)
    for t in triangles:
        d.polygon(t, "none", "#a9a39b", 0.9)
    d.polygon(facet, "none", INK, 2)
    ends = [(x, (164 - 0.55 * x)) for x in (39.5, 231)]
    d.path(ends, RED, 2.4)
    d.text(66, 70, "E stays", 11.5)
    d.text(128, 146, "S below: a cell", 11.5)


def draw_collinear_edges(d):
    panel(d, 4, "Plan vertices, collinear edges", CAPTIONS[4])
    x0, y0, x1, y1 = 128, 10, 128, 194
    vertices = [10, 62, 104, 150, 194]
    for lo, hi, far in ((10, 62, 22), (62, 150, 40), (150, 194, 30)):
        d.polygon([(x0, lo), (far, lo + 4), (far - 14, hi - 6), (x0, hi)], CREAM, INK, 1.2)
    for lo, hi, far in ((10, 104, 226), (104, 194, 236)):
        d.polygon([(x1, lo), (far, lo + 8), (far + 12, hi - 10), (x1, hi)], SAND, INK, 1.2)
    d.path([(x0, y0 - 8), (x1, y1 + 8)], BLUE, 2.6)
    for number, y in enumerate(vertices):
        d.dot((128, y), BLUE if number in (0, 4) else RED, 4.5)
    d.text(138, 46, "line", 11.5, fill=BLUE)
    d.text(138, 66, "added right", 11, fill=RED)
    d.text(138, 154, "added right", 11, fill=RED)
    d.text(118, 108, "added left", 11, fill=RED, anchor="end")


def draw_walls(d):
    panel(d, 5, "Conformed faces, walls", CAPTIONS[5])
    xs = [10, 88, 146, 248]
    left = list(zip(xs, [40, 52, 61, 77], strict=True))
    right = list(zip(xs, [82, 70, 61, 45], strict=True))
    base = list(zip(xs, [176, 170, 166, 158], strict=True))
    d.polygon([*left[:3], right[1], right[0]], CREAM, "none")
    d.polygon([left[2], left[3], right[3]], SAND, "none")
    d.polygon([*right[:3], left[3], *base[::-1]], PALE, "none")
    for x in xs:
        d.path([(x, 22), (x, 196)], RED if x == 146 else "#b8b2aa", 1.2, "3 3")
    d.path(left, INK, 2)
    d.path(right, BLUE, 2)
    d.path(base, INK, 1.6)
    for point in (*left, *right, *base):
        d.dot(point, RED if point == right[2] else INK, 3.4)
    d.text(16, 32, "top of the left cells", 11.5)
    d.text(172, 34, "of the right", 11.5, fill=BLUE)
    d.text(16, 65, "left | none", 11)
    d.text(184, 65, "none | right", 11)
    d.text(18, 124, "left | right: a wall, unless", 11)
    d.text(18, 139, "both are the same cell", 11)


def draw_rounding(d):
    panel(d, 6, "Round once, at the end", CAPTIONS[6])
    doubles = [190, 154, 118, 82, 46, 10]
    for y in doubles:
        d.path([(20, y), (248, y)], "#d5d0c9", 1)
    d.text(252, 16, "doubles", 11, fill=GREY, anchor="end")
    for x in (76, 190):
        d.path([(x, 4), (x, 200)], INK, 1.4)
    exact = [184, 127, 111, 53, 14]
    to = [190, 118, 82, 46, 10]
    for y, z in zip(exact, to, strict=True):
        d.dot((76, y), RED, 4)
        d.path([(84, y), (182, z)], RED, 1.2, end="red")
        d.dot((190, z), BLUE, 4.5)
    d.text(30, 40, "exact", 11.5, fill=RED)
    d.text(200, 40, "rounded", 11.5, fill=BLUE)
    d.text(200, 100, "the next", 11, fill=GREY)


def drawing():
    """The whole drawing."""
    whole = Drawing(WIDTH, HEIGHT, "draw_architecture.py")
    draw_parts(whole)
    whole.at(462, 0)
    whole.text(0, 38, "How strata builds a stack, from the youngest surface down", 16, bold=True)
    for draw in (draw_tiling, draw_overlay, draw_facet, draw_collinear_edges, draw_walls, draw_rounding):
        draw(whole)
    return whole


if __name__ == "__main__":
    OUTPUT.write_text(drawing().svg(), encoding="utf-8")
    print(OUTPUT)
