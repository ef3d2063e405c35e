"""Whether factors are unique: how far apart the ends of starts lie that are about equally good.

Bagher et al. 2016 close with this: for a few materials "multiple quite different forms of the
locally-minimizing factors can be found yielding about the same rendering fidelity", which "may be
due to" B(theta_h, theta_d) being no product, "along with the presence of nearly equal top singular
values for the weighted SVD of B".
"""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.fitting.basis.lobes import Cells, Lobes, cells, checked_lobes, seen_by, speculars
from npfm.fitting.fits import Fit
from npfm.fitting.iterations import FACTORS, Iterations
from npfm.fitting.objective import Objective
from npfm.fitting.shared_lobes.starts import width
from npfm.reflectance.table import CHANNELS

Array = NDArray[np.float64]

#: Ends of starts whose objectives are above the least one by no more than this share of it count as
#: equally good: what the page of the paper's claims calls the same result.
NEAR = 0.05
#: A root mean square of logarithms: factors that are 10 % apart.
APART = float(np.log(1.1))
CHANNEL = (
    "material", "channel", "starts", "near", "worst", "D", "G", "F", "F_G2", "product",
    "sigma_ratio", "sigma_ratio_specular", "roughness",
)  # fmt: skip
SUMMARY = "quantity", "value"


def ends(found: Iterations, channel: int) -> NDArray[np.intp]:
    """Where the run from each start ended, in a record of a channel: the least objective first."""
    own = np.flatnonzero((found.channel == channel) & (found.run == 0))
    last = {int(found.start[k]): k for k in own}
    states = np.array(list(last.values()))
    return states[np.argsort(found.objective[states], kind="stable")]


def near(found: Iterations, channel: int) -> NDArray[np.intp]:
    """Those of `ends` that are about as good as the first."""
    states = ends(found, channel)
    reached = found.objective[states]
    return states[reached <= (1 + NEAR) * reached[0]]


def centred_rms(change: Array, weight: Array) -> float:
    """Weighted root mean square of a change of logarithms, its mean taken out: the scale is free.

    Both arrays have one shape.
    """
    total = weight.sum()
    if total <= 0:
        return 0.0
    rest = change - np.vdot(weight, change) / total
    return float(np.sqrt(np.vdot(weight, rest**2) / total))


def distance(
    lobes: Lobes, at: Cells, first: Mapping[str, Array], other: Mapping[str, Array]
) -> dict[str, float]:
    """Compare factors of two ends.

    Parameters
    ----------
    lobes : Lobes
        The fit of the channel: it says what the samples see.
    at : Cells
    first, other : mapping of str to ndarray
        Logarithms of D, G and F.

    Returns
    -------
    dict of str to float
        Root mean squares of the change of logarithms, each counted by what the samples see and the
        least over scales: of D, G and F; of F G^2 (`F_G2`), all that can be told of the two where D
        is narrow, theta_i and theta_o being next to theta_d; and of D F K (`product`), all that the
        model is but for rho_d and the scale.
    """
    seen = seen_by(lobes, at)
    change = {name: other[name] - first[name] for name in FACTORS}
    own = {name: centred_rms(change[name], getattr(seen, name)[0]) for name in FACTORS}
    theta_d = np.linspace(0, 1, change["F"].size, endpoint=False) + 0.5 / change["F"].size
    nodes = (np.arange(change["G"].size) + 0.5) / change["G"].size
    both = change["F"] + 2 * np.interp(theta_d, nodes, change["G"])
    parts = speculars(lobes, at)[0, 0]
    weight = at.weights(lobes.rho_d[0] + parts) * parts**2
    K = [np.log(np.maximum(at.at.kernel(np.exp(log["G"])), 1e-300)) for log in (other, first)]
    plane = np.add.outer(change["D"], change["F"]).reshape(-1, 1)
    whole = np.where(weight > 0, plane + K[0] - K[1], 0.0)
    return {
        **own,
        "F_G2": centred_rms(both, seen.F[0]),
        "product": centred_rms(whole, weight),
    }


def sigma_ratio(B: Array, at: Cells, weighted_by: Array) -> float:
    """Second singular value of B(theta_h, theta_d) as a share of the first, weighted.

    Rows and columns are scaled by the roots of what the samples weigh in them, which makes the
    weights of the cells about equal; a singular value decomposition knows no others.

    Parameters
    ----------
    B : ndarray, shape (theta_h, theta_d)
    at : Cells
    weighted_by : ndarray, the same shape
        Values of the BRDF that the compressive weight hangs on.
    """
    value = np.broadcast_to(weighted_by.reshape(-1, 1), at.weight.shape)
    weight = at.weights(value).sum(1).reshape(B.shape)
    scaled = np.sqrt(weight.sum(1))[:, None] * B * np.sqrt(weight.sum(0))
    values = np.linalg.svd(scaled, compute_uv=False)
    return float(values[1] / values[0]) if len(values) > 1 and values[0] > 0 else 0.0


def measure(fit: Fit, found: Iterations, bivariate: Fit, objective: Objective) -> pd.DataFrame:
    """Compare the ends of a material's starts.

    Parameters
    ----------
    fit : Fit
        Of independent-g.
    found : Iterations
        What led to it.
    bivariate : Fit
        Of the model bivariate, to the same table.
    objective : Objective
        Of the fits.

    Returns
    -------
    DataFrame
        Columns `CHANNEL` but material, a row a channel: how many starts there are, and how many
        ends are about as good as the best; by which share the worst of these is above it; the
        largest distances from the best to one of these; the ratio of the top singular values
        of B, and of B less the fit's rho_d; and the alpha of GGX that is as wide as the fit's D.

    Raises
    ------
    NpfmError
        If the fits are on different grids, or the record is of another grid, or a fit has arrays
        that are not those of its model.
    """
    sizes, plane = fit.grid.shape[:2], bivariate.parameters["B"]
    if bivariate.grid != fit.grid or (found.D.shape[1], found.F.shape[1]) != sizes:
        raise NpfmError("the fits and the record of iterations are not of one table")
    if plane.shape != (len(CHANNELS), *sizes):
        raise NpfmError(f"the fit of bivariate has a B of shape {plane.shape}; fit it again")
    at, rows = cells(fit.grid, objective), []
    groups = checked_lobes(fit)
    for channel, (name, lobes) in enumerate(zip(CHANNELS, groups, strict=True)):
        states = near(found, channel)
        logs = [
            {factor: np.log(np.maximum(getattr(found, factor)[k], 1e-12)) for factor in FACTORS}
            for k in states
        ]
        apart = [distance(lobes, at, logs[0], other) for other in logs[1:]]
        most = {key: max((each[key] for each in apart), default=0.0) for key in CHANNEL[5:10]}
        reached = found.objective[states]
        B = plane[channel].astype(float)
        rows.append(
            {
                "channel": name,
                "starts": len(ends(found, channel)),
                "near": len(states),
                "worst": float(reached[-1] / reached[0] - 1) if reached[0] > 0 else 0.0,
                **most,
                "sigma_ratio": sigma_ratio(B, at, B),
                "sigma_ratio_specular": sigma_ratio(B - lobes.rho_d[0], at, B),
                "roughness": width(lobes.D[0], fit.grid.theta_h),
            }
        )
    return pd.DataFrame(rows, columns=CHANNEL[1:])


def read(paths: Sequence[str]) -> pd.DataFrame:
    """Read what `measure` found of several materials.

    Raises
    ------
    NpfmError
        As of `tables.read`, or if a channel is none, or a distance or ratio is missing.
    """
    found = []
    for path in paths:
        found.append(tables.read(path, CHANNEL[:2], CHANNEL[2:]))
        tables.check(path, found[-1], "channel", CHANNELS)
        tables.check_finite(path, found[-1], CHANNEL[5:11])
    return pd.concat(found, ignore_index=True)


def ambiguous(channels: pd.DataFrame) -> pd.Series:
    """Channels one of whose factors is further from that of an equally good fit than `APART`."""
    return channels[["D", "G", "F"]].max(axis=1) > APART


def summary(channels: pd.DataFrame) -> pd.DataFrame:
    """Count ambiguous channels, and ask whether their singular values are close.

    Parameters
    ----------
    channels : DataFrame
        As `measure` makes it, of all materials.

    Returns
    -------
    DataFrame
        Columns `SUMMARY`. Rank correlations are Spearman's, of the largest distance of D, G and F
        with the ratios of singular values and with the roughness, over channels with two equally
        good ends or more.
    """
    from scipy.stats import spearmanr

    apart = ambiguous(channels)
    several = channels[channels["near"] > 1]
    rows = {
        "channels": len(channels),
        "channels with equally good ends": len(several),
        "channels with ambiguous factors": apart.sum(),
        "channels with an ambiguous product D F K": (channels["product"] > APART).sum(),
        "materials with ambiguous factors": channels.loc[apart, "material"].nunique(),
    }
    for name in CHANNEL[5:10]:
        rows[f"median distance of {name}"] = several[name].median()
        rows[f"largest distance of {name}"] = several[name].max()
    largest = several[["D", "G", "F"]].max(axis=1)
    for name in CHANNEL[10:]:
        varied = len(several) > 2 and largest.nunique() > 1 and several[name].nunique() > 1
        found = spearmanr(largest, several[name]) if varied else (np.nan, np.nan)
        rows[f"rank correlation with {name}"], rows[f"p of that, {name}"] = found
        rows[f"median {name}, ambiguous"] = channels.loc[apart, name].median()
        rows[f"median {name}, others"] = channels.loc[~apart, name].median()
    return pd.DataFrame(rows.items(), columns=SUMMARY)
