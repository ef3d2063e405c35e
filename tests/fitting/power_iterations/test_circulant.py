import numpy as np
import pytest

from npfm.evaluation.anisotropic_slopes import SURFACES, backscattered, dense_matrix, recovery
from npfm.fitting.power_iterations.circulant import TOO_NARROW, distribution
from npfm.reflectance.anisotropic_slopes import Normals
from npfm.reflectance.microsurfaces import turned_scale


def noise(normals):
    return 0.05 + np.random.default_rng(4).random(normals.shape)


@pytest.mark.parametrize("shape", [(6, 8), (5, 9)])
def test_it_is_the_eigenvector_of_the_whole_matrix(shape):
    """Against a dense matrix, and an eigenvalue solver that knows nothing of power iterations."""
    normals = Normals(*shape)
    values, vectors = np.linalg.eig(dense_matrix(noise(normals), normals))
    largest = vectors[:, np.argmax(values.real)].real
    found, status, _ = distribution(noise(normals), normals, "consistent")
    assert status == "converged"
    np.testing.assert_allclose(found.ravel(), largest / largest[np.argmax(np.abs(largest))], 1e-8)


def test_the_papers_kernel_is_equation_15():
    """K = 4 f cos^5(theta_o) max(0, o.h) sec^4(theta_h) in P = D cos^4, as a whole matrix."""
    normals = Normals(6, 8)
    f, o = noise(normals).ravel(), normals.directions.reshape(-1, 3)
    weight = np.repeat(normals.solid_angle, 8)
    K = np.array([4 * a * h[2] ** 5 * np.maximum(0, o @ h) for a, h in zip(f, o, strict=True)])
    values, vectors = np.linalg.eig(K * weight / o[:, 2] ** 4)
    P = np.abs(vectors[:, np.argmax(values.real)].real)
    found = distribution(f.reshape(6, 8), normals, "paper")[0].ravel() * o[:, 2] ** 4
    np.testing.assert_allclose(found / found.sum(), P / P.sum(), rtol=1e-8)


@pytest.mark.parametrize("alpha", [(0.05, 0.6), (0.1, 0.5), (0.3, 0.6), (0.05, 0.05), (0.6, 0.6)])
def test_known_surfaces_are_found_again(alpha):
    table = recovery([(90, 90)], [alpha], [0, 2, 17, 45, 61.3, 90])
    assert (table.status == "converged").all()
    assert (table.alpha_error < 0.005).all()
    assert (table.rho_error < 0.01).all()
    assert (table.backscatter_error < 0.005).all()


@pytest.mark.parametrize("turn", [0, 1, 2, 17, 45])
def test_too_few_azimuths_are_told(turn):
    table = recovery([(90, 90)], [(0.01, 0.6)], [turn])
    assert (table.status == TOO_NARROW).all()


@pytest.mark.parametrize("surface", SURFACES)
def test_what_is_turned_by_whole_bins_is_found_turned(surface):
    normals = Normals(20, 24)
    f = backscattered(surface, turned_scale((0.1, 0.4), 0.3), normals)
    f = f * np.linspace(1, 2, 24)  # and is not symmetric
    found = distribution(f, normals, "consistent")
    turned = distribution(np.roll(f, 5, axis=1), normals, "consistent")
    np.testing.assert_allclose(turned[0], np.roll(found[0], 5, axis=1), rtol=1e-8, atol=1e-12)
    assert turned[1:] == found[1:]


@pytest.mark.parametrize("kernel", ["consistent", "paper"])
def test_little_light_is_no_trouble(kernel):
    normals = Normals(10, 12)
    nothing = np.zeros(normals.shape)
    D, status, _ = distribution(nothing, normals, kernel)
    assert (D == 1).all()
    assert status == "degenerate: no light comes back"
    one = nothing.copy()
    one[4, 7] = 1e-200
    D, status, _ = distribution(one, normals, kernel)
    assert ((one > 0) == D).all()
    assert status == TOO_NARROW
