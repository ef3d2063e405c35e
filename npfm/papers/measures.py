"""How a claim is put to the tables: each function returns what the run says about one."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import spearmanr

from npfm.evaluation.head_to_head import TIE_DB, HeadToHead, head_to_head
from npfm.evaluation.metrics import mean_db
from npfm.papers import bagher2016
from npfm.papers.captions import CAPTIONS, chosen
from npfm.papers.evidence import NAMES, Evidence, Untestable

SHARE_TOLERANCE = 5.0  # percent points
SIGNIFICANCE = 0.05  # of a rank correlation
SPREAD = 0.05  # of the objective: starts that end nearer than that agree
WORST = 4  # materials that Figure 10 shows
NON_PARAMETRIC = ["independent-g", "g-from-d", "naive"]


@dataclass(frozen=True)
class Finding:
    """What a run says about a claim: its figures, whether they bear it out, and by how much not."""

    ours: str
    holds: bool
    difference: str = ""


def average(evidence: Evidence, model: str) -> Finding:
    """Mean PSNR over all renderings that a model has; within 2 dB of the paper's it holds."""
    values = evidence.renderings([model])[model]
    difference = values.mean() - bagher2016.MEAN_PSNR_DB[NAMES[model][0]]
    ours = f"{values.mean():.2f} dB, {len(values)} renderings"
    return Finding(ours, abs(difference) <= TIE_DB, f"{difference:+.2f} dB")


def gap(evidence: Evidence, model: str, other: str) -> Finding:
    """How far a model's mean PSNR is above another's, over the renderings that both have."""
    table = evidence.renderings([model, other])
    ours = float((table[model] - table[other]).mean())
    paper = bagher2016.MEAN_PSNR_DB[NAMES[model][0]] - bagher2016.MEAN_PSNR_DB[NAMES[other][0]]
    difference = ours - paper
    told = f"{ours:+.2f} dB, {len(table)} renderings"
    return Finding(told, abs(difference) <= TIE_DB, f"{difference:+.2f} dB")


def order(evidence: Evidence) -> Finding:
    """Order of the mean PSNRs over the renderings that all models have."""
    models = evidence.models()
    if len(models) < 2:
        raise Untestable("the run has fewer than two of the models")
    means = evidence.renderings(models).mean()
    ours = means.sort_values(ascending=False, kind="stable")
    turned = [
        f"{later} above {earlier} by {means[later] - means[earlier]:.2f} dB"
        for k, earlier in enumerate(models)
        for later in models[k + 1 :]
        if means[later] > means[earlier]
    ]
    return Finding(" > ".join(ours.index), not turned, "; ".join(turned))


def gain_correlation(evidence: Evidence) -> Finding:
    """Rank correlation of diffuseness and what independent-g gains over the better other one."""
    gain, diffuseness = _gain_by_diffuseness(evidence)
    if gain.nunique() < 4:
        raise Untestable("the run has too few materials for a correlation")
    rank, p = spearmanr(diffuseness, gain)
    holds = bool(rank > 0 and p < SIGNIFICANCE)
    ours = f"rank correlation {rank:.2f} (p = {p:.2g}), {len(gain)} materials"
    return Finding(ours, holds, "no significant increase" if not holds else "")


def similar_when_specular(evidence: Evidence) -> Finding:
    """Largest difference of the three models' means over the third least diffuse materials."""
    gain, _ = _gain_by_diffuseness(evidence)
    specular = gain.index[: max(1, len(gain) // 3)]
    means = evidence.materials(NON_PARAMETRIC).loc[specular].mean()
    spread = np.ptp(means)
    ours = f"means within {spread:.1f} dB, the {len(specular)} least diffuse materials"
    return Finding(ours, spread <= TIE_DB, f"{spread:.1f} dB apart")


def largest_gain(evidence: Evidence, paper: float) -> Finding:
    """Largest gain of independent-g over the better of the two others in a rendering."""
    table = evidence.renderings(NON_PARAMETRIC)
    gain = table["independent-g"] - table[NON_PARAMETRIC[1:]].max(axis=1)
    material, scene = gain.index[int(gain.argmax())]
    ours = f"{gain.max():.1f} dB ({material}, scene {scene})"
    return Finding(ours, abs(gain.max() - paper) <= TIE_DB, f"{gain.max() - paper:+.1f} dB")


def best_for_every_material(evidence: Evidence, others: Sequence[str]) -> Finding:
    """Materials whose mean PSNR of independent-g is above that of every other model there is."""
    there = [model for model in others if model in evidence.models()]
    if not there:
        raise Untestable(f"the run has none of {', '.join(others)}")
    table = evidence.materials(["independent-g", *there])
    lost = table[table["independent-g"] <= table[there].max(axis=1)]
    ours = f"{len(table) - len(lost)} of {len(table)} materials"
    return Finding(ours, lost.empty, _listed("not ", lost.index))


def wins(evidence: Evidence, model: str, paper: float) -> Finding:
    """Share of the renderings that independent-g wins by more than 2 dB."""
    score = _score(evidence, model)
    return _share(score.wins, score.compared, paper)


def ties(evidence: Evidence, model: str, paper: float) -> Finding:
    """Share of the renderings within 2 dB of each other."""
    score = _score(evidence, model)
    return _share(score.ties, score.compared, paper)


def better_materials(evidence: Evidence, model: str, paper: float) -> Finding:
    """Share of the materials whose mean PSNR of independent-g is above a model's."""
    table = evidence.materials(["independent-g", model])
    better = int((table["independent-g"] > table[model]).sum())
    return _share(better, len(table), paper)


def comparable(evidence: Evidence, first: str, second: str) -> Finding:
    """Whether the first of two models has the greater mean PSNR, by at most 2 dB."""
    means = evidence.renderings([first, second]).mean()
    difference = means[first] - means[second]
    return Finding(f"{difference:+.2f} dB", 0 <= difference <= TIE_DB, f"{difference:+.2f} dB")


def weighting_needed(evidence: Evidence, model: str) -> Finding:
    """Least gain by the compressive weight among the specular materials of Figure 7."""
    specular = chosen(CAPTIONS[7], _weighted_materials(evidence))[:-1]
    gain = _gain_by_weight(evidence, specular, 89, model)
    ours = ", ".join(f"{name} {value:+.1f} dB" for name, value in gain.items())
    return Finding(ours, bool((gain > TIE_DB).all()), f"{gain.min():+.1f} dB for {gain.idxmin()}")


def weighting_harmless(evidence: Evidence, model: str) -> Finding:
    """Gain by the compressive weight for the diffuse material of Figure 7."""
    diffuse = chosen(CAPTIONS[7], _weighted_materials(evidence))[-1:]
    gain = _gain_by_weight(evidence, diffuse, 89, model)
    ours = f"{gain.index[0]} {gain.iloc[0]:+.1f} dB"
    return Finding(ours, gain.iloc[0] >= -TIE_DB, f"{gain.iloc[0]:+.1f} dB")


def weighting_restricted(evidence: Evidence) -> Finding:
    """Mean gain by the compressive weight where fits use angles up to 80 degrees."""
    materials = _weighted_materials(evidence)
    gain = _gain_by_weight(evidence, materials, 80, "independent-g")
    ours = f"{gain.mean():+.1f} dB, {len(gain)} materials"
    return Finding(ours, gain.mean() > TIE_DB, f"{gain.mean():+.1f} dB")


def starts_agree(evidence: Evidence) -> Finding:
    """Share of the fitted channels whose starts end within 5 % in the objective."""
    if evidence.starts is None or evidence.starts.empty:
        raise Untestable("the run has no fits of independent-g from several starts")
    spread = evidence.starts["spread"]
    agree = int((spread <= SPREAD).sum())
    ours = f"{agree} of {len(spread)} channels within {100 * SPREAD:.0f} %; "
    ours += f"median {100 * spread.median():.2f} %, largest {100 * spread.max():.1f} %"
    return Finding(
        ours, agree > len(spread) / 2, f"{len(spread) - agree} channels are further apart"
    )


def among_the_worst(evidence: Evidence, material: str) -> Finding:
    """Whether a material is among those of Figure 10, most visibly wrong under independent-g."""
    if material not in evidence.worst:
        raise Untestable(f"the run has no {material} under independent-g")
    place = list(evidence.worst).index(material) + 1
    ours = f"number {place} of {len(evidence.worst)} materials"
    return Finding(ours, place <= WORST, f"not among the {WORST} of Figure 10")


def bivariate_gain(evidence: Evidence, material: str, *, saves: bool) -> Finding:
    """What the bivariate model gains over independent-g: more than 2 dB, or less than nothing."""
    table = evidence.materials(["bivariate", "independent-g"])
    if material not in table.index:
        raise Untestable(f"the run has no {material}")
    gain = table["bivariate"][material] - table["independent-g"][material]
    return Finding(f"{gain:+.1f} dB", gain > TIE_DB if saves else gain < 0, f"{gain:+.1f} dB")


def size(evidence: Evidence, variant: str, paper: int) -> Finding:
    """Bytes of a fit, as stored."""
    if variant not in evidence.bytes.index:
        raise Untestable(f"the run has no {variant}")
    ours = int(evidence.bytes[variant])
    return Finding(f"{ours} bytes", ours == paper, f"{ours - paper:+d} bytes")


def _weighted_materials(evidence: Evidence) -> list[str]:
    return list(_weighting(evidence).dropna(subset="psnr_db")["material"].unique())


def _weighting(evidence: Evidence) -> pd.DataFrame:
    if evidence.weighting is None:
        raise Untestable("the run has no table of fits without the compressive weight")
    return evidence.weighting


def _gain_by_weight(
    evidence: Evidence, materials: Sequence[str], max_angle: int, model: str
) -> pd.Series:
    """What the compressive weight gains, mean over the scenes in dB, by material that has both.

    Fits are named as `npfm.run.weighting` names them, or as the run does if it has them.
    """
    by_fit = _weighting(evidence).groupby(["material", "variant"])["psnr_db"]
    means = by_fit.agg(mean_db).unstack()
    weighted = [
        name for name in (f"{model}-to-{max_angle}-weighted", model) if name in means.columns
    ]
    without = f"{model}-to-{max_angle}-unweighted"
    if not materials:
        raise Untestable("the run has too few materials with and without the compressive weight")
    if not weighted or without not in means:
        raise Untestable(f"the run has no {model} with and without the compressive weight")
    gain = (means[weighted[0]] - means[without]).reindex(list(materials)).dropna()
    if gain.empty:
        raise Untestable(f"the run has no PSNR of {model} with and without the compressive weight")
    return gain


def _gain_by_diffuseness(evidence: Evidence) -> tuple[pd.Series, pd.Series]:
    """Mean gain over the better other model, and diffuseness, by increasing diffuseness."""
    if evidence.diffuseness is None:
        raise Untestable("the run has no table of diffuseness")
    table = evidence.materials(NON_PARAMETRIC)
    gain = table["independent-g"] - table[NON_PARAMETRIC[1:]].max(axis=1)
    diffuseness = evidence.diffuseness.reindex(gain.index).sort_values(kind="stable")
    return gain.reindex(diffuseness.index), diffuseness


def _score(evidence: Evidence, model: str) -> HeadToHead:
    variants = [evidence.variant(name) for name in ("independent-g", model)]
    score = head_to_head(evidence.psnr, *variants)
    if not score.compared:
        raise Untestable(f"the run has no picture of both {' and '.join(variants)}")
    return score


def _share(count: int, total: int, paper: float) -> Finding:
    share = 100 * count / total
    holds = abs(share - paper) <= SHARE_TOLERANCE
    return Finding(f"{share:.1f} % ({count} of {total})", holds, f"{share - paper:+.1f} points")


def _listed(prefix: str, names: Collection[str], most: int = 6) -> str:
    shown = ", ".join(list(names)[:most]) + (
        f" and {len(names) - most} more" if len(names) > most else ""
    )
    return f"{prefix}{shown}" if len(names) else ""
