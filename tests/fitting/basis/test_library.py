"""Factors of many fits: gathered, written, read, and what is refused."""

import numpy as np
import pytest
from lobed import GRID, fit_of, many

from npfm.errors import NpfmError
from npfm.fitting.basis import library
from npfm.fitting.basis.curves import coefficients, reconstruct
from npfm.fitting.basis.lobes import MOST_LOBES
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.models import shared_lobes

both = pytest.mark.parametrize("model", ["independent-g", "shared-lobes"])


def gathered(model):
    return library.gather(many(model), Objective())


@both
def test_a_file_holds_all(tmp_path, model):
    found = gathered(model)
    library.save(tmp_path / "all.npz", found)
    again = library.load(tmp_path / "all.npz")
    assert (again.model, again.grid, again.spline) == (model, GRID, False)
    assert again.materials == found.materials and set(found.materials) == {
        f"m{k}" for k in range(8)
    }
    for name in "DFG":
        assert again.logs[name] == pytest.approx(found.logs[name], abs=1e-5)
        assert again.seen[name] == pytest.approx(found.seen[name], rel=1e-5)


@both
def test_numbers_of_a_material_are_counted(model):
    found = gathered(model)
    groups, lobes, channels = (3, 1, 1) if model == "independent-g" else (1, 2, 3)
    assert found.unknowns(4) == groups * (4 * (2 * lobes + channels) + channels * (lobes + 1))
    assert found.basis_values(4) == 5 * (18 + 18 + 90)


@both
def test_a_material_left_out_says_nothing(model):
    fits = many(model)
    others = library.gather(fits, Objective()).without("m3")
    assert "m3" not in others.materials
    alone = library.gather({k: v for k, v in fits.items() if k != "m3"}, Objective())
    for name, basis in others.bases(3).items():
        assert basis.mean == pytest.approx(alone.bases(3)[name].mean)
        assert basis.curves == pytest.approx(alone.bases(3)[name].curves)
    assert others.without("no-such").materials == others.materials


def test_smooth_families_need_few_curves():
    found = gathered("independent-g").without("m2")
    for name, basis in found.bases(4).items():
        logs = gathered("independent-g").logs[name][6]
        back = reconstruct(basis, coefficients(basis, logs))
        assert np.log(back) - np.log(back).max() == pytest.approx(logs, abs=0.2)


def test_too_few_materials_are_told():
    few = library.gather(dict(list(many("independent-g").items())[:3]), Objective())
    with pytest.raises(NpfmError, match="a basis without m0 would be of 2 materials"):
        few.without("m0")


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (Fit("bivariate", {"B": np.ones((3, 18, 18), np.float32)}, GRID), "a fit of 'bivariate'"),
        (fit_of("shared-lobes", 0.3, 1, 1), "its model, settings or grid"),
    ],
)
def test_other_fits_are_refused(other, message):
    with pytest.raises(NpfmError, match=f"mine: {message}"):
        library.gather(many("independent-g") | {"mine": other}, Objective())


@pytest.mark.parametrize(
    ("model", "changes"),
    [
        ("independent-g", {"D": np.ones((3, 17))}),
        ("independent-g", {"D": np.ones((1, 18)), "G": np.ones((1, 90))}),
        ("independent-g", {"D": np.ones(3)}),
        ("independent-g", {"rho_s": np.ones((3, 2))}),
        ("shared-lobes", {"F": np.ones((1, 18))}),
        ("shared-lobes", {"rho_s": np.ones((3, 3))}),
        (
            "shared-lobes",
            {"D": np.ones((1, 6, 18)), "G": np.ones((1, 6, 90)), "rho_s": np.ones((3, 6))},
        ),
    ],
)
def test_arrays_that_no_fit_of_the_model_has_are_told(model, changes):
    arrays = fit_of(model, 0.3, 1, 1).parameters
    changed = Fit(model, arrays | {k: v.astype(np.float32) for k, v in changes.items()}, GRID)
    with pytest.raises(NpfmError, match=f"mine: its arrays .* are not those of {model}"):
        library.gather({"mine": changed}, Objective())


def test_no_fit_has_more_lobes_than_the_model_takes():
    assert MOST_LOBES == shared_lobes.MOST_LOBES


@pytest.mark.parametrize(
    ("name", "array"),
    [
        ("factors", np.array("npfm-fit-1")),
        ("model", np.array("naive")),
        ("grid", np.array([18, 17, 36])),
        ("grid", np.array([18, 18])),
        ("material", np.array(["m0"])),
        ("log_D", np.zeros((24, 18))),
        ("log_D", np.full((24, 1, 18), 3e38)),
        ("log_D", np.full((24, 1, 18), -99.0)),
        ("log_D", np.zeros((24, 2, 18))),
        ("log_F", np.full((24, 1, 18), np.nan)),
        ("seen_G", np.full((24, 1, 90), -1.0)),
        ("seen_G", None),
    ],
)
def test_damaged_files_are_told_in_one_line(tmp_path, name, array):
    path = tmp_path / "all.npz"
    library.save(path, gathered("independent-g"))
    arrays = dict(np.load(path)) | {name: array}
    np.savez(path, **{key: value for key, value in arrays.items() if value is not None})
    with pytest.raises(NpfmError, match="make it again with npfm basis gather") as caught:
        library.load(path)
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


def test_factors_of_several_lobes_are_of_no_model_of_one(tmp_path):
    path = tmp_path / "all.npz"
    library.save(path, gathered("shared-lobes"))
    np.savez(path, **dict(np.load(path)) | {"model": np.array("independent-g")})
    with pytest.raises(NpfmError, match=r"of 2 lobes that 3 channels share, by independent-g"):
        library.load(path)
