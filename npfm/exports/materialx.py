"""A material of MaterialX, as OpenPBR has it, for Blender, Houdini, Maya and renderers of films.

A metal has its colour at normal incidence as `base_color`, and all of its reflection is scaled by
`specular_weight`; a dielectric has the Fresnel factor of its `specular_ior`, scaled and coloured by
`specular_color`, above a base (OpenPBR 1.1, sections "Metal" and "Glossy-diffuse").
"""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from npfm.datasets.formulas import fresnel
from npfm.exports.simple_surface import (
    Lobe,
    as_table,
    chosen,
    facets,
    lobe,
    mean_schlick,
    schlick,
)
from npfm.exports.sources import Source
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table
from npfm.storage.files import Kind, marked, replacing

NAME = "materialx"
ABOUT = "a material of MaterialX (OpenPBR), for renderers of films"
SUFFIX = ".mtlx"
MODELS = ("ggx-fitted",)
MARK = "<!-- Written by npfm. -->"
KIND = Kind("a MaterialX file", SUFFIX, marked(MARK.encode()))
#: Reflects two thirds at normal incidence; user interfaces show 1 to 3, and files may have more.
MOST_IOR = 10.0

Array = NDArray[np.float64]
Inputs = dict[str, float | Array]


def write(path: str, sources: Sequence[Source]) -> str:
    """Write the material; say what it is, and how far that is from the fit."""
    [source] = sources
    known, grid = lobe(source), source.table.grid
    is_metal, said = chosen(metal_table(known, grid), dielectric_table(known, grid), source.table)
    with replacing(path, KIND) as temporary:
        made = (metal if is_metal else dielectric)(known)
        temporary.write_text(document(made, source.name), encoding="ascii")
    return said


def metal(known: Lobe) -> Inputs:
    """Inputs of the metal."""
    return {
        "base_metalness": 1.0,
        "base_color": known.normal / (known.weight or 1.0),
        "specular_weight": known.weight,
        "specular_roughness": known.roughness,
    }


def dielectric(known: Lobe) -> Inputs:
    """Inputs of the dielectric."""
    return {
        "base_color": _base(known),
        "specular_color": _tint(known),
        "specular_ior": _ior(known),
        "specular_roughness": known.roughness,
    }


def metal_table(known: Lobe, grid: HalfDifference) -> Table:
    """Values of the metal at the cells of a grid, in 1/sr."""
    reflected = schlick(known.normal, known.weight, grid)
    return as_table(reflected * facets(known.alpha, grid), grid)


def dielectric_table(known: Lobe, grid: HalfDifference) -> Table:
    """Values of the dielectric at the cells of a grid, in 1/sr; its base is dimmed evenly."""
    layer = fresnel(np.cos(grid.theta_d), _ior(known))[:, None]
    tint, base = (x[:, None, None, None] for x in (_tint(known), _base(known)))
    values = base * (1 - _mean(known)[0]) / np.pi + tint * layer * facets(known.alpha, grid)
    return as_table(values, grid)


def document(inputs: Inputs, name: str) -> str:
    """Return the file.

    Parameters
    ----------
    inputs : dict of str to (float or ndarray of shape (3,))
        What differs from the defaults of OpenPBR; colours are linear Rec. 709.
    name : str
        Of the material; of what no name of MaterialX has, nothing is left.
    """
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
    named = plain if re.match("[A-Za-z]", plain) else f"m_{plain}"
    lines = "".join(f"    {_input(*pair)}\n" for pair in inputs.items())
    return (
        '<?xml version="1.0"?>\n'
        f"{MARK}\n"
        '<materialx version="1.39" colorspace="lin_rec709">\n'
        f'  <open_pbr_surface name="{named}_surface" type="surfaceshader">\n{lines}'
        "  </open_pbr_surface>\n"
        f'  <surfacematerial name="{named}" type="material">\n'
        '    <input name="surfaceshader" type="surfaceshader" '
        f'nodename="{named}_surface" />\n'
        "  </surfacematerial>\n"
        "</materialx>\n"
    )


def _input(name: str, value: float | Array) -> str:
    numbers = ", ".join(f"{x:.6g}" for x in np.atleast_1d(value))
    kind = "float" if np.ndim(value) == 0 else "color3"
    return f'<input name="{name}" type="{kind}" value="{numbers}" />'


def _ior(known: Lobe) -> float:
    root = float(np.sqrt(known.f0))
    return min((1 + root) / max(1 - root, 1e-3), MOST_IOR)


def _tint(known: Lobe) -> Array:
    return np.minimum(known.normal / fresnel(np.ones(1), _ior(known)), 1)


def _base(known: Lobe) -> Array:
    return known.base(_mean(known))


def _mean(known: Lobe) -> Array:
    """What the layer reflects in the mean over a hemisphere, shape (1,), without its colour."""
    return mean_schlick(fresnel(np.ones(1), _ior(known)), 1.0)
