"""Points to be shaded: what is known of them where light directions are chosen and looked up."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Shading:
    """Points of surfaces as a BRDF sees them.

    Parameters
    ----------
    normal, view : ndarray, shape (p, 3)
        Unit normal for shading and unit direction to the camera, above the horizon.
    tangent : ndarray, shape (p, 3), or None
        Unit vector across the normal that the azimuth of anisotropic reflection is counted from;
        None where nothing asks for it.
    """

    normal: Array
    view: Array
    tangent: Array | None = None

    def __len__(self) -> int:
        return len(self.normal)

    def __getitem__(self, chosen: slice | NDArray) -> Self:
        given = {name: value for name, value in vars(self).items() if value is not None}
        return replace(self, **{name: value[chosen] for name, value in given.items()})

    @property
    def cos_o(self) -> Array:
        """Cosine of view and normal, shape (p,)."""
        return np.einsum("ij,ij->i", self.view, self.normal)

    def cosines(self, light: Array) -> Array:
        """Cosines (p, m) of directions `light` (p, m, 3) with the normals."""
        return (light @ self.normal[:, :, None])[..., 0]

    def directions(self, cosine: Array, azimuth: Array) -> Array:
        """Unit vectors (p, m, 3) at angles (p, m) from the normals, azimuths from the views'."""
        sine = np.sqrt(1 - cosine**2)
        local = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine], axis=-1)
        return local @ self.view_frame

    @property
    def view_frame(self) -> Array:
        """Rows x, y, z of frames with z the normal and the view at y = 0, x > 0: (p, 3, 3)."""
        x = self.view - self.cos_o[:, None] * self.normal
        # Looking straight down, any x will do: the coordinate axis that is farthest from the
        # normal.
        axis = np.eye(3)[np.argmin(np.abs(self.normal), axis=1)]
        along = np.einsum("ij,ij->i", axis, self.normal)[:, None] * self.normal
        x = np.where(np.linalg.norm(x, axis=1, keepdims=True) > 1e-7, x, axis - along)
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        return np.stack([x, np.cross(self.normal, x), self.normal], axis=1)
