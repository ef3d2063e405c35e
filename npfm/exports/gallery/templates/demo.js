const MEASURED = "measured", NONE = "", SPHERE = "sphere", FIGURE = "figure";
const SIZES = [128, 256, 384, 512, 768], SIZE = 384;
// Pairs of light directions: in a pass, and of a pixel in the end.
const MOST_IN_PASS = 64, IN_PAUSE = 4, MOST = 2 ** 16;
const STEP = 0.1; // radian, of an arrow key
const state = { material: null, left: null, right: NONE, scene: 0, object: SPHERE, stops: 0, roughness: 0, size: SIZE,
  split: 0.5, light: [0, 0], figure: [0, 0], turns: "light", running: true };
let sides = [], lit = null, front = null, back = null, pairs = 0, passes = 0, count = 1, asking = 0, seed = 0;

const variantsOf = (material) => DATA.variants.filter((shader) => shader.materials.includes(material)).map((shader) => shader.name);
const choicesOf = (material) => [...(DATA.measured.includes(material) ? [MEASURED] : []), ...variantsOf(material)];
const editable = (choice) => DATA.variants.some((shader) => shader.name === choice && shader.editable);

// What one side of the picture is rendered from: its program, and the values of that.
async function sideOf(choice, material) {
  const factor = 2 ** state.roughness, known = variantsOf(material);
  const by = choice === MEASURED ? known[0] : choice;
  const shader = DATA.variants.find((each) => each.name === by);
  const own = shader && (await rows(by, material, choice === MEASURED ? 1 : factor));
  const D = shader && distribution(own, shader.constants);
  if (choice !== MEASURED) {
    const source = `uniform sampler2D fitted;\n${shader.source}\nvec3 npfm_row(int k) { return texelFetch(fitted, ivec2(k, 0), 0).rgb; }\n`;
    return { program: program(source + DATA.shaders.trace), fitted: numbers(shader.rows, 1, 3, own), facets: facetsOf(D, 0) };
  }
  const table = await measuredTable(material);
  // Whatever its D is, half vectors of all widths are chosen as well.
  const facets = facetsOf(D || Array(table.bins).fill(0), 0.25);
  return { program: program(table.source + DATA.shaders.trace), measured: table.measured, scale: table.scale, facets };
}

// Makes what has changed, and begins anew; whatever was asked for last is what is shown.
async function prepare() {
  const mine = ++asking, { material, left, right } = state;
  const scene = DATA.scenes[state.scene];
  tell();
  try {
    const made = await Promise.all((right === NONE ? [left] : [left, right]).map((choice) => sideOf(choice, material)));
    const light = lit && lit.index === scene.light ? lit : { index: scene.light, ...(await lightOf(scene.light)) };
    if (state.object === FIGURE) await loadFigure();
    if (mine !== asking) return;
    for (const side of sides) for (const name of ["fitted", "facets"]) gl.deleteTexture(side[name] || null);
    if (lit && lit !== light) for (const name of ["light", "down", "across"]) gl.deleteTexture(lit[name]);
    [sides, lit] = [made, light];
    trouble("");
    restart();
  } catch (error) {
    if (mine === asking) trouble(error.message);
  }
}

function restart() {
  const { size } = state;
  if (canvas.width !== size || !front) {
    [canvas.width, canvas.height] = [size, size];
    for (const old of [front, back]) if (old) removed(old);
    [front, back] = [target(size, size), target(size, size)];
  }
  gl.bindFramebuffer(gl.FRAMEBUFFER, front.frame);
  gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
  [pairs, passes] = [0, 0];
  // What has changed is seen all the same.
  if (!state.running) {
    pass(IN_PAUSE, [0.5, 0.5]);
    show();
    progress("");
  }
}

// Adds so many pairs of light directions to every pixel, with rays through this point of it.
function pass(number, offset) {
  const { size } = state, { distance, field } = DATA.camera;
  const shared = { ...lit, previous: front.texture, figure: state.object === FIGURE,
    normals: state.object === FIGURE ? drawFigure(offset) : lit.light, turned: turning(state.light), distant: distance, edge: Math.tan(field / 2), size: [size, size], offset,
    first: pairs, seed, count: number };
  gl.bindFramebuffer(gl.FRAMEBUFFER, back.frame);
  gl.viewport(0, 0, size, size);
  gl.enable(gl.SCISSOR_TEST);
  const cut = sides.length > 1 ? Math.round(state.split * size) : size;
  sides.forEach((side, k) => {
    gl.scissor(k ? cut : 0, 0, k ? size - cut : cut, size);
    use(side.program, { ...shared, ...side });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  });
  gl.disable(gl.SCISSOR_TEST);
  [front, back] = [back, front];
  pairs += number;
  passes += 1;
}

function show() {
  const { exposure, gamma } = DATA.scenes[state.scene], split = sides.length > 1 ? Math.round(state.split * state.size) : -9;
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, state.size, state.size);
  use(program(DATA.shaders.show), { sums: front.texture, count: pairs, exposure: exposure * 2 ** state.stops, gamma, split });
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}

// Columns of the rotation from the camera's axes to those of what was dragged right and down.
function turning([across, down]) {
  const [s, c, t, d] = [Math.sin(across), Math.cos(across), Math.sin(down), Math.cos(down)];
  return [c, 0, -s, s * t, d, c * t, s * d, -t, c * d];
}

// As many pairs in a frame as leave the page at ease, with one point of the pixel for all of them.
let last = 0, shown = 0, frames = 0;

function frame(now) {
  requestAnimationFrame(frame);
  const took = now - last;
  last = now;
  if (!state.running || !sides.length || pairs >= MOST) return;
  if (passes > 2) count = Math.max(1, Math.min(MOST_IN_PASS, took > 50 ? Math.floor(count / 1.5) : took < 22 ? count + 1 : count));
  pass(count, [0.7548776662466927, 0.5698402909980532].map((step) => (0.5 + passes * step) % 1));
  show();
  frames += 1;
  if (now - shown > 500) {
    const rate = shown && (1000 * frames) / (now - shown);
    progress(rate ? `${rate.toFixed(rate < 10 ? 1 : 0)} frames a second` : "");
    [shown, frames] = [now, 0];
  } else if (pairs >= MOST) progress("done");
}

function progress(rate) {
  byId("progress").textContent = [`${2 * pairs} light directions a pixel`, rate].filter(Boolean).join(" · ");
}

function trouble(message) {
  byId("trouble").hidden = !message;
  byId("trouble").textContent = message;
}

function tell() {
  const { material, left, right } = state, scene = DATA.scenes[state.scene];
  options("left", choicesOf(material).map((name) => [name, name]), left);
  options("right", [[NONE, "the same"], ...choicesOf(material).map((name) => [name, name])], right);
  for (const key of ["material", "scene", "object", "size"]) byId(key).value = state[key];
  byId("page").href = `materials/${encodeURIComponent(material)}.html`;
  byId("split").hidden = right === NONE;
  byId("left-said").textContent = left;
  byId("right-said").textContent = right;
  byId("exposure").value = state.stops;
  byId("exposure-said").textContent = `${scene.exposure} × 2^${state.stops}, gamma ${scene.gamma}`;
  const edited = [left, right].filter(editable), factor = Number((2 ** state.roughness).toPrecision(3));
  byId("roughness").disabled = !edited.length;
  byId("roughness").value = state.roughness;
  byId("roughness-said").textContent = edited.length ? `slopes × ${factor}, of ${[...new Set(edited)].join(" and ")}`
    : `only of ${DATA.variants.filter((shader) => shader.editable).map((shader) => shader.name).join(", ") || "models of microfacets, which the run has not"}`;
  byId("turns").hidden = state.object === SPHERE;
  for (const what of ["light", "figure"]) byId(`turn-${what}`).setAttribute("aria-pressed", state.turns === what);
  byId("pause").setAttribute("aria-pressed", !state.running);
  history.replaceState(null, "", `#${new URLSearchParams({ material, left, right, scene: scene.name, roughness: state.roughness })}`);
}

function options(id, wanted, chosen) {
  byId(id).replaceChildren(...wanted.map(([value, label]) => element("option", { value }, label)));
  byId(id).value = chosen;
}

// Changes the state; of what a material does not have, the first takes the place.
function choose(changes) {
  Object.assign(state, changes);
  const there = choicesOf(state.material);
  if (!there.includes(state.left)) state.left = variantsOf(state.material)[0];
  if (!there.includes(state.right)) state.right = NONE;
  if (state.object === SPHERE) state.turns = "light";
  return prepare();
}

function turn(across, down) {
  const [before, above] = state[state.turns];
  state[state.turns] = [(before + across) % (2 * Math.PI), Math.max(-Math.PI / 2, Math.min(Math.PI / 2, above + down))];
  if (sides.length) restart();
}

function expose(stops) {
  state.stops = Math.max(-8, Math.min(8, stops));
  tell();
  if (pairs) show();
}

function next(list, current, by) {
  return list[(list.indexOf(current) + by + list.length) % list.length];
}

function run(running) {
  state.running = running;
  tell();
}

function key(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target.closest("select, input, button, a")) return;
  const places = [...DATA.scenes.keys()];
  const actions = {
    ArrowLeft: () => turn(-STEP, 0), ArrowRight: () => turn(STEP, 0), ArrowUp: () => turn(0, -STEP), ArrowDown: () => turn(0, STEP),
    o: () => turnsWhat(state.turns === "light" ? "figure" : "light"), 0: straighten, s: () => choose({ scene: next(places, state.scene, 1) }),
    "+": () => expose(state.stops + 0.5), "=": () => expose(state.stops + 0.5), "-": () => expose(state.stops - 0.5),
    ",": () => choose({ material: next(DATA.materials, state.material, -1) }), ".": () => choose({ material: next(DATA.materials, state.material, 1) }),
    " ": () => run(!state.running),
  };
  if (!(event.key in actions)) return;
  actions[event.key]();
  event.preventDefault();
}

// A sphere looks the same however it is turned.
function turnsWhat(what) {
  state.turns = state.object === SPHERE ? "light" : what;
  tell();
}

function straighten() {
  Object.assign(state, { light: [0, 0], figure: [0, 0], stops: 0, roughness: 0 });
  prepare();
}

function listen() {
  const on = (id, event, action) => byId(id).addEventListener(event, (e) => action(e.target.value));
  for (const id of ["material", "left", "right", "object"]) on(id, "change", (value) => choose({ [id]: value }));
  for (const id of ["scene", "size"]) on(id, "change", (value) => choose({ [id]: Number(value) }));
  on("roughness", "input", (value) => choose({ roughness: Number(value) }));
  on("exposure", "input", (value) => expose(Number(value)));
  on("split", "input", (value) => { state.split = Number(value); if (sides.length) restart(); });
  on("pause", "click", () => run(!state.running));
  for (const what of ["light", "figure"]) on(`turn-${what}`, "click", () => turnsWhat(what));
  on("straight", "click", straighten);
  document.addEventListener("keydown", key);
  let from = null;
  canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); from = [event.clientX, event.clientY]; });
  canvas.addEventListener("pointermove", (event) => {
    if (!from) return;
    // Across the picture is half a turn.
    const step = Math.PI / canvas.clientWidth;
    turn((event.clientX - from[0]) * step, (event.clientY - from[1]) * step);
    from = [event.clientX, event.clientY];
  });
  for (const over of ["pointerup", "pointercancel"]) canvas.addEventListener(over, () => { from = null; });
  canvas.addEventListener("webglcontextlost", () => trouble("The graphics card has taken the picture away; load the page again."));
}

function begin() {
  byId("title").textContent = "Demo";
  byId("about").textContent = `materials of the run ${DATA.run}, rendered by this browser`;
  byId("note").textContent = DATA.left_out ? `The first ${DATA.materials.length} materials; ${DATA.left_out} more are in the gallery.` : "";
  options("material", DATA.materials.map((name) => [name, name]));
  options("scene", DATA.scenes.map((scene, k) => [k, `of scene ${scene.name}`]));
  options("object", [SPHERE, ...(DATA.figure ? [FIGURE] : [])].map((name) => [name, name]));
  options("size", SIZES.map((size) => [size, `${size} × ${size}`]));
  const asked = new URLSearchParams(location.hash.slice(1));
  const first = DATA.materials.includes(asked.get("material")) ? asked.get("material") : DATA.materials[0];
  const scene = Math.max(0, DATA.scenes.findIndex((each) => each.name === asked.get("scene")));
  const roughness = Math.max(-2, Math.min(2, Number(asked.get("roughness")) || 0));
  if (!able) {
    trouble("This browser has no WebGL 2 with pictures of floating-point numbers, which the demo draws with.");
    return Promise.resolve();
  }
  listen();
  requestAnimationFrame(frame);
  return choose({ material: first, left: asked.get("left"), right: asked.get("right") || NONE, scene, roughness });
}

const ready = begin();
