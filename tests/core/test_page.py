# SPDX-License-Identifier: GPL-3.0-or-later
"""Models as a page of HTML, in a real browser: what its canvas shows is what the model is."""

import json
import re

import numpy as np
import pytest
from browser import CHROMIUM, browse
from realmodel.core import Project, Rock, Surface, build
from sample_scripts import coarse_sample

_NEEDS_BROWSER = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
SIZES = {"desktop": (1200, 800), "phone": (390, 844)}

# The color of the canvas where a place of the model (local coordinates) is seen, after drawing.
_COLOR = """
const { THREE, camera, renderer, render, state, update, data, pick } = realmodel;
const canvas = document.getElementById("canvas"), gl = renderer.getContext();
function pixel(place) {
  camera.updateMatrixWorld();  // as drawing does
  const at = new THREE.Vector3(...place).project(camera);
  return [(at.x + 1) / 2 * canvas.clientWidth, (1 - at.y) / 2 * canvas.clientHeight];
}
function read([x, y]) {
  const ratio = canvas.width / canvas.clientWidth, rgba = new Uint8Array(4);
  const column = Math.floor(x * ratio), row = canvas.height - 1 - Math.floor(y * ratio);
  gl.readPixels(column, row, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
  return [...rgba.slice(0, 3)];
}
function color(at) { render(); return read(at); }
function click(selector) { document.querySelector(selector).click(); }
"""


def cake(names=("a", "b", "c"), **project):
    """Horizontal layers of 10, the base at 0, in a region of 100 by 60."""
    region = [[0.0, 0], [100, 0], [100, 60], [0, 60]]
    corners, triangles = np.array(region), np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    surfaces = [
        Surface(name, np.column_stack([corners, np.full(4, 10.0 * (k + 1))]), triangles, block=name)
        for k, name in enumerate(names)
    ]
    return Project(project.pop("name", "cake"), [Rock("rock", surfaces, base_elevation=0.0)], **project)


def data_of(page):
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)[1])


def rgb(text):
    return [int(text[at : at + 2], 16) for at in (1, 3, 5)]


def test_numbers_are_those_of_the_report():
    model = build(cake())
    page = data_of(model.to_html())
    report = model.report()
    for shown, said in zip(page["blocks"], report["blocks"], strict=True):
        assert (shown["name"], shown["volume"], shown["share"], shown["parts"]) == (
            said["name"],
            said["volume"],
            said["share"],
            said["components"],
        )
    assert page["volume"] == report["volume"]


def test_a_file_is_the_page_and_has_the_same_bytes(tmp_path):
    model = build(cake())
    model.save(tmp_path / "a.html")
    build(cake()).save(tmp_path / "b.html")
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()
    assert (tmp_path / "a.html").read_text(encoding="utf-8") == model.to_html()


@_NEEDS_BROWSER
@pytest.mark.parametrize("size", SIZES)
def test_canvas_shows_blocks_and_what_is_hidden_is_not_there(tmp_path, size):
    model = build(cake())
    script = (
        _COLOR
        + """
    const before = pick(...pixel([-50, -30, 0]));
    click("input[data-block='1']");
    const hidden = pick(...pixel([-50, -30, 0]));
    render();
    const picture = [color(pixel([-49.9, -29.9, 10])), color([2, 60])];
    click("#all"); click("#all");
    const volumes = [...document.querySelectorAll("#blocks .number[data-volume]")];
    return { before, hidden, picture, none: pick(...pixel([-50, -30, 0])),
             rows: volumes.map(cell => Number(cell.dataset.volume)),
             sideways: document.documentElement.scrollWidth - window.innerWidth };
    """
    )
    found, said = browse(model.to_html(), script, tmp_path, SIZES[size])
    assert said == []
    assert found["before"] == 1  # the corner of the middle layer
    assert found["hidden"] != 1
    assert found["none"] == -1
    assert found["picture"][0] != found["picture"][1]  # a block, and the background
    assert found["rows"] == [block.volume for block in reversed(model.blocks)]
    assert found["sideways"] <= 0  # nothing to scroll


def places_within(model, axis, share):
    """Ten places of a plane, drawn at random, those near a boundary left out."""
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    draw = np.random.default_rng(5).uniform(size=(200, 3))
    draw[:, axis] = share
    places = low + draw * (high - low)
    near = 0.01 * np.linalg.norm(high - low)
    steps = near * np.array([[a, b, c] for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1)])
    steps = steps[steps[:, axis] == 0]
    blocks = model.block_at((places[:, None] + steps).reshape(-1, 3)).reshape(len(places), -1)
    places = places[(blocks == blocks[:, :1]).all(axis=1) & (blocks[:, 0] >= 0)][:10]
    assert len(places) == 10
    return places


@_NEEDS_BROWSER
@pytest.mark.parametrize("sample", ["fault_blocks", "recumbent_fold", "tunnel"])
def test_sections_are_filled_with_the_right_colors(tmp_path, sample):
    model = build(coarse_sample(sample, 4 if sample == "recumbent_fold" else 1))
    page = model.to_html()
    data = data_of(page)
    share = 0.437
    places = np.array([places_within(model, axis, share) for axis in range(3)])
    script = (
        _COLOR
        + f"""
    const {{ controls, box }} = realmodel, result = [];
    const middle = box.low.clone().add(box.high).multiplyScalar(0.5);
    const places = {(places - data["origin"]).tolist()}, toward = [[-1, 0, 0], [0, -1, 0], [0, -0.001, 1]];
    for (const axis of [0, 1, 2]) {{
      controls.target.copy(middle);
      const direction = new THREE.Vector3(...toward[axis]);
      camera.position.copy(middle).addScaledVector(direction, 2 * box.low.distanceTo(box.high));
      controls.update();
      click(`input[name=axis][value=${{"xyz"[axis]}}]`);
      const slider = document.getElementById("at");
      slider.value = 1000 * {share};
      slider.dispatchEvent(new Event("input"));
      render();
      const colors = places[axis].map(place => read(pixel(place)));
      result.push([colors, places[axis].slice(0, 3).map(place => pick(...pixel(place)))]);
    }}
    return result;
    """
    )
    found, said = browse(page, script, tmp_path, (800, 500))
    assert said == []
    colors = {block["number"]: rgb(block["color"]) for block in data["blocks"]}
    for axis, (shown, picked) in enumerate(found):
        expected = model.block_at(places[axis]).tolist()
        assert shown == [colors[block] for block in expected], "xyz"[axis]
        assert picked == expected[:3], "xyz"[axis]


@_NEEDS_BROWSER
def test_an_address_gives_the_same_view_again(tmp_path):
    page = build(cake()).to_html()
    script = """
    const { state, camera, data } = realmodel;
    const { axis, at, explode, vertical, hidden } = state, { theme } = document.documentElement.dataset;
    return { axis, at, explode, vertical, theme, hidden: [...hidden], hash: location.hash,
             camera: camera.position.toArray() };
    """
    view = "#c=300,-200,150,1,2,3&h=0,2&s=y,0.25,1&e=0.5&v=4&l=&t=dark"
    first, said = browse(page, script, tmp_path, view=view)
    assert said == []
    assert (first["axis"], first["hidden"], first["at"], first["explode"], first["vertical"]) == (
        "y",
        [0, 2],
        0.25,
        0.5,
        4,
    )
    assert first["camera"] == pytest.approx([300, -200, 150])
    assert first["theme"] == "dark"
    change = (
        "document.getElementById('canvas').dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft'}));"
    )
    turned, _ = browse(page, change + script, tmp_path, view=view)
    assert turned["camera"] != pytest.approx(first["camera"])
    again, _ = browse(page, script, tmp_path, view=turned["hash"])
    assert again["camera"] == pytest.approx(turned["camera"], rel=1e-4)
    assert again == turned | {"camera": again["camera"], "hash": again["hash"]}


@_NEEDS_BROWSER
def test_names_are_text_whatever_they_hold(tmp_path):
    names = ["</script><b>x", "<img src=x onerror=said.push('run')>", '"& \u2028 Größe']
    model = build(cake(names, name="</title><script>said.push('run')</script>"))
    script = """
    const cells = [...document.querySelectorAll("#blocks tr td:nth-child(2)")];
    return { title: document.title, rows: cells.map(cell => cell.textContent) };
    """
    found, said = browse(model.to_html(), script, tmp_path)
    assert said == []
    assert found["title"] == "</title><script>said.push('run')</script>"
    assert found["rows"] == names[::-1]


@_NEEDS_BROWSER
def test_a_notebook_shows_the_page_in_a_frame(tmp_path):
    script = """
    const frame = document.querySelector("iframe");
    while (!(frame.contentWindow.realmodel)) await new Promise(done => setTimeout(done, 20));
    const inside = frame.contentDocument, { realmodel } = frame.contentWindow;
    inside.getElementById("top").click();
    return { blocks: realmodel.data.blocks.length, address: frame.contentWindow.location.href,
             hasLink: !inside.getElementById("link").hidden, width: inside.getElementById("canvas").width };
    """
    page = (
        f"<!DOCTYPE html><html data-ready=yes><head></head><body>{build(cake())._repr_html_()}</body></html>"
    )
    shown, said = browse(page, script, tmp_path)
    assert said == []
    assert (shown["blocks"], shown["address"], shown["hasLink"]) == (3, "about:srcdoc", False)
    assert shown["width"] > 300
