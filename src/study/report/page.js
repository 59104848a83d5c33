"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const by = id => document.getElementById(id);
const canvases = ["picture", "truth", "difference"].map(by);
const [width, height] = data.size;
// What is shown: a candidate, how, and which part of the picture (centre in pixels, zoom).
const state = { at: data.first, mode: "side", truth: false, split: 0.5, zoom: 1, x: width / 2, y: height / 2, pixel: null };
const pictures = new Map();
let timer = 0;

const number = v => v === null || v === undefined ? "" : Math.abs(v) >= 100 || v === 0 ? v.toFixed(0) : v.toPrecision(3);

async function decode(source) {
  const image = new Image();
  image.src = source;
  await image.decode();
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  return { canvas, values: context.getImageData(0, 0, width, height).data };
}

async function picture(i) {
  if (!pictures.has(i)) pictures.set(i, decode(i < 0 ? data.truth : data.candidates[i].picture));
  return pictures.get(i);
}

const linear = Float64Array.from({ length: 256 }, (_, i) => {
  const v = i / 255;
  return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
});

function difference(a, b) {
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d");
  const out = context.createImageData(width, height);
  let worst = [0, -1];
  for (let i = 0; i < width * height; i++) {
    let sum = 0, most = 0;
    for (let c = 0; c < 3; c++) {
      const d = linear[a[4 * i + c]] - linear[b[4 * i + c]];
      sum += d;
      most = Math.max(most, Math.abs(d));
    }
    if (most > worst[1]) worst = [i, most];
    const shade = Math.round(255 * Math.sqrt(Math.min(1, 4 * most)));
    out.data.set(sum >= 0 ? [shade, shade * 0.35, 0, 255] : [0, shade * 0.6, shade, 255], 4 * i);
  }
  context.putImageData(out, 0, 0);
  return { canvas, worst: [worst[0] % width, Math.floor(worst[0] / width)] };
}

const differences = new Map();
async function compared(i) {
  if (!differences.has(i)) {
    const [a, b] = await Promise.all([picture(i), picture(-1)]);
    differences.clear();
    differences.set(i, difference(a.values, b.values));
  }
  return differences.get(i);
}

// The part of the picture that a canvas shows: left, top, wide, high, in pixels.
function part() {
  const wide = width / state.zoom, high = height / state.zoom;
  const hold = (v, size, room) => Math.min(Math.max(v - size / 2, 0), room - size);
  return [hold(state.x, wide, width), hold(state.y, high, height), wide, high];
}

function paint(canvas, source, from = 0, to = 1) {
  const context = canvas.getContext("2d");
  const [left, top, wide, high] = part();
  context.imageSmoothingEnabled = state.zoom < 1;
  const x = from * canvas.width, w = (to - from) * canvas.width;
  context.drawImage(source, left + from * wide, top, (to - from) * wide, high, x, 0, w, canvas.height);
}

function cross(canvas) {
  if (!state.pixel) return;
  const [left, top, wide] = part();
  const scale = canvas.width / wide;
  const context = canvas.getContext("2d");
  context.strokeStyle = "#e69f00";
  context.lineWidth = Math.max(2, canvas.width / 300);
  const side = Math.max(scale, 12);
  const middle = (v, from) => (v + 0.5 - from) * scale;
  context.strokeRect(middle(state.pixel[0], left) - side / 2, middle(state.pixel[1], top) - side / 2, side, side);
}

let turn = 0;
async function show() {
  const mine = ++turn;
  const i = state.at;
  const [shown, truth, both] = await Promise.all([picture(i), picture(-1), compared(i)]);
  if (mine !== turn) return;
  for (const canvas of canvases) {
    const wide = Math.min(width, 2048);
    if (canvas.width !== wide) { canvas.width = wide; canvas.height = Math.round(wide * height / width); }
  }
  const side = state.mode === "side";
  by("two").hidden = by("three").hidden = !side;
  by("split").hidden = state.mode !== "slide";
  if (state.mode === "blink") paint(canvases[0], (state.truth ? truth : shown).canvas);
  else paint(canvases[0], shown.canvas);
  if (state.mode === "slide") paint(canvases[0], truth.canvas, state.split, 1);
  by("says").textContent = state.mode === "blink" && state.truth ? "Truth"
    : state.mode === "slide" ? "Picture left, truth right" : "Picture";
  if (side) { paint(canvases[1], truth.canvas); paint(canvases[2], both.canvas); }
  canvases.forEach(cross);
  read(shown, truth);
  document.body.dataset.ready = `${i} ${state.mode}`;
}

function read(shown, truth) {
  if (!state.pixel) return;
  const [x, y] = state.pixel;
  const at = 4 * (y * width + x);
  const say = values => [0, 1, 2].map(c => values[at + c]).join(" ");
  by("read").textContent = `(${x}, ${y}) picture ${say(shown.values)}, truth ${say(truth.values)} of 255, sRGB`;
  location.replace(`#${state.at + 1},${x},${y},${state.zoom}`);
}

function choose(i) {
  state.at = i;
  const candidate = data.candidates[i];
  by("name").textContent = `${i + 1}  ${candidate.options}`;
  by("figures").textContent = data.columns.map((column, c) => `${column} ${number(candidate.values[c])}`).join("; ");
  for (const element of document.querySelectorAll("[data-point]"))
    element.toggleAttribute("aria-current", Number(element.dataset.point) === i);
  show();
}

function mode(name) {
  state.mode = name;
  for (const id of ["side", "blink", "slide"]) by(id).setAttribute("aria-pressed", String(id === name));
  clearInterval(timer);
  state.truth = false;
  // Twice a second, unless somebody wants less motion: then by the space bar.
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (name === "blink" && !calm) timer = setInterval(flip, 500);
  show();
}

function flip() { state.truth = !state.truth; show(); }

function zoom(factor, x = state.x, y = state.y) {
  const before = state.zoom;
  state.zoom = Math.min(64, Math.max(1, before * factor));
  const kept = before / state.zoom;
  state.x = x + (state.x - x) * kept;
  state.y = y + (state.y - y) * kept;
  const [left, top, wide, high] = part();
  state.x = left + wide / 2;
  state.y = top + high / 2;
  show();
}

function place(canvas, event) {
  const box = canvas.getBoundingClientRect();
  const [left, top, wide, high] = part();
  return [left + (event.clientX - box.left) / box.width * wide, top + (event.clientY - box.top) / box.height * high];
}

function point(x, y) {
  state.pixel = [Math.min(width - 1, Math.max(0, Math.floor(x))), Math.min(height - 1, Math.max(0, Math.floor(y)))];
  show();
}

async function worst() {
  const both = await compared(state.at);
  state.pixel = both.worst;
  [state.x, state.y] = both.worst;
  state.zoom = Math.max(state.zoom, 8);
  zoom(1);
}

for (const canvas of canvases) {
  const fingers = new Map();
  let moved = 0;
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    zoom(2 ** (-event.deltaY / 200), ...place(canvas, event));
  }, { passive: false });
  canvas.addEventListener("pointerdown", event => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    moved = 0;
  });
  canvas.addEventListener("pointermove", event => {
    const last = fingers.get(event.pointerId);
    if (!last) { if (event.pointerType === "mouse") point(...place(canvas, event)); return; }
    const now = [event.clientX, event.clientY];
    const scale = part()[2] / canvas.getBoundingClientRect().width;
    if (fingers.size === 2) {
      const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
      const apart = p => Math.hypot(p[0] - other[0], p[1] - other[1]);
      if (apart(last) > 0) zoom(apart(now) / apart(last));
    } else {
      state.x -= (now[0] - last[0]) * scale;
      state.y -= (now[1] - last[1]) * scale;
      zoom(1);
    }
    moved += Math.hypot(now[0] - last[0], now[1] - last[1]);
    fingers.set(event.pointerId, now);
  });
  for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, event => {
    if (kind === "pointerup" && fingers.size === 1 && moved < 4) point(...place(canvas, event));
    fingers.delete(event.pointerId);
  });
}

for (const id of ["side", "blink", "slide"]) by(id).addEventListener("click", () => mode(id));
by("plus").addEventListener("click", () => zoom(2));
by("minus").addEventListener("click", () => zoom(0.5));
by("reset").addEventListener("click", () => zoom(1 / 64));
by("worst").addEventListener("click", worst);
by("split").addEventListener("input", event => { state.split = event.target.value / 1000; show(); });
addEventListener("keydown", event => {
  if (event.target.tagName === "INPUT" || event.ctrlKey || event.metaKey) return;
  const step = part()[2] / 16;
  const done = {
    "+": () => zoom(2), "=": () => zoom(2), "-": () => zoom(0.5), "0": () => zoom(1 / 64),
    ArrowLeft: () => { state.x -= step; zoom(1); }, ArrowRight: () => { state.x += step; zoom(1); },
    ArrowUp: () => { state.y -= step; zoom(1); }, ArrowDown: () => { state.y += step; zoom(1); },
    " ": () => { if (state.mode === "blink") flip(); else return true; }, w: worst,
    n: () => choose((state.at + 1) % data.candidates.length),
    p: () => choose((state.at + data.candidates.length - 1) % data.candidates.length),
  }[event.key];
  const onCanvas = event.target.tagName === "CANVAS" || event.target === document.body;
  if (done && (onCanvas || event.key.length === 1 && event.key !== " ") && !done()) event.preventDefault();
});

const head = document.createElement("tr");
for (const column of ["options", ...data.columns]) head.appendChild(document.createElement("th")).textContent = column;
by("table").tHead.appendChild(head);
data.candidates.forEach((candidate, i) => {
  const row = by("table").tBodies[0].insertRow();
  row.dataset.point = i;
  row.tabIndex = 0;
  row.insertCell().textContent = `${i + 1}  ${candidate.options}${candidate.front ? " *" : ""}`;
  for (const value of candidate.values) row.insertCell().textContent = number(value);
});
for (const element of document.querySelectorAll("[data-point]")) {
  const pick = () => choose(Number(element.dataset.point));
  element.addEventListener("click", pick);
  element.addEventListener("keydown", event => { if (event.key === "Enter") pick(); });
}
const [at, x, y, z] = location.hash.slice(1).split(",").map(Number);
if (z > 0 && x < width && y < height) Object.assign(state, { pixel: [x, y], x, y, zoom: Math.min(64, Math.max(1, z)) });
choose(at >= 1 && at <= data.candidates.length ? at - 1 : data.first);
