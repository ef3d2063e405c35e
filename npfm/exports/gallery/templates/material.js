const NAMES = ["measured", ...DATA.variants.map((look) => look.name)];
const LOBES = [null, "6 3", "2 2", "8 2 2 2", "1 3"];  // dashes, as many as a model has lobes
const CHANNELS = [["red", "#D55E00"], ["green", "#009E73"], ["blue", "#0072B2"]];
const LARGEST_SIDE = 528, MOST_ZOOM = 64;
// The first fit that has curves to be seen, until another is chosen.
const firstFit = 1 + Math.max(0, DATA.variants.findIndex((look) => look.curves.length));
const state = { scene: 0, picture: 0, fit: firstFit, stops: 0, error: false, zoom: 1, x: 0, y: 0, pointer: null };
const cache = new Map();
const canvas = byId("picture");
const sheet = document.createElement("canvas");

// Half-precision floats by their words.
const HALF = Float32Array.from({ length: 65536 }, (_, word) => {
  const sign = word & 0x8000 ? -1 : 1, exponent = (word >> 10) & 31, fraction = word & 1023;
  if (exponent === 31) return fraction ? NaN : sign * Infinity;
  return sign * (exponent ? 2 ** (exponent - 25) * (1024 + fraction) : 2 ** -24 * fraction);
});

// Pictures of a scene as words, channel by channel; npfm/exports/gallery/pixels.py packs them.
async function pictures(scene) {
  if (!cache.has(scene)) cache.set(scene, inflated(binary(scene)).then((bytes) => unpacked(bytes, DATA.scenes[scene])));
  return cache.get(scene);
}

function unpacked(bytes, { width, height }) {
  const pixels = width * height;
  const places = [];
  for (let i = 0; i < pixels; i++) if (bytes[i]) places.push(i);
  const measured = new Uint16Array(3 * pixels);
  for (let i = 0; i < 3 * pixels; i++) measured[i] = (bytes[pixels + i] << 8) | bytes[4 * pixels + i];
  const made = [measured], each = 3 * places.length, high = 7 * pixels, low = high + each * (NAMES.length - 1);
  for (let fit = 0; fit < NAMES.length - 1; fit++) {
    const words = measured.slice(), start = fit * each;
    for (let channel = 0, k = 0; channel < 3; channel++) {
      for (let j = 0; j < places.length; j++, k++) {
        words[channel * pixels + places[j]] += (bytes[high + start + k] << 8) | bytes[low + start + k];
      }
    }
    made.push(words);
  }
  return made;
}

// Bagher et al. 2016, section 5: (1 - 2^(-exposure x pixel))^(1 / gamma), by word.
function toneMap(scene) {
  const { exposure, gamma, scale } = DATA.scenes[scene];
  const factor = exposure * 2 ** state.stops * scale;
  return Uint8ClampedArray.from(HALF, (value) =>
    Number.isNaN(value) ? 0 : Math.round(255 * (1 - 2 ** (-factor * Math.max(value, 0))) ** (1 / gamma)));
}

// The picture that is chosen, or how its display values differ from those of the measurement.
function painted(all) {
  const { width, height } = DATA.scenes[state.scene], pixels = width * height;
  const image = new ImageData(width, height), shown = toneMap(state.scene);
  const words = all[state.picture], measured = all[0];
  image.data.fill(255);
  for (let i = 0; i < pixels; i++) {
    let difference = 0;
    for (let channel = 0, k = i; channel < 3; channel++, k += pixels) {
      image.data[4 * i + channel] = shown[words[k]];
      difference += Math.abs(shown[words[k]] - shown[measured[k]]);
    }
    if (state.error) image.data.set(errorColor(difference / (3 * 255)), 4 * i);
  }
  return image;
}

async function paint() {
  const wanted = state.scene;
  const all = await pictures(wanted);
  if (wanted !== state.scene) return;
  const { width, height } = DATA.scenes[wanted];
  sheet.width = width;
  sheet.height = height;
  sheet.getContext("2d").putImageData(painted(all), 0, 0);
  view();
  tell(all);
}

// Whole pixels of the screen for each of the picture's at zoom 1, so that none is wider than others.
function fitCanvas() {
  const { width, height } = DATA.scenes[state.scene], ratio = devicePixelRatio || 1;
  const side = Math.min(LARGEST_SIDE, document.documentElement.clientWidth - 32) * ratio;
  const whole = Math.max(1, Math.floor(side / Math.max(width, height)));
  canvas.width = width * whole;
  canvas.height = height * whole;
  canvas.style.width = `${canvas.width / ratio}px`;
}

function view() {
  const { width, height } = DATA.scenes[state.scene];
  const [w, h] = [width / state.zoom, height / state.zoom];
  state.x = Math.max(0, Math.min(width - w, state.x));
  state.y = Math.max(0, Math.min(height - h, state.y));
  const context = canvas.getContext("2d");
  context.imageSmoothingEnabled = false;
  context.drawImage(sheet, state.x, state.y, w, h, 0, 0, canvas.width, canvas.height);
}

function zoomed(factor, at = [0.5, 0.5]) {
  const { width, height } = DATA.scenes[state.scene], before = state.zoom;
  state.zoom = Math.max(1, Math.min(MOST_ZOOM, before * factor));
  state.x += at[0] * width * (1 / before - 1 / state.zoom);
  state.y += at[1] * height * (1 / before - 1 / state.zoom);
  view();
}

function share(event) {
  const box = canvas.getBoundingClientRect();
  return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
}

function pixelAt([sx, sy]) {
  const { width, height } = DATA.scenes[state.scene];
  const x = Math.floor(state.x + (sx * width) / state.zoom), y = Math.floor(state.y + (sy * height) / state.zoom);
  return x >= 0 && y >= 0 && x < width && y < height ? [x, y] : null;
}

function radiance(words, [x, y]) {
  const { width, height, scale } = DATA.scenes[state.scene];
  return [0, 1, 2].map((channel) => scale * HALF[words[channel * width * height + y * width + x]]);
}

function tell(all) {
  if (!state.pointer) {
    byId("pointer").textContent = "The value under the pointer: linear radiance, red, green and blue.";
    return;
  }
  const lines = [[`(${state.pointer.join(", ")})`, ""], [NAMES[0], radiance(all[0], state.pointer)]];
  if (state.picture) lines.push([NAMES[state.picture], radiance(all[state.picture], state.pointer)]);
  const wide = Math.max(...lines.map(([name]) => name.length));
  byId("pointer").textContent = lines.map(([name, rgb]) =>
    `${name.padEnd(wide)}  ${rgb ? rgb.map((v) => Number(v.toPrecision(4)).toString().padStart(10)).join("") : ""}`.trimEnd()).join("\n");
}

function choose(picture) {
  state.picture = Math.max(0, Math.min(NAMES.length - 1, picture));
  if (state.picture) state.fit = state.picture;
  update();
}

function metric(name, variant) {
  const found = DATA.metrics.find((m) => m.name === name);
  return found && withUnit(found, (found.values[DATA.scenes[state.scene].name] || {})[variant]);
}

function update() {
  const name = NAMES[state.picture], scene = DATA.scenes[state.scene];
  byId("flip").value = state.picture;
  byId("flip-said").textContent = name;
  byId("exposure").value = state.stops;
  byId("exposure-said").textContent = `${scene.exposure} × 2^${state.stops}, gamma ${scene.gamma}`;
  const said = state.picture ? [metric("psnr", name), metric("ssim", name) && `SSIM ${metric("ssim", name)}`] : [];
  byId("shown").textContent = [`${state.picture + 1} ${name}${state.error ? ", error" : ""}`, ...said.filter(Boolean)].join(" · ");
  byId("error").setAttribute("aria-pressed", state.error);
  byId("scale").hidden = !state.error;
  [...byId("scenes").querySelectorAll("button")].forEach((b, k) => b.setAttribute("aria-pressed", k === state.scene));
  drawFactors();
  drawTable();
  const at = new URLSearchParams({ scene: scene.name, variant: name });
  history.replaceState(null, "", `#${at}`);
  return paint();
}

function changeScene(k) {
  state.scene = (k + DATA.scenes.length) % DATA.scenes.length;
  Object.assign(state, { stops: 0, zoom: 1, x: 0, y: 0, pointer: null });
  fitCanvas();
  update();
}

function drawFactors() {
  const look = DATA.variants[state.fit - 1];
  byId("factors-title").textContent = look ? `Factors of ${look.name}` : "No fits";
  if (!look) return;
  byId("curves").replaceChildren(...look.curves.map(plotOf));
  const lines = CHANNELS.map(([name, color]) => [name, color, null]);
  const lobes = look.curves.find((c) => c.lobes);
  if (lobes) lobes.values.forEach((_, k) => lines.push([`lobe ${k + 1}`, "#333", LOBES[k]]));
  if (look.curves.some((c) => c.values.length === 1 && !c.lobes)) lines.push(["all channels", "#333", null]);
  if (look.curves.some((c) => c.published)) lines.push(["published, in our scale", "#333", "5 3"]);
  byId("key").replaceChildren(...(look.curves.length ? lines : []).map(([name, color, dashes]) =>
    element("span", { class: "key" }, drawn("svg", { width: 26, height: 10 }, drawn("line", { x1: 0, x2: 26, y1: 5, y2: 5,
      stroke: color, "stroke-width": 2, "stroke-dasharray": dashes })), name)));
  const words = Object.entries(look.parameters).map(([name, values]) => `${name} ${values.map(written).join(", ")}`);
  const none = look.curves.length ? [] : ["This model has no factor that is a curve."];
  byId("parameters").textContent = [...none, ...words].join(" · ");
}

function plotOf(curve) {
  const within = curve.angles.map((a) => a <= 80);
  const seen = curve.values.flatMap((v) => v.filter((x, k) => x > 0 && within[k]));
  const plot = factorPlot(curve.name, Math.min(0.5, ...seen));
  const line = (angles, values, color, dashes) => plot.line(angles, values, { stroke: color, "stroke-dasharray": dashes });
  (curve.published || []).forEach((v, k) => line(curve.published_angles, v, CHANNELS[k][1], "5 3"));
  const look = (k) => curve.lobes ? ["#333", LOBES[k]] : [curve.values.length > 1 ? CHANNELS[k][1] : "#333", null];
  curve.values.forEach((v, k) => line(curve.angles, v, ...look(k)));
  return plot.svg;
}

function drawTable() {
  const scene = DATA.scenes[state.scene].name;
  byId("table-title").textContent = `Every fit in scene ${scene}`;
  const columns = DATA.metrics.map((m) => ({ label: m.unit === "1" ? m.label : `${m.label} (${m.unit})`, better: m.better,
    values: NAMES.slice(1).map((v) => (m.values[scene] || m.values.all || {})[v]) }));
  const fits = DATA.variants.map((look) => ({ ...look, seconds: sum(look.channels, "seconds"),
    objective: sum(look.channels, "objective") / look.channels.length }));
  columns.push({ label: "bytes", better: "lower", values: fits.map((f) => f.bytes) },
    { label: "seconds", better: "lower", values: fits.map((f) => rounded(f.seconds)) },
    { label: "objective", better: "lower", values: fits.map((f) => rounded(f.objective)) });
  const head = element("tr", {}, ...["key", "variant"].map((t) => element("th", {}, t)),
    ...columns.map((c) => element("th", { title: c.better ? `${c.better} is better` : null }, `${c.label} ${c.better === "higher" ? "↑" : "↓"}`)),
    element("th", { class: "text" }, "status, red, green, blue"));
  const rows = fits.map((fit, k) => element("tr", { "aria-selected": state.picture === k + 1, onclick: () => choose(k + 1) },
    element("td", {}, k < 8 ? element("kbd", {}, String(k + 2)) : ""),
    element("td", {}, swatch(fit), fit.name),
    ...columns.map((c) => element("td", { class: isBest(c, k) ? "best" : "" }, written(c.values[k]))),
    element("td", { class: "text", title: fit.channels.map((c) => `${c.channel}: best of its starts: ${c.start}`).join("\n") }, statusOf(fit.channels))));
  byId("table").replaceChildren(element("thead", {}, head), element("tbody", {}, ...rows));
}

function statusOf(channels) {
  const all = channels.map((c) => c.status);
  return new Set(all).size === 1 ? all[0] : all.join(", ");
}

function sum(rows, key) {
  return rows.reduce((total, row) => total + row[key], 0);
}

function rounded(value) {
  return isNumber(value) ? Number(value.toPrecision(6)) : null;
}

function isBest(column, k) {
  const order = (v) => (v === "inf" ? Infinity : v === "-inf" ? -Infinity : v);
  const known = column.values.map(order).filter(isNumber);
  const best = column.better === "higher" ? Math.max(...known) : Math.min(...known);
  return known.length > 1 && order(column.values[k]) === best;
}

function key(event) {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const slider = event.target instanceof HTMLInputElement;
  const actions = {
    " ": () => choose(state.picture ? 0 : state.fit), e: () => { state.error = !state.error; update(); },
    s: () => changeScene(state.scene + 1), "0": () => expose(0), "+": () => zoomed(2), "=": () => zoomed(2), "-": () => zoomed(0.5),
    ArrowRight: () => choose(state.picture + 1), ArrowLeft: () => choose(state.picture - 1),
    ArrowUp: () => expose(state.stops + 0.5), ArrowDown: () => expose(state.stops - 0.5),
  };
  const digit = /^[1-9]$/.test(event.key) && Number(event.key) <= NAMES.length;
  if (slider && event.key.startsWith("Arrow")) return;
  if (event.target instanceof HTMLButtonElement && event.key === " ") return;
  if (digit) choose(Number(event.key) - 1);
  else if (event.key in actions) actions[event.key]();
  else return;
  event.preventDefault();
}

function expose(stops) {
  state.stops = Math.max(-8, Math.min(8, stops));
  update();
}

// Drag with one pointer, pinch with two, wheel to zoom.
const touching = new Map();

function pointerMoved(event) {
  const before = touching.get(event.pointerId), now = share(event);
  if (before && touching.size === 1) {
    const { width, height } = DATA.scenes[state.scene];
    state.x -= ((now[0] - before[0]) * width) / state.zoom;
    state.y -= ((now[1] - before[1]) * height) / state.zoom;
    view();
  } else if (before) {
    const [other] = [...touching].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
    const apart = (at) => Math.hypot(at[0] - other[0], at[1] - other[1]) || 1e-3;
    zoomed(apart(now) / apart(before), other);
  }
  if (before) touching.set(event.pointerId, now);
  state.pointer = pixelAt(now);
  pictures(state.scene).then(tell);
}

function listen() {
  document.addEventListener("keydown", key);
  byId("flip").addEventListener("input", (event) => choose(Number(event.target.value)));
  byId("exposure").addEventListener("input", (event) => expose(Number(event.target.value)));
  byId("error").addEventListener("click", () => { state.error = !state.error; update(); });
  byId("in").addEventListener("click", () => zoomed(2));
  byId("out").addEventListener("click", () => zoomed(0.5));
  byId("reset").addEventListener("click", () => zoomed(0));
  canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); touching.set(event.pointerId, share(event)); });
  for (const over of ["pointerup", "pointercancel"]) canvas.addEventListener(over, (event) => touching.delete(event.pointerId));
  canvas.addEventListener("pointermove", pointerMoved);
  canvas.addEventListener("pointerleave", () => { state.pointer = null; pictures(state.scene).then(tell); });
  canvas.addEventListener("wheel", (event) => { event.preventDefault(); zoomed(2 ** (-event.deltaY / 300), share(event)); }, { passive: false });
  addEventListener("resize", () => { fitCanvas(); view(); });
}

function begin() {
  byId("title").textContent = DATA.material;
  byId("demo").hidden = !DATA.demo;
  byId("demo").href = `../demo.html#${new URLSearchParams({ material: DATA.material })}`;
  byId("video").hidden = !DATA.video;
  byId("video").href = `../video/${encodeURIComponent(DATA.material)}.html`;
  byId("run").textContent = `in the run ${DATA.run}`;
  byId("flip").max = NAMES.length - 1;
  byId("scenes").append(...DATA.scenes.map((scene, k) => element("button", { onclick: () => changeScene(k) }, `scene ${scene.name}`)));
  drawErrorScale();
  const asked = new URLSearchParams(location.hash.slice(1));
  state.scene = Math.max(0, DATA.scenes.findIndex((scene) => scene.name === asked.get("scene")));
  state.picture = Math.max(0, NAMES.indexOf(asked.get("variant")));
  if (state.picture) state.fit = state.picture;
  listen();
  fitCanvas();
  return update();
}

const ready = begin();
