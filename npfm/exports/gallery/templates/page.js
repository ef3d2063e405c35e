const DATA = JSON.parse(document.getElementById("data").textContent);
const SVG = "http://www.w3.org/2000/svg";

// Names and messages become text and attributes here, never markup.
function element(name, attributes = {}, ...children) {
  return filled(document.createElement(name), attributes, children);
}

function drawn(name, attributes = {}, ...children) {
  return filled(document.createElementNS(SVG, name), attributes, children);
}

function filled(made, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

function byId(id) {
  return document.getElementById(id);
}

function binary(k) {
  return bytesOf(byId(`binary-${k}`).textContent);
}

// Bytes of their base 64.
function bytesOf(coded) {
  const text = atob(coded);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Numbers as the tables have them.
function written(value) {
  if (value === null || value === undefined) return "–";
  if (value === "inf") return "∞";
  if (value === "-inf") return "−∞";
  return String(value);
}

function withUnit(quantity, value) {
  const unit = quantity.unit === "1" ? "" : ` ${quantity.unit}`;
  return typeof value === "number" ? written(value) + unit : written(value);
}

function isNumber(value) {
  return typeof value === "number";
}

// The mark of a variant, as the figures draw it.
function markOf(look, x, y, size) {
  return drawn("path", {
    d: look.mark,
    transform: `translate(${x} ${y}) scale(${size})`,
    fill: look.filled ? look.color : "#fff",
    stroke: look.color,
    "stroke-width": look.filled ? 0.04 : 0.16,
  });
}

function swatch(look) {
  return drawn("svg", { class: "mark", viewBox: "-7 -7 14 14", "aria-hidden": "true" }, markOf(look, 0, 0, 10));
}

// Round numbers from low to high, about so many of them.
function ticks(low, high, wanted) {
  const rough = (high - low) / wanted;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough);
  const made = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k++) {
    made.push(Number((k * step).toPrecision(12)));
  }
  return made;
}

function decades(low, high) {
  const made = [];
  const every = Math.ceil((Math.log10(high) - Math.log10(low)) / 6);
  for (let k = Math.ceil(Math.log10(low) - 1e-9); 10 ** k <= high * (1 + 1e-9); k += every) made.push(Number(`1e${k}`));
  return made;
}

function plain(value) {
  return value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5)
    ? value.toExponential(0).replace("e-", "e−").replace("e+", "e") : String(value);
}

// Maps of errors: a share of the range of display values as a colour, and the scale of it.
function errorColor(share) {
  const k = Math.min(255, Math.round((255 * share) / DATA.errors.largest));
  return [0, 2, 4].map((at) => parseInt(DATA.errors.colors.slice(6 * k + at, 6 * k + at + 2), 16));
}

function drawErrorScale() {
  const scale = byId("scale").querySelector("canvas").getContext("2d");
  for (let k = 0; k < 256; k++) {
    scale.fillStyle = `#${DATA.errors.colors.slice(6 * k, 6 * k + 6)}`;
    scale.fillRect(k, 0, 1, 1);
  }
  byId("scale-said").textContent = `0 to ${DATA.errors.largest} and more: mean difference of the channels, as a share of the display's range`;
}

const AXES = { D: "theta_h (degrees)", G: "theta_i or theta_o (degrees)", F: "theta_d (degrees)",
  "F G²": "theta_d = theta_i = theta_o (degrees)" };

// A factor as in Figure 6: relative, logarithmic, theta_h by its root; down to its least value.
function factorPlot(name, least) {
  const W = 300, H = 190, L = 42, B = 34, T = 18, R = 8;
  const svg = drawn("svg", { viewBox: `0 0 ${W} ${H}`, role: "img", "aria-label": `factor ${name}` });
  const root = name === "D", floor = root ? 5e-7 : Math.max(1e-4, least / 1.3), top = 1.6;
  const x = (a) => L + (W - L - R) * (root ? Math.sqrt(a / 90) : a / 90);
  const y = (v) => T + (H - T - B) * (Math.log10(top / v) / Math.log10(top / floor));
  for (const a of root ? [0, 5, 20, 45, 90] : [0, 15, 30, 45, 60, 75, 90]) {
    svg.append(drawn("line", { class: "grid", x1: x(a), x2: x(a), y1: T, y2: H - B }),
      drawn("text", { x: x(a), y: H - B + 13, "text-anchor": "middle" }, String(a)));
  }
  for (const v of floor > 0.05 ? [0.1, 0.2, 0.5, 1].filter((k) => k >= floor) : decades(floor, top)) {
    svg.append(drawn("line", { class: "grid", x1: L, x2: W - R, y1: y(v), y2: y(v) }),
      drawn("text", { x: L - 4, y: y(v) + 4, "text-anchor": "end" }, plain(v)));
  }
  const clip = `clip-${name.charCodeAt(0)}-${name.length}`;
  svg.append(drawn("clipPath", { id: clip }, drawn("rect", { x: L, y: T, width: W - L - R, height: H - T - B })));
  svg.append(drawn("text", { x: L, y: 12, style: "font-weight:600" }, `${name}, relative`),
    drawn("text", { x: (L + W - R) / 2, y: H - 5, "text-anchor": "middle" }, AXES[name]));
  const path = (angles, values) => pathOf(angles, values, x, y, floor / 100);
  const line = (angles, values, look) => {
    const made = drawn("path", { d: path(angles, values), fill: "none", "stroke-width": 1.4, "clip-path": `url(#${clip})`, ...look });
    svg.append(made);
    return made;
  };
  return { svg, path, line };
}

function pathOf(angles, values, x, y, least) {
  let path = "", down = false;
  values.forEach((v, k) => {
    if (v !== null) path += `${down ? "L" : "M"}${x(angles[k]).toFixed(1)} ${y(Math.max(v, least)).toFixed(1)}`;
    down = v !== null;
  });
  return path;
}
