"""Our fits of other authors' models against those that they published."""

import numpy as np
import pytest

from npfm.datasets import neural
from npfm.fitting import registry
from npfm.fitting.objective import Objective, channel_samples, solid_angles
from npfm.fitting.parametric import author_metrics
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

#: Each of our fits: what it minimises, and the published fit of the same form.
COMPARED = {
    "abc-e2": (author_metrics.logarithmic, "abc-published"),
    "abc-ours": (author_metrics.compressive, "abc-published"),
    "shifted-gamma": (author_metrics.compressive, "shifted-gamma-published"),
    "cook-torrance": (author_metrics.cosine, "cook-torrance-published"),
    "ward": (author_metrics.cosine, "ward-published"),
    "blinn-phong": (author_metrics.cosine, "blinn-phong-published"),
}
#: The fitted model of Lafortune's lobe has several, and other criteria; independent-g minimises the
#: objective, by which tests/models/test_published.py compares.
ALONE = {"lafortune-published", "independent-g-published"}


def thinned(table):
    """Every third bin of theta_h and theta_d, every fifteenth of phi_d: centres stay centres."""
    return Table(table.values[:, 1::3, 1::3, 7::15], HalfDifference(30, 30, 12))


def error(metric, measured, table):
    """The sum that a metric stands for, sample by sample."""
    goal = metric([channel_samples(measured, channel, Objective()) for channel in range(3)])
    model = np.maximum(table.values, 0) / goal.scale[:, None, None, None]
    value = goal.value
    if goal.logarithmic:
        cosine = np.maximum(goal.grid.cosines[0], 0)
        model, value = np.log1p(cosine * model), np.log1p(cosine * value)
    return np.sum(goal.weight * (model - value) ** 2)


@pytest.fixture(scope="module")
def measured(data):
    names = ["alum-bronze", "nylon", "polyethylene"]
    return {name: thinned(neural.load(data / "merl_nbrdf.zip", name)) for name in names}


@pytest.mark.parametrize("name", COMPARED)
@pytest.mark.parametrize("material", ["alum-bronze", "nylon", "polyethylene"])
def test_our_fit_is_no_worse_than_the_published_one(data, measured, name, material):
    metric, published = COMPARED[name]
    table = measured[material]
    ours = registry.model(name).fit(table, Objective(), None, 1)
    theirs = registry.model(published)
    file = registry.declared(published).published
    parameters = file.read(data / "published_fits" / file.name)[material]
    fit = theirs.fit(table, Objective(), None, 1, published=parameters)
    found = error(metric, table, registry.model(name).tabulate(ours))
    assert found < error(metric, table, theirs.tabulate(fit))
    if metric is author_metrics.compressive:
        shares = [record.objective for record in ours.records]
        assert found == pytest.approx(sum(shares), rel=1e-6)


def test_every_model_that_is_compared_with_is_here():
    there = {name for name, model in registry.models().items() if model.published}
    assert {published for _, published in COMPARED.values()} == there - ALONE


def test_the_weight_of_solid_angle_is_that_of_both_directions():
    """Cosines have the means that they have over two independent directions of a hemisphere."""
    grid = HalfDifference()
    weight = np.where(grid.above_horizon, solid_angles(grid), 0.0)
    cos_i, cos_o = grid.cosines
    for values, mean in ((cos_i, 1 / 2), (cos_o**2, 1 / 3), (cos_i * cos_o, 1 / 4)):
        assert np.average(values, weights=weight) == pytest.approx(mean, rel=5e-3)
