"""Factored reflectance: a factor of the view times one of each angle of another direction, summed.

Lawrence et al. 2004, equations 3 and 8: with the direction p that the light is described by, its
half vector with the view or the light itself,

    cos(theta_i) (rho - rho_d) [4 (i.h)] = rho_s t sum_jk F_j(o) u_jk(theta_p) v_jk(phi_p),

where t is the colour, itself a product of a factor of each of the three, and averages to 1 over
the channels. The Jacobian 4 (i.h) is there in the recipe ``improved`` where p is the half vector,
rho_d is 0 in the recipe ``paper``. Azimuths are counted from the tangent; where there is one
azimuth of the view only, as for isotropic reflection, they are counted from the view's.

A fit holds these arrays, which are all that one who evaluates or samples it has to know. J and K
count terms, n and m bins of angle and azimuth; the first axis of 3 is the colour channel.

=========  ============  ========================================================================
kind       (1, 2)        1 where p is the half vector, else 0; 1 in the recipe improved, else 0
F_o        (1, J, n, m)  of the view, at the middles of even bins of theta_o, and at azimuths that
                         begin with 0; linear in between
u          (1, J, K, n)  shares of bins of theta_p: they add up to 1
v          (1, J, K, m)  integrals over even bins of phi_p, from 0 to 2 pi
rho_d      (3,)          Lambertian part in 1/sr
rho_s      (3,)          mean of the rest in 1/sr
tint_o     (3, n, m)     the colour's factor of the view, as F_o
tint_u     (3, n)        of theta_p, at each bin
tint_v     (3, m)        of phi_p, at each bin
=========  ============  ========================================================================

Bins of theta_p are even, except that those of half vectors are in the recipe ``improved`` uniform
in sqrt(theta_h), as MERL's are.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError

Array = NDArray[np.float64]
HALF_PI, TWO_PI = np.pi / 2, 2 * np.pi
#: Cosine of the last degree before the horizon.
LEAST_COSINE = np.cos(np.deg2rad(89))
NAMES = ("kind", "F_o", "u", "v", "rho_d", "rho_s", "tint_o", "tint_u", "tint_v")


@dataclass(frozen=True)
class Angles:
    """Where factors are tabulated.

    Parameters
    ----------
    half : bool
        Whether the direction p is the half vector, not the light.
    improved : bool
        Whether the recipe is ``improved``, not ``paper``.
    shape : tuple of four int
        Bins of theta_o, phi_o, theta_p and phi_p.
    """

    half: bool
    improved: bool
    shape: tuple[int, int, int, int]

    @property
    def relative(self) -> bool:
        """Whether azimuths are counted from the view's."""
        return self.shape[1] == 1

    @property
    def jacobian(self) -> bool:
        """Whether the factors are of densities of half vectors, 4 (i.h) times those of light."""
        return self.half and self.improved

    @cached_property
    def theta_o(self) -> Array:
        """Angles of the view that are tabulated."""
        return (np.arange(self.shape[0]) + 0.5) / self.shape[0] * HALF_PI

    @cached_property
    def phi_o(self) -> Array:
        """Azimuths of the view that are tabulated."""
        return np.arange(self.shape[1]) / self.shape[1] * TWO_PI

    @cached_property
    def edges(self) -> Array:
        """Edges of the bins of theta_p, from 0 to pi/2."""
        return self._warped(np.arange(self.shape[2] + 1.0))

    @cached_property
    def theta_p(self) -> Array:
        """Middles of the bins of theta_p."""
        return self._warped(np.arange(self.shape[2]) + 0.5)

    @cached_property
    def phi_p(self) -> Array:
        """Middles of the bins of phi_p."""
        return (np.arange(self.shape[3]) + 0.5) / self.shape[3] * TWO_PI

    def _warped(self, place: NDArray) -> Array:
        return (place / self.shape[2]) ** (2 if self.jacobian else 1) * HALF_PI

    @cached_property
    def bands(self) -> Array:
        """Differences of cos(theta_p) between the edges of each bin."""
        return -np.diff(np.cos(self.edges))

    def bin_of(self, theta_p: Array, phi_p: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Bins of theta_p and phi_p that angles fall into."""
        theta = np.sqrt(theta_p / HALF_PI) if self.jacobian else theta_p / HALF_PI
        k = (theta * self.shape[2]).astype(np.intp)
        b = (phi_p / TWO_PI % 1 * self.shape[3]).astype(np.intp)
        return np.clip(k, 0, self.shape[2] - 1), np.minimum(b, self.shape[3] - 1)

    def between(self, theta_p: Array, phi_p: Array) -> tuple["Between", "Between"]:
        """Where angles lie between the middles of bins of theta_p, and of those of phi_p."""
        theta = np.sqrt(theta_p / HALF_PI) if self.jacobian else theta_p / HALF_PI
        n, m = self.shape[2:]
        place = np.clip(theta * n - 0.5, 0, n - 1)
        k = np.minimum(place.astype(np.intp), max(n - 2, 0))
        around = phi_p / TWO_PI % 1 * m - 0.5
        b = np.floor(around).astype(np.intp)
        return (
            Between(k, np.minimum(k + 1, n - 1), place - k),
            Between(b % m, (b + 1) % m, around - b),
        )

    def of_view(self, factor: Array, theta_o: Array, phi_o: Array) -> Array:
        """Interpolate factors (..., n, m) of the view at q views.

        Returns
        -------
        ndarray, shape (..., q)
        """
        n, m = self.shape[:2]
        place = np.clip(theta_o / HALF_PI * n - 0.5, 0, n - 1)
        k = np.minimum(place.astype(np.intp), max(n - 2, 0))
        across = phi_o / TWO_PI % 1 * m
        b = np.minimum(across.astype(np.intp), m - 1)
        up, on = place - k, across - b
        rows = ((k, 1 - up), (np.minimum(k + 1, n - 1), up))
        columns = ((b, 1 - on), ((b + 1) % m, on))
        parts = [factor[..., i, j] * (s * t) for i, s in rows for j, t in columns]
        return np.sum(parts, axis=0)


@dataclass(frozen=True)
class Between:
    """Pairs of neighbouring bins, and how far it is from the middle of the first to the next.

    Parameters
    ----------
    first, second : ndarray of int, shape (q,)
    part : ndarray, shape (q,)
        From 0 to 1.
    """

    first: NDArray[np.intp]
    second: NDArray[np.intp]
    part: Array

    def of(self, values: Array) -> Array:
        """Interpolate values (..., bins): (..., q)."""
        low, high = values[..., self.first], values[..., self.second]
        return low + self.part * (high - low)


@dataclass(frozen=True)
class Factors:
    """Factors of a BRDF; the module tells what the arrays are, here without the axis of length 1.

    Parameters
    ----------
    angles : Angles
        Where they are tabulated.
    F_o, u, v : ndarray
        The factors.
    rho_d, rho_s : ndarray, shape (3,)
        The coefficients.
    tints : tuple of three ndarray
        Factors of the colour.
    """

    angles: Angles
    F_o: Array
    u: Array
    v: Array
    rho_d: Array
    rho_s: Array
    tints: tuple[Array, Array, Array]

    @property
    def terms(self) -> tuple[int, int]:
        """J and K."""
        return self.u.shape[0], self.u.shape[1]

    def arrays(self) -> dict[str, Array]:
        """Return the arrays as a fit holds them."""
        kind = np.array([[float(self.angles.half), float(self.angles.improved)]])
        shared = {"kind": kind, "F_o": self.F_o[None], "u": self.u[None], "v": self.v[None]}
        own = zip(NAMES[4:], (self.rho_d, self.rho_s, *self.tints), strict=True)
        return shared | dict(own)


def read(parameters: Mapping[str, NDArray]) -> Factors:
    """Return the factors of a fit.

    Raises
    ------
    NpfmError
        If an array is missing, or their shapes do not belong together.
    """
    if missing := [name for name in NAMES if name not in parameters]:
        raise NpfmError(
            f"the fit has no array '{missing[0]}'; give one of the model factored, "
            "or what npfm factor writes"
        )
    a = {name: np.asarray(parameters[name], dtype=float) for name in NAMES}
    dimensions = (2, 4, 4, 4, 1, 1, 3, 2, 2)
    if any(a[name].ndim != d for name, d in zip(NAMES, dimensions, strict=True)):
        raise NpfmError("the arrays are not those of factors; make them again with npfm factor")
    (_, J, *view), (*_, K, n), m = a["F_o"].shape, a["u"].shape, a["v"].shape[-1]
    wanted = ((1, 2), (1, J, *view), (1, J, K, n), (1, J, K, m), (3,), (3,), (3, *view))
    for name, shape in zip(NAMES, (*wanted, (3, n), (3, m)), strict=True):
        if a[name].shape != shape:
            raise NpfmError(
                f"the array '{name}' is {a[name].shape} where the others want {shape}; "
                "make them again with npfm factor"
            )
    half, improved = a["kind"][0] > 0.5
    angles = Angles(bool(half), bool(improved), (view[0], view[1], n, m))
    tints = a["tint_o"], a["tint_u"], a["tint_v"]
    return Factors(angles, a["F_o"][0], a["u"][0], a["v"][0], a["rho_d"], a["rho_s"], tints)


def reflectance(factors: Factors, light: Array, view: Array) -> Array:
    """BRDF (3, q) in 1/sr at pairs of directions (q, 3) over a surface of normal z and tangent x.

    Both above the horizon. Between the middles of bins factors are linear in what the bins are even
    in. For light within a degree of the horizon the cosine that it is divided by is that of 89
    degrees: no table has samples there.
    """
    angles = factors.angles
    p, jacobian = light, 1.0
    if angles.half:
        p = light + view
        length = np.linalg.norm(p, axis=-1)
        p, jacobian = p / length[:, None], (2 * length if angles.jacobian else 1.0)
    phi_o = np.arctan2(view[:, 1], view[:, 0])
    theta_o = np.arccos(np.clip(view[:, 2], 0, 1))
    azimuth = np.arctan2(p[:, 1], p[:, 0]) - (phi_o if angles.relative else 0)
    theta, phi = angles.between(np.arccos(np.clip(p[:, 2], 0, 1)), azimuth)
    u = theta.of(factors.u / angles.bands)
    v = phi.of(factors.v * (angles.shape[3] / TWO_PI))
    product = np.einsum("jq,jkq,jkq->q", angles.of_view(factors.F_o, theta_o, phi_o), u, v)
    tint_o, tint_u, tint_v = factors.tints
    tint = angles.of_view(tint_o, theta_o, phi_o) * theta.of(tint_u) * phi.of(tint_v)
    shown = product / (np.maximum(light[:, 2], LEAST_COSINE) * jacobian)
    return factors.rho_d[:, None] + factors.rho_s[:, None] * tint * shown
