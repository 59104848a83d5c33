// ---- Loading

// Reads what a tab and a plane need. All channels of a small tab are read, for the read-out.
async function load() {
  const mine = ++turn;
  document.body.dataset.ready = "";
  const tab = data.tabs[state.tab], plane = tab.planes[state.plane];
  const small = tab.planes.flatMap(plane => plane.channels).length <= 16;
  const listed = (small ? tab.planes : plane ? [plane] : []).map(plane => ({ plane, names: plane.channels }));
  const next = loaded && loaded.tab === tab ? { ...loaded } : { tab, channels: new Map() };
  const one = async id => id === null ? null : unpack(id);
  next.exact ??= await one(data.exact);
  if (!next.marks) {
    next.marks = { errors: tab.errors.digits ? await values(tab.errors) : null, wrong: await one(tab.wrong), doubts: await one(tab.doubts) };
    next.error = next.marks.errors ? errorColors(next.marks) : null;
    next.doubt = next.marks.doubts ? doubtColors(next.marks.doubts) : null;
  }
  const need = names => Promise.all(names.map(async name => {
    const entry = data.channels[name];
    if (!next.channels.has(name)) next.channels.set(name, entry && entry.digits ? await values(entry) : null);
  }));
  await need(plane ? plane.channels : []);
  if (mine !== turn) return;
  loaded = { ...next, rows: [], complete: false };
  const channels = plane ? plane.channels.map(name => next.channels.get(name)) : [];
  const limits = range(channels);
  loaded.sides = plane ? [0, 1].map(side => colors(plane, channels, side, limits)) : [null, null];
  by("scale").innerHTML = plane ? scaleOf(plane, limits) : "";
  by("meaning").textContent = plane ? plane.meaning : "";
  draw();
  // The pictures are there; the numbers of the other planes follow.
  await need(listed.flatMap(({ names }) => names));
  if (mine !== turn) return;
  loaded.rows = listed.flatMap(({ plane, names }) => names.map(name => ({ name, kind: plane.kind })));
  loaded.complete = true;
  draw();
}

// ---- Drawing

const fit = canvas => Math.min(canvas.width / width, canvas.height / height) || 1;

// The whole picture, then whole pixels of the screen for a pixel of the picture.
function scales() {
  const all = fit(views[0]);
  return [all, ...[1, 2, 4, 8, 16, 32, 64].filter(scale => scale > all * 1.01)];
}

function scale(canvas) {
  if (!state.step) return fit(canvas);
  const all = scales();
  return all[Math.min(state.step, all.length - 1)];
}

// The left and the top edge of what is shown, in pixels of the picture; whole pixels of the screen.
function corner(canvas) {
  const s = scale(canvas);
  const edge = (middle, room, size) => Math.round(s * (room / s >= size ? (size - room / s) / 2 : Math.min(Math.max(middle - room / s / 2, 0), size - room / s))) / s;
  return [edge(state.x, canvas.width, width), edge(state.y, canvas.height, height)];
}

function paint(canvas, source, from = 0) {
  const context = canvas.getContext("2d"), s = scale(canvas), [left, top] = corner(canvas);
  context.save();
  context.beginPath();
  context.rect(from * canvas.width, 0, canvas.width, canvas.height);
  context.clip();
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.imageSmoothingEnabled = s < 1;
  context.imageSmoothingQuality = "high";
  context.setTransform(s, 0, 0, s, -left * s, -top * s);
  if (source) context.drawImage(source, 0, 0);
  context.restore();
}

function box(canvas, [x, y], color, least) {
  const context = canvas.getContext("2d"), s = scale(canvas), [left, top] = corner(canvas);
  const side = Math.max(s, least), at = (v, edge) => (v + 0.5 - edge) * s - side / 2;
  for (const [line, tone] of [[4, "#000"], [2, color]]) {
    context.lineWidth = line;
    context.strokeStyle = tone;
    context.strokeRect(at(x, left) - 1, at(y, top) - 1, side + 2, side + 2);
  }
}

const place = i => [i % width, Math.floor(i / width)];
const shown = () => state.hover || state.cursor;

function draw() {
  cancelAnimationFrame(drawing);
  drawing = requestAnimationFrame(now);
}

function now() {
  if (!loaded) return;
  const side = state.mode === "side", ratio = devicePixelRatio || 1;
  const there = [true, side, Boolean(loaded.error), Boolean(loaded.doubt)];
  there.forEach((there, i) => { by(`figure${i}`).hidden = !there; });
  by("views").classList.toggle("large", !side);
  by("views").classList.toggle("one", there.filter(Boolean).length === 1);
  by("views").classList.toggle("zoomed", state.step > 0);
  for (const canvas of views) {
    const high = Math.min(canvas.clientWidth * height / width, Math.max(240, innerHeight * 0.8));
    const [w, h] = [Math.round(canvas.clientWidth * ratio), Math.round(high * ratio)];
    if (w && (canvas.width !== w || canvas.height !== h)) {
      [canvas.width, canvas.height] = [w, h];
      canvas.style.height = `${high}px`;
    }
  }
  const [first, second] = loaded.sides, [one, other] = data.sides;
  const missing = (source, name) => source ? name : `${name}: not in this page`;
  paint(views[0], state.mode === "blink" && state.swapped ? second : first);
  if (state.mode === "slide") paint(views[0], second, state.split);
  by("caption0").textContent = state.mode === "slide" ? `${one} left, ${other} right`
    : state.mode === "blink" && state.swapped ? missing(second, other) : missing(first, one);
  if (side) { paint(views[1], second); by("caption1").textContent = missing(second, other); }
  if (loaded.error) { paint(views[2], loaded.error.canvas); by("caption2").innerHTML = `${data.measure.name}: ${loaded.error.legend}`; }
  if (loaded.doubt) { paint(views[3], loaded.doubt.canvas); by("caption3").innerHTML = `Undecided: ${loaded.doubt.legend}`; }
  if (loaded.error && scale(views[2]) < 4) for (const [i] of loaded.tab.worst) if (loaded.marks.wrong && loaded.marks.wrong[i]) box(views[2], place(i), "#ffd65c", 10 * ratio);
  const pixel = shown();
  if (pixel) views.forEach((canvas, i) => { if (there[i]) box(canvas, pixel, "#fff", 8 * ratio); });
  read();
  document.body.dataset.ready = loaded.complete ? `${state.tab} ${state.plane} ${state.mode}` : "";
}

// ---- The read-out

function cell(row, content, name) {
  const td = row.insertCell();
  td.textContent = content;
  if (name) td.className = name;
  return td;
}

function table(head) {
  const made = document.createElement("table");
  const row = made.createTHead().insertRow();
  for (const name of head) row.appendChild(document.createElement("th")).textContent = name;
  made.createTBody();
  return made;
}

// What the verdict says about a pixel, in a line.
function verdict(i) {
  const { errors, wrong, doubts } = loaded.marks;
  const parts = [];
  if (loaded.tab.mark === "not-judged") parts.push("not judged");
  else if (wrong) parts.push(data.measure.words[wrong[i] ? 1 : 0]);
  if (errors) {
    const entry = loaded.tab.worst.find(([pixel]) => pixel === i);
    const rounded = data.rounded && !(loaded.exact && loaded.exact[i]), say = v => rounded ? `\u2248 ${Number(v.toPrecision(2))}` : short(v);
    const error = entry ? Number(entry[1].replace("inf", "Infinity")) : number(errors, 0, i);
    parts.push(error === Infinity ? "no bound holds it" : data.measure.unit ? `${say(error)} ${data.measure.unit}` : `${data.measure.name.toLowerCase()} ${say(error)}`);
  }
  const names = doubts ? data.doubts.filter(([bit]) => doubts[i] & bit).map(([, name]) => name) : [];
  if (names.length) parts.push(`undecided: ${names.join(", ")}`);
  return parts.join("; ");
}

function read() {
  const pixel = shown(), out = by("read");
  out.replaceChildren();
  if (!pixel) { out.textContent = "Point at a pixel, or focus the pictures and press an arrow key."; return; }
  const i = pixel[1] * width + pixel[0], isWrong = loaded.marks.wrong && loaded.marks.wrong[i];
  const line = (content, name) => { const p = out.appendChild(document.createElement("p")); p.textContent = content; if (name) p.className = name; };
  line(`(${pixel.join(", ")}) ${verdict(i)}`, isWrong ? "wrong" : "");
  if (isWrong && data.cause) line(`looks like: ${data.cause}`);
  const listed = data.explained[i];
  const made = document.createElement("table");
  for (const { name, kind } of loaded.rows) {
    const channel = loaded.channels.get(name), body = made.createTBody();
    body.dataset.channel = name;
    const head = body.insertRow().appendChild(document.createElement("th"));
    [head.colSpan, head.textContent] = [2, name];
    const add = (label, content, style) => { if (content) { const row = body.insertRow(); cell(row, label); cell(row, content, style); } };
    data.sides.forEach((label, side) => add(label.toLowerCase(), text(channel, side, i, kind)));
    add("difference", difference(channel, i));
    for (const { interval, stage, word, error } of listed ? listed.checks : [])
      if (interval && interval[0] === name && stage === loaded.tab.name)
        add("right", `${interval[2] === interval[3] ? interval[2] : `${interval[2]} to ${interval[3]}`}${error ? ` (${error})` : ""}`, word === "WRONG" ? "wrong" : "");
  }
  out.appendChild(made);
  if (!listed && Object.keys(data.explained).length) line("The exact interval is known for the listed pixels.", "small");
}

function decide() {
  const i = state.cursor ? state.cursor[1] * width + state.cursor[0] : -1;
  const listed = data.explained[i];
  by("decisions").hidden = !listed;
  for (const button of by("worst").querySelectorAll("button")) button.setAttribute("aria-current", String(Number(button.dataset.pixel) === i));
  if (!listed) return;
  by("decided").textContent = `Decisions at (${place(i).join(", ")})`;
  const made = table(["stage", "", "value", data.sides[0].toLowerCase(), "right from", "to", "error"]);
  for (const check of listed.checks) {
    const row = made.tBodies[0].insertRow();
    cell(row, check.stage);
    cell(row, check.word, check.word === "WRONG" ? "wrong" : "");
    if (check.interval) check.interval.forEach(value => cell(row, value));
    else cell(row, check.says, "says").colSpan = 4;
    cell(row, check.error);
  }
  by("checks").replaceChildren(...listed.checks.length ? [made] : []);
  by("replay").textContent = listed.replay;
  by("text").textContent = listed.text;
  by("text").hidden = !listed.text;
}

// ---- Acting

function tell() {
  clearTimeout(tell.later);
  tell.later = setTimeout(() => {
    location.replace(`#${[state.tab, state.plane, ...state.cursor || []].join(",")}`);
    if (state.cursor) by("spoken").textContent = `${state.cursor.join(", ")}: ${verdict(state.cursor[1] * width + state.cursor[0])}`;
  }, 250);
}

function look(x, y) { [state.x, state.y] = [x, y]; }

function point(x, y, follow) {
  state.hover = null;
  state.cursor = [Math.min(width - 1, Math.max(0, x)), Math.min(height - 1, Math.max(0, y))];
  const [canvas] = views, s = scale(canvas), [left, top] = corner(canvas);
  const outside = (v, edge, room) => v < edge || v + 1 > edge + room / s;
  if (follow && (outside(state.cursor[0], left, canvas.width) || outside(state.cursor[1], top, canvas.height))) look(...state.cursor);
  decide();
  tell();
  draw();
}

function jump(i) {
  const all = scales(), near = all.findIndex(scale => scale >= 16 * (devicePixelRatio || 1));
  state.step = Math.max(state.step, near < 0 ? all.length - 1 : near);
  look(...place(i).map(v => v + 0.5));
  point(...place(i));
}

function next() {
  const all = loaded.tab.worst.map(([i]) => i);
  if (!all.length) return;
  const here = state.cursor ? all.indexOf(state.cursor[1] * width + state.cursor[0]) : -1;
  jump(all[(here + 1) % all.length]);
}

// Zooms by steps; the point of the picture at a place of the canvas stays there.
function zoom(by, canvas = views[0], at = [canvas.width / 2, canvas.height / 2]) {
  const before = scale(canvas), [left, top] = corner(canvas);
  state.step = Math.min(scales().length - 1, Math.max(0, Math.min(state.step, scales().length - 1) + by));
  const s = scale(canvas);
  look(left + at[0] / before + (canvas.width / 2 - at[0]) / s, top + at[1] / before + (canvas.height / 2 - at[1]) / s);
  draw();
}

function mode(name) {
  if (name === "blink" && state.mode === "blink") state.swapped = !state.swapped;
  else state.swapped = false;
  state.mode = name;
  for (const id of ["side", "blink", "slide"]) by(id).setAttribute("aria-pressed", String(id === name));
  by("split").hidden = name !== "slide";
  clearInterval(timer);
  // Twice a second. With reduced motion the button and the space bar swap the pictures.
  if (name === "blink" && !calm.matches) timer = setInterval(swap, 500);
  draw();
}

function swap() { state.swapped = !state.swapped; draw(); }

function open(tab, plane = 0) {
  state.tab = tab;
  const { planes, says, mark, worst } = data.tabs[tab];
  state.plane = Math.min(plane, Math.max(0, planes.length - 1));
  by("tabs").querySelectorAll("[role=tab]").forEach((button, i) => {
    button.setAttribute("aria-selected", String(i === tab));
    button.tabIndex = i === tab ? 0 : -1;
  });
  by("panel").setAttribute("aria-labelledby", `tab${tab}`);
  by("says").textContent = says;
  by("says").className = mark === "wrong" ? "wrong" : "";
  by("plane").parentElement.hidden = planes.length < 2;
  by("plane").replaceChildren(...planes.map((plane, i) => new Option(plane.name, i, false, i === state.plane)));
  by("worst").replaceChildren(...worst.map(([i, error, why]) => {
    const item = document.createElement("li"), button = item.appendChild(document.createElement("button"));
    button.dataset.pixel = i;
    const size = Number(error.replace("inf", "Infinity"));
    button.textContent = `(${place(i).join(", ")}) ${size === Infinity ? "" : `${short(size)} ${data.measure.unit} `}${why}`;
    button.addEventListener("click", () => jump(i));
    return item;
  }));
  if (!worst.length) by("worst").textContent = "No pixel has an error.";
  decide();
  tell();
  load();
}

for (const [k, canvas] of views.entries()) {
  const fingers = new Map();
  let moved = 0, spread = 1, rolled = 0;
  const at = event => {
    const box = canvas.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width * canvas.width, (event.clientY - box.top) / box.height * canvas.height];
  };
  const under = event => { const [left, top] = corner(canvas), [x, y] = at(event); return [Math.floor(left + x / scale(canvas)), Math.floor(top + y / scale(canvas))]; };
  const inside = ([x, y]) => x >= 0 && y >= 0 && x < width && y < height;
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    rolled += event.deltaY;
    if (Math.abs(rolled) >= 40) { zoom(rolled < 0 ? 1 : -1, canvas, at(event)); rolled = 0; }
  }, { passive: false });
  canvas.addEventListener("pointerdown", event => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    [moved, spread] = [0, 1];
  });
  canvas.addEventListener("pointermove", event => {
    const last = fingers.get(event.pointerId), here = [event.clientX, event.clientY];
    if (!last) {
      if (event.pointerType === "mouse") { state.hover = inside(under(event)) ? under(event) : null; draw(); }
      return;
    }
    if (fingers.size === 2) {
      const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
      const apart = p => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      spread *= apart(here) / apart(last);
      if (spread > 1.5 || spread < 0.67) { zoom(spread > 1 ? 1 : -1, canvas, at(event)); spread = 1; }
    } else {
      const [left, top] = corner(canvas), s = scale(canvas), room = s * canvas.clientWidth / canvas.width;
      const middle = [left + canvas.width / s / 2, top + canvas.height / s / 2];
      look(middle[0] - (here[0] - last[0]) / room, middle[1] - (here[1] - last[1]) / room);
      draw();
    }
    moved += Math.hypot(here[0] - last[0], here[1] - last[1]);
    fingers.set(event.pointerId, here);
  });
  for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, event => {
    if (kind === "pointerup" && fingers.size === 1 && moved < 4 && inside(under(event))) point(...under(event));
    fingers.delete(event.pointerId);
  });
  canvas.addEventListener("pointerleave", () => { state.hover = null; draw(); });
}

by("views").addEventListener("keydown", event => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const far = event.shiftKey ? 10 : 1, [x, y] = state.cursor || [Math.floor(width / 2), Math.floor(height / 2)];
  const act = {
    ArrowLeft: () => point(x - far, y, true), ArrowRight: () => point(x + far, y, true),
    ArrowUp: () => point(x, y - far, true), ArrowDown: () => point(x, y + far, true),
    "+": () => zoom(1), "=": () => zoom(1), "-": () => zoom(-1), 0: () => zoom(-99),
    w: next, " ": swap, b: () => mode("blink"), s: () => mode("slide"), d: () => mode("side"),
  }[event.key];
  if (!act) return;
  event.preventDefault();
  act();
});

for (const id of ["side", "blink", "slide"]) by(id).addEventListener("click", () => mode(id));
for (const [id, step] of [["plus", 1], ["minus", -1], ["fit", -99]]) by(id).addEventListener("click", () => zoom(step));
by("split").addEventListener("input", event => { state.split = event.target.value / 1000; draw(); });
by("plane").addEventListener("change", event => { state.plane = Number(event.target.value); tell(); load(); });
addEventListener("resize", draw);

data.tabs.forEach((tab, i) => {
  const button = by("tabs").appendChild(document.createElement("button"));
  const [sign, word] = { right: ["\u2713", "right"], wrong: ["\u2717", "wrong"], "not-judged": ["\u2013", "not judged"] }[tab.mark];
  Object.assign(button, { id: `tab${i}`, type: "button", innerHTML: `<span class="${tab.mark}" aria-label="${word}">${sign}</span> ` });
  button.append(tab.name);
  button.setAttribute("role", "tab");
  button.setAttribute("aria-controls", "panel");
  button.addEventListener("click", () => open(i));
});
by("tabs").addEventListener("keydown", event => {
  const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
  if (!step) return;
  open((state.tab + step + data.tabs.length) % data.tabs.length);
  by(`tab${state.tab}`).focus();
});

// What the page does not hold.
const lacking = digits => Object.entries(data.channels).filter(([, channel]) => channel.digits === digits).map(([name]) => name);
by("missing").textContent = [[0, "Left out, because the page would be too large"], [2, "Rounded to 3 digits"], [3, "Rounded to 5 digits"]]
  .filter(([digits]) => lacking(digits).length).map(([digits, what]) => `${what}${digits ? " except near wrong and listed pixels" : ""}: ${lacking(digits).join(", ")}.`).join(" ") + (data.rounded ? " Errors elsewhere have two digits." : "");

const [tab, plane, x, y] = location.hash.slice(1).split(",").map(Number);
if (data.tabs.length) {
  if (x >= 0 && y >= 0 && x < width && y < height) { state.cursor = [x, y]; look(x + 0.5, y + 0.5); }
  const wrong = Math.max(0, data.tabs.findIndex(tab => tab.mark === "wrong"));
  open(location.hash.length > 1 && tab < data.tabs.length ? tab : wrong, plane || 0);
} else {
  by("panel").hidden = true;
  document.body.dataset.ready = "none";
}
