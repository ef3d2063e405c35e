"""Claims about anisotropic materials, put to tables that are made up."""

import numpy as np
import pandas as pd
import pytest

from npfm.evaluation.fidelity import COLUMNS
from npfm.papers import claims, page
from npfm.papers.claims_anisotropic import TOPICS
from npfm.papers.evidence import Evidence

CLAIMS = {claim.text: claim for topic in TOPICS for claim in topic.claims}


def evidence(count, eight_bit=107.0, **more):
    names = [f"m{k:03}" for k in range(count)]
    rows = [(name, "shared-lobes", 50.0, eight_bit, 45.0, 100.0) for name in names]
    psnr = [("A", name, v, 50.0) for name in names for v in ("shared-lobes", "power-iteration")]
    fits = [(name, "power-iteration", "converged", 0.4) for name in names for _ in range(3)]
    return Evidence(
        psnr=pd.DataFrame(psnr, columns=["scene", "material", "variant", "psnr_db"]),
        fits=pd.DataFrame(fits, columns=["material", "variant", "status", "seconds"]),
        **{
            "bytes": pd.Series({"shared-lobes": 8040, "power-iteration": 100}),
            "fidelity": pd.DataFrame(rows, columns=list(COLUMNS)),
            **more,
        },
    )


def judged(found):
    return {text: page.judged(claim, found) for text, claim in CLAIMS.items()}


def test_what_rests_on_the_database_is_not_judged_without_it():
    verdicts = judged(evidence(12))
    for text in ("average PSNR of the pictures", "materials below 100 dB"):
        _, verdict, why = verdicts[text]
        assert verdict == page.UNTESTABLE
        assert "UTIA database" in why
        assert "12 materials" in why
    assert "107.00 dB; 50.00 dB with" in verdicts["average PSNR of the pictures"][2]
    assert "fabric106" in next(why for text, (_, _, why) in verdicts.items() if "albedo" in text)
    size = "a fit takes no more than 6 KB"
    assert verdicts[size][:2] == ("100 bytes", page.HOLDS)
    large = evidence(1, bytes=pd.Series({"shared-lobes": 1, "power-iteration": 98280}))
    assert judged(large)[size][1] == page.DIFFERS
    for text in ("values of a fit", "a fit takes less than 20 seconds", "fits cannot fail"):
        assert verdicts[text][1] == page.HOLDS, text


@pytest.mark.parametrize(("eight_bit", "verdict"), [(107.0, page.HOLDS), (90.0, page.DIFFERS)])
def test_with_as_many_materials_it_is(eight_bit, verdict):
    verdicts = judged(evidence(150, eight_bit))
    assert verdicts["average PSNR of the pictures"][1] == verdict
    assert verdicts["materials below 100 dB"][1] == verdict


def test_a_run_without_the_model_says_so():
    other = evidence(12)
    alone = other.psnr[other.psnr["variant"] != "shared-lobes"]
    for text, verdict in judged(evidence(12, fidelity=None)).items():
        if "PSNR" in text:
            assert verdict[1:] == (page.UNTESTABLE, "the run has no table of fidelity")
    found = Evidence(psnr=alone, bytes=other.bytes, fits=other.fits, fidelity=other.fidelity)
    assert judged(found)["values of a fit"][2] == "the run has no shared-lobes"


def test_slow_fits_are_seen():
    slow = evidence(3)
    slow.fits.loc[4, "seconds"] = 60.0
    assert judged(slow)["a fit takes less than 20 seconds"][1] == page.DIFFERS


@pytest.mark.parametrize("dataset", page.ANISOTROPIC)
def test_the_page_of_an_anisotropic_run_has_the_claims_about_those(tmp_path, dataset):
    page.write(tmp_path / "page.md", "mine", dataset, evidence(12), ["figures/fidelity.png"], None)
    written = (tmp_path / "page.md").read_text()
    assert f"Of {len(CLAIMS)} claims" in written
    assert all(claim in written for claim in CLAIMS)
    assert "![fidelity](figures/fidelity.png)" in written
    assert "UTIA" in written
    assert claims.TOPICS[0].title not in written
    assert not np.char.find(written, "the paper has 100 and 4") >= 0
