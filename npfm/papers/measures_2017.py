"""How the claims of Peng et al. 2017 are put to the tables of a run."""

import pandas as pd

from npfm.evaluation.head_to_head import TIE_DB
from npfm.papers import peng2017
from npfm.papers.evidence import Evidence, Untestable
from npfm.papers.measures import Finding

OURS, OTHER, FREE = "shared lobes", "independent-g", "bivariate"


def better_materials(evidence: Evidence) -> Finding:
    """For how many materials the mean PSNR over the paper's two scenes is above independent-g's."""
    table = _in_two_scenes(evidence, [OURS, OTHER])
    gain = table[OURS] - table[OTHER]
    share, paper = (gain > 0).mean(), peng2017.BETTER_THAN_INDEPENDENT_G / peng2017.MATERIALS
    ours = f"{(gain > 0).sum()} of {len(gain)}, median {gain.median():+.2f} dB"
    losers = ", ".join(f"{name} {db:+.1f} dB" for name, db in gain[gain <= 0].items())
    return Finding(ours, share >= paper, f"not for {losers}")


def never_worse(evidence: Evidence) -> Finding:
    """Whether no material is more than 2 dB below independent-g."""
    table = _in_two_scenes(evidence, [OURS, OTHER])
    gain = table[OURS] - table[OTHER]
    ours = f"at worst {gain.min():+.2f} dB, {gain.idxmin()}"
    return Finding(ours, gain.min() >= -TIE_DB, ours)


def nearer_to_bivariate(evidence: Evidence) -> Finding:
    """Whether the mean PSNR is nearer to the bivariate model's than to independent-g's."""
    mean = _in_two_scenes(evidence, [OURS, OTHER, FREE]).mean()
    ours = ", ".join(f"{model} {mean[model]:.2f} dB" for model in (OTHER, OURS, FREE))
    nearer = abs(mean[OURS] - mean[FREE]) < abs(mean[OURS] - mean[OTHER])
    return Finding(ours, bool(nearer), ours)


def sometimes_above_bivariate(evidence: Evidence) -> Finding:
    """For how many materials the mean PSNR is even above the bivariate model's."""
    table = _in_two_scenes(evidence, [OURS, FREE])
    count = (table[OURS] > table[FREE]).sum()
    return Finding(f"{count} of {len(table)} materials", bool(count > 0), "for none")


def gain(evidence: Evidence, material: str, large: bool) -> Finding:
    """What a material gains over independent-g: more than 2 dB, or no more."""
    table = _in_two_scenes(evidence, [OURS, OTHER])
    if material not in table.index:
        raise Untestable(f"the run has no {material}")
    [row] = table.loc[[material]].to_dict("records")
    decibels = float(row[OURS] - row[OTHER])
    ours = f"{decibels:+.2f} dB"
    return Finding(ours, (decibels > TIE_DB) == large, ours)


def size(evidence: Evidence) -> Finding:
    """How many values a fit has, of four bytes each, beside those of independent-g."""
    names = [evidence.variant(model) for model in (OURS, OTHER)]
    count, other = (int(evidence.bytes[name]) // 4 for name in names)
    ours = f"{count}, {count - other:+d}"
    as_printed = (peng2017.PARAMETERS, peng2017.MORE_THAN_INDEPENDENT_G)
    return Finding(ours, (count, count - other) == as_printed, ours)


def _in_two_scenes(evidence: Evidence, models: list[str]) -> pd.DataFrame:
    """Mean PSNR in dB by material and model, over those of the two scenes that the run has."""
    table = evidence.renderings(models)
    table = table[table.index.get_level_values("scene").isin(peng2017.SCENES)]
    if table.empty:
        raise Untestable(f"the run has neither of the scenes {' and '.join(peng2017.SCENES)}")
    return table.groupby("material").mean()
