"""The factors that the authors published come back from tables made of them."""

import numpy as np
import pytest

from npfm.fitting.factors.microfacet import G_THETA
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, channel_samples, evaluate
from npfm.fitting.solvers.choice import chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models import independent_g
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import Table

#: A metal with a mirror-like peak, and a nearly diffuse plastic.
MATERIALS = ("alum-bronze", "nylon")
#: A node counts if its samples get this share of their value from the specular term.
VISIBLE = 0.01


def published(data, name) -> Fit:
    """A material's published factors; G[0] was never observed, and takes the next value."""
    with np.load(data / "npf_reference.npz") as archive:
        k = archive["names"].tolist().index(name)
        parameters = {key: archive[key][k].T.copy() for key in ("D", "F", "G")}
        parameters |= {key: archive[key][k] / np.float32(np.pi) for key in ("rho_d", "rho_s")}
    parameters["G"][:, 0] = parameters["G"][:, 1]
    return Fit("independent-g", parameters, MERL)


def specular_shares(table: Table, fit: Fit, channel: int) -> dict:
    """Weighted mean share of the specular term in the samples of each node, by factor."""
    weight = channel_samples(table, channel, Objective()).weight
    value = np.where(weight > 0, table.values[channel], 0)
    specular = np.maximum(value - fit.parameters["rho_d"][channel], 0)
    share = specular / np.where(value > 0, value, 1)
    shares = {
        "D": (weight * share).sum((1, 2)) / np.maximum(weight.sum((1, 2)), 1e-300),
        "F": (weight * share).sum((0, 2)) / np.maximum(weight.sum((0, 2)), 1e-300),
    }
    top, bottom = np.zeros(G_THETA.size), np.zeros(G_THETA.size)
    for cosine in MERL.cosines:
        place = np.rad2deg(np.arccos(cosine[weight > 0])) - 0.5  # in nodes of one degree
        place = np.clip(place, 0, G_THETA.size - 1)
        low = np.minimum(place.astype(int), G_THETA.size - 2)
        for node, part in ((low, 1 - (place - low)), (low + 1, place - low)):
            part = part * weight[weight > 0]
            top += np.bincount(node, part * share[weight > 0], G_THETA.size)
            bottom += np.bincount(node, part, G_THETA.size)
    return shares | {"G": top / np.maximum(bottom, 1e-300)}


def recovery(data, name) -> list[dict]:
    """For each channel the relative objective, and for each factor nodes counted and worst error.

    Errors are relative, with each factor scaled to maximum 1 over the nodes that count.
    """
    truth = published(data, name)
    table = independent_g.tabulate(truth)
    fit = independent_g.fit(table, Objective(), chosen(SolverSettings()), seed=1)
    found, rows = independent_g.tabulate(fit), []
    for channel in range(3):
        samples = channel_samples(table, channel, Objective())
        row = {"objective": evaluate(samples, found.values[channel] / samples.scale)}
        row["objective"] /= samples.energy
        for key, share in specular_shares(table, truth, channel).items():
            counts = share >= VISIBLE
            expected = truth.parameters[key][channel][counts].astype(float)
            recovered = fit.parameters[key][channel][counts].astype(float)
            ratio = recovered / recovered.max() / (expected / expected.max())
            row[key] = int(counts.sum()), float(np.abs(ratio - 1).max())
        rows.append(row)
    return rows


@pytest.mark.parametrize("name", MATERIALS)
def test_published_factors_come_back(data, name):
    for row in recovery(data, name):
        assert row["objective"] < 1e-5
        for key, enough in (("D", 60), ("F", 85), ("G", 90)):
            nodes, error = row[key]
            assert nodes >= enough
            assert error < 0.01, key
