# SPDX-License-Identifier: GPL-3.0-or-later
"""Ground investigations of sites whose rock is known, as AGS 3 and 4 files like those of contractors."""

from dataclasses import dataclass

import numpy as np

# code, what a log says, the mean thickness and how much it varies
ROCKS = (
    ("LC", "Stiff fissured dark grey CLAY (LONDON CLAY FORMATION)", 0, 0),
    ("RTD", "Dense orange brown sandy GRAVEL, 20% cobbles (RIVER TERRACE DEPOSITS)", 4, 6),
    ("PEAT", 'Spongy dark brown ""fibrous"" PEAT', 0.3, 1.5),
    ("ALV", "Soft grey silty CLAY (ALLUVIUM)", 2.5, 4),
    ("BRK", "Firm brown sandy CLAY (BRICKEARTH)", 0.5, 2),
    ("MG", "MADE GROUND: brick, concrete and ash in sand", 0.8, 1.4),
)
EAST, NORTH = 531_480.25, 180_210.5  # of the National Grid


@dataclass(frozen=True)
class Site:
    """logs: the intervals of each hole from above, (top, base, code). places: x, y, height of the ground."""

    places: dict[str, tuple[float, float, float]]
    logs: dict[str, list[tuple[float, float, str]]]

    @property
    def codes(self) -> set[str]:
        return {code for log in self.logs.values() for _, _, code in log}


def random_site(seed: int, lenses: bool = False) -> Site:
    """Units of which most end within the site, in holes of different depths. lenses: sand in the clay."""
    rng = np.random.default_rng(seed)
    used = [n for n in range(len(ROCKS)) if n == 0 or rng.random() < 0.8]
    waves = rng.uniform(-0.03, 0.03, (len(ROCKS), 2))
    phases = rng.uniform(0, 6.3, len(ROCKS))
    places, logs = {}, {}
    for number in range(rng.integers(4, 16)):
        x, y = rng.uniform((0, 0), (250, 160)).round(2)
        level, tops = -8 + 2 * np.sin(0.02 * x + phases[0]), {}
        for n in used:
            _, _, mean, range_ = ROCKS[n]
            level += max(0.0, mean + range_ * np.sin(waves[n] @ (x, y) + phases[n]))
            tops[ROCKS[n][0]] = level
        ground = round(level, 2)
        hole = f"BH{number + 1:02d}" + ("A" if rng.random() < 0.1 else "")
        places[hole] = (EAST + x, NORTH + y, ground)
        end, depth, log = rng.choice([6.0, 10.45, 15.0, 25.0]), 0.0, []
        below = [*list(tops.values())[-2::-1], -np.inf]
        for code, top in zip(reversed(tops), below, strict=True):
            base = round(min(end, ground - top), 2)
            if base - depth >= 0.1:
                log.append((depth, base, code))
                depth = base
        if lenses and log[-1][2] == "LC" and log[-1][1] - log[-1][0] > 3 and rng.random() < 0.3:
            top, base, _ = log.pop()
            log += [(top, top + 1, "LC"), (top + 1, top + 1.5, "SAND"), (top + 1.5, base, "LC")]
        logs[hole] = [(round(top, 2), round(base, 2), code) for top, base, code in log]
    return Site(places, logs)


def quoted(*rows):
    return "".join(",".join(f'"{entry}"' for entry in row) + "\r\n" for row in rows)


_WORDS = {code: words for code, words, _, _ in ROCKS} | {"SAND": "Dense grey fine SAND", "": ""}


def ags4(site: Site, grid: str = "OSGB") -> str:
    """As AGS 4.1: with the groups that each file has, and abbreviations, units and types."""
    groups = {
        "PROJ": (("PROJ_ID", "", "ID"), ("PROJ_NAME", "", "X"), ("PROJ_MEMO", "", "X")),
        "TRAN": (("TRAN_ISNO", "", "X"), ("TRAN_DATE", "yyyy-mm-dd", "DT"), ("TRAN_AGS", "", "X")),
        "ABBR": (("ABBR_HDNG", "", "X"), ("ABBR_CODE", "", "X"), ("ABBR_DESC", "", "X")),
        "TYPE": (("TYPE_TYPE", "", "X"), ("TYPE_DESC", "", "X")),
        "UNIT": (("UNIT_UNIT", "", "X"), ("UNIT_DESC", "", "X")),
        "LOCA": (
            *(("LOCA_ID", "", "ID"), ("LOCA_TYPE", "", "PA"), ("LOCA_STAT", "", "PA")),
            *(("LOCA_NATE", "m", "2DP"), ("LOCA_NATN", "m", "2DP"), ("LOCA_GREF", "", "PA")),
            *(("LOCA_GL", "m", "2DP"), ("LOCA_REM", "", "X"), ("LOCA_FDEP", "m", "2DP")),
            *(("LOCA_LOCX", "m", "2DP"), ("LOCA_LOCY", "m", "2DP"), ("LOCA_LAT", "", "DMS")),
        ),
        "HDPH": (
            *(("LOCA_ID", "", "ID"), ("HDPH_TOP", "m", "2DP"), ("HDPH_BASE", "m", "2DP")),
            *(("HDPH_TYPE", "", "PA"), ("HDPH_CREW", "", "X")),
        ),
        "GEOL": (
            *(("LOCA_ID", "", "ID"), ("GEOL_TOP", "m", "2DP"), ("GEOL_BASE", "m", "2DP")),
            *(("GEOL_DESC", "", "X"), ("GEOL_LEG", "", "PA"), ("GEOL_GEOL", "", "PA")),
            ("GEOL_STAT", "", "X"),
        ),
        "SAMP": (("LOCA_ID", "", "ID"), ("SAMP_TOP", "m", "2DP"), ("SAMP_TYPE", "", "PA")),
    }
    ends = {hole: log[-1][1] for hole, log in site.logs.items()}
    rows = {
        "PROJ": [("G1234", "Lea Bridge, Plot 7", "")],
        "TRAN": [("1", "2026-03-02", "4.1.1")],
        "ABBR": [("GEOL_GEOL", code, _WORDS[code].rpartition("(")[2]) for code in sorted(site.codes)],
        "TYPE": [
            ("2DP", "Value; 2 decimal places"),
            ("ID", "Unique identifier"),
            ("PA", "Text listed in ABBR"),
        ],
        "UNIT": [("m", "metre"), ("yyyy-mm-dd", "year month day")],
        "LOCA": [
            (
                hole,
                "CP",
                "FINAL",
                f"{x:.2f}",
                f"{y:.2f}",
                grid,
                f"{z:.2f}",
                "",
                f"{ends[hole]:.2f}",
                "",
                "",
                "",
            )
            for hole, (x, y, z) in site.places.items()
        ],
        "HDPH": [(hole, "0.00", f"{end:.2f}", "CP", "JB") for hole, end in ends.items()],
        "GEOL": [
            (hole, f"{top:.2f}", f"{base:.2f}", _WORDS[code], str(200 + len(code)), code, "")
            for hole, log in site.logs.items()
            for top, base, code in log
        ],
        "SAMP": [(hole, "1.00", "B") for hole in site.logs],
    }
    return "\r\n".join(
        quoted(
            ("GROUP", name),
            ("HEADING", *(heading for heading, _, _ in headings)),
            ("UNIT", *(unit for _, unit, _ in headings)),
            ("TYPE", *(kind for _, _, kind in headings)),
            *(("DATA", *row) for row in rows[name]),
        )
        for name, headings in groups.items()
    )


def ags3(site: Site) -> str:
    """As AGS 3.1: headings over several lines, and texts that are continued."""
    layers = []
    for hole, log in site.logs.items():
        for top, base, code in log:
            words = _WORDS[code]
            layers += [
                (hole, f"{top:.2f}", f"{base:.2f}", words[:9], "220", code),
                ("<CONT>", "", "", words[9:], "", ""),
            ]
    locations = [
        (hole, "CP", f"{x:.2f}", f"{y:.2f}", f"{z:.2f}", f"{site.logs[hole][-1][1]:.2f}")
        for hole, (x, y, z) in site.places.items()
    ]
    return "\r\n".join(
        quoted(*rows)
        for rows in (
            (
                ("**PROJ",),
                ("*PROJ_ID", "*PROJ_NAME", "*PROJ_GRID", "*PROJ_AGS"),
                ("G1234", "Plot 7", "OSGB", "3.1"),
            ),
            (
                ("**ABBR",),
                ("*ABBR_HDNG", "*ABBR_CODE", "*ABBR_DESC"),
                ("HOLE_TYPE", "CP", "Cable percussion"),
            ),
            (
                ("**HOLE",),
                ("*HOLE_ID", "*HOLE_TYPE", "*HOLE_NATE", "*HOLE_NATN"),
                ("*HOLE_GL", "*HOLE_FDEP"),
                ("<UNITS>", "", "m", "m", "m", "m"),
                *locations,
            ),
            (
                ("**GEOL",),
                ("*HOLE_ID", "*GEOL_TOP", "*GEOL_BASE", "*GEOL_DESC", "*GEOL_LEG", "*GEOL_GEOL"),
                ("<UNITS>", "m", "m", "", "", ""),
                *layers,
            ),
        )
    )
