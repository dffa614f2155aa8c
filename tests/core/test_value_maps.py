# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps of tops, thickness and uncertainty in GeoPackages, and the styles of their layers."""

import shutil
import sqlite3
import subprocess
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from realmodel.core import Model, UsageError, build
from realmodel.core.exporters.map_styles import classes_style
from realmodel.core.results.samples import plan_grids
from realmodel.core.results.value_areas import value_maps
from sample_scripts import built_sample

HAS_QGIS = (
    shutil.which("/usr/bin/python3")
    and not subprocess.run(
        ["/usr/bin/python3", "-c", "import qgis.core"], capture_output=True, check=False
    ).returncode
)
QGIS = """
import os, sys
os.environ["QT_QPA_PLATFORM"] = "offscreen"
from qgis.core import QgsApplication, QgsVectorLayer
application = QgsApplication([], False)
application.initQgis()
for name in sys.argv[2:]:
    layer = QgsVectorLayer(f"{sys.argv[1]}|layername={name}", name, "ogr")
    renderer = layer.renderer()
    parts = renderer.categories() if renderer.type() == "categorizedSymbol" else renderer.ranges()
    colors = [part.symbol().color().name() for part in parts]
    print(name, layer.isValid(), layer.featureCount(), renderer.type(), *colors)
"""


@pytest.fixture(scope="module")
def model():
    return built_sample("uncertain_valley")


@pytest.fixture(scope="module")
def saved(model, tmp_path_factory):
    """A GeoPackage of cells of 50 m."""
    made = Model.of(model)
    made.project = replace(model.project, crs="EPSG:25832")
    path = tmp_path_factory.mktemp("maps") / "m.gpkg"
    made.save(path, cell_size=50.0)
    return path


@pytest.mark.parametrize("cell_size", [None, 37.0, (100.0, 40.0)])
def test_each_cell_lies_in_the_class_of_its_value(model, cell_size):
    shapely = pytest.importorskip("shapely", reason="shapely is not installed: scripts/test.sh installs it")
    grids = plan_grids(model, cell_size)
    (west, north), (dx, dy) = grids.north_west, grids.size
    rows, columns = grids.top.shape
    x, y = np.meshgrid(west + dx * (np.arange(columns) + 0.5), north - dy * (np.arange(rows) + 0.5))
    names = [block.name for block in model.blocks]
    deviations = dict(grids.deviation)
    maps = value_maps(model, cell_size)
    assert {made.kind for made in maps} == {"top", "thickness", "deviation"}
    assert {made.of for made in maps if made.kind == "deviation"} == set(deviations) != set()
    for made in maps:
        if made.kind == "deviation":
            values = deviations[made.of]
        else:
            array = grids.upper if made.kind == "top" else grids.thickness
            values = array[names.index(made.of)]
            values = np.where(values > 0, values, np.nan) if made.kind == "thickness" else values
        seen = np.zeros(values.shape, int)
        for low, high, polygons in made.areas:
            shape = shapely.MultiPolygon([shapely.Polygon(rings[0], rings[1:]) for rings in polygons])
            assert shape.is_valid
            inside = shapely.contains_xy(shape, x, y)
            assert shape.area == pytest.approx(inside.sum() * dx * dy, rel=1e-9)
            assert (values[inside] >= low - 1e-9 * abs(low)).all() and (values[inside] <= high + 1e-9).all()
            seen += inside
        assert np.array_equal(seen == 1, np.isfinite(values)) and seen.max() == 1


def test_a_deviation_is_the_root_of_the_variance(model):
    for name, values in plan_grids(model).deviation:
        variance = model.surface_attributes(name)["variance"]
        assert np.nanmax(values) <= np.sqrt(np.nanmax(variance)) * (1 + 1e-12)
        assert np.nanmin(values) >= 0
        assert np.nanmax(values) > 0.5 * np.sqrt(np.nanmax(variance))


def test_every_layer_has_the_style_that_qgis_opens_it_with(saved):
    base = sqlite3.connect(saved)
    layers = [name for (name,) in base.execute("SELECT table_name FROM gpkg_geometry_columns")]
    styles = base.execute("SELECT f_table_name, styleQML FROM layer_styles WHERE useAsDefault = 1").fetchall()
    assert sorted(name for name, _ in styles) == sorted(layers)
    assert {
        "geology",
        "contours",
        "top_of_Lake_clay",
        "thickness_of_Till",
        "standard_deviation_of_clay",
    } <= set(layers)
    kinds = dict(base.execute("SELECT table_name, data_type FROM gpkg_contents").fetchall())
    assert kinds.pop("layer_styles") == "attributes"
    assert set(kinds) == set(layers) and set(kinds.values()) == {"features"}
    for name, text in styles:
        renderer = ElementTree.fromstring(text).find("renderer-v2")
        entries = list(renderer.find("categories" if name in ("geology", "contours") else "ranges"))
        assert {entry.get("symbol") for entry in entries} == {
            symbol.get("name") for symbol in renderer.find("symbols")
        }
        if name not in ("geology", "contours"):
            classes = base.execute(f"SELECT low, high FROM {name} ORDER BY low").fetchall()
            assert [(float(e.get("lower")), float(e.get("upper"))) for e in entries] == classes
    base.close()


def test_names_that_are_hard_in_xml_are_in_the_style(model, tmp_path):
    made = Model.of(model)
    names = ['A & "B" <c>', "Löß, grün"]
    rock = made.project.rocks[0]
    surfaces = [replace(s, block=n) for s, n in zip(rock.surfaces, [None, *names, None], strict=False)]
    project = replace(made.project, rocks=[replace(rock, surfaces=surfaces)])
    build(project).save(tmp_path / "m.gpkg", cell_size=100.0)
    base = sqlite3.connect(tmp_path / "m.gpkg")
    titles = [title for (title,) in base.execute("SELECT identifier FROM gpkg_contents")]
    assert {f"top of {name}" for name in names} <= set(titles)
    base.close()


def test_a_constant_value_is_one_class():
    text = classes_style([(5.0, 5.0)])
    assert len(ElementTree.fromstring(text).findall(".//range")) == 1


def test_the_interval_is_that_of_tops_alone(model, tmp_path):
    model.save(tmp_path / "m.gpkg", contour_interval=10.0, cell_size=50.0)
    base = sqlite3.connect(tmp_path / "m.gpkg")
    assert {low % 10 for (low,) in base.execute("SELECT low FROM top_of_Till")} == {0.0}
    assert {high - low for low, high in base.execute("SELECT low, high FROM thickness_of_Till")} != {10.0}
    base.close()
    with pytest.raises(UsageError):
        model.save(tmp_path / "n.gpkg", cell_size=-1.0)
    assert not (tmp_path / "n.gpkg").exists()


@pytest.mark.skipif(not HAS_QGIS, reason="python3-qgis is not installed")
def test_qgis_shows_the_layers_in_their_styles(saved):
    base = sqlite3.connect(saved)
    colors = dict(base.execute("SELECT block, color FROM geology").fetchall())
    count = base.execute("SELECT count(*) FROM thickness_of_Lake_clay").fetchone()[0]
    base.close()
    names = ["geology", "contours", "thickness_of_Lake_clay"]
    command = ["/usr/bin/python3", "-c", QGIS, str(saved), *names]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    geology, contours, thickness = (line.split() for line in told)
    assert geology[1:4] == ["True", str(len(colors)), "categorizedSymbol"]
    assert set(geology[4:]) == set(colors.values())
    assert contours[1] == "True" and set(contours[4:]) == {"#6b4521"}
    assert thickness[1:4] == ["True", str(count), "graduatedSymbol"]
    assert len(set(thickness[4:])) == count and thickness[4] == "#00224e"  # from dark to bright
