"""The claims of Lawrence et al. 2004 put to variances that bear them out, or not."""

import itertools

import numpy as np
import pandas as pd
import pytest

from npfm.evaluation.importance import COLUMNS, gather
from npfm.papers import claims_2004, lawrence2004, page
from npfm.papers import measures_2004 as measures
from npfm.papers.evidence import Evidence, Untestable

(TOPIC,) = claims_2004.TOPICS
SAMPLES = (4, 100)


def evidence(exponent=-1.0, **changes):
    """Variances as printed, those of some strategies multiplied."""
    rows = []
    for light, material in itertools.product(lawrence2004.IMPROVEMENT, lawrence2004.MATERIALS):
        printed = lawrence2004.IMPROVEMENT[light][material]
        factors = dict(zip(lawrence2004.STRATEGIES, printed, strict=True))
        # What the paper says is more than its tables bear out.
        factors["blinn-phong"] = max(2.0, factors["blinn-phong"])
        for (strategy, factor), n in itertools.product(
            [*factors.items(), ("factored", 1.0)], SAMPLES
        ):
            variance = 0.1 * factor * changes.get(strategy, 1) * n ** (exponent + 1)
            recipe = "paper" if strategy == "factored" else ""
            row = (light, material, strategy, recipe, "sobol", n, variance, 0, 1, 1e-7)
            rows.append(row)
    variance = gather([pd.DataFrame(rows, columns=COLUMNS[:-1])])
    return Evidence(pd.DataFrame(), pd.Series(), variance=variance)


def test_every_claim_holds_where_all_is_as_printed():
    for claim in TOPIC.claims:
        assert page.judged(claim, evidence())[1] == page.HOLDS, claim.text


def test_the_best_recipe_of_a_strategy_counts():
    rows = evidence()
    worse = rows.variance[rows.variance["strategy"] == "lafortune"].copy()
    worse["n_var"] *= 100
    worse["recipe"] = "least-squares"
    both = Evidence(rows.psnr, rows.bytes, variance=pd.concat([rows.variance, worse]))
    found = measures.as_printed(both, "constant", "nickel")
    assert found.holds and found.ours == "306, 11.5, 2.17, 1.66"


def test_materials_that_gain_less_are_named():
    found = measures.better_than(evidence(cosine=0.1), "cosine", 5)
    assert not found.holds
    assert found.ours == "0.89 to 31, median 16, 3 materials"
    assert found.difference == "blue-metallic-paint 0.89"


def test_factors_that_are_not_those_printed_are_named():
    found = measures.as_printed(evidence(**{"per-view": 0.1}), "beach", "nickel")
    assert not found.holds
    assert found.difference == "times the printed: per-view 0.1"


def test_a_variance_that_falls_faster_is_told():
    found = measures.inverse_of_samples(evidence(-1.5))
    assert not found.holds
    assert found.ours == "exponents from -1.50 to -1.50"
    assert "factored paper -1.5" in found.difference


def test_what_the_study_lacks_cannot_be_tested():
    none = Evidence(pd.DataFrame(), pd.Series())
    with pytest.raises(Untestable, match="importance was not made before"):
        measures.inverse_of_samples(none)
    rows = evidence()
    with pytest.raises(Untestable, match="does not have the light 'grace'"):
        measures.as_printed(rows, "grace", "nickel")
    with pytest.raises(Untestable, match="the study has no brass"):
        measures.as_printed(rows, "beach", "brass")
    with pytest.raises(Untestable, match="does not compare brute-force at 100 samples"):
        measures.better_than(rows, "brute-force", 1)
    assert np.isfinite(rows.variance["improvement"]).all()
