#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the public examples of GemPy and LoopStructural by one call each, and prints the share of random
points of the box that have the same unit there.

    python -m venv build/peers && build/peers/bin/pip install gempy==2026.0.3 LoopStructural==1.9.0
    PYTHONPATH=addon build/peers/bin/python scripts/compare_peers.py GEMPY_DATA GEMPY LOOP [EXAMPLE ...]
    PYTHONPATH=addon build/peers/bin/python scripts/compare_peers.py --page

The first three are clones of cgre-aachen/gempy_data, gempy-project/gempy and Loop3D/LoopStructural on GitHub.
--page runs the code of docs/guide/gempy_loopstructural.md instead, and writes its table and its data, which a
formula makes.
"""

import contextlib
import importlib.metadata
import io
import os
import re
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
from realmodel.core import build, from_gempy, from_loop

_POINTS = 4000
_SIX = ("Sandstone", "Siltstone", "Shale", "Sandstone_2", "Schist", "Gneiss")
_CUBE = (0, 1000, 0, 1000, 0, 1000)
_LONG = (0, 2500, 0, 1000, 0, 1000)
_BASIN = (0, 2000, 0, 1000, 0, 1000)
_HILL = (0, 2000, 0, 2000, 0, 1600)
_SERIES = {"Strat_Series1": "rock3", "Strat_Series2": ("rock2", "rock1")}
_FAULT = {"Fault_Series": "fault"}
_MAIN = {"Fault_Series": "Main_Fault"}
# name: the tables of points and orientations, the stack, the extent, what more from_gempy gets
GEMPY = {
    **{
        name: (
            f"jan_models/model{n}_surface_points",
            f"jan_models/model{n}_orientations",
            stack,
            extent,
            more,
        )
        for n, name, stack, extent, more in (
            (1, "horizontal", {"s": ("rock2", "rock1")}, _CUBE, {}),
            (2, "fold", {"s": ("rock2", "rock1")}, _CUBE, {}),
            (3, "recumbent fold", {"s": ("rock2", "rock1")}, _CUBE, {}),
            (4, "pinchout", {"s": ("rock2", "rock1")}, _CUBE, {}),
            (5, "fault", {**_FAULT, "s": ("rock2", "rock1")}, _CUBE, {"faults": [*_FAULT]}),
            (6, "unconformity", _SERIES, _CUBE, {}),
            (7, "combination", {**_FAULT, **_SERIES}, _LONG, {"faults": [*_FAULT]}),
        )
    },
    **{
        f"more examples {n}": (f"lisa_models/interfaces{n}", f"lisa_models/foliations{n}", stack, _HILL, more)
        for n, stack, more in (
            (1, {"young": _SIX[:3], "old": ("Sandstone2", "Siltstone2", "Shale2")}, {}),
            *((n, {"s": _SIX}, {}) for n in (2, 3, 6, 9)),
            *((n, {**_MAIN, "s": _SIX}, {"faults": [*_MAIN]}) for n in (5, 8)),
            (7, {"F1": "Fault_1", "F2": "Fault_2", "s": _SIX}, {"faults": ["F1", "F2"]}),
        )
    },
    **{
        f"video {name}": (
            f"video_tutorials_v3/tutorial_model{file}_surface_points",
            f"video_tutorials_v3/tutorial_model{file}_orientations",
            stack,
            extent,
            more,
        )
        for name, file, stack, extent, more in (
            ("1", "", _SERIES, _LONG, {}),
            ("2, fault", "_faults_1", {**_FAULT, **_SERIES}, _LONG, {"faults": [*_FAULT]}),
            (
                "3, onlap",
                "_onlap_1",
                {"young": ("basin_fill_2", "basin_fill_1"), "old": ("basin_top", "basin_bottom")},
                _BASIN,
                {"relations": {"young": "onlap"}},
            ),
            (
                "3, subduction",
                "_onlap_2",
                {
                    "top": "continental_top",
                    "continental": ("continental_shallow", "continental_deep"),
                    "oceanic": ("oceanic_top", "oceanic_bottom"),
                },
                _BASIN,
                {"relations": {"top": "onlap", "continental": "onlap"}},
            ),
        )
    },
    "1.1 basics": (
        "getting_started/simple_fault_model_points",
        "getting_started/simple_fault_model_orientations",
        {**_MAIN, "s": ("Sandstone_2", "Siltstone", "Shale", "Sandstone_1")},
        (0, 2000, 0, 2000, 0, 750),
        {"faults": [*_MAIN]},
    ),
    "1.4 onlap": (
        "tut-ch1-4/tut_ch1-4_points",
        "tut-ch1-4/tut_ch1-4_orientations",
        {"sea": "seafloor", "right": ("rock1", "rock2"), "onlap": "onlap_surface", "left": "rock3"},
        (-200, 1000, -500, 500, -1000, 0),
        {"relations": {"right": "onlap"}},
    ),
    "1.5 graben": (
        "tut-ch1-5/tut_ch1-5_points",
        "tut-ch1-5/tut_ch1-5_orientations",
        {"f1": "fault1", "f2": "fault2", "s": ("rock4", "rock3", "rock2", "rock1")},
        (0, 1000, 0, 1000, -1000, -400),
        {"faults": ["f1", "f2"]},
    ),
    "Greenstone": (
        "tut_SandStone/SandStone_Points",
        "tut_SandStone/SandStone_Foliations",
        {"granite": "EarlyGranite", "BIF": ("SimpleMafic2", "SimpleBIF"), "mafic": "SimpleMafic1"},
        (696000, 747000, 6863000, 6930000, -20000, 200),
        {},
    ),
    "Alès": (
        "AlesModel/2018_interf",
        "AlesModel/2018_orient_clust_n_init5_0",
        {f: f for f in ("fault_left", "fault_right", "fault_lr")}
        | {"Trias": ("LIAS", "TRIAS"), "C": "CARBO"},
        (729550.0, 751500.0, 1913500.0, 1923650.0, -1800.0, 800.0),
        {"faults": ["fault_left", "fault_right", "fault_lr"]},
    ),
}

# name: the table, the column, its bounds, faults
LOOP = {
    "Claudius": (
        "claudius",
        {"strati": {f"from {v}": {"min": v} for v in (0, 60, 250, 330)}},
        "claudiusbb",
        [],
    ),
    "duplex": ("duplex", [["strati"]], "duplexbb", ["fault1", "fault2"]),
    "faulted intrusion": ("intrusion", [["strati"]], "intrusionbb", ["fault"]),
}
_EVERY = 20  # of the points of Claudius


def of_gempy(folders, name):
    """The share of random points in the unit that GemPy gives, and the seconds that we took."""
    import gempy

    points, orientations, stack, extent, more = GEMPY[name]
    files = [
        next(path for folder in folders if (path := folder / f"{table}.csv").exists())
        for table in (points, orientations)
    ]
    began = time.perf_counter()
    model = build(from_gempy(*files, stack=stack, extent=extent, **more))
    seconds = time.perf_counter() - began
    low, high = np.array(extent, float).reshape(3, 2).T
    places = np.random.default_rng(7).uniform(low, high, (_POINTS, 3))
    with contextlib.redirect_stdout(io.StringIO()):
        importer = gempy.data.ImporterHelper(
            path_to_surface_points=str(files[0]), path_to_orientations=str(files[1])
        )
        theirs = gempy.create_geomodel(
            project_name=name, extent=list(extent), resolution=[6, 6, 6], importer_helper=importer
        )
        theirs.interpolation_options.mesh_extraction = False
        members = {
            group: [units] if isinstance(units, str) else list(units) for group, units in stack.items()
        }
        gempy.map_stack_to_surfaces(gempy_model=theirs, mapping_object=members)
        if more.get("faults"):
            gempy.set_is_fault(theirs, more["faults"])
        for group in more.get("relations", {}):
            relation = gempy.data.StackRelationType.ONLAP
            theirs.structural_frame.get_group_by_name(group).structural_relation = relation
        numbers = np.rint(gempy.compute_model_at(theirs, places)).astype(int).ravel()
    names = np.array([element.name for element in theirs.structural_frame.structural_elements])
    return share(model, places, names[numbers - 1]), seconds


def of_loop(folder, name):
    """As of_gempy, of LoopStructural; None where it says no units without displacements given to it."""
    from LoopStructural import GeologicalModel

    table, column, bounds, faults = LOOP[name]
    low, high = np.loadtxt(folder / f"{bounds}.txt")
    data = pd.read_csv(folder / f"{table}.csv")
    if isinstance(column, dict):
        data = data[(np.arange(len(data)) % _EVERY == 0) | data["nx"].notna()]
    began = time.perf_counter()
    model = build(from_loop(data, column, bounds=(low, high), faults=faults))
    seconds = time.perf_counter() - began
    if faults:
        return None, seconds
    theirs = GeologicalModel(low, high)
    theirs.data = data
    ((feature, units),) = column.items()
    field = theirs.create_and_add_foliation(feature)
    places = np.random.default_rng(7).uniform(low, high, (_POINTS, 3))
    values = field.evaluate_value(places)
    bases = np.array([unit["min"] for unit in units.values()])
    names = np.array(["basement", *units])
    return share(model, places, names[np.searchsorted(bases, values)]), seconds


def share(model, places, units):
    names = np.array([*(block.name for block in model.blocks), ""])
    return float((names[model.block_at(places)] == units).mean())


ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "guide" / "gempy_loopstructural.md"
TABLES = ROOT / "docs" / "examples" / "peers"
_BOX = np.array([[0.0, 0.0, 0.0], [1000.0, 800.0, 600.0]])
_THROW, _FAULT_X, _THICKNESS = 80.0, 550.0, 120.0
_BLOCKS = re.compile(r"^```py(?:thon)?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_WRITTEN = {
    name: re.compile(rf"(?<=<!-- {name} -->\n).*?(?=<!-- end -->)", re.DOTALL)
    for name in ("agreement", "solids")
}


def base_of_shale(x, y):
    """The truth of the page: an open fold, which a vertical fault lowers in the east."""
    return 260 + 50 * np.sin(x / 160) + 0.04 * y - np.where(x > _FAULT_X, _THROW, 0)


def true_units(places):
    above = places[:, 2] - base_of_shale(*places[:, :2].T)
    return np.array(["basement", "shale", "sand"])[np.searchsorted([0, _THICKNESS], above)]


def page_tables():
    """{name: data frame} of the page: points, orientations, and both as LoopStructural has them."""
    random = np.random.default_rng(7)
    points = []
    for name, above in (("shale", 0.0), ("sand", _THICKNESS)):
        x, y = random.uniform([20, 20], [980, 780], (40, 2)).round(1).T
        far = abs(x - _FAULT_X) > 40
        z = (base_of_shale(x, y) + above).round(2)
        points.append(pd.DataFrame({"X": x, "Y": y, "Z": z, "formation": name})[far])
    fault = [(_FAULT_X, y, z, "fault") for y in (100, 400, 700) for z in (50, 300, 550)]
    points = pd.concat([*points, pd.DataFrame(fault, columns=points[0].columns)], ignore_index=True)
    x, y = np.array([[100, 300, 500, 700, 900], [200, 600, 400, 200, 600]], float)
    east, north = 50 / 160 * np.cos(x / 160), 0.04
    orientations = pd.DataFrame({"X": x, "Y": y, "Z": base_of_shale(x, y).round(2)})
    orientations["azimuth"] = (np.degrees(np.arctan2(-east, -north)) % 360).round(1)
    orientations["dip"] = np.degrees(np.arctan(np.hypot(east, north))).round(1)
    orientations = orientations.assign(polarity=1, formation="shale")
    orientations.loc[len(orientations)] = [_FAULT_X, 400, 300, 90, 90, 1, "fault"]
    bedding = points[points.formation != "fault"]
    loop = bedding[["X", "Y", "Z"]].assign(val=np.where(bedding.formation == "sand", _THICKNESS, 0.0))
    dips = orientations[["X", "Y", "Z"]].copy()
    dip, azimuth = np.radians(orientations.dip), np.radians(orientations.azimuth)
    dips["nx"], dips["ny"] = np.sin(dip) * np.sin(azimuth), np.sin(dip) * np.cos(azimuth)
    dips["nz"] = np.cos(dip)
    names = np.where(orientations.formation == "fault", "fault", "strati")
    on_fault = points[points.formation == "fault"][["X", "Y", "Z"]].assign(val=0.0)
    features = [loop.assign(feature_name="strati"), dips.round(4).assign(feature_name=names)]
    features.append(on_fault.assign(feature_name="fault"))
    loop = pd.concat(features, ignore_index=True)
    return {"points": points, "orientations": orientations, "loop": loop.assign(coord=0)}


def page_places():
    return np.random.default_rng(1).uniform(*_BOX, (_POINTS, 3))


def run_page(mark, names=None):
    """What the code of the page with this text leaves behind, run after what left `names`."""
    (code,) = (code for code in _BLOCKS.findall(PAGE.read_text(encoding="utf-8")) if mark in code)
    names = {} if names is None else names
    os.chdir(ROOT)
    with contextlib.redirect_stdout(io.StringIO()):
        exec(compile(code, PAGE.name, "exec"), names)
    return names


def our_page_units(mark):
    """The unit of each place in the model of the code of the page with this text."""
    model = run_page(mark)["model"]
    return np.array([block.name for block in model.blocks])[model.block_at(page_places())]


def closed_page_solids(mark, names):
    """What the page prints of the solids that surfaces cut out of a box. mark: the code of the surfaces."""
    surfaces = run_page(mark, names)["surfaces"]
    (code,) = (code for code in _BLOCKS.findall(PAGE.read_text(encoding="utf-8")) if "cut_by_surface" in code)
    begin = code.index("# The box")
    lines = [line for line in code[:begin].splitlines() if line.startswith(("import", "from"))]
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile("\n".join([*lines, code[begin:]]), PAGE.name, "exec"), {"surfaces": surfaces})
    return printed.getvalue()


def agreement():
    """The table of the page, and what its code makes of their surfaces."""
    import gempy

    places = page_places()
    true = true_units(places)
    rows = ["| | right | same as RealModel | RealModel right |", "|---|---|---|---|"]
    of_gempy = run_page("import gempy")
    solids = [closed_page_solids("scalar_field_matrix", of_gempy)]
    theirs = of_gempy["geo_model"]
    theirs.interpolation_options.mesh_extraction = False
    with contextlib.redirect_stdout(io.StringIO()):
        numbers = np.rint(gempy.compute_model_at(theirs, places)).astype(int).ravel()
    names = np.array([element.name for element in theirs.structural_frame.structural_elements])
    of_loop = run_page("import LoopStructural")
    solids.append(closed_page_solids("strati.surfaces", of_loop))
    values = of_loop["strati"].evaluate_value(places)
    loop = np.array(["basement", "shale", "sand"])[np.searchsorted([0, _THICKNESS], values)]
    for package, units, mark in (
        ("gempy", names[numbers - 1], "import build, from_gempy"),
        ("LoopStructural", loop, "import build, from_loop"),
    ):
        ours = our_page_units(mark)
        name = f"{package.replace('gempy', 'GemPy')} {importlib.metadata.version(package)}"
        shares = ((units == true).mean(), (units == ours).mean(), (ours == true).mean())
        rows.append(f"| {name} | " + " | ".join(f"{100 * part:.1f} %" for part in shares) + " |")
    return "\n".join([*rows, ""]), "```text\n" + "\n".join(solids) + "```\n"


def write_page():
    for name, table in page_tables().items():
        table.to_csv(TABLES / f"{name}.csv", index=False)
    table, solids = agreement()
    text = _WRITTEN["agreement"].sub(lambda _: table, PAGE.read_text(encoding="utf-8"), count=1)
    PAGE.write_text(_WRITTEN["solids"].sub(lambda _: solids, text, count=1), encoding="utf-8")


def main(gempy_data, gempy, loop, *wanted):
    warnings.simplefilter("ignore")
    folders = [Path(gempy_data) / "data/input_data", Path(gempy) / "examples/data/input_data"]
    print("| example | same unit | s |\n| --- | --- | --- |")
    for examples, run, folder in (
        (GEMPY, of_gempy, folders),
        (LOOP, of_loop, Path(loop) / "LoopStructural/datasets/data"),
    ):
        for name in examples:
            if not wanted or name in wanted:
                same, seconds = run(folder, name)
                text = "built" if same is None else f"{same:.3f}"
                print(f"| {name} | {text} | {seconds:.1f} |", flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["--page"]:
        warnings.simplefilter("ignore")
        write_page()
    else:
        main(*sys.argv[1:])
