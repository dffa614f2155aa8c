# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables, figures and values of docs/validation.md, all of docs/validation.json.

In any document a line `<!-- validation: NAME -->` begins a table, which `<!-- end -->` ends, and
`<!-- value KEY -->...<!-- end -->` is a number in a sentence.
"""

from __future__ import annotations

import json
import math
import re
import statistics
from collections.abc import Callable, Sequence
from pathlib import Path

from svg_drawing import BLUE, GRAY, INK, PALE, RED, Drawing

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "docs" / "validation.json"
PAGE = ROOT / "docs" / "validation.md"
IMAGES = ROOT / "docs" / "images" / "validation"
COLORS = {
    "RealModel": BLUE,
    "GemPy": RED,
    "LoopStructural": "#d08a2e",
    "SciPy RBF": "#5f8f3f",
    "Manifold": RED,
    "planes": GRAY,  # least-squares planes, in tables alone
    "nearest hole": GRAY,
}
FOUR = ("RealModel", "GemPy", "LoopStructural", "SciPy RBF")
KINDS = {
    "near_flat": "near-flat beds with errors",
    "rough": "rough beds, few data",
    "folded": "folds, upright to recumbent",
}
NODDY = {
    "n_upright": "upright folds",
    "n_unconformity": "folds below an unconformity",
    "n_fault": "folds with a fault",
}
_TABLE = re.compile(r"(<!-- validation: ([\w ]+) -->\n).*?(<!-- end -->)", re.DOTALL)
_VALUE = re.compile(r"(<!-- value ([^>]+?) -->)[^\n]*?(<!-- end -->)")


def documents() -> list[Path]:
    """Those that may hold tables and values."""
    return sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])


def written(text: str, data: dict) -> str:
    """A document with the tables and values of the data."""
    tables, numbers = TABLES, values(data)
    text = _TABLE.sub(lambda match: f"{match[1]}{tables[match[2]](data)}{match[3]}", text)
    return _VALUE.sub(lambda match: f"{match[1]}{numbers[match[2]]}{match[3]}", text)


def read() -> dict:
    return json.loads(DATA.read_text(encoding="utf-8"))


def write(data: dict) -> None:
    """Writes the data, the figures, and the tables and values of all documents."""
    DATA.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    IMAGES.mkdir(parents=True, exist_ok=True)
    for name, svg in figures(data).items():
        (IMAGES / name).write_text(svg, encoding="utf-8")
    for path in documents():
        text = path.read_text(encoding="utf-8")
        if (new := written(text, data)) != text:
            path.write_text(new, encoding="utf-8")


def _percent(share: float | None, digits: int = 1) -> str:
    return "refused" if share is None else f"{100 * share:.{digits}f} %"


def _made(shares: Sequence[float | None]) -> list[float]:
    return [share for share in shares if share is not None]


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _programs(row: dict) -> list[str]:
    return [name for name in COLORS if name in row["programs"]]


def _histories(data: dict) -> str:
    names = _programs(data["parts"]["rough"])
    rows = []
    for kind, words in KINDS.items():
        part = data["parts"][kind]
        cells = []
        for name in names:
            shares = part["programs"][name]["shares"]
            made = _made(shares)
            refused = f", {len(shares) - len(made)} refused" if len(made) < len(shares) else ""
            cells.append(f"{_percent(statistics.mean(made))} (worst {_percent(min(made))}{refused})")
        rows.append([words, str(part["histories"]), *cells])
    seconds = [
        "processor time each",
        "",
        *(
            f"{statistics.mean(data['parts'][kind]['programs'][name]['seconds'] for kind in KINDS):.1f} s"
            for name in names
        ),
    ]
    return _table(["kind", "histories", *names], [*rows, seconds])


def _folds(data: dict) -> str:
    part = data["parts"]["folds"]
    names = _programs(part)
    rows = []
    for number, fold in enumerate(part["folds"]):
        shares = [part["programs"][name]["shares"][number] for name in names]
        rows.append([NODDY[fold], *("not run" if share is None else _percent(share) for share in shares)])
    return _table(["model made by Noddy", *names], rows)


def _moureze(data: dict) -> str:
    part = data["parts"]["moureze"]
    names = _programs(part)
    rows = []
    for words, figure in (("mean", statistics.mean), ("worst draw", min), ("best draw", max)):
        rows.append([words, *(_percent(figure(_made(part["programs"][n]["shares"]))) for n in names)])
    refused = [part["programs"][name]["shares"].count(None) for name in names]
    if any(refused):
        rows.append(["draws refused", *map(str, refused)])
    return _table([f"of {part['draws']} draws", *names], rows)


def _methods(data: dict) -> str:
    part = data["parts"]["methods"]
    count = len(part["histories"])
    rows = []
    for name, shares in part["methods"].items():
        cells = [f"{100 * share:.1f}" if share is not None else "refused" for share in shares]
        few = "" if len(shares) == count else f" (of {len(shares)})"
        mean = f"**{100 * statistics.mean(_made(shares)):.1f}**{few}"
        rows.append([name, *cells, *[""] * (count - len(shares)), mean])
    return _table(["method; share in the right block, %", *part["histories"], "mean"], rows)


def _wells(data: dict) -> str:
    part = data["parts"]["wells"]
    rows = []
    for name in _programs(part):
        row = part["programs"][name]
        errors = [f"{row[key]:.0f} m" if row[key] is not None else "" for key in ("median", "rms")]
        rows.append([name, _percent(row["share"]), *errors])
    return _table(
        ["program", "length in the right block", "median error of a contact", "root mean square"], rows
    )


def _claudius(data: dict) -> str:
    part = data["parts"]["claudius"]
    rows = []
    for name in _programs(part):
        row = part["programs"][name]
        far = row["distances"] or [None] * 4
        cells = ["refused" if pair is None else f"{pair[0]:.1f} ± {pair[1]:.1f}" for pair in far]
        rows.append([name, *cells, f"{row['seconds']:.0f} s"])
    return _table(["mean ± deviation, m", "D", "C", "B", "A", "processor time"], rows)


def _scientific(number: float) -> str:
    if not number:
        return "0"
    power = math.floor(math.log10(number))
    return f"{number / 10**power:.1f}e{power}"


def _exact(data: dict) -> str:
    part = data["parts"]["exact"]
    stacks, booleans = part["stacks"], part["booleans"]
    ours, theirs = (booleans["programs"][name] for name in ("RealModel", "Manifold"))
    compared = stacks["stacks"] - stacks["joined"]
    rows = [
        [
            f"volumes of {stacks['blocks']:,} blocks of {compared:,} random stacks",
            "exact rationals",
            f"{stacks['wrong']} blocks missing or too many; {stacks['beyond']} volumes off by more than a "
            f"billionth or the rounding of coordinates; median difference {_scientific(stacks['median'])}",
        ],
        [
            f"union + intersection = A + B, {booleans['pairs']} pairs of scanned solids",
            "exact rationals",
            f"off by {_scientific(ours['gap'])} at most (Manifold: {_scientific(theirs['gap'])}); open edges "
            f"{ours['open']} (Manifold: {theirs['open']})",
        ],
        [
            "volumes of the same results",
            "Manifold",
            f"differ by {_scientific(booleans['beside'])} at most",
        ],
        *(
            [
                f"{cut['layers']} layers of {cut['triangles']:,} triangles, cut by a sphere",
                "Manifold",
                f"volume inside differs by {_scientific(cut['beside'])}; {cut['seconds']['RealModel']} s "
                f"(Manifold: {cut['seconds']['Manifold']} s)",
            ]
            for cut in part["cuts"]
        ),
    ]
    return _table(["tested", "beside", "result"], rows)


def _off(row: dict) -> float:
    return abs(row["found"] / row["expected"] - 1)


def _work(row: dict) -> str:
    return "hill" if "hill" in row["work"] else row["work"].split()[0]


def _solvers(data: dict) -> str:
    rows = [
        [
            row["work"],
            f"{row['solver']}, {row['elements']}",
            row["of"],
            f"{row['found']:.6g}",
            f"{row['expected']:.6g}",
            "less than 0.0001 %" if _off(row) < 1e-6 else _percent(_off(row), 2),
        ]
        for row in data["parts"]["solvers"]["rows"]
    ]
    return _table(["work", "solver, elements", "truth", "found", "expected", "off by"], rows)


def _calibration(data: dict) -> str:
    rows = [
        [row["surface"], _percent(row["most"], 0), _percent(row["half"], 0)]
        for row in data["parts"]["calibration"]["surfaces"]
    ]
    return _table(["surface", "within P10-P90 (right: 80 %)", "within P25-P75 (right: 50 %)"], rows)


def _versions(data: dict) -> str:
    return _table(["program", "version"], [[name, version] for name, version in data["versions"].items()])


TABLES: dict[str, Callable[[dict], str]] = {
    "histories": _histories,
    "folds": _folds,
    "moureze": _moureze,
    "methods": _methods,
    "wells": _wells,
    "claudius": _claudius,
    "exact": _exact,
    "solvers": _solvers,
    "calibration": _calibration,
    "versions": _versions,
}


def values(data: dict) -> dict[str, str]:
    """{key: text} for sentences: "histories folded GemPy", "wells SciPy RBF", "claudius B RealModel", ..."""
    parts = data["parts"]
    numbers = {}
    for kind in KINDS:
        numbers[f"histories {kind}"] = str(parts[kind]["histories"])
        for name, row in parts[kind]["programs"].items():
            numbers[f"histories {kind} {name}"] = _percent(statistics.mean(_made(row["shares"])))
    numbers["histories"] = str(sum(parts[kind]["histories"] for kind in KINDS))
    numbers["seeds"] = f"0 to {parts['rough']['seeds'] - 1}"
    for name, row in parts["folds"]["programs"].items():
        for fold, share in zip(parts["folds"]["folds"], row["shares"], strict=True):
            if share is not None:
                numbers[f"folds {fold} {name}"] = _percent(share)
    for name, row in parts["moureze"]["programs"].items():
        numbers[f"moureze {name}"] = _percent(statistics.mean(_made(row["shares"])))
    for name, row in parts["wells"]["programs"].items():
        numbers[f"wells {name}"] = _percent(row["share"])
    numbers["wells holes"] = str(parts["wells"]["holes"])
    for name, row in parts["claudius"]["programs"].items():
        for horizon, far in zip("DCBA", row["distances"] or [], strict=False):
            numbers[f"claudius {horizon} {name}"] = f"{far[1]:.1f} m"
    for key in ("points", "dips", "asked"):
        numbers[f"claudius {key}"] = f"{parts['claudius'][key]:,}"
    for name, shares in parts["methods"]["methods"].items():
        numbers[f"methods {name}"] = _percent(statistics.mean(_made(shares)))
    numbers["exact stacks"] = f"{parts['exact']['stacks']['stacks']:,}"
    numbers["exact joined"] = str(parts["exact"]["stacks"]["joined"])
    shares = [row["most"] for row in parts["calibration"]["surfaces"]]
    numbers["calibration least"], numbers["calibration most"] = (
        _percent(min(shares), 0),
        _percent(max(shares), 0),
    )
    return numbers


_LEFT, _RIGHT, _WIDTH, _LANE = 220, 24, 720, 9


def _dots(
    rows: list, axis: tuple[float, float], ticks: Sequence[float], label: str, scale=None, mark=None
) -> str:
    """A figure. rows: (words, {series: value, or (least, middle, most)}); scale: text of a tick; mark: a
    value with a dashed line."""
    series = [name for name in COLORS if any(name in row for _, row in rows)]
    heights = [max(26, _LANE * len(row) + 12) for _, row in rows]
    top = 44 if len(series) > 1 else 14
    drawing = Drawing(_WIDTH, top + sum(heights) + 46, "validate.sh")
    x = _LEFT
    for name in series if len(series) > 1 else []:
        drawing.dot((x, 20), COLORS[name], 4.5)
        drawing.text(x + 9, 24, name)
        x += 34 + 7.4 * len(name)
    low, high = axis

    def across(value):
        share = (min(max(value, low), high) - low) / (high - low)
        return _LEFT + share * (_WIDTH - _LEFT - _RIGHT)

    bottom = top + sum(heights)
    for tick in ticks:
        drawing.path([(across(tick), top), (across(tick), bottom)], "#dcd8d2", 1.0)
        drawing.text(across(tick), bottom + 17, scale(tick) if scale else f"{tick:g}", 11.5, anchor="middle")
    if mark is not None:
        drawing.path([(across(mark), top), (across(mark), bottom)], INK, 1.3, "5 4")
    drawing.text((_LEFT + _WIDTH - _RIGHT) / 2, bottom + 37, label, 12, anchor="middle")
    y = top
    for (words, row), height in zip(rows, heights, strict=True):
        drawing.path([(_LEFT - 4, y + height), (_WIDTH - _RIGHT, y + height)], PALE, 1.0)
        drawing.text(_LEFT - 12, y + height / 2 + 4, words, 12, anchor="end")
        lane = y + height / 2 - _LANE * (len(row) - 1) / 2
        for name in series:
            if name not in row:
                continue
            value = row[name]
            if isinstance(value, tuple):
                drawing.path([(across(value[0]), lane), (across(value[2]), lane)], COLORS[name], 1.6)
                value = value[1]
            drawing.dot((across(value), lane), COLORS[name], 4.5)
            lane += _LANE
        y += height
    return drawing.svg()


def _spread(shares: Sequence[float | None]) -> tuple[float, float, float]:
    made = [100 * share for share in _made(shares)]
    return min(made), statistics.mean(made), max(made)


def figures(data: dict) -> dict[str, str]:
    """{file: its SVG}."""
    parts = data["parts"]
    whole = "% of random points in the right block"
    drawn = {}
    rows = [
        (words, {name: _spread(parts[kind]["programs"][name]["shares"]) for name in FOUR})
        for kind, words in KINDS.items()
    ]
    drawn["histories.svg"] = _dots(
        rows, (70, 100), range(70, 101, 5), f"{whole}: mean, worst and best history"
    )
    rows = []
    for number, fold in enumerate(parts["folds"]["folds"]):
        shares = {
            name: parts["folds"]["programs"][name]["shares"][number]
            for name in COLORS
            if name in parts["folds"]["programs"]
        }
        rows.append((NODDY[fold], {name: 100 * share for name, share in shares.items() if share is not None}))
    drawn["folds.svg"] = _dots(rows, (50, 100), range(50, 101, 10), whole)
    part = parts["moureze"]
    rows = [
        ("surface of Moureze", {name: _spread(part["programs"][name]["shares"]) for name in _programs(part)})
    ]
    drawn["moureze.svg"] = _dots(
        rows, (30, 100), range(30, 101, 10), "% of places on the right side: mean, worst and best draw"
    )
    rows = [
        (name, {"SciPy RBF" if name == "SciPy RBF" else "RealModel": _spread(shares)})
        for name, shares in parts["methods"]["methods"].items()
    ]
    drawn["methods.svg"] = _dots(
        rows, (20, 100), range(20, 101, 10), f"{whole}: mean, worst and best history"
    )
    part = parts["wells"]
    rows = [("wells left out", {name: 100 * part["programs"][name]["share"] for name in _programs(part)})]
    drawn["wells.svg"] = _dots(rows, (40, 100), range(40, 101, 10), "% of the length in the right block")
    part = parts["claudius"]
    rows = [
        (
            f"horizon {horizon}",
            {
                name: part["programs"][name]["distances"][k][1]
                for name in _programs(part)
                if part["programs"][name]["distances"]
            },
        )
        for k, horizon in enumerate("DCBA")
    ]
    far = 10 * math.ceil(max(max(row.values()) for _, row in rows) / 10)
    drawn["claudius.svg"] = _dots(rows, (0, far), range(0, far + 1, 10), "standard deviation of distances, m")
    drawn["exact.svg"] = _exact_figure(parts["exact"])
    rows = [
        (f"{_work(row)}, {row['solver']}, {row['elements']}", {"RealModel": _log(_off(row))})
        for row in parts["solvers"]["rows"]
    ]
    drawn["solvers.svg"] = _dots(
        rows,
        (-16, 0),
        range(-16, 1, 2),
        "difference from the truth, as a share of it",
        lambda power: f"1e{power}",
    )
    rows = [(row["surface"], {"RealModel": 100 * row["most"]}) for row in parts["calibration"]["surfaces"]]
    drawn["calibration.svg"] = _dots(
        rows, (40, 100), range(40, 101, 10), "% within P10-P90; the dashed line is right", mark=80
    )
    return drawn


def _log(number: float) -> float:
    return math.log10(max(number, 1e-20))


def _exact_figure(part: dict) -> str:
    gaps = {name: _log(row["gap"]) for name, row in part["booleans"]["programs"].items()}
    rows = [
        ("volumes of blocks (median)", {"RealModel": _log(part["stacks"]["median"])}),
        ("union + intersection", gaps),
        ("Booleans, beside Manifold", {"RealModel": _log(part["booleans"]["beside"])}),
        *(
            (f"cut of {cut['layers']} layers, beside Manifold", {"RealModel": _log(cut["beside"])})
            for cut in part["cuts"]
        ),
    ]
    return _dots(
        rows, (-20, -8), range(-20, -7, 2), "difference, as a share of the volume", lambda power: f"1e{power}"
    )
