"""A sphere of a material of glTF 2.0, for game engines, browsers and Blender.

The metallic-roughness material of the core, as its appendix B says it; a dielectric has its
specular reflection by the extensions KHR_materials_ior and KHR_materials_specular, of which the
latter lets it be weaker than a smooth surface's and coloured.
"""

import base64
import json
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

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

NAME = "gltf"
ABOUT = "a sphere with the material, for Blender, browsers and game engines"
SUFFIX = ".gltf"
MODELS = ("ggx-fitted",)
GENERATOR = "npfm"
KIND = Kind("a glTF file", SUFFIX, marked(f'"generator": "{GENERATOR}"'.encode()))
#: The most that three.js takes.
MOST_IOR = 2.333
RINGS, SEGMENTS = 32, 64
#: Numbers of the specification.
FLOAT, UNSIGNED_SHORT, VERTICES, INDICES = 5126, 5123, 34962, 34963

Array = NDArray[np.float64]


def write(path: str, sources: Sequence[Source]) -> str:
    """Write the sphere; say what it is of, and how far that is from the fit."""
    [source] = sources
    known, grid = lobe(source), source.table.grid
    is_metal, said = chosen(metal_table(known, grid), dielectric_table(known, grid), source.table)
    with replacing(path, KIND) as temporary:
        text = json.dumps(document(material(known, is_metal), source.name), indent=1)
        temporary.write_text(f"{text}\n", encoding="utf-8")
    return said


def material(known: Lobe, is_metal: bool) -> dict[str, Any]:
    """Return the material as the specification has it."""
    if is_metal:
        return _rough(known, known.normal, 1)
    normal = _share(known)
    ior = min((1 + np.sqrt(normal.max())) / (1 - min(np.sqrt(normal.max()), 0.99)), MOST_IOR)
    smooth = max(((ior - 1) / (ior + 1)) ** 2, 1e-6)
    return _rough(known, _base(known), 0) | {
        "extensions": {
            "KHR_materials_ior": {"ior": _number(max(ior, 1.0))},
            "KHR_materials_specular": {
                "specularFactor": _number(known.weight),
                "specularColorFactor": [_number(x) for x in normal / smooth],
            },
        }
    }


def metal_table(known: Lobe, grid: HalfDifference) -> Table:
    """Values of the metal at the cells of a grid, in 1/sr."""
    return as_table(schlick(known.normal, 1.0, grid) * facets(known.alpha, grid), grid)


def dielectric_table(known: Lobe, grid: HalfDifference) -> Table:
    """Values of the dielectric at the cells of a grid, in 1/sr."""
    reflected = known.weight * schlick(_share(known), 1.0, grid)
    through = (1 - reflected.max(axis=0)) / np.pi
    base = _base(known)[:, None, None, None] * through
    return as_table(base + reflected * facets(known.alpha, grid), grid)


def document(made: dict[str, Any], name: str) -> dict[str, Any]:
    """Return a sphere of radius 1 of a material, with its vertices inside."""
    points, triangles = _sphere()
    vertices, faces = points.astype("<f4").tobytes(), triangles.astype("<u2").tobytes()
    data = base64.b64encode(vertices + faces).decode()
    extensions = {"extensionsUsed": list(made["extensions"])} if "extensions" in made else {}
    views = ((0, len(vertices), VERTICES), (len(vertices), len(faces), INDICES))
    return {
        "asset": {"version": "2.0", "generator": GENERATOR},
        **extensions,
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": name}],
        "materials": [{"name": name, **made}],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0, "NORMAL": 0}, "indices": 1, "material": 0}
                ]
            }
        ],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": FLOAT,
                "count": len(points),
                "type": "VEC3",
                "min": points.min(axis=0).tolist(),
                "max": points.max(axis=0).tolist(),
            },
            {
                "bufferView": 1,
                "componentType": UNSIGNED_SHORT,
                "count": triangles.size,
                "type": "SCALAR",
            },
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": length, "target": target}
            for start, length, target in views
        ],
        "buffers": [
            {
                "byteLength": len(vertices) + len(faces),
                "uri": f"data:application/octet-stream;base64,{data}",
            }
        ],
    }


def _rough(known: Lobe, colour: Array, metallic: int) -> dict[str, Any]:
    return {
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(_number(x) for x in colour), 1],
            "metallicFactor": metallic,
            "roughnessFactor": _number(known.roughness),
        }
    }


def _share(known: Lobe) -> Array:
    """What the dielectric reflects at normal incidence, of that at grazing."""
    return known.normal / (known.weight or 1.0)


def _base(known: Lobe) -> Array:
    """Albedo of the base: the brightest channel of what is above dims all."""
    return known.base(known.weight * mean_schlick(_share(known), 1.0).max(keepdims=True))


def _number(value: float) -> float:
    return float(f"{value:.6g}")


def _sphere() -> tuple[Array, NDArray[np.int64]]:
    """Vertices (n, 3), which are the normals as well, and triangles (m, 3)."""
    theta = np.linspace(0, np.pi, RINGS + 1)[:, None]
    phi = np.linspace(0, 2 * np.pi, SEGMENTS + 1)
    parts = (np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi))
    points = np.stack(np.broadcast_arrays(*parts), axis=-1).astype(np.float32)
    k = np.arange(RINGS)[:, None] * (SEGMENTS + 1) + np.arange(SEGMENTS)
    below = k + SEGMENTS + 1
    upper = np.stack([k, below, k + 1], axis=-1)[1:]
    lower = np.stack([k + 1, below, below + 1], axis=-1)[:-1]
    triangles = np.concatenate([upper.reshape(-1, 3), lower.reshape(-1, 3)])
    return points.reshape(-1, 3).astype(float), triangles
