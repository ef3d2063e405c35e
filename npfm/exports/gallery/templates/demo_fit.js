// What a material is rendered from: rows of a fit, or a measured table; and how its facets lie.

// Numbers that npfm.exports.gallery.demo.packed packed.
async function floats(k) {
  const bytes = await inflated(binary(k)), count = bytes.length / 4;
  const sorted = new Uint8Array(bytes.length);
  for (let part = 0; part < 4; part++) for (let i = 0; i < count; i++) sorted[4 * i + part] = bytes[part * count + i];
  return new Float32Array(sorted.buffer);
}

const rowsOf = new Map();

// Rows of the fit of a variant to a material, its slopes so many times as steep.
async function rows(variant, material, roughness) {
  const shader = DATA.variants.find((each) => each.name === variant);
  if (!rowsOf.has(variant)) rowsOf.set(variant, await floats(DATA.lights.length + DATA.variants.indexOf(shader)));
  const start = 3 * shader.rows * shader.materials.indexOf(material);
  const own = rowsOf.get(variant).slice(start, start + 3 * shader.rows);
  return shader.editable && roughness !== 1 ? rougher(own, shader.constants, roughness) : own;
}

// As npfm edit --roughness: npfm.reflectance.slopes.rougher, or alpha of a formula.
function rougher(own, at, factor) {
  if ("npfm_alpha" in at) {
    own.fill(own[3 * at.npfm_alpha] * factor, 3 * at.npfm_alpha, 3 * at.npfm_alpha + 3);
    return own;
  }
  const centres = thetaH(at.npfm_theta_h_bins, 0.5), slopes = centres.map(Math.tan);
  const D = slopes.map((_, k) => own[3 * (at.npfm_D + k)]);
  const logs = D.map((value) => Math.log(Math.max(value, 1e-300 * Math.max(...D))));
  const squares = slopes.map((slope) => slope * slope);
  const stretched = squares.map((square) => {
    const source = square / factor ** 2;
    return (Math.exp(interpolated(source, squares, logs)) * ((1 + square) / (1 + source)) ** 2) / factor ** 2;
  });
  const bands = centres.map((theta, k) =>
    ((Math.PI * (k + 0.5)) / at.npfm_theta_h_bins ** 2) * Math.sin(theta));
  const covered = 2 * Math.PI * total(stretched.map((value, k) => value * bands[k] * Math.cos(centres[k])));
  const normal = stretched.map((value) => value / covered);
  normal.forEach((value, k) => own.fill(value, 3 * (at.npfm_D + k), 3 * (at.npfm_D + k) + 3));
  for (let node = 0; node < at.npfm_sigma_nodes; node++) {
    const elevation = ((node / (at.npfm_sigma_nodes - 1)) * Math.PI) / 2;
    const area = total(normal.map((value, k) => value * bands[k] * facing(elevation, centres[k])));
    own.fill(area, 3 * (at.npfm_sigma + node), 3 * (at.npfm_sigma + node) + 3);
  }
  return own;
}

// npfm.reflectance.slopes.facing
function facing(elevation, theta) {
  const a = Math.cos(elevation) * Math.cos(theta), b = Math.sin(elevation) * Math.sin(theta);
  const t = Math.acos(Math.max(-1, Math.min(1, -a / Math.max(b, 1e-300))));
  return 2 * (a * t + b * Math.sin(t));
}

function interpolated(x, places, values) {
  const k = places.findIndex((place) => place > x);
  if (k < 0) return values[values.length - 1];
  if (k === 0) return values[0];
  return values[k - 1] + ((values[k] - values[k - 1]) * (x - places[k - 1])) / (places[k] - places[k - 1]);
}

function total(values) {
  return values.reduce((sum, value) => sum + value, 0);
}

// Angles of theta_h bins: at 0.5 their centres, at 0 their lower edges.
function thetaH(bins, place) {
  return Array.from({ length: bins }, (_, k) => (((k + place) / bins) ** 2 * Math.PI) / 2);
}

// D of a fit at the bins, in any scale; lobes in the shares of their colours.
function distribution(own, at) {
  const bins = Array.from({ length: at.npfm_theta_h_bins }, (_, k) => k);
  if ("npfm_alpha" in at) {
    const alpha = own[3 * at.npfm_alpha];
    return thetaH(bins.length, 0.5).map((theta) => (alpha * Math.cos(theta) ** 2 + Math.sin(theta) ** 2 / alpha) ** -2);
  }
  const lobes = Array.from({ length: at.npfm_lobes || 1 }, (_, lobe) => lobe);
  return bins.map((bin) => total(lobes.flatMap((lobe) => LUMINANCE.map((share, c) =>
    share * own[3 * (at.npfm_rho_s + lobe) + c] * own[3 * (at.npfm_D + lobe * bins.length + bin) + c]))));
}

// Half vectors as D has them, a share of them evenly over the bins; as a texture.
function facetsOf(D, even) {
  const squares = [...thetaH(D.length, 0), Math.PI / 2].map((theta) => Math.sin(theta) ** 2);
  const masses = D.map((value, k) => value * (squares[k + 1] - squares[k])), sum = total(masses);
  const shares = masses.map((mass) => (sum > 0 ? ((1 - even) * mass) / sum + even / D.length : 1 / D.length));
  const data = new Float32Array(3 * (D.length + 1));
  let below = 0;
  shares.forEach((share, k) => {
    data.set([below, squares[k], share / (Math.PI * (squares[k + 1] - squares[k]))], 3 * k);
    below += share;
  });
  data.set([2, 1, 0], 3 * D.length);
  data[3 * D.length] = 1;
  return numbers(D.length + 1, 1, 3, data);
}

const tables = new Map();

// A measured table, from a script beside the page that calls npfmTable. Only the last is kept: each has 9 MB.
function measuredTable(material) {
  if (!tables.has(material)) {
    tables.clear();
    tables.set(material, asked(`tables/${encodeURIComponent(material)}.js`).then(unpackedTable));
  }
  return tables.get(material);
}

// What a script beside the page has said.
let arrived = null;
for (const name of ["npfmTable", "npfmFigure"]) globalThis[name] = (...given) => { arrived = given; };

function asked(address) {
  return new Promise((done, failed) => {
    const script = element("script", { src: address });
    script.onload = () => done(arrived);
    script.onerror = () => failed(new Error(`${address} is not beside the page.`));
    document.head.append(script);
  }).finally(() => { arrived = null; });
}

async function unpackedTable([shape, scale, content]) {
  const [h, d, p] = shape, cells = h * d * p;
  const bytes = await inflated(bytesOf(content));
  const words = new Uint16Array(3 * cells);
  for (let channel = 0; channel < 3; channel++) {
    for (let cell = 0, word = 0; cell < cells; cell++) {
      const k = channel * cells + cell;
      word = ((cell % p ? word : 0) + ((bytes[k] << 8) | bytes[3 * cells + k])) & 65535;
      words[3 * cell + channel] = word;
    }
  }
  const measured = bound(gl.TEXTURE_3D);
  gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGB16F, p, d, h, 0, gl.RGB, gl.HALF_FLOAT, words);
  const bins = Object.entries({ h, d }).map(([name, n]) => `const int npfm_theta_${name}_bins = ${n};\n`).join("");
  return { measured, scale, bins: h, source: `${bins}const int npfm_phi_d_bins = ${p};\n${DATA.shaders.angles}${DATA.shaders.table}` };
}
