import numpy as np
import pytest
from shaded import point

from npfm.errors import NpfmError
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.models import ggx, power_iteration
from npfm.reflectance.directional import UTIA, Directional, directions
from npfm.reflectance.microsurfaces import anisotropic_ggx, turned_scale
from npfm.reflectance.table import Table
from npfm.reflectance.tabulated_slopes import elevations
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.sampling.turned_facets import frames, turned_facets
from npfm.rendering.shading import Shading

LIGHT = Environment(np.ones((4, 8, 3)))
STRATEGIES = "quantiles", "visible-slopes"
ALPHA = 0.1, 0.5


def facets_of(density=lambda h: anisotropic_ggx(h, turned_scale(ALPHA, 0.0))):
    phi = np.arange(48) / 48 * 2 * np.pi
    return {"D": density(directions(elevations(11)[:, None], phi))[None]}


def made(name, parameters, grid=UTIA):
    return registry.make([name], Given(LIGHT, grid, None, parameters))[0]


@pytest.mark.parametrize("name", STRATEGIES)
def test_highlights_stretch_across_the_brushing(name):
    at = point(20.0)
    light = made(name, facets_of()).sample(np.random.default_rng(1).random((1, 20_000, 2)), at)
    half = light + at.view[:, None]
    x, y, z = np.moveaxis(half @ frames(at).transpose(0, 2, 1), -1, 0)
    slopes = np.median(np.abs(x / z)), np.median(np.abs(y / z))
    assert slopes[1] > 3.5 * slopes[0]


def test_cells_hold_the_normals_that_are_drawn_in_them():
    surface = turned_facets(Given(LIGHT, UTIA, None, facets_of()))
    share = np.zeros(surface.D.size)
    for cell in (0, 31, 700, 47 * 32 + 31):
        share[:] = 0
        share[cell] = 1
        u = 0.001 + 0.998 * np.random.default_rng(2).random((1, 100, 2))
        normals = surface.normals(np.cumsum(share)[None], u)
        assert (surface.cells(normals) == cell).all()
        np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1)
    middles = surface.middles.reshape(-1, 3)
    assert np.array_equal(surface.cells(middles), np.arange(len(middles)))
    assert surface.solid_angles.sum() * 48 == pytest.approx(np.pi)


def test_the_visible_facets_are_the_better_choice_at_grazing_angles():
    """Variance of the light of a white sky that a surface of these facets reflects."""
    table = Table(np.broadcast_to(brushed(), (3, *UTIA.shape)), UTIA)
    deviation = {}
    for name in STRATEGIES:
        at, strategy = point(75.0), made(name, facets_of())
        light = strategy.sample(np.random.default_rng(3).random((1, 20_000, 2)), at)
        density = strategy.pdf(light, at)[0]
        along = light[0] @ frames(at)[0].T
        up = along[:, 2] > 0
        view = np.broadcast_to(frames(at)[0] @ at.view[0], along[up].shape)
        values = np.zeros(len(along))
        values[up] = table.lookup(along[up], view)[0] * along[up, 2] / density[up]
        deviation[name] = values.std() / values.mean()
    assert deviation["visible-slopes"] < 0.7 * deviation["quantiles"]


def brushed():
    """Values of the surface whose facets are `facets_of`."""
    D = facets_of()["D"]
    parameters = {"D": D / D.max(), "F": np.ones((3, 90)), "rho_s": np.ones(3)}
    single = {key: value.astype(np.float32) for key, value in parameters.items()}
    return power_iteration.tabulate(Fit("power-iteration", single, UTIA)).values[0]


@pytest.mark.parametrize("name", STRATEGIES)
def test_fits_without_such_a_distribution_are_refused(name):
    table = Table(np.full((3, 3, 6, 3, 6), 0.2), Directional(3, 6, 3, 6))
    converted = ggx.fit(table, Objective(), None, 1).parameters
    lobes = {"D": np.ones((1, 3, 6, 3))}
    for parameters in (converted, lobes, facets_of()):
        with pytest.raises(NpfmError, match="no factor D of theta_h and phi_h"):
            made(name, parameters, table.grid)


def test_a_point_without_a_tangent_is_refused():
    at = point(20.0)
    bare = Shading(normal=at.normal, view=at.view)
    with pytest.raises(ValueError, match="turned from a tangent"):
        made("quantiles", facets_of()).sample(np.full((1, 1, 2), 0.5), bare)


def test_a_mirror_is_sampled_where_it_mirrors():
    D = np.zeros((1, 11, 48))
    D[0, 0] = 1
    at = point(40.0)
    mirror = 2 * at.cos_o[:, None] * at.normal - at.view
    for name in STRATEGIES:
        light = made(name, {"D": D}).sample(np.random.default_rng(4).random((1, 1000, 2)), at)
        assert np.median(light[0] @ mirror[0]) > np.cos(np.deg2rad(1))
