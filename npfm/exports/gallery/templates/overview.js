const LEFT = 62, TOP = 12, PLOT = 300, PITCH = 15, MARK = 7.5;
const VARIANTS = DATA.variants.map((look) => look.name);
const ORDERS = [
  ...(DATA.materials.some((m) => m.diffuseness !== null) ? [["diffuseness", "diffuseness"]] : []),
  ["name", "name"],
  ...DATA.quantities.map((q) => [`worst ${q.name}`, `${q.label}, worst first`]),
];
const state = {
  quantity: firstQuantity(),
  scene: null,
  order: `worst ${firstQuantity()}`,
  of: VARIANTS.includes("independent-g") ? "independent-g" : VARIANTS[0],
  off: new Set(),
  find: "",
  at: null,
};
let points = [];

// Nothing is shown first that the run has no number of: pictures may be too small for SSIM.
function firstQuantity() {
  const known = (q) => Object.values(q.values).some((rows) => Object.keys(rows).length);
  return (DATA.quantities.find((q) => q.name === DATA.first && known(q)) || DATA.quantities.find(known)
    || DATA.quantities[0]).name;
}

function quantity(name = state.quantity) {
  return DATA.quantities.find((q) => q.name === name);
}

// The scene that is chosen, or what stands for it where a quantity has no scenes.
function valuesOf(q) {
  return q.values[state.scene] || q.values.mean || Object.values(q.values)[0];
}

function value(q, material, variant) {
  return (valuesOf(q)[material] || {})[variant];
}

function shownVariants() {
  return DATA.variants.filter((look) => !state.off.has(look.name));
}

function ordered() {
  const wanted = state.find.trim().toLowerCase();
  const shown = DATA.materials.filter((m) => m.name.toLowerCase().includes(wanted));
  return shown.map((m) => [keyOf(m), m]).sort(([a, m], [b, n]) => compare(a, b) || compare(m.name, n.name)).map(([, m]) => m);
}

function keyOf(material) {
  if (state.order === "name") return material.name;
  if (state.order === "diffuseness") return material.diffuseness ?? Infinity;
  const q = quantity(state.order.slice("worst ".length));
  const found = value(q, material.name, state.of);
  const number = found === "inf" ? Infinity : found === "-inf" ? -Infinity : found;
  return number === undefined || number === null ? Infinity : q.better === "higher" ? number : -number;
}

function compare(a, b) {
  return a < b ? -1 : a > b ? 1 : 0;
}

function pageOf(material, variant) {
  const at = new URLSearchParams();
  if (DATA.scenes.includes(state.scene)) at.set("scene", state.scene);
  if (variant) at.set("variant", variant);
  return `materials/${encodeURIComponent(material)}.html${at.size ? `#${at}` : ""}`;
}

// One small picture out of those of a material: rows are scenes, columns the measurement and fits.
function thumbnail(material, variant) {
  const side = DATA.thumbnail;
  const column = variant ? material.variants.indexOf(variant) + 1 : 0;
  const row = Math.max(0, DATA.scenes.indexOf(state.scene));
  const picture = element("img", {
    class: "thumbnail", loading: "lazy", width: side, height: side, alt: "",
    src: `materials/${encodeURIComponent(material.name)}.jpg`,
  });
  picture.style.objectPosition = `${-column * side}px ${-row * side}px`;
  return picture;
}

function drawLegend() {
  const q = quantity();
  byId("legend").replaceChildren(...DATA.variants.map((look) => {
    const found = ordered().map((m) => value(q, m.name, look.name)).filter(isNumber);
    const mean = found.length ? Number((found.reduce((a, b) => a + b, 0) / found.length).toPrecision(4)) : null;
    const box = element("input", { type: "checkbox", onchange: () => toggle(look.name) });
    box.checked = !state.off.has(look.name);
    const size = isNumber(look.bytes) ? `, ${sizeOf(look.bytes)}` : "";
    return element("label", { class: box.checked ? "" : "off" }, box, swatch(look),
      element("span", {}, look.name), element("small", {}, `${withUnit(q, mean)}${size}`));
  }));
}

function sizeOf(bytes) {
  return bytes < 1000 ? `${bytes} bytes` : `${Number((bytes / 1000).toPrecision(2))} kB`;
}

function toggle(name) {
  if (!state.off.delete(name)) state.off.add(name);
  draw();
}

function drawChart() {
  const q = quantity(), materials = ordered(), variants = shownVariants();
  const names = 7 * Math.max(4, ...materials.map((m) => m.name.length)) * 0.87;
  const wide = byId("chart").clientWidth || 600;
  const pitch = Math.max(PITCH, (wide - LEFT - 20) / Math.max(1, materials.length));
  const width = LEFT + pitch * materials.length + 12, height = TOP + PLOT + names + 14;
  const svg = drawn("svg", { width, height, viewBox: `0 0 ${width} ${height}` });
  const numbers = materials.flatMap((m) => variants.map((v) => value(q, m.name, v.name))).filter(isNumber);
  points = [];
  if (numbers.length) {
    const scale = axis(svg, q, numbers, width);
    const x = (k) => LEFT + (k + 0.5) * pitch;
    drawNames(svg, materials, x);
    for (const look of variants) drawVariant(svg, q, look, materials, x, scale);
    svg.append(drawn("circle", { id: "ring", r: 8, fill: "none", stroke: "#1b1b1b", "stroke-width": 1.5, visibility: "hidden" }));
  } else {
    svg.append(drawn("text", { x: LEFT, y: TOP + 30 }, "Nothing to show: no material, no variant or no number."));
  }
  byId("chart").replaceChildren(svg);
  const gaps = materials.length * variants.length - numbers.length;
  byId("note").textContent = [
    q.better === "lower" ? "lower is better" : "higher is better",
    gaps ? `${gaps} without a finite number` : "",
  ].filter(Boolean).join(" · ");
}

// Seconds and objectives span decades; metrics do not.
function axis(svg, q, numbers, width) {
  const least = Math.min(...numbers), most = Math.max(...numbers);
  const logarithmic = ["seconds", "objective"].includes(q.name) && least > 0;
  const room = (most - least) * 0.06 || Math.abs(most) * 0.05 || 1;
  const [low, high] = logarithmic ? [least / 1.3, most * 1.3] : [least - room, most + room];
  const t = logarithmic ? Math.log10 : (v) => v;
  const scale = (v) => TOP + PLOT * (1 - (t(v) - t(low)) / (t(high) - t(low)));
  const marks = logarithmic && high / low > 30 ? decades(low, high) : ticks(low, high, 6);
  for (const mark of marks) {
    const y = scale(mark);
    svg.append(drawn("line", { class: "grid", x1: LEFT, x2: width - 8, y1: y, y2: y }),
      drawn("text", { x: LEFT - 6, y: y + 4, "text-anchor": "end" }, plain(mark)));
  }
  const said = q.unit === "1" ? q.label : `${q.label} (${q.unit})`;
  svg.append(drawn("text", { transform: `translate(14 ${TOP + PLOT / 2}) rotate(-90)`, "text-anchor": "middle" }, said));
  return scale;
}

function drawNames(svg, materials, x) {
  materials.forEach((material, k) => {
    svg.append(
      drawn("line", { class: "grid", x1: x(k), x2: x(k), y1: TOP, y2: TOP + PLOT }),
      drawn("text", { transform: `translate(${x(k) + 4} ${TOP + PLOT + 10}) rotate(-90)`, "text-anchor": "end" }, material.name),
    );
  });
}

function drawVariant(svg, q, look, materials, x, scale) {
  const places = materials.map((m, k) => [x(k), value(q, m.name, look.name), m])
    .map(([px, v, m]) => ({ px, py: isNumber(v) ? scale(v) : null, material: m, look, value: v }));
  let path = "", down = false;
  for (const place of places) {
    if (place.py !== null) path += `${down ? "L" : "M"}${place.px.toFixed(1)} ${place.py.toFixed(1)}`;
    down = place.py !== null;
  }
  svg.append(drawn("path", { d: path, fill: "none", stroke: look.color, "stroke-opacity": 0.45,
    "stroke-width": 1.2, "stroke-dasharray": look.dashed ? "4 3" : null }));
  for (const place of places.filter((p) => p.py !== null)) {
    svg.append(markOf(look, place.px, place.py, MARK));
    points.push(place);
  }
}

function nearest(event) {
  const box = byId("chart").firstChild.getBoundingClientRect();
  const [x, y] = [event.clientX - box.left, event.clientY - box.top];
  const distance = (p) => Math.hypot(p.px - x, p.py - y);
  return points.reduce((best, p) => (!best || distance(p) < distance(best) ? p : best), null);
}

function show(point) {
  state.at = point && [point.material.name, point.look.name];
  const ring = byId("ring"), card = byId("card");
  card.hidden = !point;
  if (ring) ring.setAttribute("visibility", point ? "visible" : "hidden");
  if (!point) return;
  ring.setAttribute("cx", point.px);
  ring.setAttribute("cy", point.py);
  const said = quantity(), seconds = value(quantity("seconds"), point.material.name, point.look.name);
  const pictures = [["measured", null], [point.look.name, point.look.name]].map(([label, variant]) =>
    element("figure", {}, thumbnail(point.material, variant), element("figcaption", {}, label)));
  card.replaceChildren(element("strong", {}, point.material.name),
    element("div", {}, `${said.label} ${withUnit(said, point.value)} · ${withUnit(quantity("seconds"), seconds)}`), ...pictures);
  place(card, point);
}

function place(card, point) {
  const box = byId("chart").firstChild.getBoundingClientRect();
  const x = box.left + point.px + scrollX, y = box.top + point.py + scrollY;
  const right = x + 18 + card.offsetWidth < scrollX + document.documentElement.clientWidth;
  card.style.left = `${Math.max(4, right ? x + 18 : x - 18 - card.offsetWidth)}px`;
  card.style.top = `${Math.max(scrollY + 4, y - card.offsetHeight / 2)}px`;
}

function open(point) {
  if (point) location.href = pageOf(point.material.name, point.look.name);
}

function current() {
  return state.at && points.find((p) => p.material.name === state.at[0] && p.look.name === state.at[1]);
}

// To the next point on the left or right of the same variant, or above or below in the same column.
function move(event) {
  const from = current() || points[0];
  if (event.key === "Enter") open(current());
  else if (event.key === "Escape") show(null);
  else if (from && ["ArrowLeft", "ArrowRight"].includes(event.key)) {
    const row = points.filter((p) => p.look === from.look);
    step(row, from, event.key === "ArrowRight" ? 1 : -1);
  } else if (from && ["ArrowUp", "ArrowDown"].includes(event.key)) {
    const column = points.filter((p) => p.material === from.material).sort((a, b) => a.py - b.py);
    step(column, from, event.key === "ArrowDown" ? 1 : -1);
  } else return;
  event.preventDefault();
}

function step(list, from, by) {
  const there = current() ? list.indexOf(from) + by : 0;
  const next = list[Math.max(0, Math.min(list.length - 1, there))];
  const box = byId("chart");
  box.scrollLeft = Math.max(0, Math.min(next.px - 40, Math.max(box.scrollLeft, next.px + 60 - box.clientWidth)));
  show(next);
}

function drawMaterials() {
  const shown = ordered();
  byId("count").textContent = `${shown.length} of ${DATA.materials.length} materials, as measured`;
  byId("materials").replaceChildren(...shown.map((m) =>
    element("a", { href: pageOf(m.name) }, thumbnail(m, null), element("span", {}, m.name))));
}

function chooseScenes() {
  const there = Object.keys(quantity().values).filter((s) => s !== "mean" || DATA.scenes.length > 1);
  const label = { mean: "mean over the scenes", all: "–" };
  byId("scene").replaceChildren(...there.map((s) => element("option", { value: s }, label[s] || s)));
  if (!there.includes(state.scene)) state.scene = there[0];
  byId("scene").value = state.scene;
  byId("scene").disabled = there.length < 2;
}

function draw() {
  chooseScenes();
  byId("of-label").hidden = !state.order.startsWith("worst ");
  drawLegend();
  drawChart();
  drawMaterials();
  show(current());
}

function begin() {
  byId("demo").hidden = !DATA.demo;
  byId("title").textContent = `Gallery of the run ${DATA.run}`;
  byId("summary").textContent = [[DATA.materials, "material"], [VARIANTS, "variant"], [DATA.scenes, "scene"]]
    .map(([list, name]) => `${list.length} ${name}${list.length === 1 ? "" : "s"}`).join(", ");
  byId("videos").hidden = !DATA.videos.length;
  byId("videos").append(...DATA.videos.map((name) => element("a", { href: `video/${encodeURIComponent(name)}.html` }, name)));
  const choices = { quantity: DATA.quantities.map((q) => [q.name, q.label]), order: ORDERS, of: VARIANTS.map((v) => [v, v]) };
  for (const [id, options] of Object.entries(choices)) {
    byId(id).append(...options.map(([v, label]) => element("option", { value: v }, label)));
    byId(id).value = state[id];
  }
  for (const id of ["quantity", "scene", "order", "of"]) {
    byId(id).addEventListener("change", (event) => { state[id] = event.target.value; draw(); });
  }
  byId("search").addEventListener("input", (event) => { state.find = event.target.value; draw(); });
  byId("all").addEventListener("click", () => { state.off.clear(); draw(); });
  byId("none").addEventListener("click", () => { VARIANTS.forEach((v) => state.off.add(v)); draw(); });
  const chart = byId("chart");
  chart.addEventListener("pointermove", (event) => show(nearest(event)));
  chart.addEventListener("pointerleave", () => show(null));
  chart.addEventListener("click", (event) => open(nearest(event)));
  chart.addEventListener("keydown", move);
  document.addEventListener("keydown", (event) => {
    if (event.key !== "/" || event.target === byId("search")) return;
    event.preventDefault();
    byId("search").focus();
  });
  let frame = 0;
  addEventListener("resize", () => { cancelAnimationFrame(frame); frame = requestAnimationFrame(drawChart); });
  draw();
}

begin();
