"""A sum of 20 products of four factors of one angle each, in the manner of Bilgili et al. 2011.

log(1 + rho / scale) = sum_r u_r(theta_h) v_r(phi_h) w_r(theta_o) x_r(phi_o), of the half and the
outgoing vector.

What is known of the original ("A general BRDF representation based on tensor decomposition",
Computer Graphics Forum 30(8)): Bagher et al. 2016 (section 2) describe 20 products of four
tabulated factors over these angles, 77 KB a material in double precision. The survey of Pajarola,
Suter and Ruiters (tutorial "Tensor Approximation in Visualization and Graphics") calls it repeated
Tucker decomposition after a logarithmic transform: each product is the decomposition of core size 1
of what the ones before it have left.

What is chosen here:

- The materials are isotropic, so only phi_h - phi_o matters, and phi_o is held at 0: its factor has
  one node, which holds the core. A free phi_o would spend products on that difference alone.
- MERL's cells with phi_d in [0, pi) are just those with the azimuth between the two vectors in
  [0, pi]: the tensor has that range and no symmetry is assumed. Exchanging light and view is
  none of it: the model is not reciprocal.
- theta_h has the bins of the table; phi_h and theta_o have nodes with linear interpolation, as
  many as make the stored numbers of a MERL table the original's: 77 304 bytes in double precision.
- Values at the nodes are the least-squares solution for the samples; nodes that no sample reaches
  continue their neighbours smoothly.
- The scale inside the logarithm is a tenth of the weighted median of the samples.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from npfm.fitting.channels import ChannelFit, as_table, fit_channels
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, Samples, evaluate
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.angles import directions
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "tucker-20"
COEFFICIENTS = ("scale",)
SIGNED = ("theta_h", "phi_h", "theta_o", "phi_o")  # the factors, by the axes of the tensor
RECIPROCAL = False
SOLVER = False
OBJECTIVE = False  # least squares of the logarithm
OWN_TABLE = 1e-4  # found one by one, products are not those of the table again
SETTINGS = {"sweeps": "joint improvements of all products after the last (default: 0, as original)"}
TERMS = 20
PHI_H_NODES, THETA_O_NODES = 25, 45
#: Scale inside the logarithm, in units of the weighted median.
SCALE = 0.1
#: Weight of the differences between neighbouring nodes beside that of one sample.
SMOOTHNESS = 1e-2
#: A product is found when a step lowers the relative error of the tensor by less.
TOLERANCE = 1e-6

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Nodes:
    """Where the cells of a grid lie between the nodes of (theta_o, phi_h).

    Parameters
    ----------
    index : ndarray of int, shape (4,) + grid.shape
        Flat indices of the four nodes around a cell.
    share : ndarray, the same shape
        Their shares in its value.
    """

    index: NDArray[np.intp]
    share: Array

    def values(self, tensor: Array) -> Array:
        """Interpolate a tensor of shape (theta_h, theta_o * phi_h) at every cell."""
        rows = np.arange(len(tensor))[:, None, None]
        return sum(s * tensor[rows, i] for i, s in zip(self.index, self.share, strict=True))

    def matrix(self, row: int, cells: NDArray[np.bool_]) -> sparse.csr_array:
        """Matrix that interpolates at some cells of one theta_h bin."""
        index, share = self.index[:, row, cells], self.share[:, row, cells]
        samples = np.broadcast_to(np.arange(index.shape[1]), index.shape)
        shape = index.shape[1], THETA_O_NODES * PHI_H_NODES
        return sparse.csr_array((share.ravel(), (samples.ravel(), index.ravel())), shape=shape)


@lru_cache(maxsize=1)
def nodes(grid: HalfDifference) -> Nodes:
    """Place the cells of a grid; those below the horizon go to the nearest node."""
    _, view = directions(grid.theta_h[:, None, None], grid.theta_d[:, None], grid.phi_d)
    theta_o = np.arccos(np.clip(view[..., 2], 0.0, 1.0))
    phi_h = np.arctan2(np.abs(view[..., 1]), view[..., 0])
    (o, o_share), (h, h_share) = (
        _between(angle, most, number)
        for angle, most, number in (
            (theta_o, np.pi / 2, THETA_O_NODES),
            (phi_h, np.pi, PHI_H_NODES),
        )
    )
    corners = [(a, b) for a in (0, 1) for b in (0, 1)]
    index = np.stack([(o + a) * PHI_H_NODES + h + b for a, b in corners])
    share = np.stack([np.abs(1 - a - o_share) * np.abs(1 - b - h_share) for a, b in corners])
    return Nodes(index, share)


def _between(angle: Array, most: float, number: int) -> tuple[NDArray[np.intp], Array]:
    """Node below an angle in [0, most], and how far the angle is on the way to the next."""
    place = angle / most * (number - 1)
    below = np.minimum(place.astype(np.intp), number - 2)
    return below, np.minimum(place - below, 1.0)


@lru_cache(maxsize=1)
def _smoothness() -> sparse.csc_array:
    """Sum of squared differences between neighbouring nodes, as a matrix."""
    theta_o, phi_h = (
        sparse.diags_array(np.outer([-1.0, 1.0], np.ones(n - 1)), offsets=[0, 1], shape=(n - 1, n))
        for n in (THETA_O_NODES, PHI_H_NODES)
    )
    steps = sparse.vstack(
        [
            sparse.kron(theta_o, sparse.eye_array(PHI_H_NODES)),
            sparse.kron(sparse.eye_array(THETA_O_NODES), phi_h),
        ]
    )
    return (SMOOTHNESS * steps.T @ steps).tocsc()


def resampled(samples: Samples, logarithm: Array) -> Array:
    """Values at the nodes that are best for the samples that count.

    Parameters
    ----------
    samples : Samples
        Not folded.
    logarithm : ndarray, shape of the grid
        Their transformed values.

    Returns
    -------
    ndarray, shape (theta_h, theta_o * phi_h)
        Bins of theta_h without a sample are those of the nearest bin that has one.
    """
    placed, counts = nodes(samples.grid), samples.weight > 0
    seen = np.flatnonzero(counts.any((1, 2)))
    tensor = np.empty((len(counts), THETA_O_NODES * PHI_H_NODES))
    for row in seen:
        matrix = placed.matrix(int(row), counts[row])
        normal = (matrix.T @ matrix + _smoothness()).tocsc()
        tensor[row] = splu(normal).solve(matrix.T @ logarithm[row, counts[row]])
    nearest = seen[np.abs(np.arange(len(counts))[:, None] - seen).argmin(1)]
    return tensor[nearest]


def products(tensor: Array, sweeps: int) -> list[Array]:
    """Factors, one array (nodes, TERMS) for each axis, whose products add up to about a tensor.

    Each product is the Tucker decomposition of core size 1 of what is left by those before it; the
    last factor takes the cores. `sweeps` of alternating least squares then improve all products
    together.
    """
    from tensorly.cp_tensor import CPTensor, cp_to_tensor
    from tensorly.decomposition import parafac, tucker
    from tensorly.tenalg import outer

    factors = [np.zeros((length, TERMS)) for length in tensor.shape]
    left, count = tensor.copy(), 0
    while count < TERMS and left.any():
        core, found = tucker(left, rank=[1] * left.ndim, init="svd", tol=TOLERANCE)
        found[-1] = found[-1] * core.item()
        for factor, column in zip(factors, found, strict=True):
            factor[:, count] = column[:, 0]
        left -= outer([column[:, 0] for column in found])
        count += 1
    if sweeps and count:
        begun = CPTensor((None, [factor[:, :count] for factor in factors]))
        joint = parafac(
            tensor, count, init=begun, n_iter_max=sweeps, tol=TOLERANCE**2, linesearch=True
        )
        if np.linalg.norm(tensor - cp_to_tensor(joint)) < np.linalg.norm(left):
            for factor, columns in zip(factors, joint.factors, strict=True):
                factor[:, :count] = columns
    return factors


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material: the factors and the scale of each channel."""
    return 3 * (TERMS * (grid.theta_h_bins + PHI_H_NODES + THETA_O_NODES + 1) + 1)


def fit(table: Table, objective: Objective, solve: Solver, seed: int, *, sweeps: int = 0) -> Fit:
    """Resample each channel, take the logarithm, and decompose it; nothing in it is random.

    `npfm.models` says what every `fit` takes and raises.

    Parameters
    ----------
    sweeps : int
        Joint improvements of all products.
    """
    parameters, records = fit_channels(
        table,
        objective,
        lambda samples, channel: _fit_channel(samples, sweeps),
        COEFFICIENTS,
        RECIPROCAL,
    )
    return Fit(NAME, parameters, table.grid, records)


def _fit_channel(samples: Samples, sweeps: int) -> ChannelFit:
    began = time.process_time()
    tensor = resampled(samples, np.log1p(samples.value / SCALE))
    shape = len(tensor), THETA_O_NODES, PHI_H_NODES, 1
    found = products(tensor.reshape(shape).swapaxes(1, 2), sweeps)
    factors = [factor.astype(np.float32) for factor in found]
    model = _values(factors, SCALE, samples.grid)
    reached = evaluate(samples, model) / (samples.energy or 1.0)
    seconds = time.process_time() - began
    trace = Trace("svd", "converged", TERMS + sweeps, 0, (0.0, seconds), (1.0, reached))
    named = dict(zip(SIGNED, factors, strict=True))
    return ChannelFit({**named, "scale": SCALE}, (trace,))


def _values(factors: Sequence[NDArray], scale: float, grid: HalfDifference) -> Array:
    theta_h, phi_h, theta_o, phi_o = (factor.astype(float) for factor in factors)
    directional = (theta_o[:, None] * phi_h * phi_o).reshape(-1, TERMS)
    logarithm = nodes(grid).values(theta_h @ directional.T)
    return scale * np.expm1(np.maximum(logarithm, 0.0))


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr; never negative."""
    p = fit.parameters
    channels = [
        _values([p[name][channel] for name in SIGNED], float(p["scale"][channel]), fit.grid)
        for channel in range(3)
    ]
    return as_table(channels, fit.grid)
