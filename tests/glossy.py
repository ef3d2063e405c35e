"""A table for whatever needs a material with a base, a lobe and colours."""

import numpy as np

from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import INVALID, Table


def glossy(width=0.2):
    """A lobe of so many radians on a base, rising to grazing angles, of three colours."""
    theta_h, theta_d = MERL.theta_h[:, None, None], MERL.theta_d[:, None]
    lobe = np.exp(-((np.tan(theta_h) / width) ** 2)) * (0.1 + 0.9 * (1 - np.cos(theta_d)) ** 5)
    colour = np.array([1.0, 0.8, 0.3])[:, None, None, None]
    return Table(np.where(MERL.above_horizon, 0.1 * colour + 3 * lobe * colour**2, INVALID))
