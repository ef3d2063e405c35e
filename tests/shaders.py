"""Functions of GLSL, run by a browser, for tests."""

import base64
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from browser import opened
from numpy.typing import NDArray

#: A row of pixels, each of which has the directions of its column for its own.
FRAGMENT = """#version 300 es
precision highp float;
precision highp sampler2D;
{function}
uniform sampler2D vectors;
out vec4 color;
vec3 at(int row) {{ return texelFetch(vectors, ivec2(int(gl_FragCoord.x), row), 0).xyz; }}
void main() {{ color = vec4(npfm_brdf(at(0), at(1), at(2)), 1.0); }}
"""
VERTEX = """#version 300 es
void main() {
  gl_Position = vec4(vec2(gl_VertexID % 2, gl_VertexID / 2) * 4.0 - 1.0, 0.0, 1.0);
}
"""
SCRIPT = """
const given = JSON.parse(document.getElementById("given").textContent);
const bytes = Uint8Array.from(atob(given.vectors), (c) => c.charCodeAt(0));
const gl = document.createElement("canvas").getContext("webgl2");
gl.getExtension("EXT_color_buffer_float");
const texture = (format, height, data) => {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  }
  const layout = data ? gl.RGB : gl.RGBA;
  gl.texImage2D(gl.TEXTURE_2D, 0, format, given.count, height, 0, layout, gl.FLOAT, data);
  return made;
};
const target = texture(gl.RGBA32F, 1, null);
gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
texture(gl.RGB32F, 3, new Float32Array(bytes.buffer));
gl.viewport(0, 0, given.count, 1);
const compiled = (kind, source) => {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw Error(gl.getShaderInfoLog(shader));
  return shader;
};
return given.fragments.map((fragment) => {
  const program = gl.createProgram();
  gl.attachShader(program, compiled(gl.VERTEX_SHADER, given.vertex));
  gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, fragment));
  gl.linkProgram(program);
  gl.useProgram(program);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const pixels = new Float32Array(4 * given.count);
  gl.readPixels(0, 0, given.count, 1, gl.RGBA, gl.FLOAT, pixels);
  return Array.from(pixels.filter((_, k) => k % 4 < 3));
});
"""


def evaluated(
    folder: Path,
    functions: Sequence[str],
    light: NDArray,
    view: NDArray,
    normal: NDArray,
) -> list[NDArray[np.float64]]:
    """Compile functions and run them.

    Parameters
    ----------
    folder : Path
        For a page.
    functions : sequence of str
        Each with ``vec3 npfm_brdf(vec3 light, vec3 view, vec3 normal)``.
    light, view, normal : ndarray, shape (n, 3)
        What they are run on.

    Returns
    -------
    list of ndarray, shape (n, 3)
    """
    vectors = np.stack([light, view, normal]).astype("<f4")
    fragments = [FRAGMENT.format(function=text) for text in functions]
    given = {"vectors": base64.b64encode(vectors.tobytes()).decode(), "count": len(light)}
    text = json.dumps({**given, "fragments": fragments, "vertex": VERTEX}).replace("<", "\\u003c")
    page = folder / "shaders.html"
    page.write_text(
        f'<!DOCTYPE html><body><script type="application/json" id="given">{text}</script>'
    )
    return [np.reshape(found, (-1, 3)) for found in opened(page, SCRIPT)]
