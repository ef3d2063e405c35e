"""Fits of GGX as materials of glTF and of OpenPBR, read by a validator and by MaterialX."""

import json
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from npfm.__main__ import main
from npfm.exports import gltf
from npfm.exports.sources import Source
from npfm.fitting import fits
from npfm.fitting.fits import Fit
from npfm.fitting.registry import tabulated
from npfm.reflectance.half_difference import MERL

#: Where `.ci/run` puts the validator of the Khronos group.
VALIDATOR = Path(sys.prefix) / "node" / "node_modules" / "gltf-validator"
VALIDATE = """
const validator = require(process.argv[1]), fs = require("fs");
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[2])))
  .then(report => console.log(JSON.stringify(report)));
"""

#: rho_d, rho_s, alpha and f0, and whether it is a metal in glTF.
SURFACES = {
    "copper": ([0, 0, 0], [0.96, 0.66, 0.54], 0.02, 0.97, True),
    "dark-metal": ([0.001, 0.001, 0.001], [0.3, 0.3, 0.3], 0.05, 1.0, False),
    "plastic": ([0.1, 0.03, 0.02], [0.9, 0.9, 0.9], 0.04, 0.04, False),
    "coloured": ([0.02, 0.02, 0.01], [0.2, 0.15, 0.1], 0.07, 0.26, False),
    "felt": ([0.2, 0.1, 0.1], [0, 0, 0], 0.5, 0.04, False),
    "black": ([0, 0, 0], [0, 0, 0], 0.5, 0.04, False),
    "too-bright": ([0.5, 0.4, 0.1], [7, 5, 5], 0.001, 1.0, True),
}


@pytest.fixture(params=SURFACES)
def surface(request, tmp_path):
    """Name, path of the fit, and whether it is a metal."""
    rho_d, rho_s, alpha, f0, metal = SURFACES[request.param]
    arrays = {"rho_d": rho_d, "rho_s": rho_s, "alpha": [alpha], "f0": [f0]}
    made = {name: np.array(value, dtype=np.float32) for name, value in arrays.items()}
    path = tmp_path / f"{request.param}.npz"
    fits.save(path, Fit("ggx-fitted", made, MERL))
    return request.param, path, metal


def exported(path, kind, capsys, suffix):
    output = path.with_suffix(suffix)
    assert main(["export", str(path), "--to", kind, "-o", str(output)]) == 0
    said = capsys.readouterr().err
    return output, float(re.search(r"(\S+)% from the fit", said)[1]), said


def spec(material, cos_h, cos_d, cos_i, cos_o):
    """Appendix B of the glTF specification and KHR_materials_specular, shape (n, 3)."""
    rough = material["pbrMetallicRoughness"]
    base, a2 = np.array(rough["baseColorFactor"][:3]), rough["roughnessFactor"] ** 4
    D = a2 / (np.pi * (cos_h**2 * (a2 - 1) + 1) ** 2)
    one, other = (a * np.sqrt(a2 + (1 - a2) * b**2) for a, b in ((cos_i, cos_o), (cos_o, cos_i)))
    specular = (D * 0.5 / (one + other))[:, None]
    rise = ((1 - cos_d) ** 5)[:, None]
    if rough["metallicFactor"] == 1:
        return specular * (base + (1 - base) * rise)
    ior = material["extensions"]["KHR_materials_ior"]["ior"]
    extension = material["extensions"]["KHR_materials_specular"]
    f0 = np.minimum(((ior - 1) / (ior + 1)) ** 2 * np.array(extension["specularColorFactor"]), 1)
    F, weight = f0 + (1 - f0) * rise, extension["specularFactor"]
    return (1 - weight * F.max(axis=1, keepdims=True)) * base / np.pi + weight * F * specular


def test_gltf_is_the_fit_by_the_formulas_of_its_specification(surface, capsys):
    name, path, metal = surface
    output, distance, said = exported(path, "gltf", capsys, ".gltf")
    [material] = json.loads(output.read_text())["materials"]
    assert ("a metal" in said) == metal
    assert material["pbrMetallicRoughness"]["metallicFactor"] == metal
    rng = np.random.default_rng(4)
    cells = np.stack([rng.integers(0, n, 2000) for n in MERL.shape])
    # Near the normal, where nothing rises; the lobe is the same everywhere.
    cells[1] %= 20
    cos_i, cos_o = (cosine[tuple(cells)] for cosine in MERL.cosines)
    seen = np.minimum(cos_i, cos_o) > 0.1
    cells, cos_i, cos_o = cells[:, seen], cos_i[seen], cos_o[seen]
    cos_h, cos_d = np.cos(MERL.theta_h)[cells[0]], np.cos(MERL.theta_d)[cells[1]]
    found = spec(material, cos_h, cos_d, cos_i, cos_o)
    expected = tabulated(path).values[:, *cells].T
    if name == "too-bright":
        assert distance > 10
    else:
        np.testing.assert_allclose(found, expected, rtol=0.05, atol=1e-4)
        assert distance < 3
    # What it says of itself is that of the formulas.
    known = gltf.lobe(Source(path))
    table = (gltf.metal_table if metal else gltf.dielectric_table)(known, MERL)
    np.testing.assert_allclose(found, table.values[:, *cells].T, rtol=1e-4, atol=1e-9)


def test_gltf_has_nothing_that_its_validator_complains_of(surface, capsys):
    if not (shutil.which("node") and VALIDATOR.is_dir()):
        pytest.skip(f"there is no node, or no gltf-validator in {VALIDATOR.parent} (see .ci/run)")
    output, _, _ = exported(surface[1], "gltf", capsys, ".gltf")
    call = ["node", "-e", VALIDATE, str(VALIDATOR), str(output)]
    report = json.loads(subprocess.run(call, capture_output=True, text=True, check=True).stdout)
    assert report["issues"]["messages"] == []
    assert report["info"]["totalTriangleCount"] == 2 * (gltf.RINGS - 1) * gltf.SEGMENTS
    assert report["info"]["resources"][0]["storage"] == "data-uri"


def test_a_sphere_of_gltf_is_closed_and_faces_outwards():
    points, triangles = gltf._sphere()
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ij->i", normals, corners.mean(axis=1)) > 0).all()
    assert np.linalg.norm(normals, axis=1).sum() / 2 == pytest.approx(4 * np.pi, rel=0.01)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1, rtol=1e-6)


def test_materialx_reads_it_and_makes_a_shader(surface, capsys):
    import MaterialX as mx
    from MaterialX import PyMaterialXGenGlsl, PyMaterialXGenShader

    name, path, _ = surface
    output, distance, _ = exported(path, "materialx", capsys, ".mtlx")
    assert distance < 4 or name == "too-bright"
    search, library = mx.getDefaultDataSearchPath(), mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), search, library)
    document = mx.createDocument()
    mx.readFromXmlFile(document, str(output))
    document.setDataLibrary(library)
    assert document.validate() == (True, "")
    [material] = document.getMaterialNodes()
    [shader] = mx.getShaderNodes(material)
    assert shader.getNodeDef().getName() == "ND_open_pbr_surface_surfaceshader"
    known = {given.getName(): given for given in shader.getNodeDef().getActiveInputs()}
    for given in shader.getInputs():
        assert given.getType() == known[given.getName()].getType()
    generator = PyMaterialXGenGlsl.GlslShaderGenerator.create()
    context = PyMaterialXGenShader.GenContext(generator)
    context.registerSourceCodeSearchPath(search)
    assert "main" in generator.generate(name, shader, context).getSourceCode("pixel")


def test_openpbr_keeps_colours_at_normal_incidence(surface, capsys):
    name, path, _ = surface
    output, _, said = exported(path, "materialx", capsys, ".mtlx")
    inputs = {
        given.get("name"): np.array(given.get("value").split(", "), dtype=float)
        for given in ET.parse(output).getroot().find("open_pbr_surface")
    }
    rho_d, rho_s, alpha, f0, _ = SURFACES[name]
    assert inputs["specular_roughness"] == pytest.approx(np.sqrt(alpha), rel=1e-4)
    if "a metal" in said:
        found = inputs["specular_weight"] * inputs["base_color"]
    else:
        smooth = ((inputs["specular_ior"] - 1) / (inputs["specular_ior"] + 1)) ** 2
        found = inputs["specular_color"] * smooth
        # Under what is reflected in the mean: at most 0.685.
        assert (inputs["base_color"] >= np.minimum(np.pi * np.array(rho_d), 1) - 1e-5).all()
        assert (inputs["base_color"] <= np.minimum(3.2 * np.pi * np.array(rho_d), 1) + 1e-5).all()
    if name != "too-bright":
        np.testing.assert_allclose(found, np.array(rho_s) * f0, rtol=1e-3, atol=1e-6)


@pytest.mark.parametrize(("kind", "suffix"), [("gltf", ".gltf"), ("materialx", ".mtlx")])
def test_names_are_harmless(kind, suffix, tmp_path, capsys):
    arrays = {"rho_d": [0.1] * 3, "rho_s": [0.5] * 3, "alpha": [0.1], "f0": [0.04]}
    made = {name: np.array(value, dtype=np.float32) for name, value in arrays.items()}
    path = tmp_path / '7 "<ä>&.npz'
    fits.save(path, Fit("ggx-fitted", made, MERL))
    output, _, _ = exported(path, kind, capsys, suffix)
    if kind == "gltf":
        assert json.loads(output.read_text())["materials"][0]["name"] == '7 "<ä>&'
    else:
        assert ET.parse(output).getroot().find("surfacematerial").get("name") == "m_7______"
