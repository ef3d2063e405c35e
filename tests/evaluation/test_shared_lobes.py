import numpy as np
import pandas as pd
import pytest

from npfm.errors import NpfmError
from npfm.evaluation import shared_lobes as study
from npfm.evaluation.accuracy_cost import FITS
from npfm.fitting.fits import Fit
from npfm.models import shared_lobes
from npfm.reflectance.microsurfaces import ggx
from npfm.rendering.lights.environment import Environment

WORDS = study.SHARED, study.OWN


def rows():
    found = [
        ("felt", "compared", name, scene, 1.0, 100, level + (scene == "C"))
        for name, level in (("shared-lobes", 50.0), ("independent-g", 40.0))
        for scene in "AC"
    ]
    found += [("felt", "lobes", f"{n}-{w}", "A", n, 4 * n, 30.0) for n in (1, 3) for w in WORDS]
    return pd.DataFrame(found, columns=FITS)


def test_psnr_is_the_mean_over_the_scenes():
    table = study.psnr(rows()).set_index("variant")
    assert table.psnr_db.to_dict() == {"shared-lobes": 50.5, "independent-g": 40.5}
    assert study.wins(study.psnr(rows()), "shared-lobes", "independent-g") == (1, 1)


def test_lobes_by_number_and_sharing():
    table = study.lobes(rows())
    assert list(table.lobes) == [1, 1, 3, 3]
    assert list(table.shared) == [1, 0, 1, 0]
    with pytest.raises(NpfmError, match="no fits of the stage 'lobes'"):
        study.lobes(rows()[:4])


def glossy(grid, rho_d):
    """A fit of one narrow lobe whose F, G are 1, over a diffuse part."""
    D = ggx(np.cos(grid.theta_h), 0.05)
    parameters = {
        "D": np.stack([D / D.max()] * 3)[None],
        "F": np.ones((3, grid.theta_d_bins)),
        "G": np.ones((1, 3, 90)),
        "rho_s": np.full((3, 3), 1.0),
        "rho_d": np.full(3, rho_d),
    }
    single = {name: array.astype(np.float32) for name, array in parameters.items()}
    return Fit("shared-lobes", single, grid)


def test_D_is_better_than_the_cosine_where_nothing_is_diffuse_and_worse_where_all_is(grid):
    light = Environment(np.ones((8, 16, 3), dtype=np.float32))
    effort = study.Effort(6, [16, 64], 2048, 2)
    gains = []
    for rho_d in (0.0, 100.0):
        fit = glossy(grid, rho_d)
        table = study.sampling(fit, shared_lobes.tabulate(fit), light, effort)
        assert len(table) == 6
        assert (table.repetitions == 2).all()
        np.testing.assert_allclose(table.psnr_db, -20 * np.log10(table.rms))
        errors = table.pivot(index="samples", columns="way", values="psnr_db")
        gains.append(errors["D"] - errors["cosine"])
    assert (gains[0] > 0).all()
    assert (gains[1] < 0).all()
