"""Distances of factors against changes that are known, and singular values of known planes."""

import numpy as np
import pandas as pd
import pytest
from lobed import GRID, NODES, fit_of

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation import uniqueness as study
from npfm.fitting.basis.lobes import cells, lobes_of
from npfm.fitting.fits import Fit
from npfm.fitting.iterations import Iterations
from npfm.fitting.objective import Objective
from npfm.reflectance.half_difference import HalfDifference

AT = cells(GRID, Objective())
FIT = fit_of("independent-g", 0.02, 1.0, 0.5)  # a narrow D
LOBES = lobes_of(FIT.parameters)[0]
LOGS = {name: np.log(getattr(LOBES, name)[0]) for name in "DGF"}


def moved(**changes):
    return {name: log + changes.get(name, 0) for name, log in LOGS.items()}


def test_scales_are_no_distance():
    found = study.distance(LOBES, AT, LOGS, moved(D=1.0, G=-2.0, F=3.0))
    assert max(found.values()) < 1e-9


def test_what_one_factor_changes_by_is_its_distance_alone():
    bump = 0.3 * np.sign(np.sin(40 * GRID.theta_d))
    found = study.distance(LOBES, AT, LOGS, moved(F=bump))
    assert found["D"] == found["G"] == 0
    assert found["F"] == pytest.approx(0.3, rel=0.1) == found["F_G2"]
    assert found["product"] == pytest.approx(found["F"], rel=0.1)


def test_of_a_narrow_lobe_only_f_times_g_squared_is_told():
    def tilt(theta):
        return 2.0 * np.cos(theta)

    found = study.distance(LOBES, AT, LOGS, moved(F=-2 * tilt(GRID.theta_d), G=tilt(NODES)))
    assert found["F"] > 0.5 and found["G"] > 0.25
    assert found["F_G2"] < 0.02 and found["product"] < 0.1
    wide = lobes_of(fit_of("independent-g", 1.0, 1.0, 0.5).parameters)[0]
    logs = {name: np.log(getattr(wide, name)[0]) for name in "DGF"}
    other = {"D": logs["D"], "F": logs["F"] - 2 * tilt(GRID.theta_d), "G": logs["G"] + tilt(NODES)}
    assert study.distance(wide, AT, logs, other)["product"] > 3 * found["product"]


def test_singular_values_of_a_product_and_of_two():
    rng = np.random.default_rng(3)
    u, v = rng.uniform(1, 2, 18), rng.uniform(1, 2, 18)
    flat = np.ones(GRID.shape[:2])
    assert study.sigma_ratio(np.outer(u, v), AT, flat) < 1e-12
    weight = AT.weights(np.ones_like(AT.weight)).sum(1).reshape(18, 18)
    rows, columns = np.sqrt(weight.sum(1)), np.sqrt(weight.sum(0))
    # Two products that are orthogonal once rows and columns are weighted.
    a, b = np.eye(18)[4], np.eye(18)[9]
    plane = (np.outer(a, a) + 0.25 * np.outer(b, b)) / rows[:, None] / columns
    assert study.sigma_ratio(plane, AT, flat) == pytest.approx(0.25)
    assert study.sigma_ratio(0 * plane, AT, flat) == 0


def record(steps):
    """Of one channel thrice: (start, run, objective, change of F)."""
    every = [(channel, *step) for channel in range(3) for step in steps]
    channel, start, run, objective, change = map(np.array, zip(*every, strict=True))
    return Iterations(
        tuple("abcd"[: start.max() + 1]),
        channel,
        start,
        run,
        objective,
        np.tile(LOBES.D[0], (len(every), 1)),
        np.tile(LOBES.G[0], (len(every), 1)),
        LOBES.F[0] * np.exp(np.outer(change, np.sign(np.sin(40 * GRID.theta_d)))),
    )


STEPS = [
    (0, 0, 0.5, 9.0), (0, 0, 0.101, 0.2), (1, 0, 0.4, 9.0), (1, 0, 0.1, 0.0), (2, 0, 0.12, 5.0),
    (3, 0, 0.104, 0.4), (1, 1, 0.09, 7.0),
]  # fmt: skip


def plane():
    return Fit("bivariate", {"B": np.ones((3, 18, 18), np.float32)}, GRID)


def test_ends_of_starts_that_are_about_as_good_are_compared():
    found = record(STEPS)
    assert found.start[study.ends(found, 0)].tolist() == [1, 0, 3, 2]
    assert found.start[study.near(found, 0)].tolist() == [1, 0, 3]
    table = study.measure(FIT, found, plane(), Objective())
    assert tuple(table.columns) == study.CHANNEL[1:]
    assert table["starts"].tolist() == [4] * 3 and table["near"].tolist() == [3] * 3
    assert table["worst"].tolist() == pytest.approx([0.04] * 3)
    assert table["F"].tolist() == pytest.approx([0.4] * 3, rel=0.1)
    assert table["D"].tolist() == [0] * 3
    assert table["roughness"].between(0.01, 0.06).all()  # to a bin, and these are coarse


def test_a_single_end_is_no_distance():
    table = study.measure(FIT, record(STEPS[2:4]), plane(), Objective())
    assert table["near"].tolist() == [1] * 3 and not table[["D", "G", "F"]].to_numpy().any()


def test_fits_of_other_tables_are_refused():
    other = HalfDifference(6, 6, 4)
    small = Fit("bivariate", {"B": np.ones((3, 6, 6), np.float32)}, other)
    with pytest.raises(NpfmError, match="not of one table"):
        study.measure(FIT, record(STEPS), small, Objective())


def test_arrays_of_another_shape_are_refused():
    flat = Fit("bivariate", {"B": np.ones((3, 18, 1), np.float32)}, GRID)
    with pytest.raises(NpfmError, match=r"B of shape \(3, 18, 1\)"):
        study.measure(FIT, record(STEPS), flat, Objective())
    narrow = Fit(FIT.model, FIT.parameters | {"F": np.ones((3, 4), np.float32)}, GRID)
    with pytest.raises(NpfmError, match="are not those of independent-g"):
        study.measure(narrow, record(STEPS), plane(), Objective())


def test_the_summary_counts_and_correlates(tmp_path):
    distances = [0.0, 0.05, 0.2, 0.4]
    rows = [
        (
            f"m{k}",
            "red",
            8,
            near,
            0.01,
            0.0,
            d / 2,
            d,
            0.0,
            d / 10,
            0.1 * (k + 1),
            0.5 - 0.1 * k,
            0.5,
        )
        for k, (near, d) in enumerate(zip((1, 2, 8, 8), distances, strict=True))
    ]
    tables.write(tmp_path / "a.csv", pd.DataFrame(rows, columns=study.CHANNEL))
    channels = study.read([tmp_path / "a.csv"])
    found = study.summary(channels).set_index("quantity")["value"]
    assert found["channels"] == 4 and found["channels with equally good ends"] == 3
    assert (
        found["channels with ambiguous factors"] == found["materials with ambiguous factors"] == 2
    )
    assert found["channels with an ambiguous product D F K"] == 0
    assert found["median distance of F"] == 0.2 and found["largest distance of G"] == 0.2
    assert found["rank correlation with sigma_ratio"] == pytest.approx(1)
    assert found["rank correlation with sigma_ratio_specular"] == pytest.approx(-1)
    assert np.isnan(found["rank correlation with roughness"])  # all are alike
    assert found["median sigma_ratio, ambiguous"] == pytest.approx(0.35)
