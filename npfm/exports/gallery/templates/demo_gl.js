// WebGL 2: programs, and textures of numbers.
const canvas = byId("picture");
const gl = canvas.getContext("webgl2", { antialias: false, alpha: false, preserveDrawingBuffer: true });
const able = Boolean(gl && gl.getExtension("EXT_color_buffer_float"));
const VERTEX = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID % 2, gl_VertexID / 2) * 4.0 - 1.0, 0.0, 1.0); }`;
const PRECISION = "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n";
const programs = new Map();

// A program with its uniforms by name; made once for a source.
function program(fragment, vertex = VERTEX) {
  const key = vertex + fragment;
  if (!programs.has(key)) programs.set(key, linked(vertex, PRECISION + fragment));
  return programs.get(key);
}

function linked(vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  const uniforms = {};
  for (let k = 0; k < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); k++) {
    const { name, type } = gl.getActiveUniform(made, k);
    uniforms[name] = { at: gl.getUniformLocation(made, name), type };
  }
  return { made, uniforms };
}

// Uses a program with these values; textures are bound one after another.
function use({ made, uniforms }, values) {
  gl.useProgram(made);
  let unit = 0;
  for (const [name, { at, type }] of Object.entries(uniforms)) {
    const value = values[name];
    if (type === gl.SAMPLER_2D || type === gl.SAMPLER_3D) {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(type === gl.SAMPLER_2D ? gl.TEXTURE_2D : gl.TEXTURE_3D, value);
      gl.uniform1i(at, unit++);
    } else if (type === gl.FLOAT) gl.uniform1f(at, value);
    else if (type === gl.FLOAT_VEC2) gl.uniform2fv(at, value);
    else if (type === gl.FLOAT_MAT3) gl.uniformMatrix3fv(at, false, value);
    else if (type === gl.UNSIGNED_INT) gl.uniform1ui(at, value);
    else gl.uniform1i(at, value);
  }
}

// A texture of float32 with so many channels, to be read texel by texel.
function numbers(width, height, channels, data) {
  const formats = { 1: [gl.R32F, gl.RED], 2: [gl.RG32F, gl.RG], 3: [gl.RGB32F, gl.RGB], 4: [gl.RGBA32F, gl.RGBA] };
  const [stored, given] = formats[channels];
  const made = bound(gl.TEXTURE_2D);
  gl.texImage2D(gl.TEXTURE_2D, 0, stored, width, height, 0, given, gl.FLOAT, data);
  return made;
}

function bound(kind) {
  const made = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(kind, made);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(kind, filter, gl.NEAREST);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  return made;
}

// A picture of sums that a pass writes to.
function target(width, height) {
  const texture = numbers(width, height, 4, null), frame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
  return { texture, frame };
}

function removed({ texture, frame, depth = null }) {
  gl.deleteTexture(texture);
  gl.deleteFramebuffer(frame);
  gl.deleteRenderbuffer(depth);
}
