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
