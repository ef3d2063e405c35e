import numpy as np
import pytest

from npfm.evaluation import power_iterations as study
from npfm.fitting.fits import Fit
from npfm.papers import dupuy2015
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.microsurfaces import ggx


def test_table_1_of_the_paper():
    """Known surfaces are found again, nearer than the paper prints."""
    printed = dupuy2015.BACKSCATTER_ERROR
    table = study.recovery((dupuy2015.TABLE_1_NODES, dupuy2015.MERL_NODES), printed)
    assert len(table) == 2 * 2 * len(printed)
    for row in table.itertuples():
        assert 0 <= row.backscatter_error < printed[row.alpha], row
        assert row.alpha_error < 1e-4
    fine = table[table.nodes == dupuy2015.TABLE_1_NODES].backscatter_error.to_numpy()
    coarse = table[table.nodes == dupuy2015.MERL_NODES].backscatter_error.to_numpy()
    assert (fine < coarse).all()


def test_roughness_is_found_from_mirrors_to_matte():
    table = study.recovery((90,), (0.005, 0.05, 0.3, 0.6))
    assert (table.alpha_error < 1e-4).all()


def test_every_part_is_timed():
    table = study.timing((6, 12), 1)
    assert set(table.part) == {"once", "eigenproblem", "mirrors", "fresnel"}
    assert len(table) == 8
    assert (table.seconds >= 0).all()


def fit_of(alpha, rho_s=(0.1, 0.5, 2.0)):
    D = ggx(np.cos(MERL.theta_h), alpha)
    F = np.linspace(0.5, 1, 90)
    parameters = {"D": (D / D.max())[None], "F": np.stack([F] * 3), "rho_s": np.array(rho_s)}
    single = {key: value.astype(np.float32) for key, value in parameters.items()}
    return Fit("power-iteration", single, MERL)


def test_what_an_artist_reads_off_a_fit():
    table = study.surfaces({"satin": fit_of(0.3), "mirror": fit_of(0.001)}).set_index("material")
    satin = table.loc["satin"]
    assert satin.alpha_ggx == pytest.approx(0.3, rel=1e-3)
    assert [satin.red, satin.green, satin.blue] == pytest.approx([0.05, 0.25, 1.0])
    assert satin.resolved
    assert satin.alpha_flattened == pytest.approx(satin.alpha_ggx, rel=1e-2)


def test_a_surface_below_the_resolution_of_the_table_says_so():
    table = study.surfaces({"mirror": fit_of(0.001)})
    assert not table.resolved.item()
    assert table.alpha_flattened.item() > 2 * table.alpha_ggx.item()
