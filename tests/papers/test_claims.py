"""The paper's claims put to tables that are made to bear them out, or not."""

import itertools
from dataclasses import replace

import pandas as pd
import pytest

from npfm.papers import bagher2016, measures, page
from npfm.papers.claims import TOPICS
from npfm.papers.evidence import NAMES, Evidence, Untestable

SCENES = ["A", "B"]
MATERIALS = ["chrome", "alum-bronze", "violet-acrylic", "nylon", "green-latex", "pink-felt"]
DIFFUSENESS = pd.Series([0.001, 0.01, 0.02, 0.5, 1.0, 2.0], MATERIALS)
CLAIMS = {claim.text: claim for topic in TOPICS for claim in topic.claims}


def long_table(values):
    rows = [(s, m, v, db(m, s) if callable(db) else db) for v, db in values.items()
            for s, m in itertools.product(SCENES, MATERIALS)]  # fmt: skip
    return pd.DataFrame(rows, columns=["scene", "material", "variant", "psnr_db"])


def evidence(values, **tables):
    sizes = pd.Series(bagher2016.BYTES)
    return Evidence(long_table(values), sizes, DIFFUSENESS, **tables)


def papers_own():
    return {names[0]: bagher2016.MEAN_PSNR_DB[names[0]] for names in NAMES.values()}


def test_the_papers_own_averages_hold_in_their_order():
    ours = evidence(papers_own())
    assert measures.order(ours).holds
    for model in NAMES:
        finding = measures.average(ours, model)
        assert finding.holds
        assert finding.ours.endswith(" dB, 12 renderings")


def test_an_average_differs_by_what_it_is_off():
    finding = measures.average(evidence(papers_own() | {"naive": 50.0}), "naive")
    assert not finding.holds
    assert finding.difference == "-6.71 dB"
    assert measures.average(evidence(papers_own() | {"naive": 56.71 - 1.99}), "naive").holds


def test_a_gap_is_that_of_the_renderings_that_both_have():
    rows = evidence(papers_own() | {"naive": lambda m, s: 56.71 + (m == "nylon")}).psnr
    found = measures.gap(replace(evidence(papers_own()), psnr=rows), "naive", "independent-g")
    assert (found.ours, found.holds) == ("-1.34 dB, 12 renderings", True)
    lacking = rows[(rows["variant"] != "naive") | (rows["material"] == "nylon")]
    found = measures.gap(replace(evidence(papers_own()), psnr=lacking), "naive", "independent-g")
    assert found.ours == "-0.51 dB, 2 renderings"
    far = measures.gap(evidence(papers_own() | {"naive": 50.0}), "naive", "independent-g")
    assert (far.holds, far.difference) == (False, "-6.71 dB")


def test_models_out_of_order_are_named_with_their_distance():
    finding = measures.order(evidence(papers_own() | {"naive": 60.0}))
    assert not finding.holds
    assert finding.difference == "naive above independent-g by 1.78 dB"
    assert finding.ours.startswith("bivariate > naive > independent-g > g-from-d")


def test_the_order_is_that_of_the_renderings_that_all_have():
    rows = long_table({"bivariate": 60.0, "naive": lambda m, s: 90.0 if m == "chrome" else 50.0})
    lacking = rows[(rows["variant"] != "bivariate") | (rows["material"] != "chrome")]
    assert measures.order(replace(evidence({"naive": 1.0}), psnr=lacking)).holds


def test_published_fits_stand_for_a_model_before_ours_and_ours_where_there_are_none():
    both = evidence({"abc-published": 1.0, "abc-e2": 2.0})
    assert both.variant("Loew") == "abc-published"
    assert evidence({"abc-e2": 2.0}).variant("Loew") == "abc-e2"
    with pytest.raises(Untestable, match="the run has no tucker-20"):
        both.variant("Bilgili")


def rising(material, scene):
    return 40.0 + 3 * MATERIALS.index(material)


def test_the_gain_grows_with_diffuseness_or_does_not():
    flat = {"g-from-d": 40.0, "naive": 39.0}
    finding = measures.gain_correlation(evidence(flat | {"independent-g": rising}))
    assert finding.holds
    assert finding.ours.startswith("rank correlation 1.00")
    falling = evidence({"independent-g": 60.0, "g-from-d": rising, "naive": 39.0})
    assert not measures.gain_correlation(falling).holds


def test_the_largest_gain_is_over_the_better_of_the_two_in_one_rendering():
    values = {
        "independent-g": lambda m, s: 53.0 if (m, s) == ("nylon", "B") else 41.0,
        "g-from-d": 40.0,
        "naive": 30.0,
    }
    finding = measures.largest_gain(evidence(values), paper=14.0)
    assert finding.ours == "13.0 dB (nylon, scene B)"
    assert finding.holds
    assert not measures.largest_gain(evidence(values), paper=16.0).holds


def test_similar_is_asked_of_the_least_diffuse_third():
    values = {"independent-g": lambda m, s: 41.0 if m in MATERIALS[:2] else 60.0}
    values |= {"g-from-d": 40.0, "naive": 40.0}
    assert measures.similar_when_specular(evidence(values)).holds
    values["naive"] = 38.0
    assert not measures.similar_when_specular(evidence(values)).holds


def test_materials_that_another_model_wins_are_named():
    values = {"independent-g": 50.0, "abc-e2": lambda m, s: 51.0 if m == "nylon" else 40.0}
    finding = measures.best_for_every_material(evidence(values), ["Loew", "Ngan"])
    assert (finding.ours, finding.holds) == ("5 of 6 materials", False)
    assert finding.difference == "not nylon"
    values["abc-e2"] = 40.0
    assert measures.best_for_every_material(evidence(values), ["Loew"]).holds


def test_wins_and_ties_are_shares_of_the_renderings_compared():
    values = {"independent-g": 50.0, "abc-e2": lambda m, s: 49.0 if m == "nylon" else 40.0}
    won = measures.wins(evidence(values), "Loew", paper=80.0)
    assert (won.ours, won.holds) == ("83.3 % (10 of 12)", True)
    tied = measures.ties(evidence(values), "Loew", paper=21.25)
    assert (tied.ours, tied.holds) == ("16.7 % (2 of 12)", True)
    assert measures.wins(evidence(values), "Loew", paper=77.0).difference == "+6.3 points"


def weighting(weighted, unweighted, angle=89):
    names = {"naive" if angle == 89 else f"naive-to-{angle}-weighted": weighted}
    return long_table(names | {f"naive-to-{angle}-unweighted": unweighted})


def test_weighting_is_needed_where_every_specular_material_gains():
    needed = evidence({"naive": 1.0}, weighting=weighting(50.0, 40.0))
    assert measures.weighting_needed(needed, "naive").holds
    lost = weighting(50.0, lambda m, s: 49.0 if m == "chrome" else 40.0)
    shown = measures.chosen(measures.CAPTIONS[7], MATERIALS)
    finding = measures.weighting_needed(replace(needed, weighting=lost), "naive")
    assert finding.holds == ("chrome" not in shown[:-1])
    with pytest.raises(Untestable, match="no table of fits without"):
        measures.weighting_needed(evidence({"naive": 1.0}), "naive")
    with pytest.raises(Untestable, match="no g-from-d with and without"):
        measures.weighting_needed(needed, "g-from-d")


def test_weighting_is_harmless_where_the_diffuse_material_hardly_loses():
    for unweighted, holds in ((51.0, True), (53.0, False)):
        table = evidence({"naive": 1.0}, weighting=weighting(50.0, unweighted))
        assert measures.weighting_harmless(table, "naive").holds == holds


def test_starts_agree_where_most_channels_do():
    spread = pd.DataFrame({"material": "chrome", "channel": "red", "spread": [0.0, 0.01, 0.3]})
    finding = measures.starts_agree(evidence({"naive": 1.0}, starts=spread))
    assert finding.holds
    assert "2 of 3 channels within 5 %" in finding.ours
    spread["spread"] = [0.0, 0.1, 0.3]
    assert not measures.starts_agree(evidence({"naive": 1.0}, starts=spread)).holds


def test_failures_are_looked_up_among_the_worst():
    run = evidence({"independent-g": 1.0}, worst=["a", "alum-bronze", "b", "c", "violet-acrylic"])
    assert measures.among_the_worst(run, "alum-bronze").ours == "number 2 of 5 materials"
    assert measures.among_the_worst(run, "alum-bronze").holds
    assert not measures.among_the_worst(run, "violet-acrylic").holds


def test_the_bivariate_model_saves_or_lacks():
    run = evidence({"bivariate": rising, "independent-g": 50.0})
    assert measures.bivariate_gain(run, "chrome", saves=False).ours == "-10.0 dB"
    assert measures.bivariate_gain(run, "chrome", saves=False).holds
    assert not measures.bivariate_gain(run, "chrome", saves=True).holds
    assert measures.bivariate_gain(run, "pink-felt", saves=True).holds
    with pytest.raises(Untestable, match="the run has no red-fabric"):
        measures.bivariate_gain(run, "red-fabric", saves=False)


def test_sizes_are_those_of_the_paper_exactly():
    assert measures.size(evidence({"naive": 1.0}), "naive", 4344).holds
    assert measures.size(evidence({"naive": 1.0}), "naive", 4340).difference == "+4 bytes"


def test_nothing_is_claimed_of_a_run_that_has_nothing():
    empty = Evidence(long_table({"another": 1.0}), pd.Series(dtype=float))
    verdicts = {page.judged(claim, empty)[1] for claim in CLAIMS.values()}
    assert verdicts == {page.UNTESTABLE}


def test_every_claim_is_judged_on_a_run_that_has_everything():
    pairs = {f"{model}-to-89-unweighted": 1.0 for model in measures.NON_PARAMETRIC}
    pairs |= dict.fromkeys(measures.NON_PARAMETRIC, 50.0)
    pairs |= {"independent-g-to-80-weighted": 50.0, "independent-g-to-80-unweighted": 40.0}
    run = Evidence(
        long_table(papers_own() | {"independent-g": rising}).replace("nylon", "red-fabric"),
        pd.Series(bagher2016.BYTES),
        DIFFUSENESS.rename({"nylon": "red-fabric"}),
        pd.DataFrame({"spread": [0.0]}),
        long_table(pairs),
        MATERIALS,
    )
    claims = [claim for topic in TOPICS[:-2] for claim in topic.claims]  # of this paper
    verdicts = {claim.text: page.judged(claim, run) for claim in claims}
    untestable = [text for text, (_, verdict, _) in verdicts.items() if verdict == page.UNTESTABLE]
    assert len(untestable) == 1 and "polyurethane-foam" in untestable[0]
    assert sum(verdict == page.HOLDS for _, verdict, _ in verdicts.values()) > 20


def test_fits_of_few_angles_are_compared_with_fits_of_the_same_angles():
    """Not with those of the run, which use more."""
    pairs = {"independent-g": 60.0, "independent-g-to-89-unweighted": 1.0}
    pairs |= {"independent-g-to-80-weighted": 50.0, "independent-g-to-80-unweighted": 40.0}
    finding = measures.weighting_restricted(evidence({"naive": 1.0}, weighting=long_table(pairs)))
    assert finding.ours.startswith("+10.0 dB")


def test_pictures_without_a_psnr_or_equal_to_the_measurement_leave_claims_testable():
    """A black material, and one that some model meets exactly."""
    odd = {"chrome": float("nan"), "nylon": float("inf")}

    def psnr(db):
        return lambda material, scene: odd.get(material, db)

    values = {"independent-g": psnr(58.0), "naive": 50.0, "g-from-d": 49.0}
    run = evidence(values, weighting=weighting(psnr(50.0), 40.0))
    assert measures.average(run, "independent-g").ours == "58.00 dB, 8 renderings"
    assert measures.order(run).ours == "independent-g > naive > g-from-d"
    best = measures.best_for_every_material(run, ["naive", "g-from-d"])
    assert best.holds and best.ours == "4 of 4 materials"
    assert measures.largest_gain(run, 8.0).holds
    assert measures.wins(run, "naive", 100.0).ours == "100.0 % (10 of 10)"
    assert "chrome" not in measures.weighting_needed(run, "naive").ours
