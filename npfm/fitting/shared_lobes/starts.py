"""What the fit of shared lobes begins with."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.factors.slices import factors_of_slices
from npfm.fitting.shared_lobes.directional import DirectionalLobesProblem
from npfm.fitting.shared_lobes.problem import CLAMP, LobesProblem, State

Array = NDArray[np.float64]

STARTS, RANDOM_STARTS = 3, 1
#: Widths of the widths start, and powers of the powers start, span this factor up and down.
WIDTHS, POWERS = 3.0, 2.0
#: Where GGX has half its height: tan(theta_h) = 0.64 alpha.
HALF_HEIGHT = np.sqrt(np.sqrt(2) - 1)


def first_factors(problem: LobesProblem) -> tuple[Array, Array]:
    """D of all channels together and the F of each, to begin a fit of one lobe with."""
    if isinstance(problem, DirectionalLobesProblem):
        return problem.profile(), np.ones((len(problem.samples), problem.sizes[1]))
    found = [factors_of_slices(channel) for channel in problem.samples]
    D = np.exp(np.mean([np.log(D) for D, _ in found], axis=0))
    return D, np.stack([F for _, F in found])


def start_states(problem: LobesProblem, single: State, seed: int) -> Iterator[tuple[str, State]]:
    """Starts by name; each is made when it is its turn. No two of their lobes are equal.

    GGX lobes about the width of the single one; powers of the single D, with its G; random ones.

    Parameters
    ----------
    problem : LobesProblem
    single : State
        Fit of one lobe to the same samples.
    seed : int
        Of the random starts.
    """
    lobes, (nh, _, nodes) = problem.lobes, problem.sizes
    spread = np.linspace(-1, 1, lobes) if lobes > 1 else np.zeros(1)
    D, G, flat = single.D[0], single.G[0], np.ones((lobes, nodes))
    widths = width(*problem.over_theta_h(D)) * WIDTHS**spread
    yield "widths", problem.state(ggx(problem.theta_h, widths), single.F, flat)
    powers = POWERS**-spread
    yield "powers", problem.state(D ** powers[:, None], single.F, np.tile(G, (lobes, 1)))
    rng, (_, F) = np.random.default_rng(seed), first_factors(problem)
    for k in range(RANDOM_STARTS):
        D, G = (rng.uniform(CLAMP, 1.0, (lobes, n)) for n in (nh, nodes))
        yield f"random-{k + 1}", problem.state(D, F, G)


def width(D: Array, theta_h: Array) -> float:
    """Roughness alpha of the GGX distribution that falls to half its height where D does."""
    peak = int(np.argmax(D))
    fallen = np.flatnonzero(D[peak:] / D[peak] < 0.5)
    half = theta_h[peak + fallen[0]] if fallen.size else theta_h[-1]
    return float(np.clip(np.tan(half) / HALF_HEIGHT, 0.01, 1.0))


def ggx(theta_h: Array, alphas: Array) -> Array:
    """GGX distributions of height 1, shape (lobes, theta_h) (Walter et al. 2007, equation 33)."""
    tan2 = np.tan(theta_h) ** 2
    return 1 / (np.cos(theta_h) ** 4 * (1 + tan2 / alphas[:, None] ** 2) ** 2)
