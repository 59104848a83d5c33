"use strict";
const by = id => document.getElementById(id);
const data = JSON.parse(by("data").textContent);
const [width, height] = data.size;
const pixels = width * height;
const NONE = 0xffffffff;
const views = [0, 1, 2, 3].map(i => by(`view${i}`));
const calm = matchMedia("(prefers-reduced-motion: reduce)");
// Where one looks: a tab, a plane, the scale (a place in `scales()`) and the pixel at the middle.
const state = { tab: 0, plane: 0, mode: "side", swapped: false, split: 0.5, step: 0, x: width / 2, y: height / 2, cursor: null, hover: null };
let loaded = null, timer = 0, drawing = 0, turn = 0;

// ---- Numbers

async function unpack(id) {
  const text = by(`b${id}`).textContent;
  const packed = Uint8Array.fromBase64 ? Uint8Array.fromBase64(text) : Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  for (let i = 1; i < bytes.length; i++) bytes[i] += bytes[i - 1];
  return bytes;
}

// The values of a channel in both pictures; a picture that lacks them has null.
async function values(entry) {
  const bits = await Promise.all(entry.bytes.map(async ids => {
    if (!ids.length) return null;
    const all = new Uint32Array(pixels);
    for (const [k, bytes] of (await Promise.all(ids.map(unpack))).entries())
      for (let i = 0; i < pixels; i++) all[i] |= bytes[i] << (24 - 8 * k);
    return all;
  }));
  // The second picture is stored as the bits that differ.
  if (bits[0] && bits[1]) for (let i = 0; i < pixels; i++) bits[1][i] ^= bits[0][i];
  const numbers = bits.map((all, side) => all && entry.float[side] ? new Float32Array(all.buffer) : all);
  const low = Math.max(...entry.bytes.map(ids => ids.length)) === 4;
  return { bits, numbers, float: entry.float, digits: entry.digits, low };
}

const isExact = (channel, i) => channel.digits === 4 || channel.low && loaded.exact && loaded.exact[i] === 1;

// A number without its low bytes is that in the middle of what they may be.
function number(channel, side, i) {
  const all = channel.numbers[side];
  if (!channel.float[side] || isExact(channel, i) || all[i] === 0 || !Number.isFinite(all[i])) return all[i];
  const bits = new Uint32Array([channel.bits[side][i] | (channel.digits === 3 ? 0x80 : 0x8000)]);
  return new Float32Array(bits.buffer)[0];
}

function text(channel, side, i, kind) {
  if (!channel || !channel.numbers[side]) return "\u2013";
  const v = number(channel, side, i);
  if (!channel.float[side]) return kind === "index" && v === NONE ? "none" : String(v);
  if (Number.isNaN(v)) return "NaN";
  if (!Number.isFinite(v)) return (v > 0 ? "inf" : "-inf") + (kind === "depth" && v > 0 ? " (empty)" : "");
  if (isExact(channel, i)) return Object.is(v, -0) ? "-0" : String(v);
  return v === 0 ? "0" : `\u2248 ${v.toPrecision(channel.digits === 3 ? 5 : 3)}`;
}

const order = bits => bits >>> 31 ? -(bits & 0x7fffffff) : bits;

function difference(channel, i) {
  const [a, b] = channel ? channel.bits : [];
  if (!a || !b || channel.float[0] !== channel.float[1]) return "";
  const exact = isExact(channel, i);
  if (a[i] === b[i]) return exact ? "0" : "same digits";
  if (!channel.float[0]) return "differs";
  const [v, w] = [0, 1].map(side => number(channel, side, i));
  if (!Number.isFinite(v) || !Number.isFinite(w)) return "differs";
  return (exact ? `${Math.abs(order(a[i]) - order(b[i]))} ulp, ` : "\u2248 ") + (v - w).toExponential(2);
}

const short = v => !Number.isFinite(v) ? (v > 0 ? "inf" : String(v)) : v === 0 ? "0" : String(Number(v.toPrecision(4)));

// ---- Colours

const STOPS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
const RIGHT = [[13, 27, 52], [62, 124, 196], [190, 220, 245]];
const WRONG = [[255, 214, 92], [240, 110, 20], [190, 0, 30]];
const DOUBTS = [[86, 180, 233], [0, 158, 115], [240, 228, 66], [204, 121, 167], [230, 159, 0], [213, 94, 0], [150, 150, 255], [200, 200, 200]];
const STRANGE = [255, 0, 255];

function ramp(stops, share) {
  const at = Math.min(1, Math.max(0, share)) * (stops.length - 1);
  const k = Math.min(stops.length - 2, Math.floor(at));
  return stops[k].map((c, j) => c + (stops[k + 1][j] - c) * (at - k));
}

const css = color => `rgb(${color.map(Math.round).join(",")})`;
const gradient = stops => `<span class="bars" style="background:linear-gradient(90deg,${stops.map(css).join(",")})"></span>`;
const swatch = color => `<span class="swatch" style="background:${css(color)}"></span>`;
const encode = v => 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);

// The least and the greatest finite value of a plane: of the reference where there is one.
function range(channels) {
  let low = Infinity, high = -Infinity;
  for (const channel of channels) {
    const all = channel && (channel.numbers[1] || channel.numbers[0]);
    for (let i = 0; all && i < pixels; i++) if (Math.abs(all[i]) < Infinity) {
      if (all[i] < low) low = all[i];
      if (all[i] > high) high = all[i];
    }
  }
  return low <= high ? [low, high] : [0, 0];
}

function picture(color) {
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d");
  const out = context.createImageData(width, height);
  for (let i = 0; i < pixels; i++) {
    const rgb = color(i);
    if (!rgb) continue;
    out.data[4 * i] = rgb[0]; out.data[4 * i + 1] = rgb[1]; out.data[4 * i + 2] = rgb[2]; out.data[4 * i + 3] = 255;
  }
  context.putImageData(out, 0, 0);
  return canvas;
}

// A plane of one of the pictures in colours; null means an empty pixel.
function colors(plane, channels, side, [low, high]) {
  const all = channels.map(channel => channel && channel.numbers[side]);
  if (!all.every(Boolean)) return null;
  const [a, b, c] = all;
  const most = Math.max(Math.abs(low), Math.abs(high)) || 1;
  switch (plane.kind) {
    case "color": return picture(i => [a[i], b[i], c[i]].some(Number.isNaN) ? STRANGE : [a[i], b[i], c[i]].map(v => encode(Math.min(1, Math.max(0, v)))));
    case "vector": case "normal": {
      const size = plane.kind === "normal" ? 1 : most;
      return picture(i => {
        const v = [a[i], b[i], c[i]];
        if (v.every(v => v === 0)) return null;
        return v.every(Number.isFinite) ? v.map(v => 127.5 + 127.5 * v / size) : STRANGE;
      });
    }
    case "index": return picture(i => {
      if (a[i] === NONE) return null;
      const hash = Math.imul(a[i] + 1, 0x9e3779b1) >>> 0;
      return [80 + (hash >>> 24) % 176, 80 + (hash >>> 16 & 255) % 176, 80 + (hash >>> 8 & 255) % 176];
    });
    case "count": return picture(i => a[i] === 0 ? null : ramp(STOPS, a[i] / most));
    default: return picture(i => {
      if (a[i] === Infinity && plane.kind === "depth") return null;
      if (Number.isNaN(a[i]) || a[i] === -Infinity) return STRANGE;
      return ramp(STOPS, high > low ? (a[i] - low) / (high - low) : 0.5);
    });
  }
}

function scaleOf(plane, [low, high]) {
  const unit = plane.unit ? ` ${plane.unit}` : "";
  const strange = `${swatch(STRANGE)}NaN`;
  const empty = '<span class="swatch empty"></span>empty';
  const most = Math.max(Math.abs(low), Math.abs(high));
  switch (plane.kind) {
    case "color": return `Linear RGB shown in sRGB, clipped to [0, 1]; ${strange}`;
    case "normal": return `X, Y, Z from -1 to 1 as red, green, blue; ${empty} ${strange}`;
    case "vector": return `X, Y, Z from ${short(-most)} to ${short(most)} as red, green, blue; ${empty} ${strange}`;
    case "index": return `A colour for each index; ${empty}`;
    case "count": return `0 ${gradient(STOPS)} ${short(most)}; ${empty}`;
    case "depth": return `${short(low)} ${gradient(STOPS)} ${short(high)}${unit}, linear; ${empty} ${strange}`;
    default: return `${short(low)} ${gradient(STOPS)} ${short(high)}${unit}, linear; ${strange}`;
  }
}

// Errors: blue where right, yellow to red where wrong. Without a limit the scale is logarithmic.
function errorColors({ errors, wrong }) {
  const all = errors.numbers[0];
  const { limit } = data.measure;
  let low = Infinity, high = 0;
  for (let i = 0; i < pixels; i++) if (all[i] > 0 && all[i] < Infinity) { low = Math.min(low, all[i]); high = Math.max(high, all[i]); }
  const share = v => v === Infinity ? 1 : high > low ? Math.log(v / low) / Math.log(high / low) : 0.5;
  const canvas = picture(i => {
    if (all[i] === 0 && !(wrong && wrong[i])) return RIGHT[0];
    if (wrong && wrong[i]) return ramp(WRONG, limit === null ? share(all[i]) : Math.log10(Math.max(1, all[i] / limit)) / 2);
    return ramp(RIGHT, limit === null ? 0.3 + 0.7 * share(all[i]) : all[i] / limit);
  });
  const [right, beyond] = data.measure.words.map(word => word.toLowerCase());
  const legend = limit === null
    ? low > high ? `${swatch(RIGHT[0])}0 everywhere` : `${swatch(RIGHT[0])}0; ${short(low)} to ${short(high)}, logarithmic, ${gradient(RIGHT)}${right} ${gradient(WRONG)}${beyond}`
    : `${right} 0 ${gradient(RIGHT)} ${limit}, ${beyond} ${gradient(WRONG)} ${100 * limit}`;
  return { canvas, legend };
}

function doubtColors(doubts) {
  const tally = data.doubts.map(() => 0);
  let several = false;
  const canvas = picture(i => {
    if (!doubts[i]) return RIGHT[0];
    let color = null;
    data.doubts.forEach(([bit], k) => {
      if (!(doubts[i] & bit)) return;
      tally[k]++;
      several ||= color !== null;
      color = color ? [255, 255, 255] : DOUBTS[k % DOUBTS.length];
    });
    return color;
  });
  const legend = data.doubts.map(([, name], k) => tally[k] ? `${swatch(DOUBTS[k % DOUBTS.length])}${name} ${tally[k]}` : "").join("");
  return { canvas, legend: legend ? legend + (several ? `${swatch([255, 255, 255])}several` : "") : "none" };
}
