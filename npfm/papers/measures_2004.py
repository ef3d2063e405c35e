"""How the claims of Lawrence et al. 2004 are put to the variances of a run."""

import numpy as np
import pandas as pd

from npfm.evaluation.importance import FACTORED, PAPER, SOBOL
from npfm.papers import lawrence2004
from npfm.papers.evidence import Evidence, Untestable
from npfm.papers.measures import Finding

#: How far apart factors of improvement are that agree, and exponents that are "approximately" one.
WITHIN, SLOPE_TOLERANCE = 2.0, 0.15


def better_than(evidence: Evidence, strategy: str, least: float) -> Finding:
    """Least factor, over the materials in constant light, by which a strategy has more variance."""
    gain = _improvement(evidence, "constant", strategy)
    few = gain[gain < least]
    ours = f"{gain.min():.2g} to {gain.max():.2g}, median {gain.median():.2g}, {_count(gain)}"
    return Finding(ours, few.empty, _named(few))


def as_printed(evidence: Evidence, light: str, material: str) -> Finding:
    """Whether the factors of improvement over all strategies are within 2 of those printed."""
    found = {}
    for strategy in lawrence2004.STRATEGIES:
        gain = _improvement(evidence, light, strategy)
        if material not in gain.index:
            raise Untestable(f"the study has no {material}")
        found[strategy] = gain[material]
    printed = pd.Series(
        {name: lawrence2004.improvement(light, material, name) for name in found}, dtype=float
    )
    ratio = pd.Series(found) / printed
    apart = ratio[np.abs(np.log(ratio)) > np.log(WITHIN)]
    ours = ", ".join(f"{gain:.3g}" for gain in found.values())
    return Finding(ours, apart.empty, f"times the printed: {_named(apart)}")


def inverse_of_samples(evidence: Evidence) -> Finding:
    """Whether the variance of every strategy falls as the inverse of the samples, in the median."""
    rows = _rows(evidence, "constant")
    rows = rows[~rows["strategy"].str.contains("+", regex=False)]
    slopes = [
        (" ".join(str(part) for part in key[:2] if part), _slope(line))
        for key, line in rows.groupby(["strategy", "recipe", "material"])
    ]
    by_way = pd.DataFrame(slopes, columns=["way", "slope"]).groupby("way")["slope"].median()
    off = by_way[np.abs(by_way + 1) > SLOPE_TOLERANCE]
    ours = f"exponents from {by_way.max():.2f} to {by_way.min():.2f}"
    return Finding(ours, off.empty, _named(off))


def _slope(rows: pd.DataFrame) -> float:
    variance = rows["n_var"] / rows["samples"]
    return float(np.polyfit(np.log(rows["samples"]), np.log(variance), 1)[0])


def _improvement(evidence: Evidence, light: str, strategy: str) -> pd.Series:
    """Variance of a strategy, by its best recipe, over factored sampling's, by material."""
    rows = _rows(evidence, light)
    rows = rows[rows["samples"] == lawrence2004.SAMPLES]
    factored = (rows["strategy"] == FACTORED) & (rows["recipe"] == PAPER)
    base = rows[factored].set_index("material")["n_var"]
    theirs = rows[rows["strategy"] == strategy].groupby("material")["n_var"].min()
    gain = (theirs / base).dropna()
    if gain.empty:
        raise Untestable(f"the study does not compare {strategy} at {lawrence2004.SAMPLES} samples")
    return gain


def _rows(evidence: Evidence, light: str) -> pd.DataFrame:
    """Rows of a light by stratified points."""
    if evidence.variance is None:
        raise Untestable("the target importance was not made before")
    rows = evidence.variance
    rows = rows[(rows["light"] == light) & (rows["points"] == SOBOL)]
    if rows.empty:
        raise Untestable(f"the study does not have the light '{light}'")
    return rows


def _count(gain: pd.Series) -> str:
    return f"{len(gain)} materials" if len(gain) > 1 else "1 material"


def _named(values: pd.Series) -> str:
    return ", ".join(f"{name} {value:.2g}" for name, value in values.items())
