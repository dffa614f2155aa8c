// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a model with three.js. The page's data are described in page/__init__.py.
"use strict";
(() => {
const byId = id => document.getElementById(id);
const data = JSON.parse(byId("data").textContent);
const AXES = ["x", "y", "z"];
const NO_BLOCK = -1;

async function bytes(text) {
  const packed = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer());
  const count = planes.length / 4, whole = new Uint8Array(planes.length);
  for (let k = 0; k < 4; k++) for (let i = 0; i < count; i++) whole[4 * i + k] = planes[k * count + i];
  return whole.buffer;
}
const floats = async text => new Float32Array(await bytes(text));
async function integers(text) {
  const numbers = new Int32Array(await bytes(text));
  for (let i = 1; i < numbers.length; i++) numbers[i] += numbers[i - 1];
  return numbers;
}

// ------------------------------------------------------------------ what is shown
const state = { hidden: new Set(), axis: "", at: 0.5, flip: false, explode: 0, vertical: 1, layers: new Set() };
const plane = new THREE.Plane();
const scene = new THREE.Scene(), model = new THREE.Group(), caps = new THREE.Group();
const camera = new THREE.PerspectiveCamera(35, 1, 1, 10);
const layers = {};  // name: group
let renderer, controls, blocks = [], low, high, diagonal, positions, corners, sides, trianglesOf, asked = false;

const parity = new THREE.MeshBasicMaterial({
  side: THREE.DoubleSide, colorWrite: false, depthWrite: false, depthTest: false, clippingPlanes: [plane], stencilWrite: true,
  stencilFunc: THREE.AlwaysStencilFunc, stencilFail: THREE.InvertStencilOp, stencilZFail: THREE.InvertStencilOp, stencilZPass: THREE.InvertStencilOp,
});

// A block: its triangles, its outside as it is seen, and its cap: where the plane is within the closed block, an odd
// number of its faces lies behind it, which the stencil buffer tells.
function makeBlock(record, at) {
  const position = new THREE.BufferAttribute(positions, 3);
  const geometry = new THREE.BufferGeometry(), closed = new THREE.BufferGeometry();
  for (const mesh of [geometry, closed]) mesh.setAttribute("position", position);
  const block = { record, triangles: Uint32Array.from(trianglesOf.get(record.number)), group: new THREE.Group() };
  closed.setIndex(new THREE.BufferAttribute(indexOf(block, () => true), 1));
  const box = block.box = boxOf(closed.index.array);
  block.center = box.getCenter(new THREE.Vector3());
  const sphere = box.getBoundingSphere(new THREE.Sphere());
  closed.boundingSphere = geometry.boundingSphere = sphere;
  const color = new THREE.Color(record.color), id = new THREE.Color(at + 1);
  block.shown = new THREE.MeshPhongMaterial({ color, flatShading: true, shininess: 0, clippingPlanes: [plane] });
  block.mesh = new THREE.Mesh(geometry, block.shown);
  block.mesh.renderOrder = data.blocks.length + 1;
  block.closed = new THREE.Mesh(closed, parity);
  const filled = tint => new THREE.MeshBasicMaterial({
    color: tint, side: THREE.DoubleSide, stencilWrite: true, stencilRef: 0, stencilFunc: THREE.NotEqualStencilFunc,
    stencilFail: THREE.ReplaceStencilOp, stencilZFail: THREE.ReplaceStencilOp, stencilZPass: THREE.ReplaceStencilOp,
  });
  block.filled = filled(color);
  block.cap = new THREE.Mesh(new THREE.PlaneBufferGeometry(1, 1), block.filled);
  block.cap.frustumCulled = false;
  block.cap.onAfterRender = () => renderer.clearStencil();
  block.closed.renderOrder = at + 0.1;
  block.cap.renderOrder = at + 0.2;
  block.pickMaterials = [new THREE.MeshBasicMaterial({ color: id, clippingPlanes: [plane] }), filled(id)];
  block.group.add(block.mesh, block.closed);
  model.add(block.group);
  caps.add(block.cap);
  return block;
}

// The box of corners, by their numbers.
function boxOf(numbers) {
  const box = new THREE.Box3(), [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const number of numbers) {
    for (let k = 0; k < 3; k++) {
      const value = positions[3 * number + k];
      if (value < low[k]) low[k] = value;
      if (value > high[k]) high[k] = value;
    }
  }
  return box.set(new THREE.Vector3(...low), new THREE.Vector3(...high));
}

// The numbers of the triangles of each block.
function listTriangles() {
  const lists = new Map(data.blocks.map(record => [record.number, []]));
  for (let side = 0; side < sides.length; side++) if (sides[side] !== NO_BLOCK) lists.get(sides[side]).push(side >> 1);
  return lists;
}

// The corners of those triangles of a block whose other side passes a test, counter-clockwise seen from outside.
function indexOf(block, test) {
  const index = new Uint32Array(3 * block.triangles.length);
  let end = 0;
  for (const t of block.triangles) {
    const isTurned = sides[2 * t] !== block.record.number, other = sides[2 * t + (isTurned ? 0 : 1)];
    if (!test(other)) continue;
    index[end++] = corners[3 * t];
    index[end++] = corners[3 * t + (isTurned ? 2 : 1)];
    index[end++] = corners[3 * t + (isTurned ? 1 : 2)];
  }
  return index.slice(0, end);
}

// Between two blocks that are shown nothing is seen, unless they are apart.
function updateBlocks() {
  const apart = state.explode > 0;
  const shown = new Set(data.blocks.map(b => b.number).filter(number => !state.hidden.has(number)));
  const layout = apart + " " + [...shown];
  const extent = high.z - low.z;
  const order = [...blocks].sort((a, b) => a.center.z - b.center.z);
  const middle = low.clone().add(high).multiplyScalar(0.5);
  order.forEach((block, rank) => {
    const up = (rank - (order.length - 1) / 2) * extent * 1.6 / order.length;
    block.group.position.set((block.center.x - middle.x) * 0.6, (block.center.y - middle.y) * 0.6, up).multiplyScalar(state.explode);
    block.group.visible = shown.has(block.record.number);
    if (layout !== updateBlocks.layout) {
      block.mesh.geometry.setIndex(new THREE.BufferAttribute(indexOf(block, other => apart || !shown.has(other)), 1));
    }
  });
  updateBlocks.layout = layout;
  model.scale.z = state.vertical;
  for (const group of Object.values(layers)) group.scale.z = state.vertical;
  for (const [name, group] of Object.entries(layers)) group.visible = state.layers.has(name);
}

function updateSection() {
  const axis = AXES.indexOf(state.axis), isCut = axis >= 0;
  const scale = axis === 2 ? state.vertical : 1;
  const at = isCut ? (low.getComponent(axis) + state.at * (high.getComponent(axis) - low.getComponent(axis))) : 0;
  plane.normal.set(0, 0, 0);
  if (isCut) plane.normal.setComponent(axis, state.flip ? 1 : -1);
  plane.constant = isCut ? (state.flip ? -at : at) * scale : 1;
  const scaling = new THREE.Vector3(1, 1, state.vertical);
  for (const block of blocks) {
    const box = block.box.clone().translate(block.group.position);
    box.min.multiply(scaling);
    box.max.multiply(scaling);
    block.closed.visible = block.cap.visible = isCut && block.group.visible && plane.intersectsBox(box);
    block.mesh.visible = !isCut || block.cap.visible || plane.distanceToPoint(box.min) >= 0;
    if (block.cap.visible) coverBox(block.cap.geometry, box, axis, at * scale);
  }
  byId("at").disabled = !isCut;
  byId("at-text").textContent = isCut ? `${state.axis} = ${number(at + data.origin[axis])} ${data.units}` : "";
}

// Puts the rectangle into a box, where a coordinate has a value.
function coverBox(rectangle, box, axis, value) {
  const corners = rectangle.attributes.position;
  for (let i = 0; i < 4; i++) {
    const place = [0, 0, 0];
    place[axis] = value;
    place[(axis + 1) % 3] = (i & 1 ? box.max : box.min).getComponent((axis + 1) % 3);
    place[(axis + 2) % 3] = (i & 2 ? box.max : box.min).getComponent((axis + 2) % 3);
    corners.setXYZ(i, ...place);
  }
  corners.needsUpdate = true;
}

// What is cut off lies toward the camera.
function chooseAxis(name) {
  const axis = AXES.indexOf(name);
  state.axis = name;
  if (axis >= 0) state.flip = camera.position.getComponent(axis) < controls.target.getComponent(axis);
}

// ------------------------------------------------------------------ layers beside the blocks
function addLayer(name, group) {
  group.name = name;
  layers[name] = group;
  scene.add(group);
  const label = document.createElement("label"), box = document.createElement("input");
  box.type = "checkbox";
  box.dataset.layer = name;
  box.addEventListener("change", () => { state.layers[box.checked ? "add" : "delete"](name); update(); });
  label.append(box, ` ${name}`);
  byId("layers").append(label);
}

async function addFaults() {
  const group = new THREE.Group();
  for (const fault of data.faults) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(await floats(fault.positions), 3));
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(await integers(fault.corners)), 1));
    const material = new THREE.MeshPhongMaterial({ color: 0xb03030, flatShading: true, shininess: 0, side: THREE.DoubleSide, transparent: true, opacity: 0.55, depthWrite: false, clippingPlanes: [plane] });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.renderOrder = data.blocks.length + 3;
    group.add(mesh);
  }
  if (data.faults.length) addLayer("Faults", group);
}

async function addHoles() {
  const group = new THREE.Group(), colors = new Map(data.blocks.map(b => [b.number, b.color]));
  const radius = diagonal / 350;
  for (const hole of data.holes) {
    const places = await floats(hole.places);
    const place = at => new THREE.Vector3().fromArray(places, 3 * at);
    for (let at = 0; at + 1 < places.length / 3; at++) {
      const path = new THREE.LineCurve3(place(at), place(at + 1));
      const color = colors.get(hole.blocks[at]) || "#8a8a8a";
      const mesh = new THREE.Mesh(new THREE.TubeBufferGeometry(path, 1, radius, 8), new THREE.MeshPhongMaterial({ color, shininess: 0 }));
      mesh.renderOrder = data.blocks.length + 2;
      group.add(mesh);
    }
    if (data.holes.length <= 60) {
      const label = document.createElement("span");
      label.textContent = hole.name;
      byId("labels").append(label);
      group.userData.labels = [...(group.userData.labels || []), { label, place: place(0) }];
    }
  }
  if (data.holes.length) addLayer("Boreholes", group);
}

async function addPoints() {
  const places = await floats(data.points);
  if (!places.length) return;
  const geometry = new THREE.BufferGeometry(), group = new THREE.Group();
  geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
  const points = new THREE.Points(geometry, new THREE.PointsMaterial({ color: 0x111111, size: 4, sizeAttenuation: false, clippingPlanes: [plane] }));
  points.renderOrder = data.blocks.length + 2;
  group.add(points);
  addLayer("Data points", group);
}

// ------------------------------------------------------------------ view
function number(value) {
  return value.toLocaleString("en-US", { maximumSignificantDigits: Math.abs(value) < 1000 ? 4 : 9, maximumFractionDigits: Math.abs(value) < 1000 ? 3 : 0 });
}

function setView(direction) {
  const middle = low.clone().add(high).multiplyScalar(0.5);
  middle.z *= state.vertical;
  const distance = 0.62 * diagonal / Math.tan(camera.fov * Math.PI / 360) / Math.min(1, camera.aspect);
  controls.target.copy(middle);
  camera.position.copy(middle).addScaledVector(direction.clone().normalize(), distance);
  controls.update();
}
const OBLIQUE = new THREE.Vector3(-0.55, -1, 0.65), FROM_ABOVE = new THREE.Vector3(0, -0.0001, 1);

function resize() {
  const box = byId("view").getBoundingClientRect();
  renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
  renderer.setSize(box.width, box.height, false);
  camera.aspect = box.width / Math.max(box.height, 1);
  camera.updateProjectionMatrix();
}

function render() {
  asked = false;
  const distance = camera.position.distanceTo(controls.target);
  camera.near = distance / 100;
  camera.far = distance + 4 * diagonal * Math.max(1, state.vertical);
  camera.updateProjectionMatrix();
  const dark = getComputedStyle(document.documentElement).getPropertyValue("--back").trim();
  renderer.setClearColor(dark || "#f4f5f7");
  renderer.render(scene, camera);
  drawMarks(distance);
}

function drawMarks(distance) {
  const box = byId("canvas").getBoundingClientRect();
  const pixel = 2 * distance * Math.tan(camera.fov * Math.PI / 360) / box.height;
  const wanted = pixel * Math.min(160, box.width / 3), power = 10 ** Math.floor(Math.log10(wanted));
  const length = [5, 2, 1].find(digit => digit * power <= wanted) * power;
  byId("scale-bar").style.width = `${length / pixel}px`;
  byId("scale-text").textContent = `${number(length)} ${data.units}`;
  const forward = controls.target.clone().sub(camera.position);
  const turn = Math.hypot(forward.x, forward.y) < 1e-3 * distance ? 0 : Math.atan2(forward.x, forward.y);
  byId("needle").setAttribute("transform", `rotate(${-turn * 180 / Math.PI})`);
  const holes = layers.Boreholes;
  for (const { label, place } of (holes && holes.userData.labels) || []) {
    const at = place.clone();
    at.z *= state.vertical;
    at.project(camera);
    label.hidden = !holes.visible || Math.abs(at.z) > 1;
    label.style.transform = `translate(${(at.x + 1) / 2 * box.width + 4}px, ${(1 - at.y) / 2 * box.height - 16}px)`;
  }
}

function ask() {
  if (!asked) requestAnimationFrame(render);
  asked = true;
}

function update() {
  updateBlocks();
  updateSection();
  showState();
  ask();
}

// ------------------------------------------------------------------ which block is at a place of the canvas
function pick(x, y) {
  const size = renderer.getSize(new THREE.Vector2()), target = new THREE.WebGLRenderTarget(1, 1);
  const others = Object.values(layers).map(group => [group, group.visible]);
  for (const [group] of others) group.visible = false;
  for (const block of blocks) [block.mesh.material, block.cap.material] = block.pickMaterials;
  renderer.setClearColor(0);
  camera.setViewOffset(size.x, size.y, x, y, 1, 1);
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  const rgba = new Uint8Array(4);
  renderer.readRenderTargetPixels(target, 0, 0, 1, 1, rgba);
  renderer.setRenderTarget(null);
  camera.clearViewOffset();
  target.dispose();
  for (const block of blocks) [block.mesh.material, block.cap.material] = [block.shown, block.filled];
  for (const [group, visible] of others) group.visible = visible;
  const at = (rgba[0] << 16) + (rgba[1] << 8) + rgba[2] - 1;
  return at < 0 ? NO_BLOCK : data.blocks[at].number;
}

function showPicked(chosen) {
  const record = data.blocks.find(b => b.number === chosen), box = byId("picked");
  for (const row of byId("blocks").rows) row.classList.toggle("picked", Number(row.dataset.block) === chosen);
  box.hidden = !record;
  if (!record) return;
  const title = document.createElement("strong"), text = document.createElement("div");
  title.textContent = record.name;
  text.textContent = `${record.material && record.material !== record.name ? `${record.material}, ` : ""}${record.volume_text} ${data.units}³ (${(100 * record.share).toFixed(1)} %)`
    + (record.parts > 1 ? `, ${record.parts} parts` : "") + (severalRocks() ? `, rock mass ${record.rock}` : "");
  box.replaceChildren(title, text);
}
const severalRocks = () => new Set(data.blocks.map(b => b.rock)).size > 1;

// ------------------------------------------------------------------ the address of a view
function hash() {
  const short = values => values.map(value => Number(value.toPrecision(6))).join(",");
  const words = [`c=${short([...camera.position.toArray(), ...controls.target.toArray()])}`];
  if (state.hidden.size) words.push(`h=${[...state.hidden].sort((a, b) => a - b).join(",")}`);
  if (state.axis) words.push(`s=${state.axis},${Number(state.at.toFixed(4))},${Number(state.flip)}`);
  if (state.explode) words.push(`e=${Number(state.explode.toFixed(3))}`);
  if (state.vertical !== 1) words.push(`v=${Number(state.vertical.toFixed(3))}`);
  words.push(`l=${[...state.layers].map(name => name[0]).join("")}`);
  const theme = document.documentElement.dataset.theme;
  if (theme) words.push(`t=${theme}`);
  return "#" + words.join("&");
}

function readHash() {
  const words = Object.fromEntries(location.hash.slice(1).split("&").map(word => word.split("=")));
  const numbers = text => text.split(",").map(Number);
  if (words.h) state.hidden = new Set(numbers(words.h));
  if (words.s) {
    const [axis, at, flip] = words.s.split(",");
    if (AXES.includes(axis)) Object.assign(state, { axis, at: Math.min(Math.max(Number(at) || 0, 0), 1), flip: flip === "1" });
  }
  if (words.e) state.explode = Math.min(Math.max(Number(words.e) || 0, 0), 1);
  if (words.v) state.vertical = Math.min(Math.max(Number(words.v) || 1, 1), 20);
  if (words.l !== undefined) state.layers = new Set(Object.keys(layers).filter(name => words.l.includes(name[0])));
  if (["dark", "light"].includes(words.t)) document.documentElement.dataset.theme = words.t;
  const places = words.c ? numbers(words.c) : [];
  return places.length === 6 && places.every(Number.isFinite) ? places : null;
}

function keepHash() {
  if (location.protocol === "about:") return;  // in a notebook
  try { history.replaceState(null, "", hash()); } catch (error) { location.hash = hash(); }
}

// ------------------------------------------------------------------ controls
function showState() {
  for (const input of document.querySelectorAll("input[name=axis]")) input.checked = input.value === state.axis;
  byId("flip").checked = state.flip;
  byId("at").value = Math.round(1000 * state.at);
  byId("explode").value = Math.round(100 * state.explode);
  byId("explode-text").textContent = `${Math.round(100 * state.explode)} %`;
  byId("vertical").value = Math.round(100 * Math.log(state.vertical) / Math.log(20));
  byId("vertical-text").textContent = `${Number(state.vertical.toFixed(2))} ×`;
  for (const input of byId("layers").querySelectorAll("input")) input.checked = state.layers.has(input.dataset.layer);
  for (const input of byId("blocks").querySelectorAll("input")) input.checked = !state.hidden.has(Number(input.dataset.block));
  byId("all").checked = !state.hidden.size;
  byId("all").indeterminate = state.hidden.size > 0 && state.hidden.size < data.blocks.length;
}

function listBlocks() {
  byId("volume-head").textContent = `Volume (${data.units}³)`;
  byId("sum").textContent = data.volume_text;
  byId("sum").dataset.volume = data.volume;
  for (const record of [...data.blocks].reverse()) {  // youngest first
    const row = byId("blocks").insertRow(), box = document.createElement("input"), swatch = document.createElement("span");
    row.dataset.block = record.number;
    Object.assign(box, { type: "checkbox", checked: true });
    box.dataset.block = record.number;
    box.setAttribute("aria-label", `Show ${record.name}`);
    box.addEventListener("change", () => { state.hidden[box.checked ? "delete" : "add"](record.number); update(); });
    swatch.className = "swatch";
    swatch.style.background = record.color;
    row.insertCell().append(box);
    const name = row.insertCell();
    name.append(swatch, record.name);
    if (severalRocks() || (record.material && record.material !== record.name)) {
      const more = document.createElement("small");
      more.textContent = [record.material !== record.name && record.material, severalRocks() && record.rock].filter(Boolean).join(" · ");
      name.append(more);
    }
    const volume = row.insertCell(), share = row.insertCell();
    volume.className = share.className = "number";
    volume.textContent = record.volume_text;
    volume.title = String(record.volume);
    volume.dataset.volume = record.volume;
    share.textContent = `${(100 * record.share).toFixed(1)} %`;
    row.addEventListener("click", event => { if (event.target !== box) showPicked(record.number); });
  }
}

function turn(right, up) {
  const offset = camera.position.clone().sub(controls.target), angles = new THREE.Spherical();
  offset.set(offset.x, offset.z, -offset.y);  // three.js measures angles from y
  angles.setFromVector3(offset);
  angles.theta += right;
  angles.phi = Math.min(Math.max(angles.phi - up, 0.001), Math.PI - 0.001);
  offset.setFromSpherical(angles);
  camera.position.copy(controls.target).add(new THREE.Vector3(offset.x, -offset.z, offset.y));
  controls.update();
}

function move(right, up) {
  const step = camera.position.distanceTo(controls.target) * 0.06, offset = new THREE.Vector3(right * step, up * step, 0);
  offset.applyQuaternion(camera.quaternion);
  camera.position.add(offset);
  controls.target.add(offset);
  controls.update();
}

function zoom(factor) {
  camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
  controls.update();
}

function toggleTheme() {
  const root = document.documentElement, isDark = getComputedStyle(root).colorScheme.includes("dark");
  root.dataset.theme = isDark ? "light" : "dark";
  keepHash();
  ask();
}

const KEYS = {
  ArrowLeft: shift => shift ? move(-1, 0) : turn(-0.1, 0), ArrowRight: shift => shift ? move(1, 0) : turn(0.1, 0),
  ArrowUp: shift => shift ? move(0, 1) : turn(0, 0.1), ArrowDown: shift => shift ? move(0, -1) : turn(0, -0.1),
  "+": () => zoom(0.9), "=": () => zoom(0.9), "-": () => zoom(1 / 0.9),
  r: () => setView(OBLIQUE), t: toggleTheme,
};

function listen() {
  controls.addEventListener("change", ask);
  controls.addEventListener("end", keepHash);
  window.addEventListener("resize", () => { resize(); ask(); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", ask);
  const set = (id, event, change) => byId(id).addEventListener(event, () => { change(byId(id)); update(); keepHash(); });
  byId("axes").addEventListener("change", event => { if (event.target.name === "axis") { chooseAxis(event.target.value); update(); keepHash(); } });
  set("flip", "change", input => { state.flip = input.checked; });
  set("at", "input", input => { state.at = input.value / 1000; });
  set("explode", "input", input => { state.explode = input.value / 100; });
  set("vertical", "input", input => { state.vertical = 20 ** (input.value / 100); });
  set("all", "change", input => { state.hidden = new Set(input.checked ? [] : data.blocks.map(b => b.number)); });
  byId("reset").addEventListener("click", () => { setView(OBLIQUE); keepHash(); });
  byId("top").addEventListener("click", () => { setView(FROM_ABOVE); keepHash(); });
  byId("theme").addEventListener("click", toggleTheme);
  byId("link").addEventListener("click", copyLink);
  byId("blocks").addEventListener("change", keepHash);
  byId("layers").addEventListener("change", keepHash);
  const canvas = byId("canvas");
  let pressed = null;
  canvas.addEventListener("pointerdown", event => { pressed = [event.clientX, event.clientY]; });
  canvas.addEventListener("pointerup", event => {
    if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
    const box = canvas.getBoundingClientRect();
    showPicked(pick(event.clientX - box.left, event.clientY - box.top));
    ask();
  });
  canvas.addEventListener("keydown", event => {
    const act = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    act(event.shiftKey);
    event.preventDefault();
    keepHash();
    ask();
  });
}

async function copyLink() {
  keepHash();
  try {
    await navigator.clipboard.writeText(location.href);
    byId("link").textContent = "Copied";
  } catch (error) {  // without a secure context there is no clipboard
    window.prompt("The address of this view", location.href);
  }
  setTimeout(() => { byId("link").textContent = "Copy link"; }, 1500);
}

// Without a graphics card smooth edges take most of the time.
function drawsInSoftware() {
  const context = document.createElement("canvas").getContext("webgl");
  const info = context && context.getExtension("WEBGL_debug_renderer_info");
  const name = info ? context.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

// ------------------------------------------------------------------ begin
async function begin() {
  if (typeof DecompressionStream === "undefined") throw new Error("This browser is too old to unpack the model: open the page in a current one.");
  try {
    renderer = new THREE.WebGLRenderer({ canvas: byId("canvas"), antialias: !drawsInSoftware(), stencil: true });
  } catch (error) {
    throw new Error("This browser draws no 3D (WebGL is off or missing): switch on hardware acceleration, or open the page in another browser.");
  }
  renderer.localClippingEnabled = true;
  renderer.autoClearStencil = true;
  [positions, corners, sides] = [await floats(data.positions), await integers(data.corners), await integers(data.sides)];
  trianglesOf = listTriangles();
  const box = boxOf(corners);
  if (box.isEmpty()) throw new Error("The model has no blocks.");
  [low, high, diagonal] = [box.min, box.max, box.min.distanceTo(box.max)];
  camera.up.set(0, 0, 1);
  const sun = new THREE.DirectionalLight(0xffffff, 0.55);
  sun.position.set(-0.4, -0.2, 1);
  camera.add(sun);
  scene.add(camera, new THREE.HemisphereLight(0xffffff, 0xd8d4cc, 0.62), model, caps);
  controls = new THREE.OrbitControls(camera, byId("canvas"));
  controls.enableKeys = false;
  controls.screenSpacePanning = true;
  blocks = data.blocks.map(makeBlock);
  await addFaults();
  await addHoles();
  await addPoints();
  if (layers.Boreholes) state.layers.add("Boreholes");
  byId("link").hidden = location.protocol === "about:";
  listBlocks();
  byId("summary").textContent = `${data.blocks.length} blocks, ${data.volume_text} ${data.units}³`;
  const ends = AXES.map((axis, k) => `${axis} ${number(low.getComponent(k) + data.origin[k])} to ${number(high.getComponent(k) + data.origin[k])}`);
  byId("place").textContent = `${ends.join(", ")} ${data.units}. ${data.crs ? `Coordinates: ${data.crs}.` : "No coordinate reference system is named."} Made with RealModel.`;
  const view = readHash();
  resize();
  updateBlocks();
  setView(OBLIQUE);
  if (view) {
    camera.position.fromArray(view);
    controls.target.fromArray(view, 3);
    controls.update();
  }
  listen();
  update();
  render();
  byId("message").hidden = true;
  window.realmodel = { THREE, state, data, camera, controls, renderer, pick, render, update, turn, box: { low, high } };
  document.documentElement.dataset.ready = "yes";
}
begin().catch(error => {
  byId("message").hidden = false;
  byId("message").textContent = error.message;
  document.documentElement.dataset.ready = "no";
  console.error(error);
});
})();
