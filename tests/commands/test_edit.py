import numpy as np
import pytest

from npfm.__main__ import main
from npfm.datasets import synthetic_anisotropic
from npfm.fitting import fits, registry
from npfm.fitting.objective import Objective
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.slopes import ggx_roughness

EDITABLE = ("beckmann", "ggx", "ggx-fitted", "power-iteration")


@pytest.fixture(scope="module")
def folder(tmp_path_factory, table):
    """Fits of the shared table."""
    folder = tmp_path_factory.mktemp("edit")
    for name in (*EDITABLE, "bivariate"):
        fit = registry.declared(name).load().fit(table, Objective(), None, 1)
        fits.save(folder / f"{name}.npz", fit)
    return folder


def edited(folder, name, factor):
    output = folder / f"{name}-{factor}.npz"
    assert (
        main(["edit", f"{folder}/{name}.npz", "--roughness", str(factor), "-o", str(output)]) == 0
    )
    return fits.load(output)


@pytest.mark.parametrize("name", EDITABLE)
def test_only_the_slopes_change(folder, name):
    fit = fits.load(folder / f"{name}.npz")
    made = edited(folder, name, 0.5)
    assert made.model == name
    for key, array in fit.parameters.items():
        assert made.parameters[key].dtype == np.float32
        changed = key in ("D", "alpha")
        assert np.array_equal(made.parameters[key], array) != changed, key
    if "alpha" in fit.parameters:
        assert made.parameters["alpha"] == fit.parameters["alpha"] / 2
    else:
        assert made.parameters["D"].max() == 1


@pytest.mark.parametrize("name", EDITABLE)
def test_the_edited_fit_is_a_table_again(folder, name):
    made = edited(folder, name, 1.5)
    values = registry.declared(name).load().tabulate(made).values[:, made.grid.above_horizon]
    assert np.isfinite(values).all()
    assert (values >= 0).all()


def test_the_roughness_is_multiplied(tmp_path):
    alpha = 0.1
    D = (1 + np.tan(MERL.theta_h) ** 2) ** 2 / (1 + np.tan(MERL.theta_h) ** 2 / alpha**2) ** 2
    parameters = {
        "D": (D / D.max())[None],
        "F": np.ones((3, 90)),
        "rho_s": np.ones(3),
    }
    single = {key: value.astype(np.float32) for key, value in parameters.items()}
    fits.save(tmp_path / "power-iteration.npz", fits.Fit("power-iteration", single, MERL))
    for factor in (0.5, 2.0, 4.0):
        made = edited(tmp_path, "power-iteration", factor).parameters["D"][0]
        assert ggx_roughness(made, MERL) == pytest.approx(alpha * factor, rel=3e-3)


def test_as_much_light_is_reflected_by_a_smoother_surface(folder):
    """Scaled slopes keep D normalised: seen from above, the albedo stays near that of F."""
    fit = fits.load(folder / "power-iteration.npz")
    smooth, smoother = (edited(folder, "power-iteration", factor) for factor in (0.25, 0.125))
    peaks = [
        registry.declared(fit.model).load().tabulate(made).values[:, 0, 0].max(-1)
        for made in (smooth, smoother)
    ]
    # A lobe of half the width is four times as high; the grid is coarse.
    np.testing.assert_allclose(peaks[1] / peaks[0], 4, rtol=0.05)


@pytest.mark.parametrize(
    ("name", "factor", "said"),
    [
        (
            "bivariate",
            "2",
            "'bivariate' cannot be made rougher; give a fit of beckmann or ggx or",
        ),
        ("ggx", "0", "give a number above 0"),
        ("ggx", "1 2", "a fit of a half-difference table has no x and y; give one number"),
        ("ggx", "1 2 3", "--roughness has 3 numbers; give one, or two for x and y"),
        ("ggx", "-1", "give a number above 0"),
        ("ggx", "rough", "give a number above 0"),
        ("absent", "2", "no such file"),
    ],
)
def test_mistakes_are_answered_in_one_line(capsys, folder, name, factor, said):
    output = folder / "never.npz"
    numbers = factor.split() if " " in factor else [factor]
    option = ["--roughness", *numbers] if numbers[1:] else [f"--roughness={factor}"]
    call = ["edit", f"{folder}/{name}.npz", *option, "-o", str(output)]
    try:
        assert main(call) == 1
    except SystemExit as stopped:
        assert stopped.code
    [line] = capsys.readouterr().err.splitlines()
    assert said in line
    assert not output.exists()


def test_slopes_along_two_axes(tmp_path):
    table = synthetic_anisotropic.load("cast-chrome", 1, Directional(6, 24, 6, 24))
    for name in ("ggx", "power-iteration"):
        fit = registry.declared(name).load().fit(table, Objective(), None, 1)
        fits.save(tmp_path / f"{name}.npz", fit)
        output = tmp_path / f"{name}-brushed.npz"
        words = ["--roughness", "0.5", "2", "-o", str(output)]
        assert main(["edit", f"{tmp_path}/{name}.npz", *words]) == 0
        before, after = (registry.tabulated(tmp_path / f"{name}{e}.npz") for e in ("", "-brushed"))
        # Seen from above, light at the same elevation comes back less along x, and more along y.
        change = (
            after.values[1, 3, [0, 6, 12, 18], 0, 0] / before.values[1, 3, [0, 6, 12, 18], 0, 0]
        )
        assert (change[::2] < 0.5).all()
        assert (change[1::2] > 1.5).all()
