"""The claims of the 2015 paper put to tables that are made to bear them out, or not."""

import itertools

import pandas as pd
import pytest

from npfm.papers import dupuy2015, page
from npfm.papers import measures_2015 as measures
from npfm.papers.claims import TOPICS
from npfm.papers.evidence import Evidence, Untestable

MATERIALS = ("chrome", "nylon", dupuy2015.WORSE, *dupuy2015.SHIFTED_GAMMA_FAILS)
AS_PRINTED = {
    "power-iteration": lambda m: 40.0,
    "abc-published": lambda m: 50.0 if m == dupuy2015.WORSE else 41.0,
    "shifted-gamma-published": lambda m: (
        25.0 if m in dupuy2015.SHIFTED_GAMMA_FAILS else 50.0 if m == dupuy2015.WORSE else 40.0
    ),
    "ggx": lambda m: 38.0,
    "beckmann": lambda m: 30.0,
}


def evidence(values, fits=None):
    rows = [
        (scene, material, variant, decibels(material))
        for variant, decibels in values.items()
        for scene, material in itertools.product("AB", MATERIALS)
    ]
    psnr = pd.DataFrame(rows, columns=["scene", "material", "variant", "psnr_db"])
    return Evidence(psnr, pd.Series(dtype=float), fits=fits)


def fits(seconds=0.1, status="converged"):
    rows = [(material, "power-iteration", seconds, status) for material in MATERIALS * 3]
    return pd.DataFrame(rows, columns=["material", "variant", "seconds", "status"])


def test_every_claim_holds_where_all_is_as_printed():
    run = evidence(AS_PRINTED, fits())
    for claim in TOPICS[-1].claims:
        assert page.judged(claim, run)[1] == page.HOLDS, claim.text


def test_metals_alone_count_for_metals():
    worse = AS_PRINTED | {"abc-published": lambda m: 90.0 if m == "nylon" else 41.0}
    found = measures.on_par(evidence(worse), dupuy2015.METALS, "Loew")
    assert found.holds and found.ours == "-1.00 dB, 2 materials"
    worse = AS_PRINTED | {"abc-published": lambda m: 45.0}
    assert not measures.on_par(evidence(worse), dupuy2015.METALS, "Loew").holds


def test_one_model_is_better_in_the_mean():
    found = measures.better(evidence(AS_PRINTED), "GGX", "Beckmann")
    assert found.holds and found.ours == "+8.00 dB, better for 5 of 5 materials"
    assert not measures.better(evidence(AS_PRINTED), "Beckmann", "GGX").holds


def test_worse_means_worse_than_all():
    run = evidence(AS_PRINTED | {"abc-published": lambda m: 39.0})
    found = measures.worse_for(run, dupuy2015.WORSE, ["Loew", "Bagher 2012"])
    assert not found.holds
    assert found.ours == "Loew -1.0 dB, Bagher 2012 +10.0 dB"


def test_a_fit_fails_by_more_than_a_tie():
    run = evidence(AS_PRINTED | {"shifted-gamma-published": lambda m: 38.5})
    assert not measures.fails_for(run, "two-layer-gold", "Bagher 2012").holds


def test_seconds_are_those_of_all_channels():
    found = measures.fast(evidence(AS_PRINTED, fits(0.2)), 1.0)
    assert found.holds and found.ours.startswith("median 0.60 s, at most 0.60 s, 5 fits")
    assert not measures.fast(evidence(AS_PRINTED, fits(0.4)), 1.0).holds


def test_a_degenerate_table_is_no_failure():
    run = evidence(AS_PRINTED, fits(status="degenerate: every sample is 0"))
    assert measures.never_fails(run).holds
    found = measures.never_fails(evidence(AS_PRINTED, fits(status="iteration cap")))
    assert not found.holds and found.difference.startswith("not alumina-oxide, chrome")


def test_what_the_run_lacks_is_untestable():
    for values, tables in ((AS_PRINTED, None), ({"ggx": lambda m: 1.0}, fits())):
        verdicts = [page.judged(claim, evidence(values, tables))[1] for claim in TOPICS[-1].claims]
        assert page.UNTESTABLE in verdicts
    with pytest.raises(Untestable, match="no felt"):
        measures.worse_for(evidence(AS_PRINTED), "felt", ["Loew"])
    with pytest.raises(Untestable, match="none of the materials"):
        measures.on_par(evidence(AS_PRINTED), ["felt"], "Loew")
