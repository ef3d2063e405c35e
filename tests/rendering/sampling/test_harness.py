"""What every strategy has to do. A new file in npfm/rendering/sampling is tested here as it is.

A strategy that follows a material is made for `TABLE`, or for the arrays of a fit of it: give
these by the strategy's name in `PARAMETERS`.
"""

import numpy as np
import pytest
from scipy.stats import chi2
from shaded import about_mirror, above_horizon, point

from npfm.fitting.factorisation.recipes import Recipe, factor
from npfm.reflectance.angles import half_difference
from npfm.reflectance.directional import Directional, directions
from npfm.reflectance.factored import Angles
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.microsurfaces import anisotropic_ggx, turned_scale
from npfm.reflectance.table import INVALID, Table
from npfm.reflectance.tabulated_slopes import elevations
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given

GRID = HalfDifference(18, 18, 36)
VIEWS = [0.0, 30.0, 65.0, 85.0]
#: Arrays of a fit of `TABLE`, for the strategies that need one.
FACETS = {"D": np.exp(-((GRID.theta_h[None] / 0.2) ** 2)) + 0.01}
#: Two lobes that the channels share.
LOBES = {"D": np.stack([np.exp(-((GRID.theta_h / w) ** 2)) + 1e-3 for w in (0.2, 0.6)])[None]}
PARAMETERS: dict[str, dict[str, np.ndarray]] = {
    "lafortune": {
        "rho_d": np.full(3, 0.1),
        "rho_s": np.tile([0.5, 0.3, 0.1], (3, 1)),
        "n": np.array([[40.0, 5.0, 10.0]]),
        "C_xy": np.array([[-1.0, -1.0, 1.0]]),
        "C_z": np.array([[1.0, 0.8, 0.9]]),
    },
    "blinn-phong": {
        "rho_d": np.full(3, 0.1),
        "rho_s": np.tile([1.0, 0.2], (3, 1)),
        "n": np.array([[50.0, 8.0]]),
        "F_0": np.array([[0.1, 0.5]]),
    },
    "quantiles": FACETS,
    "visible-slopes": FACETS,
    "normal-distribution": LOBES,
}


def table():
    """A lobe of 0.2 rad that rises to grazing angles, on a diffuse part of 0.1 1/sr."""
    theta_h, theta_d = GRID.theta_h[:, None, None], GRID.theta_d[:, None]
    lobe = 4 * np.exp(-((theta_h / 0.2) ** 2)) * (0.1 + 0.9 * (1 - np.cos(theta_d)) ** 5)
    values = np.broadcast_to(0.1 + lobe, (3, *GRID.shape))
    return Table(np.where(GRID.above_horizon, values, INVALID), GRID)


TABLE = table()
LIGHT = Environment(np.random.default_rng(5).random((16, 32, 3)) ** 4)


def reflected(light, at):
    """Light that a point reflects to the camera, by direction of the light (n, 3)."""
    cell = GRID.cell(*half_difference(light, at.view, at.normal))
    brdf = np.maximum(TABLE.values[1].ravel()[cell], 0)
    return LIGHT.lookup(light)[..., 1] * brdf * np.maximum(light @ at.normal[0], 0)


def factors(half, improved, shape, terms=(2, 2)):
    """Arrays of a factorisation of `TABLE`."""
    angles = Angles(half, improved, shape)
    return factor(TABLE.lookup, Recipe(angles, terms)).factors.arrays()


#: Kinds of factors that the strategy is tested with.
FACTORED = {
    "factored": lambda: factors(True, True, (8, 1, 32, 12)),
    "factored: as printed, views of all azimuths": lambda: factors(True, False, (8, 8, 32, 12)),
    "factored: as printed": lambda: factors(True, False, (8, 1, 32, 12), (3, 1)),
    "factored: views of all azimuths": lambda: factors(True, True, (8, 8, 32, 12)),
    "factored: by the light": lambda: factors(False, True, (8, 1, 16, 24)),
}


#: A fit of brushed metal: strategies that follow facets do so where they are turned.
TURNED_GRID = Directional(6, 24, 6, 24)
TURNED = ("quantiles: turned", "visible-slopes: turned")


def turned():
    """Arrays of a fit of a table of both directions, with alpha 0.2 and 0.6."""
    phi = np.arange(24) / 24 * 2 * np.pi
    h = directions(elevations(11)[:, None], phi)
    return {"D": anisotropic_ggx(h, turned_scale((0.2, 0.6), 0.4))[None]}


@pytest.fixture(params=sorted({*registry.strategies(), *FACTORED, *TURNED}), scope="module")
def strategy(request):
    name = request.param.split(":")[0]
    if request.param in TURNED:
        return registry.make([name], Given(LIGHT, TURNED_GRID, None, turned()))[0]
    make = FACTORED.get(request.param)
    parameters = make() if make else PARAMETERS.get(name, {})
    (made,) = registry.make([name], Given(LIGHT, GRID, TABLE, parameters))
    return made


@pytest.fixture(params=VIEWS)
def at(request):
    return point(request.param)


def drawn(strategy, at, count, seed=1):
    """Independent samples (count, 3), and their densities (count,)."""
    u = np.random.default_rng(seed).random((1, count, 2))
    light = strategy.sample(u, at)
    return light[0], strategy.pdf(light, at)[0]


def test_samples_are_unit_vectors_with_a_density(strategy, at):
    light, density = drawn(strategy, at, 50_000)
    assert light.shape == (50_000, 3) and density.shape == (50_000,)
    np.testing.assert_allclose(np.linalg.norm(light, axis=1), 1, rtol=1e-9)
    assert np.isfinite(density).all() and (density >= 0).all()
    # Rounding may move a sample over the edge of what has a density.
    above = light @ at.normal[0] > 1e-6
    assert (density[above] > 0).mean() > 0.9999


def test_corners_of_the_unit_square_have_directions(strategy, at):
    below = np.nextafter(1, 0)
    corners = np.array([[[0, 0], [0, below], [below, 0], [below, below]]])
    light = strategy.sample(corners, at)
    np.testing.assert_allclose(np.linalg.norm(light[0], axis=1), 1, rtol=1e-9)
    assert np.isfinite(strategy.pdf(light, at)).all()


def test_density_and_the_share_below_the_horizon_make_one(strategy, at):
    light, measure = above_horizon(at)
    above = strategy.pdf(light[None], at)[0] @ measure
    samples, _ = drawn(strategy, at, 400_000)
    lost = (samples @ at.normal[0] <= 0).mean()
    assert above + lost == pytest.approx(1, abs=0.005)


def bins(light, at):
    """Patches about the mirror direction, narrow near to it: number of the patch, (n,)."""
    x, y, z = np.clip(about_mirror(at).view_frame[0] @ light.T, -1, 1)
    ring = np.minimum((np.sqrt(np.arccos(z) / np.pi) * 14).astype(int), 13)
    sector = ((np.arctan2(y, x) + np.pi) / (2 * np.pi) * 12).astype(int) % 12
    return ring * 12 + sector


def test_samples_follow_the_density_by_chi_square(strategy, at):
    count = 20_000
    light, measure = above_horizon(at, 1 << 20)
    weight = strategy.pdf(light[None], at)[0] * measure
    expected = count * np.bincount(bins(light, at), weight, minlength=14 * 12)
    samples, _ = drawn(strategy, at, count)
    samples = samples[samples @ at.normal[0] > 0]
    found = np.bincount(bins(samples, at), minlength=14 * 12)
    many = expected >= 8
    assert many.sum() > 20
    # What little is expected elsewhere makes a bin of its own.
    expected = np.append(expected[many], max(expected[~many].sum(), 1))
    found = np.append(found[many], found[~many].sum())
    statistic = ((found - expected) ** 2 / expected).sum()
    assert chi2.sf(statistic, len(expected)) > 1e-4


def test_means_of_samples_scatter_about_the_integral_as_their_errors_say(strategy):
    """As z = (mean - integral) / error, of 50 means at each of four views."""
    z = np.stack([z_of_means(strategy, point(view), 50) for view in VIEWS])
    assert 0.8 <= np.sqrt((z**2).mean()) <= 1.3
    # The mean of all samples of a view, over its own error.
    assert np.abs(z.mean(axis=1) * np.sqrt(50)).max() < 4


def z_of_means(strategy, at, count):
    """Means of 100 000 samples in all, off the integral, over their standard error, (count,)."""
    light, measure = above_horizon(at, 1 << 19)
    integral = reflected(light, at) @ measure
    samples, density = drawn(strategy, at, 100_000, seed=2)
    counts = density > 0
    values = np.where(counts, reflected(samples, at) / np.where(counts, density, 1), 0)
    error = values.std() / np.sqrt(len(values) / count)
    return (values.reshape(count, -1).mean(axis=1) - integral) / error


def test_no_light_is_reflected_where_the_density_is_zero(strategy, at):
    light, measure = above_horizon(at)
    energy = reflected(light, at) * measure
    unseen = strategy.pdf(light[None], at)[0] == 0
    assert energy[unseen].sum() <= 1e-6 * energy.sum()


def test_points_are_treated_each_for_itself(strategy):
    one, other = point(20.0), point(70.0, (-0.3, 0.1, 0.8))
    parts = {name: np.concatenate([vars(one)[name], vars(other)[name]]) for name in vars(one)}
    both = type(one)(**parts)
    u = np.random.default_rng(3).random((2, 50, 2))
    light = strategy.sample(u, both)
    density = strategy.pdf(light, both)
    for k, at in enumerate((one, other)):
        alone = strategy.sample(u[k : k + 1], at)
        np.testing.assert_allclose(light[k : k + 1], alone, atol=1e-12)
        np.testing.assert_allclose(density[k : k + 1], strategy.pdf(alone, at), rtol=1e-6)
