"""The grid that tables live on: bins in theta_h, theta_d and phi_d."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

HALF_PI = np.pi / 2


@dataclass(frozen=True)
class Grid:
    """Bins of half and difference angles; the defaults are MERL's.

    Bins are uniform in theta_d, in phi_d over [0, pi), and in sqrt(theta_h) (Bagher et al.
    2016, equation 6), so that bin k of theta_h covers [(k/n)^2, ((k+1)/n)^2) x 90 degrees.
    A cell stands for the angles at the centres of its bins.

    Parameters
    ----------
    theta_h_bins, theta_d_bins, phi_d_bins : int
        Number of bins; `phi_d_bins` is even, so that exchanging light and view maps bins on bins.
    """

    theta_h_bins: int = 90
    theta_d_bins: int = 90
    phi_d_bins: int = 180

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of bins in theta_h, theta_d, phi_d."""
        return self.theta_h_bins, self.theta_d_bins, self.phi_d_bins

    @property
    def cells(self) -> int:
        """Number of cells."""
        return self.theta_h_bins * self.theta_d_bins * self.phi_d_bins

    @property
    def name(self) -> str:
        """A short name for messages and files."""
        return "half-difference " + "x".join(map(str, self.shape))

    @cached_property
    def theta_h(self) -> NDArray:
        """Bin centres of theta_h in radians, shape (theta_h_bins,)."""
        return ((np.arange(self.theta_h_bins) + 0.5) / self.theta_h_bins) ** 2 * HALF_PI

    @cached_property
    def theta_d(self) -> NDArray:
        """Bin centres of theta_d in radians, shape (theta_d_bins,)."""
        return (np.arange(self.theta_d_bins) + 0.5) / self.theta_d_bins * HALF_PI

    @cached_property
    def phi_d(self) -> NDArray:
        """Bin centres of phi_d in radians, shape (phi_d_bins,)."""
        return (np.arange(self.phi_d_bins) + 0.5) / self.phi_d_bins * np.pi

    @cached_property
    def cosines(self) -> tuple[NDArray, NDArray]:
        """Cosines of theta_i and theta_o at the cell centres, each of shape `shape`.

        Bagher et al. 2016, equations 1 and 2, with the sign of MERL's reader and of the paper's
        appendix (light and view are exchanged in the paper's text).
        """
        theta_h, theta_d = self.theta_h[:, None, None], self.theta_d[:, None]
        mean = np.cos(theta_h) * np.cos(theta_d)
        swing = np.sin(theta_h) * np.sin(theta_d) * np.cos(self.phi_d)
        return mean - swing, mean + swing

    @cached_property
    def above_horizon(self) -> NDArray[np.bool_]:
        """Where light and view at the cell centre both lie above the horizon, shape `shape`."""
        cos_i, cos_o = self.cosines
        return (cos_i > 0) & (cos_o > 0)

    def cell(self, theta_h: NDArray, theta_d: NDArray, phi_d: NDArray) -> NDArray:
        """Flat index of the cell that holds the given angles (radians; no interpolation).

        Parameters
        ----------
        theta_h, theta_d, phi_d : ndarray
            Angles in [0, pi/2], [0, pi/2] and [0, pi); the upper ends fall into the last bin.

        Returns
        -------
        ndarray of int32
            Index into a table of shape `shape`, flattened in C order.
        """
        h = _bin(np.sqrt(theta_h / HALF_PI), self.theta_h_bins)
        d = _bin(theta_d / HALF_PI, self.theta_d_bins)
        p = _bin(phi_d / np.pi, self.phi_d_bins)
        return (h * self.theta_d_bins + d) * self.phi_d_bins + p


def _bin(fraction: NDArray, bins: int) -> NDArray[np.int32]:
    return np.minimum((fraction * bins).astype(np.int32), bins - 1)


MERL = Grid()
