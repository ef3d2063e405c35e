"""A fit as one function of GLSL, its table beside it, to paste into a shader.

It has no ``#version`` and no precision of its own, so that it goes into shaders of OpenGL 3.3 and
later, and, with ``precision highp float``, of OpenGL ES 3.0 and WebGL 2.
"""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from npfm.exports.shaders.shader import shader
from npfm.exports.sources import Source
from npfm.fitting.fits import Fit
from npfm.storage.files import Kind, marked, replacing

NAME = "glsl"
ABOUT = "one function of GLSL with its table, for a shader of OpenGL or WebGL 2"
SUFFIX = ".glsl"
PARTS = ("shaders/*.glsl",)
MODELS = ("independent-g", "g-from-d", "shared-lobes", "power-iteration", "ggx", "ggx-fitted")
FIRST = "// Made by npfm: BRDF of "
KIND = Kind("a function of GLSL", SUFFIX, marked(FIRST.encode()))
ABOUT_FUNCTION = """\
// vec3 npfm_brdf(vec3 light, vec3 view, vec3 normal) is in 1/sr, of unit vectors away from the
// surface; what is reflected is light * npfm_brdf * dot(light, normal). It needs highp
// floats. At the centres of the cells of MERL's tables it is what npfm tabulate writes there.
"""


def write(path: str, sources: Sequence[Source]) -> str:
    """Write the function; say how many numbers it has."""
    [source] = sources
    text = function(source.fit, source.name)
    with replacing(path, KIND) as temporary:
        temporary.write_text(text, encoding="ascii", newline="\n")
    return f"{len(text) / 1000:.0f} kB"


def function(fit: Fit, name: str) -> str:
    """Return a fit as GLSL.

    Parameters
    ----------
    fit : Fit
        Of one of `MODELS`.
    name : str
        Of the material, for a comment: of what may end or continue one, nothing is left.
    """
    made = shader(fit)
    said = re.sub(r"[^\w .,+-]", "_", name, flags=re.ASCII)
    count = len(made.rows)
    table = ",\n  ".join(map(_vector, made.rows))
    return (
        f"{FIRST}{said} by {fit.model}.\n{ABOUT_FUNCTION}{made.source}\n"
        f"const vec3 npfm_table[{count}] = vec3[{count}](\n  {table});\n\n"
        "vec3 npfm_row(int k) {\n  return npfm_table[k];\n}\n"
    )


def _vector(row: NDArray[np.float32]) -> str:
    numbers = [str(value) for value in row]
    return f"vec3({', '.join(numbers if len(set(numbers)) > 1 else numbers[:1])})"
