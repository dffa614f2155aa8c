#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the pictures of docs/dev/algorithm.md: docs/images/algorithm_*.svg.

    python3 scripts/draw_algorithm.py

Needs Python only; the same bytes on every run.
"""

import math
import textwrap
from pathlib import Path

from svg_drawing import BLUE, CREAM, GRAY, INK, PALE, RED, SAND, STONE, Drawing

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "images"
PANEL, GAP, CAPTION = 330, 18, 236  # width of a panel, between two, and where its caption begins


def picture(panels):
    """A picture of several panels, each (title, draw, caption)."""
    captions = [textwrap.wrap(caption, 50) for _, _, caption in panels]
    height = CAPTION + 56 + 16 * max(len(lines) for lines in captions)
    whole = Drawing(len(panels) * (PANEL + GAP) + GAP, height, "draw_algorithm.py")
    for number, (title, draw, _) in enumerate(panels):
        left = GAP + number * (PANEL + GAP)
        whole.at(left, GAP)
        whole.rect(0, 0, PANEL, height - 2 * GAP, "white", "#cfcac4")
        whole.text(14, 24, title, 14, bold=True)
        whole.lines_of_text(14, CAPTION + 18, captions[number], 11.5)
        whole.at(left + 15, GAP + 40)
        draw(whole)
    return whole


def middle(*points):
    """The mean of some points."""
    return tuple(sum(p[axis] for p in points) / len(points) for axis in (0, 1))


# --- the border of a cover (300 x 190)

CORNERS = dict(zip("ABCD", [(2, 2), (298, 2), (298, 188), (2, 188)], strict=True))
CORNERS |= zip("abcdef", [(70, 46), (170, 26), (244, 70), (232, 142), (136, 172), (58, 124)], strict=True)
CORNERS |= zip("pqr", [(126, 84), (186, 84), (150, 122)], strict=True)
RING = ["abp", "bqp", "bcq", "cdq", "drq", "der", "efr", "fpr", "fap"]
AROUND = ["Aaf", "ABb", "Aba", "Bcb", "BCc", "Cdc", "Ced", "CDe", "Dfe", "DAf"]
OUTLINES = ("abcdef", "prq")  # the surface lies to one side of both


def corners(names):
    return [CORNERS[name] for name in names]


def draw_border(d):
    for names in RING:
        points = corners(names)
        for i in range(3):
            d.polygon([points[i - 1], points[i], middle(*points)], SAND, "#8f5f4d", 0.7)
    for outline in OUTLINES:
        for i, name in enumerate(outline):
            d.path([CORNERS[outline[i - 1]], CORNERS[name]], RED, 2.4)
            x, y = middle(CORNERS[outline[i - 1]], CORNERS[name])
            center = middle(*corners(outline))
            away = 15 if outline == OUTLINES[0] else 17
            share = away / math.hypot(x - center[0], y - center[1])
            x, y = x + share * (x - center[0]), y + share * (y - center[1])
            if outline != OUTLINES[0]:
                d.rect(x - 9, y - 6, 18, 12, SAND, SAND)  # no lines behind the letters
            d.text(x, y + 4, "+1", 11, bold=True, fill=RED, anchor="middle")
    d.text(4, 14, "inner edges: 1 - 1 = 0", 11.5, fill=GRAY)


def draw_winding(d):
    for names, covered in [(n, 0) for n in AROUND] + [(n, 1) for n in RING] + [("prq", 0)]:
        points = corners(names)
        d.polygon(points, SAND if covered else PALE, "#8a8378", 0.8)
        x, y = middle(*points)
        d.text(x, y + 4, str(covered), 11.5, bold=covered == 1, anchor="middle")
    for outline in OUTLINES:
        d.polygon(corners(outline), "none", RED, 2)
    d.polygon(corners("ABCD"), "none", INK, 2)
    steps = [middle(*corners(names)) for names in ("DAf", "Aaf", "fap", "fpr")]
    steps = [(8, 96), *[(x, y + 10) for x, y in steps[1:3]], (148, 103)]
    d.path([steps[0], (60, 92), (100, 102), steps[3]], BLUE, 1.6, end="ink")


# --- record lows and groups (300 x 190)

STEP = 47  # of the kinks, so that names of surfaces fit beside them
AT = [STEP * i for i in range(7)]
SURFACES = (  # heights down the page, oldest first
    ("S0", [160, 156, 158, 150, 154, 150, 152]),
    ("S1", [112, 98, 116, 128, 108, 110, 124]),
    ("S2", [66, 74, 122, 144, 92, 60, 72]),
    ("S3", [22, 30, 34, 44, 52, 120, 138]),
)
FILLS = (STONE, SAND, CREAM, PALE)


def at(heights, x):
    i = min(int(x // STEP), len(AT) - 2)
    share = (x - AT[i]) / STEP
    return heights[i] + share * (heights[i + 1] - heights[i])


def stations():
    """The kinks of all surfaces and where two of them cross."""
    found = {float(x) for x in AT}
    for i in range(len(AT) - 1):
        for k, (_, s) in enumerate(SURFACES):
            for _, t in SURFACES[:k]:
                before, after = s[i] - t[i], s[i + 1] - t[i + 1]
                if before * after < 0:
                    found.add(AT[i] + STEP * before / (before - after))
    return sorted(found)


def draw_record_lows(d):
    xs = stations()
    bottom = [(x, 186.0) for x in xs]
    envelopes = []
    for k in range(len(SURFACES)):
        # down the page is down in the rock: the lowest surface is the largest number
        envelopes.append([(x, max(at(s, x) for _, s in SURFACES[k:])) for x in xs])
    for k, (name, heights) in enumerate(SURFACES):
        under = envelopes[k - 1] if k > 0 else bottom
        for i in range(len(xs) - 1):
            quad = [envelopes[k][i], envelopes[k][i + 1], under[i + 1], under[i]]
            if max(quad[3][1] - quad[0][1], quad[2][1] - quad[1][1]) > 0.01:
                d.polygon(quad, FILLS[k], "white", 1)
        d.path(list(zip(AT, heights, strict=True)), GRAY, 1, "4 3")
        d.text(AT[-1] + 4, heights[-1] + 4, name, 10.5, fill=GRAY)
    for envelope in envelopes:
        d.path(envelope, INK, 1.6)
    d.text(16, 54, "block 3", 11)
    d.text(16, 94, "block 2", 11)
    d.text(16, 136, "block 1", 11)
    d.text(16, 178, "block 0", 11)


def outlined(d, points, fill):
    d.polygon(points, fill, "white", 1.2)


def draw_groups(d):
    d.polygon([(6, 10), (94, 4), (98, 82), (10, 90)], SAND, INK, 1.8)
    d.path([(6, 50), (50, 46), (98, 60)], "white", 1.4)
    d.path([(50, 46), (60, 6.5)], "white", 1.4)
    d.text(52, 108, "S is continuous", 11, anchor="middle")
    d.text(52, 122, "one cell", 11, bold=True, anchor="middle")

    d.polygon([(116, 10), (160, 7), (160, 86), (120, 90)], SAND)
    d.polygon([(160, 7), (204, 4), (208, 82), (160, 86)], CREAM)
    d.polygon([(116, 10), (204, 4), (208, 82), (120, 90)], "none", INK, 1.8)
    d.path([(160, 7), (160, 86)], BLUE, 2.6)
    d.text(162, 108, "S has a step", 11, anchor="middle")
    d.text(162, 122, "two cells", 11, bold=True, anchor="middle")

    # a ring around what stays, which touches itself where the hole reaches the border
    outlined(d, [(226, 8), (262, 6), (244, 56), (228, 88)], SAND)
    outlined(d, [(228, 88), (244, 56), (280, 56), (298, 84)], CREAM)
    outlined(d, [(262, 6), (296, 4), (298, 84), (280, 56)], STONE)
    d.polygon([(226, 8), (296, 4), (298, 84), (228, 88)], "none", INK, 1.8)
    d.dot((262, 6), RED, 4.5)
    d.text(262, 40, "E", 10, anchor="middle", fill=GRAY)
    d.text(262, 52, "stays", 9, anchor="middle", fill=GRAY)
    d.text(262, 108, "cell touches itself", 11, anchor="middle")
    d.text(262, 122, "each alone", 11, bold=True, anchor="middle")

    # a cell of two pieces in section
    d.polygon([(20, 142), (280, 134), (280, 178), (150, 186), (20, 166)], SAND, INK, 1.4)
    d.path([(150, 138), (150, 186)], "white", 1.4, "3 3")
    d.text(150, 162, "one plane above, planes of S below", 10.5, anchor="middle")


# --- walls (300 x 190)


def draw_columns(d):
    xs = [10, 90, 170, 290]
    left = ([30, 34, 42, 54], [92, 96, 104, 112], [172, 170, 168, 165])
    right = ([58, 50, 42, 30], [92, 96, 122, 140], [172, 170, 168, 165])

    def curve(heights):
        return list(zip(xs, heights, strict=True))

    def wall(upper, lower, begin, end, fill):
        d.polygon([*upper[begin : end + 1], *lower[begin : end + 1][::-1]], fill, "white", 1.2)

    l_top, l_mid, base = map(curve, left)
    r_top, r_mid, _ = map(curve, right)
    wall(l_top, r_top, 0, 2, CREAM)  # a | outside
    wall(r_top, l_top, 2, 3, STONE)  # outside | a'
    wall(r_top, l_mid, 0, 2, SAND)
    wall(l_top, l_mid, 2, 3, SAND)
    wall(l_mid, r_mid, 1, 3, PALE)
    for x in xs:
        d.path([(x, 14), (x, 186)], RED if x == 170 else "#a9a39b", 1.1, "3 3")
    for line in (l_top, l_mid, base):
        d.path(line, INK, 1.9)
    for line in (r_top, r_mid):
        d.path(line, BLUE, 1.9)
    for line in (l_top, l_mid, base, r_top, r_mid):
        for point in line:
            d.dot(point, RED if point == l_top[2] else INK, 3.4)
    d.text(28, 47, "a | outside", 10.5)
    d.text(222, 46, "outside | a'", 10.5)
    d.text(60, 80, "a | a'", 10.5)
    d.text(212, 88, "a | a'", 10.5)
    d.text(206, 122, "b | a'", 10.5)
    d.text(97, 148, "b | b: no wall", 10.5)
    d.text(12, 24, "left", 11, bold=True)
    d.text(40, 24, "right", 11, bold=True, fill=BLUE)


def draw_around(d):
    center, radius = (92, 96), 78
    ends = [-20, 75, 150, 250]  # degrees, on the page
    fills, names = (SAND, CREAM, PALE, STONE), ("A", "B", "outside", "C")

    def on_circle(angle, r=radius):
        a = math.radians(angle)
        return (center[0] + r * math.cos(a), center[1] + r * math.sin(a))

    for i, begin in enumerate(ends):
        end = ends[i + 1] if i + 1 < len(ends) else ends[0] + 360
        arc = [on_circle(begin + (end - begin) * k / 12) for k in range(13)]
        outlined(d, [center, *arc], fills[i])
        x, y = on_circle((begin + end) / 2, 46)
        d.text(x, y + 4, names[i], 11.5, anchor="middle")
    for angle in ends:
        d.path([center, on_circle(angle)], INK, 2)
    d.dot(center, RED, 5)
    d.text(92, 190, "around a vertical edge, in plan", 10.5, anchor="middle")

    x = 250
    d.polygon([(190, 40), (x, 30), (x, 160), (190, 168)], SAND, INK, 1.2)
    d.polygon([(x, 66), (298, 74), (298, 140), (x, 130)], CREAM, INK, 1.2)
    for y in (30, 66, 98, 130, 160):
        d.dot((x, y), RED, 4)
    d.text(257, 99, "another", 10)
    d.text(257, 111, "height", 10)
    d.text(244, 190, "along the edge", 10.5, anchor="middle")


# --- blocks without columns (300 x 190)

ENVELOPE = [(0, 52), (40, 46), (80, 58), (120, 64), (160, 62), (200, 96), (240, 122), (300, 130)]
LOWER = [(0, 112), (50, 120), (100, 110), (150, 92), (190, 76), (230, 70), (300, 62)]


def draw_bounds(d):
    def span(points, i):
        (x0, y0), (x1, y1) = points[i], points[i + 1]
        return x0, min(y0, y1), x1 - x0, abs(y1 - y0)

    colors = {0: BLUE, 1: BLUE, 2: BLUE, 3: RED, 4: RED, 5: GRAY}
    for i, color in colors.items():
        x, y, width, height = span(LOWER, i)
        fill = {BLUE: "#dbe7ef", RED: "#f3d9d6", GRAY: PALE}[color]
        d.rect(x + 1, y - 2, width - 2, round(height + 4, 1), fill, color, "3 2", 0)
    d.path(ENVELOPE, INK, 2)
    for point in ENVELOPE:
        d.dot(point, INK, 2.6)
    for i, color in colors.items():
        d.path(LOWER[i : i + 2], color, 2.2)
    for point in LOWER:
        d.dot(point, INK, 2.6)
    d.text(4, 40, "E", 13, bold=True)
    d.text(4, 102, "S", 13, bold=True)
    d.text(2, 144, "decided: below, stays whole", 11, fill=BLUE)
    d.text(150, 160, "unclear: overlaid exactly", 11, fill=RED)
    d.path([(200, 148), (200, 100)], RED, 1, end="red")
    d.text(300, 54, "decided: removed", 11, fill=GRAY, anchor="end")


def draw_nodes(d):
    tops = [(8, 40), (70, 30), (140, 38), (214, 30), (292, 42)]
    feet = [(8, 150), (104, 160), (180, 148), (292, 158)]
    d.polygon([*tops, *feet[::-1]], SAND, "none")
    d.path(tops, INK, 2)
    d.path(feet, INK, 2)
    above = [middle(tops[i], tops[i + 1]) for i in range(4)]
    below = [middle(feet[i], feet[i + 1]) for i in range(3)]
    upper = [(x, y + 22) for x, y in above]
    lower = [(x, y - 22) for x, y in below]
    d.path(upper, BLUE, 1.6)
    d.path(lower, BLUE, 1.6)
    d.path([upper[1], lower[0]], RED, 2.4)
    for point in (*upper, *lower):
        d.dot(point, BLUE, 5)
    for point in (*tops, *feet):
        d.dot(point, INK, 3)
    d.text(150, 18, "closed facets of E", 11, anchor="middle")
    d.text(150, 184, "triangles of S beneath", 11, anchor="middle")
    d.text(92, 104, "the one exact link", 11, fill=RED)
    d.text(164, 82, "across shared edges", 11, fill=BLUE)


def draw_touched(d):
    step = 38
    columns, rows = 8, 5
    divided = {(3, 1, 0), (3, 1, 1), (3, 2, 0), (4, 2, 0), (4, 2, 1), (3, 2, 1)}
    neighbors = set()

    def beside(c, r, half):
        # each square is cut from its lower left to its upper right corner: 0 above, 1 below
        return (
            [(c, r, 1), (c - 1, r, 1), (c, r - 1, 1)]
            if half == 0
            else [(c, r, 0), (c + 1, r, 0), (c, r + 1, 0)]
        )

    for triangle in divided:
        neighbors.update(beside(*triangle))
    for r in range(rows):
        for c in range(columns):
            x, y = c * step - 2, r * step
            for half in (0, 1):
                points = [(x, y), (x + step, y), (x, y + step)]
                if half == 1:
                    points = [(x + step, y), (x + step, y + step), (x, y + step)]
                fill = "white"
                if c == columns - 1:
                    fill = STONE
                elif (c, r, half) in divided:
                    fill = SAND
                elif (c, r, half) in neighbors:
                    fill = CREAM
                d.polygon(points, fill, "#8a8378", 0.8)
    d.path([(110, 74), (130, 52), (150, 82), (172, 86), (186, 112)], RED, 2.2)
    d.path([(columns * step - 2, 0), (columns * step - 2, rows * step)], INK, 3)


PICTURES = {
    "algorithm_cover": (
        (
            "The border of a surface",
            draw_border,
            "Each triangle counts +1 or -1 at its edges, by the direction. Where two triangles share an "
            "edge, the sum is 0. The other edges are the border (red), with their counts. Inner vertices "
            "are not used.",
        ),
        (
            "Coverage follows from the border",
            draw_winding,
            "The border and the frame are triangulated. Nothing is covered at the frame. Across a border "
            "edge the number changes by the count of the edge. 0 is void. A number other than 0 and 1 is "
            "refused.",
        ),
    ),
    "algorithm_overlay": (
        (
            "Envelopes, youngest first",
            draw_record_lows,
            "The surfaces are dashed. The remainder of a surface lies below all younger ones. The envelope "
            "(solid) is lowered where the next surface is lower. Each block lies between two envelopes.",
        ),
        (
            "Which pieces are one cell",
            draw_groups,
            "The pieces of S under one facet of E: three in plan, one in section. They form one cell where "
            "the cell is thick and S is continuous. Where a joined cell would touch itself, each piece "
            "stays alone.",
        ),
    ),
    "algorithm_walls": (
        (
            "Two columns along one line",
            draw_columns,
            "The line is unrolled, with face edges on its left (black) and right (blue). Between two "
            "levels, one cell lies on each side. If the cells differ, a wall separates them. Where levels "
            "cross (red), the line gets a vertex.",
        ),
        (
            "Why vertical edges close",
            draw_around,
            "Each sector belongs to one cell or to none. The first wall of a cell ends where its last wall "
            "begins. All walls use all vertices of the vertical edge (red), so they share its pieces.",
        ),
    ),
    "algorithm_blocks": (
        (
            "Bounds decide most triangles",
            draw_bounds,
            "In section. A triangle of S that lies below everything younger becomes a facet as it is. A "
            "triangle above is removed. Only triangles that may meet are intersected exactly.",
        ),
        (
            "One block, named from both sides",
            draw_nodes,
            "A node under every closed facet and one over every triangle beneath. Neighbors are linked "
            "(blue), and one point decided exactly links the two sheets (red).",
        ),
        (
            "What gets new vertices",
            draw_touched,
            "In plan. Divided triangles (dark), their neighbors (light), and all triangles in the tiles of "
            "a border (gray) get new vertices. White triangles are unchanged.",
        ),
    ),
}


def drawings():
    """The pictures by file name."""
    return {f"{name}.svg": picture(panels).svg() for name, panels in PICTURES.items()}


if __name__ == "__main__":
    for name, svg in drawings().items():
        (FOLDER / name).write_text(svg, encoding="utf-8")
        print(FOLDER / name)
