import re

import numpy as np
import pytest
from shaders import evaluated

from npfm.errors import NpfmError
from npfm.exports import glsl
from npfm.exports.shaders import shader as shaders
from npfm.exports.shaders.shader import shader
from npfm.exports.texture import texture
from npfm.fitting import registry
from npfm.fitting.fits import Fit
from npfm.reflectance.angles import directions
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import MERL, HalfDifference

COARSE = HalfDifference(20, 30, 40)
CASES = {
    "independent-g": (MERL, {}),
    "coarse": (COARSE, {}),
    "g-from-d": (MERL, {}),
    "shared-lobes": (MERL, {}),
    "of its own": (MERL, {}),
    "spline": (MERL, {"spline": np.ones(1)}),
    "power-iteration": (MERL, {}),
    "ggx": (MERL, {}),
    "ggx-fitted": (COARSE, {}),
}
MODELS = {"coarse": "independent-g", "of its own": "shared-lobes", "spline": "shared-lobes"}


def made(case):
    """A fit with random curves."""
    rng = np.random.default_rng(len(case))
    grid, extra = CASES[case]
    model, lobes = MODELS.get(case, case), 2
    h, d, _ = grid.shape
    rho = {"rho_d": rng.random(3), "rho_s": rng.random(3)}
    F = {"F": rng.uniform(0.5, 1, (3, d))}
    fall = np.exp(-np.arange(h) * (5 / h))
    match model:
        case "independent-g":
            arrays = rho | F | {"D": fall * rng.random((3, 1)), "G": rng.uniform(0.5, 1, (3, 90))}
        case "g-from-d":
            arrays = rho | F | {"D": fall * rng.uniform(0.5, 1, (3, h))}
        case "shared-lobes":
            channels = 3 if case == "of its own" else 1
            factors = {
                n: rng.uniform(0.5, 1, (channels, lobes, k)) for n, k in (("D", h), ("G", 90))
            }
            arrays = rho | F | factors | {"rho_s": rng.random((3, lobes))}
        case "power-iteration":
            arrays = F | {"D": fall[None], "rho_s": rho["rho_s"]}
        case "ggx":
            arrays = F | {"alpha": np.array([0.1]), "rho_s": rho["rho_s"]}
        case "ggx-fitted":
            arrays = rho | {"alpha": np.array([0.3]), "f0": np.array([0.04])}
    arrays |= extra
    stored = {name: array.astype(np.float32) for name, array in arrays.items()}
    return Fit(model, stored, grid)


def turned(vectors, rng):
    """Vectors (n, 3) over the normal z as they are over normals of their own, and these."""
    frames, _ = np.linalg.qr(rng.normal(size=(len(vectors[0]), 3, 3)))
    rotated = [np.einsum("nij,nj->ni", frames, v) for v in vectors]
    return *rotated, frames[:, :, 2]


def some_cells(grid, count=400):
    """Bins of cells above the horizon, some at the ends of the axes, the others anywhere."""
    rng = np.random.default_rng(3)
    bins = [rng.integers(0, n, 20 * count) for n in grid.shape]
    for k, n in enumerate(grid.shape):
        bins[k][: count // 2] = rng.choice([0, n - 1], count // 2)
    return tuple(b[grid.above_horizon[tuple(bins)]][:count] for b in bins)


@pytest.fixture(scope="module")
def values(tmp_path_factory):
    """What the function of every case says at centres of cells, the table, and their cosines."""
    found = {}
    for grid in (MERL, COARSE):
        names = [case for case, (other, _) in CASES.items() if other == grid]
        functions = [glsl.function(made(case), case) for case in names]
        h, d, p = some_cells(grid)
        light, view = directions(grid.theta_h[h], grid.theta_d[d], grid.phi_d[p])
        vectors = turned((light, view), np.random.default_rng(1))
        said = evaluated(tmp_path_factory.mktemp("glsl"), functions, *vectors)
        for case, here in zip(names, said, strict=True):
            model = registry.declared(MODELS.get(case, case)).load()
            table = model.tabulate(made(case)).values[:, h, d, p].T
            found[case] = here, table, np.minimum(light[:, 2], view[:, 2])
    return found


@pytest.mark.parametrize("case", CASES)
def test_a_function_has_the_values_of_the_table(values, case):
    said, table, cosine = values[case]
    # Single precision leaves 3e-7 of a cosine and 2e-7 radian of an angle, and the tables of ggx
    # read projected areas from nodes that are linear to 3e-6.
    error = np.abs(said / table - 1).max(axis=1)
    assert (error < 1e-4 + 3e-6 / cosine).all()
    assert np.median(error) < 2e-5


def test_rows_of_independent_g_are_those_of_the_texture():
    fit = made("independent-g")
    np.testing.assert_array_equal(shader(fit).rows, texture({"chrome": fit})[:, 0])


@pytest.mark.parametrize("name", ["a\nvec3 x;", "Grün & </script> 'öl\"", "ends with \\", "*/"])
def test_a_name_stays_in_its_comment(name):
    text = glsl.function(made("ggx-fitted"), name)
    first, *others = text.splitlines()
    assert re.fullmatch(r"// Made by npfm: BRDF of [\w .,+-]+ by ggx-fitted\.", first, re.ASCII)
    assert others == glsl.function(made("ggx-fitted"), "chrome").splitlines()[1:]


def test_the_format_declares_the_models_that_have_functions():
    assert tuple(shaders.MODELS) == glsl.MODELS


def test_other_fits_are_refused():
    with pytest.raises(NpfmError, match="a fit of naive on the grid half-difference 90x90x180 is"):
        shader(Fit("naive", {}, MERL))
    with pytest.raises(NpfmError, match="on a half-difference grid"):
        shader(Fit("ggx", {}, Directional(4, 8, 4, 8)))
