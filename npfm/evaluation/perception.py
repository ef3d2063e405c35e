"""How well metrics of fits agree with what people see: rank correlations with opinions."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import rankdata

from npfm.errors import NpfmError
from npfm.evaluation import quality, tables

PAIRS = ("material", "class", "variant", "method", "made", "metric", "value", "opinion")
CORRELATIONS = (
    "models", "class", "metric", "pairs", "materials",
    "spearman", "low", "high", "gain", "gain_low", "gain_high", "within",
)  # fmt: skip
#: What stands for every class.
ALL = "all"
#: The metric that the gains of others are over: the paper's.
BASE = "psnr"
RESAMPLES, LEVEL = 1000, 0.95


class NothingShown(NpfmError):
    """No fit is of a model and a material that people were shown."""


def pairs(
    quality_table: pd.DataFrame,
    opinions: pd.DataFrame,
    classes: Mapping[str, str],
    shown: Mapping[str, tuple[str, str]],
) -> pd.DataFrame:
    """Put every value of a metric beside the opinion on the same approximation and material.

    Parameters
    ----------
    quality_table : DataFrame
        As `npfm.evaluation.quality.read` gives it.
    opinions : DataFrame
        Columns method, material, distance.
    classes : mapping of str to str
        Of the materials.
    shown : mapping of str to (str, str)
        By variant, the method and what the variant is of it.

    Returns
    -------
    DataFrame
        Columns `PAIRS`. The value is the mean over the scenes. A metric without any value is left
        out, as SSIM of tiny pictures, and then pairs that some metric has no value of, so that
        all are compared on the same.

    Raises
    ------
    NothingShown
        If nothing in the table was shown to people.
    """
    rows = quality_table[quality_table["variant"].isin(list(shown))]
    found = _means(rows)
    found["method"] = [shown[name][0] for name in found["variant"]]
    found["made"] = [shown[name][1] for name in found["variant"]]
    found["class"] = [classes.get(name, "unknown") for name in found["material"]]
    said = opinions.rename(columns={"distance": "opinion"})
    found = found.merge(said, on=["method", "material"], how="inner")
    if found.empty:
        raise NothingShown(
            "no fit in the table is of a model and a material that people were shown; "
            f"give some of {', '.join(shown)}"
        )
    return found[list(PAIRS)].reset_index(drop=True)


def _means(rows: pd.DataFrame) -> pd.DataFrame:
    """Material, variant, metric and value: means over scenes, of pairs that have all metrics."""
    keys = ["material", "variant", "metric"]
    # A mean over scenes of which one is missing would be of others than its neighbours are.
    gaps = rows[rows["value"].isna()][keys].drop_duplicates()
    means = rows.groupby(keys, sort=False)["value"].mean().reset_index()
    means = means.merge(gaps, on=keys, how="left", indicator="gap")
    means["value"] = means["value"].where(means.pop("gap") == "left_only")
    known = means.dropna()
    means = means[means["metric"].isin(known["metric"].unique())]
    counts = known.groupby(keys[:2])["metric"].transform("count")
    return known[counts == means["metric"].nunique()].reset_index(drop=True)


def correlations(
    pairs: pd.DataFrame, groups: Mapping[str, Sequence[str]], seed: int = 1
) -> pd.DataFrame:
    """Rank correlation of every metric with opinions.

    Parameters
    ----------
    pairs : DataFrame
        As `pairs` makes it.
    groups : mapping of str to sequence of str
        Which kinds (column ``made``) belong to each group of models. Where there are several of
        what people were shown, that of the kind that stands first counts.
    seed : int
        Of the resampling.

    Returns
    -------
    DataFrame
        Columns `CORRELATIONS`, one row a group of models, class of materials and metric. Spearman's
        correlation is positive where a worse value goes with a larger difference to the eye; `low`
        and `high` are the ends of its 95 % interval, from materials drawn again with
        replacement, each with all its pairs. `gain` is the correlation minus that of PSNR, its
        interval from the same draws. `within` is the mean over the materials with three pairs or
        more of the correlation among the pairs of a material: whether the metric orders the
        models, rather than the materials.
    """
    rows = []
    for models, kinds in groups.items():
        chosen = _chosen(pairs, kinds)
        for name in [ALL, *sorted(chosen["class"].unique())]:
            of_class = chosen if name == ALL else chosen[chosen["class"] == name]
            if of_class["material"].nunique() > 1:
                rows += [(models, name, *row) for row in _rows(of_class, seed)]
    return pd.DataFrame(rows, columns=list(CORRELATIONS))


def _chosen(pairs: pd.DataFrame, kinds: Sequence[str]) -> pd.DataFrame:
    """Pairs of some kinds: of each approximation and material, of the first kind that there is."""
    ranks = {kind: rank for rank, kind in enumerate(kinds)}
    chosen = pairs.assign(rank=pairs["made"].map(ranks)).dropna(subset="rank")
    first = chosen.groupby(["method", "material"])["rank"].transform("min")
    return chosen[chosen["rank"] == first].drop(columns="rank")


def _rows(pairs: pd.DataFrame, seed: int) -> Iterator[tuple]:
    """Metric and what follows it in `CORRELATIONS`."""
    wide = pairs.pivot(index=["material", "variant"], columns="metric", values="value")
    metrics = [name for name in quality.METRICS if name in wide]
    signs = [-1.0 if quality.METRICS[name].better == "higher" else 1.0 for name in metrics]
    badness = wide[metrics].to_numpy() * signs
    opinion = pairs.groupby(["material", "variant"])["opinion"].first().loc[wide.index].to_numpy()
    materials = wide.index.get_level_values("material")
    clusters = [np.flatnonzero(materials == name) for name in materials.unique()]
    found = spearman(badness, opinion)
    drawn = _resampled(badness, opinion, clusters, seed)
    base = metrics.index(BASE) if BASE in metrics else 0
    ends = [(1 - LEVEL) / 2, (1 + LEVEL) / 2]
    low, high = np.nanquantile(drawn, ends, axis=0)
    gain_low, gain_high = np.nanquantile(drawn - drawn[:, [base]], ends, axis=0)
    several = [spearman(badness[rows], opinion[rows]) for rows in clusters if len(rows) > 2]
    within = np.nanmean(several, axis=0) if several else np.full(len(metrics), np.nan)
    for k, name in enumerate(metrics):
        gain = found[k] - found[base], gain_low[k], gain_high[k]
        yield name, len(opinion), len(clusters), found[k], low[k], high[k], *gain, within[k]


def _resampled(
    badness: NDArray, opinion: NDArray, clusters: Sequence[NDArray], seed: int
) -> NDArray[np.float64]:
    """Correlations of materials drawn with replacement, shape (RESAMPLES, metrics)."""
    rng = np.random.default_rng(seed)
    drawn = np.empty((RESAMPLES, badness.shape[1]))
    for row in drawn:
        chosen = rng.integers(len(clusters), size=len(clusters))
        rows = np.concatenate([clusters[k] for k in chosen])
        row[:] = spearman(badness[rows], opinion[rows])
    return drawn


def spearman(values: NDArray, opinion: NDArray) -> NDArray[np.float64]:
    """Spearman's rank correlation of each column with the opinions; ties share their mean rank.

    Parameters
    ----------
    values : ndarray, shape (n, metrics)
    opinion : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (metrics,)
        NaN where all values or all opinions are equal.
    """
    ranks = rankdata(np.column_stack([values, opinion]), axis=0)
    ranks -= ranks.mean(axis=0)
    norms = np.sqrt((ranks**2).sum(axis=0))
    with np.errstate(invalid="ignore", divide="ignore"):
        return (ranks[:, :-1].T @ ranks[:, -1]) / (norms[:-1] * norms[-1])


def read(path: str) -> pd.DataFrame:
    """Read the table that `correlations` makes; errors are those of `tables.read`."""
    text = list(CORRELATIONS[:3])
    return tables.read(path, text, [name for name in CORRELATIONS if name not in text])
