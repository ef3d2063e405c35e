// The figure of the run's scenes: triangles from a script beside the page, drawn as normals.
const NEAR = 2, FAR = 8;
const FIGURE_VERTEX = `#version 300 es
in vec3 position, normal;
uniform mat3 standing;       // turns it
uniform float distant, edge; // the camera: distance, tangent of half its field
uniform float unit;
uniform vec2 moved;          // by which the rays of pixels miss their centres; the picture is 2 wide
out vec3 facing;
void main() {
  vec3 at = unit * (standing * position);
  facing = standing * normal;
  float depth = distant - at.z;
  float far = ${FAR}.0, near = ${NEAR}.0;
  gl_Position = vec4(at.xy / edge + moved * depth, (depth * (far + near) - 2.0 * far * near) / (far - near), depth);
}`;
const FIGURE_FRAGMENT = `in vec3 facing;
out vec4 color;
void main() { color = vec4(normalize(gl_FrontFacing ? facing : -facing), 1.0); }`;
let figure = null, normals = null;

async function loadFigure() {
  if (figure) return;
  const [vertices, unit, content] = await asked("figure.js");
  const bytes = await inflated(bytesOf(content)), split = 12 * vertices;
  const array = gl.createVertexArray(), { made } = program(FIGURE_FRAGMENT, FIGURE_VERTEX);
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, bytes.subarray(0, split), gl.STATIC_DRAW);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, bytes.subarray(split), gl.STATIC_DRAW);
  ["position", "normal"].forEach((name, k) => {
    const at = gl.getAttribLocation(made, name);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, 3, gl.SHORT, true, 6, 6 * vertices * k);
  });
  gl.bindVertexArray(null);
  figure = { array, count: (bytes.length - split) / 4, unit };
}

// Draws normals with rays through this point of the pixels, in a picture as large as the shown one.
function drawFigure(offset) {
  const { size } = state, { distance, field } = DATA.camera;
  if (!normals || normals.size !== size) {
    if (normals) removed(normals);
    normals = { size, ...target(size, size), depth: gl.createRenderbuffer() };
    gl.bindRenderbuffer(gl.RENDERBUFFER, normals.depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, size, size);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, normals.depth);
  }
  gl.bindFramebuffer(gl.FRAMEBUFFER, normals.frame);
  gl.viewport(0, 0, size, size);
  gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
  gl.clearBufferfv(gl.DEPTH, 0, [1]);
  gl.enable(gl.DEPTH_TEST);
  // From its own axes to those of the camera: the other way round than light.
  const back = turning(state.figure.map((angle) => -angle));
  use(program(FIGURE_FRAGMENT, FIGURE_VERTEX), { standing: [0, 3, 6, 1, 4, 7, 2, 5, 8].map((k) => back[k]),
    distant: distance, edge: Math.tan(field / 2), unit: figure.unit, moved: offset.map((place) => (1 - 2 * place) / size) });
  gl.bindVertexArray(figure.array);
  gl.drawElements(gl.TRIANGLES, figure.count, gl.UNSIGNED_INT, 0);
  gl.bindVertexArray(null);
  gl.disable(gl.DEPTH_TEST);
  return normals.texture;
}
