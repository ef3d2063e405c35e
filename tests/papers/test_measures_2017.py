"""The claims of the 2017 paper put to tables that are made to bear them out, or not."""

import itertools

import pandas as pd
import pytest

from npfm.papers import measures_2017 as measures
from npfm.papers import page, peng2017
from npfm.papers.claims import TOPICS
from npfm.papers.evidence import Evidence, Untestable

HARDLY = dict.fromkeys(peng2017.HARDLY_BETTER, 0.5)
GAINS = {peng2017.MUCH_BETTER: 12.0, "chrome": 6.0, **HARDLY}
(TOPIC,) = (topic for topic in TOPICS if peng2017.SOURCE in topic.title)


def evidence(gains, free=50.0, scenes="ABC"):
    rows = []
    for scene, (material, gain) in itertools.product(scenes, gains.items()):
        # Scene B is none of the paper's, and says the opposite.
        own = 40.0 + (gain if scene != "B" else -30.0)
        values = {"independent-g": 40.0, "shared-lobes": own, "bivariate": free}
        rows += [(scene, material, variant, db) for variant, db in values.items()]
    psnr = pd.DataFrame(rows, columns=["scene", "material", "variant", "psnr_db"])
    return Evidence(psnr, pd.Series({"shared-lobes": 3288, "independent-g": 3264}))


def test_every_claim_holds_where_all_is_as_printed():
    for claim in TOPIC.claims:
        verdict = page.judged(claim, evidence(GAINS, 47.0))[1]
        assert verdict == page.HOLDS, claim.text


def test_losers_are_named():
    found = measures.better_materials(evidence(GAINS | {"nylon": -3.0}))
    assert not found.holds
    assert found.ours == "3 of 4, median +3.25 dB"
    assert found.difference == "not for nylon -3.0 dB"
    worst = measures.never_worse(evidence(GAINS | {"nylon": -3.0}))
    assert not worst.holds and worst.ours == "at worst -3.00 dB, nylon"


def test_far_below_the_bivariate_model_is_not_near_it():
    assert not measures.nearer_to_bivariate(evidence(GAINS, 60.0)).holds
    assert not measures.sometimes_above_bivariate(evidence(GAINS, 60.0)).holds


def test_the_count_of_values_is_that_of_the_paper():
    run = evidence(GAINS)
    assert measures.size(run).ours == "822, +6"
    run.bytes["shared-lobes"] = 3292
    assert not measures.size(run).holds


def test_what_a_run_lacks_cannot_be_tested():
    with pytest.raises(Untestable, match="neither of the scenes A and C"):
        measures.better_materials(evidence(GAINS, scenes="B"))
    with pytest.raises(Untestable, match="no chrome"):
        measures.gain(evidence(HARDLY), "chrome", large=True)
    with pytest.raises(Untestable, match="no shared-lobes"):
        none = Evidence(evidence(GAINS).psnr.query("variant != 'shared-lobes'"), pd.Series())
        measures.better_materials(none)
