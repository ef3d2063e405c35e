const LIGHT = DATA.light, STARTS = DATA.starts;
const PICTURES_A_SECOND = 10, ITERATIONS_A_SECOND = 6;
const state = { turn: 0, error: false, channel: 0, iteration: 0, chosen: null };
const timers = {};
let display = null, factors = null, lines = [];

// Display values of every picture: rows of turns, columns of names.
async function pictures() {
  const image = new Image();
  image.src = LIGHT.sheet;
  await image.decode();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [image.width, image.height];
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  return context;
}

function picture(turn, column) {
  return display.getImageData(column * LIGHT.width, turn * LIGHT.height, LIGHT.width, LIGHT.height);
}

function errorMap(image, measured) {
  for (let i = 0; i < image.data.length; i += 4) {
    let difference = 0;
    for (let channel = i; channel < i + 3; channel++) difference += Math.abs(image.data[channel] - measured.data[channel]);
    image.data.set(errorColor(difference / (3 * 255)), i);
  }
  return image;
}

function drawLight() {
  const measured = picture(state.turn, 0);
  byId("panes").querySelectorAll("canvas").forEach((canvas, column) => {
    const image = picture(state.turn, column);
    canvas.getContext("2d").putImageData(state.error && column ? errorMap(image, measured) : image, 0, 0);
  });
  byId("panes").querySelectorAll(".psnr").forEach((said, fit) => {
    said.textContent = decibels(LIGHT.psnr[state.turn][fit]);
  });
  byId("turn").value = state.turn;
  byId("turn-said").textContent = `${LIGHT.degrees[state.turn]}°`;
  byId("error").setAttribute("aria-pressed", state.error);
  byId("scale").hidden = !state.error;
}

function decibels(value) {
  return isNumber(value) ? `${value.toFixed(2)} dB` : `${written(value)} dB`;
}

function turnTo(turn) {
  const count = LIGHT.degrees.length;
  state.turn = ((turn % count) + count) % count;
  drawLight();
}

// Factors as starts.py packs them: logarithms of 16 bits, differences from the state before.
async function unpacked() {
  const bytes = await inflated(binary(0)), states = STARTS.start.length, made = {};
  let at = 0;
  for (const [name, angles] of Object.entries(STARTS.angles)) {
    const bins = angles.length, size = states * bins, words = new Uint16Array(size);
    for (let k = 0; k < size; k++) words[k] = ((bytes[at + k] << 8) | bytes[at + size + k]) + (k < bins ? 0 : words[k - bins]);
    made[name] = (one) => Array.from(words.subarray(one * bins, (one + 1) * bins), (word) => STARTS.least * 10 ** (word / STARTS.steps));
    at += 2 * size;
  }
  return made;
}

// Numbers of the states of a start in the channel that is shown, in their order.
function statesOf(start) {
  const found = [];
  STARTS.start.forEach((s, k) => { if (s === start && STARTS.channel[k] === state.channel) found.push(k); });
  return found;
}

function reached(start) {
  const states = statesOf(start);
  return states[Math.min(state.iteration, states.length - 1)];
}

function lastIteration() {
  return Math.max(...STARTS.names.map((_, start) => statesOf(start).length)) - 1;
}

// Axes are drawn once a channel; an iteration only moves the lines.
function drawStarts() {
  const order = STARTS.names.map((_, start) => start).sort((a, b) => isBest(a) - isBest(b));
  lines = [];
  const plots = Object.entries(STARTS.angles).map(([name, angles]) => {
    const ends = STARTS.names.flatMap((_, start) => factors[name](statesOf(start).at(-1)).filter((v, k) => angles[k] <= 80));
    const plot = factorPlot(name, Math.min(0.5, ...ends));
    for (const start of order) lines.push({ start, line: plot.line([], [], lookOf(start)), d: () => plot.path(angles, factors[name](reached(start))) });
    return plot.svg;
  });
  byId("curves").replaceChildren(...plots, objectivePlot(order));
  [...byId("channels").children].forEach((b, k) => b.setAttribute("aria-pressed", k === state.channel));
  byId("iteration").max = lastIteration();
  iterateTo(Math.min(state.iteration, lastIteration()));
}

function isBest(start) {
  return start === STARTS.best[state.channel];
}

function lookOf(start) {
  const { color, dashes } = STARTS.looks[start], pale = state.chosen !== null && state.chosen !== start;
  return { stroke: color, "stroke-dasharray": dashes, "stroke-width": isBest(start) || state.chosen === start ? 2.6 : 1.2,
    "stroke-opacity": pale ? 0.15 : 1 };
}

function objectivePlot(order) {
  const W = 300, H = 190, L = 42, B = 34, T = 18, R = 8;
  const values = order.flatMap((start) => statesOf(start).map((k) => STARTS.objective[k])).filter((v) => v > 0);
  const low = Math.min(...values) / 1.05, high = Math.max(...values) * 1.05, last = Math.max(1, lastIteration());
  const x = (k) => L + ((W - L - R) * k) / last;
  const y = (v) => T + (H - T - B) * (Math.log10(high / Math.max(v, low)) / Math.log10(high / low));
  const svg = drawn("svg", { viewBox: `0 0 ${W} ${H}`, role: "img", "aria-label": "objective" });
  for (const k of ticks(0, last, 5).filter(Number.isInteger)) {
    svg.append(drawn("line", { class: "grid", x1: x(k), x2: x(k), y1: T, y2: H - B }), drawn("text", { x: x(k), y: H - B + 13, "text-anchor": "middle" }, String(k)));
  }
  for (const v of high / low > 30 ? decades(low, high) : ticks(low, high, 4)) {
    if (v <= 0 || y(v) > H - B) continue;
    svg.append(drawn("line", { class: "grid", x1: L, x2: W - R, y1: y(v), y2: y(v) }), drawn("text", { x: L - 4, y: y(v) + 4, "text-anchor": "end" }, plain(v)));
  }
  for (const start of order) {
    const states = statesOf(start);
    const whole = states.map((one, k) => `${k ? "L" : "M"}${x(k).toFixed(1)} ${y(STARTS.objective[one]).toFixed(1)}`).join("");
    const mark = drawn("circle", { r: isBest(start) ? 4 : 3, fill: STARTS.looks[start].color });
    svg.append(drawn("path", { d: whole, fill: "none", ...lookOf(start) }), mark);
    lines.push({ start, mark, x: () => x(Math.min(state.iteration, states.length - 1)), y: () => y(STARTS.objective[reached(start)]) });
  }
  svg.append(drawn("text", { x: L, y: 12, style: "font-weight:600" }, "objective, a share of a black model's"),
    drawn("text", { x: (L + W - R) / 2, y: H - 5, "text-anchor": "middle" }, "iteration"));
  return svg;
}

function iterateTo(iteration) {
  state.iteration = Math.max(0, Math.min(lastIteration(), iteration));
  for (const { line, d, mark, x, y } of lines) {
    if (line) line.setAttribute("d", d());
    else { mark.setAttribute("cx", x()); mark.setAttribute("cy", y()); }
  }
  byId("iteration").value = state.iteration;
  byId("iteration-said").textContent = `iteration ${state.iteration} of ${lastIteration()}`;
  [...byId("key").children].forEach(tell);
}

// What a start has reached, in its button.
function tell(button, start) {
  const states = statesOf(start), now = reached(start);
  const doing = STARTS.run[now] ? "on all samples" : state.iteration >= states.length - 1 ? "ended" : "";
  button.querySelector(".now").textContent = `${STARTS.objective[now].toPrecision(4)} ${doing}`;
  button.setAttribute("aria-pressed", state.chosen === start);
  button.classList.toggle("best", isBest(start));
}

function choose(start) {
  state.chosen = state.chosen === start ? null : start;
  drawStarts();
}

function entryOf(name, start) {
  const { color, dashes } = STARTS.looks[start];
  return element("button", { onclick: () => choose(start) },
    drawn("svg", { width: 26, height: 10, "aria-hidden": "true" }, drawn("line", { x1: 0, x2: 26, y1: 5, y2: 5, stroke: color, "stroke-dasharray": dashes })),
    element("span", {}, name), element("span", { class: "now pale" }));
}

function playing(name, on) {
  clearInterval(timers[name]);
  timers[name] = null;
  byId(`play-${name}`).textContent = on ? "❚❚" : "▶";
  byId(`play-${name}`).setAttribute("aria-pressed", on);
}

function play(name, each, aSecond) {
  const on = !timers[name];
  playing(name, on);
  if (on) timers[name] = setInterval(each, 1000 / aSecond);
}

function playLight() {
  play("light", () => turnTo(state.turn + 1), PICTURES_A_SECOND);
}

// From the beginning again if it is at its end, where it stops.
function playStarts() {
  if (!timers.starts && state.iteration >= lastIteration()) iterateTo(0);
  play("starts", () => {
    iterateTo(state.iteration + 1);
    if (state.iteration >= lastIteration()) playing("starts", false);
  }, ITERATIONS_A_SECOND);
}

function showErrors() {
  state.error = !state.error;
  drawLight();
}

function changeChannel(channel) {
  state.channel = channel % STARTS.channels.length;
  drawStarts();
}

function key(event) {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const actions = {
    " ": playLight, i: playStarts, e: showErrors, c: () => changeChannel(state.channel + 1),
    ArrowRight: () => turnTo(state.turn + 1), ArrowLeft: () => turnTo(state.turn - 1),
    ArrowUp: () => iterateTo(state.iteration + 1), ArrowDown: () => iterateTo(state.iteration - 1),
  };
  if (event.target instanceof HTMLInputElement && event.key.startsWith("Arrow")) return;
  if (event.target instanceof HTMLButtonElement && event.key === " ") return;
  if (!(event.key in actions)) return;
  actions[event.key]();
  event.preventDefault();
}

function paneOf(name, column) {
  const look = column ? [swatch(LIGHT.looks[column - 1])] : [];
  return element("figure", {}, element("canvas", { width: LIGHT.width, height: LIGHT.height, "aria-label": name }),
    element("figcaption", {}, ...look, name, ...(column ? [element("span", { class: "psnr pale" })] : [])));
}

async function begin() {
  byId("title").textContent = `${DATA.material} in motion`;
  byId("others").append(...DATA.materials.filter((name) => name !== DATA.material)
    .map((name) => element("a", { href: `${encodeURIComponent(name)}.html` }, name)));
  byId("panes").append(...LIGHT.names.map(paneOf));
  byId("turn").max = LIGHT.degrees.length - 1;
  byId("channels").append(...STARTS.channels.map((name, k) => element("button", { onclick: () => changeChannel(k) }, name)));
  byId("key").append(...STARTS.names.map(entryOf));
  const count = STARTS.names.length, goesOn = STARTS.run.some((run) => run > 0);
  byId("starts-title").textContent = `D, G and F of ${count} start${count === 1 ? "" : "s"}, iteration by iteration`;
  byId("runs").textContent = `${goesOn ? "Starts are compared on some of the samples; the best, thick, goes on with all of them." : "The best start is thick."} `
    + "Objectives are over the samples of their run. A click on a start shows it alone.";
  drawErrorScale();
  for (const name of ["light", "starts"]) playing(name, false);
  byId("play-light").addEventListener("click", playLight);
  byId("play-starts").addEventListener("click", playStarts);
  byId("error").addEventListener("click", showErrors);
  byId("turn").addEventListener("input", (event) => turnTo(Number(event.target.value)));
  byId("iteration").addEventListener("input", (event) => iterateTo(Number(event.target.value)));
  document.addEventListener("keydown", key);
  [display, factors] = await Promise.all([pictures(), unpacked()]);
  drawLight();
  drawStarts();
}

const ready = begin();
