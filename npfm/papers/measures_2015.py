"""How the claims of Dupuy et al. 2015 are put to the tables of a run."""

from collections.abc import Sequence

import pandas as pd

from npfm.evaluation.head_to_head import TIE_DB
from npfm.papers.evidence import NAMES_2015, Evidence, Untestable
from npfm.papers.measures import Finding

OURS = "power iterations"


def on_par(evidence: Evidence, materials: Sequence[str], model: str) -> Finding:
    """Mean PSNR over some materials, within 2 dB of another model's or above it."""
    table = evidence.materials([OURS, model])
    table = table.loc[table.index.intersection(list(materials))]
    if table.empty:
        raise Untestable("the run has none of the materials")
    difference = (table[OURS] - table[model]).mean()
    ours = f"{difference:+.2f} dB, {len(table)} materials"
    return Finding(ours, difference >= -TIE_DB, f"{difference:+.2f} dB")


def better(evidence: Evidence, first: str, second: str) -> Finding:
    """Mean PSNR of one model above that of another, and for how many materials."""
    table = evidence.materials([first, second])
    difference = table[first] - table[second]
    ours = f"{difference.mean():+.2f} dB, better for {(difference > 0).sum()} of {len(table)}"
    return Finding(f"{ours} materials", difference.mean() > 0, f"{difference.mean():+.2f} dB")


def worse_for(evidence: Evidence, material: str, others: Sequence[str]) -> Finding:
    """Whether all of some models have a greater mean PSNR for a material."""
    gain = _gains(evidence, material, others)
    told = ", ".join(f"{name} {value:+.1f} dB" for name, value in gain.items())
    return Finding(told, bool((gain > 0).all()), told)


def fails_for(evidence: Evidence, material: str, model: str) -> Finding:
    """Whether a model is more than 2 dB below ours for a material."""
    gain = _gains(evidence, material, [model])
    told = f"{model} {gain.iloc[0]:+.1f} dB"
    return Finding(told, gain.iloc[0] < -TIE_DB, told)


def fast(evidence: Evidence, most: float) -> Finding:
    """Seconds of the slowest fit, all channels together."""
    seconds = _fits(evidence).groupby("material")["seconds"].sum()
    ours = f"median {seconds.median():.2f} s, at most {seconds.max():.2f} s, {len(seconds)} fits"
    return Finding(ours, seconds.max() <= most, f"{seconds.max():.2f} s for {seconds.idxmax()}")


def never_fails(evidence: Evidence) -> Finding:
    """Whether every fit ends as it should, or says that its samples leave it open."""
    status = _fits(evidence).groupby("material")["status"].agg(list)
    ended = status.map(lambda found: all(s.startswith(("converged", "degenerate")) for s in found))
    ours = f"{ended.sum()} of {len(ended)} materials"
    return Finding(ours, bool(ended.all()), f"not {', '.join(ended.index[~ended])}")


def _gains(evidence: Evidence, material: str, others: Sequence[str]) -> pd.Series:
    """What other models gain over ours for a material, in dB."""
    table = evidence.materials([OURS, *others])
    if material not in table.index:
        raise Untestable(f"the run has no {material}")
    [row] = table.loc[[material]].to_dict("records")
    return pd.Series({name: row[name] - row[OURS] for name in others})


def _fits(evidence: Evidence) -> pd.DataFrame:
    [name] = NAMES_2015[OURS]
    fits = evidence.fits
    if fits is None or name not in set(fits["variant"]):
        raise Untestable(f"the run has no fits of {name}")
    return fits[fits["variant"] == name]
