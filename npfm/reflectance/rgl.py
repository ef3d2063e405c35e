"""The file format of the RGL material database (``.bsdf``), as tables on our grids.

Dupuy and Jakob 2018, "An adaptive parameterization for efficient material acquisition and
rendering". Measured is, for each direction of the light, f cos(theta_o) on a square whose points
are half vectors: dense where D and the masking of the material put its highlight. The light stands
where the file says ``theta_i`` and ``phi_i``, the sensor goes around.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance import angles
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import INVALID, Table
from npfm.reflectance.warps import Array, Warp, between, bilinear, both
from npfm.storage.tensor_files import Field, read_arrays, read_header

WHAT = "a .bsdf file of the RGL database"
#: What a measurement in RGB consists of, and the axes of each; `spectra` have wavelengths.
AXES = {"phi_i": 1, "theta_i": 1, "ndf": 2, "sigma": 2, "vndf": 4, "rgb": 5, "jacobian": 1}
#: With so few azimuths of the light a material is isotropic (Mitsuba 3, ``measured``).
MOST_ISOTROPIC = 2
#: Azimuths of the light end at these parts of a turn, for materials that are symmetric; they begin
#: at -pi. A half is the same turned by 180 degrees, a quarter mirrored in both axes.
SYMMETRIES = 1, 2, 4
#: Angles in files are float32.
ROUNDING = 1e-4
#: Cosine of theta_o below which nothing counts as measured, at 89 degrees: what files say of the
#: rim is extrapolated, and divided by the cosine it rises a hundredfold.
RIM = np.cos(np.radians(89.0))
#: Share of a node in an interpolated value below which it is none.
NO_SHARE = 1e-9
#: Pairs of directions that are evaluated at a time.
CHUNK = 2**15


@dataclass(frozen=True)
class Measurement:
    """A measured material, to be evaluated anywhere.

    Parameters
    ----------
    phi_i, theta_i : ndarray, shapes (a,) and (e,)
        Azimuths and elevations of the light in radians, ascending.
    ndf, sigma : ndarray, shape (1, rows, columns)
        Distribution of half vectors, and the projected area of microfacets.
    visible : Warp
        Of the distribution of half vectors that are seen, a slice for each direction of the light.
    values : ndarray, shape (3, a * e, rows, columns)
        What is measured, divided by D / (4 sigma).
    absent : ndarray, shape (a * e, rows, columns)
        1 at nodes without a measurement, else 0.
    highest : float
        The largest theta_i that was measured.
    scaled : bool
        Whether `values` are to be multiplied by D / (4 sigma).
    """

    phi_i: Array
    theta_i: Array
    ndf: Array
    sigma: Array
    visible: Warp
    values: Array
    absent: Array
    highest: float
    scaled: bool

    @property
    def isotropic(self) -> bool:
        """Whether azimuths of the half vector are counted from that of the light."""
        return len(self.phi_i) <= MOST_ISOTROPIC

    def brdf(self, light: Array, view: Array) -> Array:
        """BRDF in 1/sr of pairs of directions over a surface with normal z and tangent x.

        Parameters
        ----------
        light, view : ndarray, shape (n, 3)
            Unit vectors.

        Returns
        -------
        ndarray, shape (3, n)
            `INVALID` where it was not measured: at `RIM` and below, beyond the directions of the
            light, and wherever one of the values that it lies between stands for none. What a
            conversion of colours has left below 0 becomes 0.
        """
        pairs = range(0, len(light), CHUNK)
        parts = [self._evaluated(light[k : k + CHUNK], view[k : k + CHUNK]) for k in pairs]
        return np.concatenate(parts, axis=1) if parts else np.empty((3, 0))

    def _evaluated(self, light: Array, view: Array) -> Array:
        light, view = self._into_range(light, view)
        theta_i, phi_i = _spherical(light)
        theta_h, phi_h = _spherical(light + view)
        if self.isotropic:
            phi_h, phi_i = phi_h - phi_i, np.zeros_like(phi_i)
        x, y = _on_square(theta_h, phi_h)
        elevations = between(self.theta_i, theta_i)
        mix = both(between(self.phi_i, phi_i), elevations, len(self.theta_i))
        at = self.visible.inverse(mix, x, y)
        known = np.isfinite(at[0]) & np.isfinite(at[1])
        u, v = (np.where(known, coordinate, 0.0) for coordinate in at)
        with np.errstate(divide="ignore", invalid="ignore"):
            factor = self._factor(theta_i, phi_i, x, y) / view[:, 2]
            brdf = np.stack([bilinear(channel, mix, u, v) for channel in self.values]) * factor
        covered = (theta_i >= self.theta_i[0] - ROUNDING) & (theta_i <= self.highest + ROUNDING)
        known &= covered & (light[:, 2] > 0) & (view[:, 2] > RIM)
        known &= (bilinear(self.absent, mix, u, v) < NO_SHARE) & np.isfinite(brdf).all(axis=0)
        return np.where(known, np.maximum(brdf, 0), INVALID)

    def _factor(self, theta_i: Array, phi_i: Array, x: Array, y: Array) -> Array:
        """D / (4 sigma) where `values` are without."""
        if not self.scaled:
            return np.ones_like(x)
        area = _sampled(self.sigma, *_on_square(theta_i, phi_i))
        return _sampled(self.ndf, x, y) / (4 * area)

    def _into_range(self, light: Array, view: Array) -> tuple[Array, Array]:
        """Pairs turned or mirrored so that the light is among the azimuths that were measured."""
        if self.isotropic:
            return light, view
        across = np.where(light[:, 1] > 0, -1.0, 1.0)
        match _symmetry(self.phi_i):
            case 1:
                return light, view
            case 2:
                signs = np.stack([across, across, np.ones_like(across)], axis=-1)
            case _:
                along = np.where(light[:, 0] > 0, -1.0, 1.0)
                signs = np.stack([along, across, np.ones_like(across)], axis=-1)
        return light * signs, view * signs


def read_bsdf(path: str | Path) -> Measurement:
    """Read a ``.bsdf`` file with a measurement in RGB.

    The database's files name no node that was not measured, but do this: a value is 0 in all
    channels where the sensor would have been below the horizon, but for a margin that lets values
    be interpolated up to it; and at theta_i = 90 degrees, where no light can stand, the values are
    those of the elevation before once more.

    Raises
    ------
    NpfmError
        If the file is absent, cut off, damaged, has spectra in place of RGB, lacks a field, or has
        one of another type or shape, or with numbers that cannot be what it says.
    """
    path = Path(path)
    fields = _fields(path)
    stored = read_arrays(path, fields, AXES)
    arrays = {name: stored[name].astype(np.float64) for name in AXES}
    _check_numbers(path, arrays)
    phi_i, theta_i, rgb, vndf = (arrays[name] for name in ("phi_i", "theta_i", "rgb", "vndf"))
    copied = len(theta_i) > 1 and theta_i[-1] > np.pi / 2 - ROUNDING
    copied = copied and np.array_equal(rgb[:, -1], rgb[:, -2])
    values = np.moveaxis(rgb, 2, 0).reshape(3, -1, *rgb.shape[3:])
    if not values.any():
        raise NpfmError(f"{path}: all values are 0; leave this material out")
    return Measurement(
        phi_i,
        theta_i,
        arrays["ndf"][None],
        arrays["sigma"][None],
        Warp.of(vndf.reshape(-1, *vndf.shape[2:])),
        values,
        (values == 0).all(axis=0).astype(np.float64),
        float(theta_i[-2] if copied else theta_i[-1]),
        bool(arrays["jacobian"][0]),
    )


def is_isotropic(path: str | Path) -> bool:
    """Whether the material of a ``.bsdf`` file is isotropic, from the header alone.

    Raises
    ------
    NpfmError
        If the file is absent, or its header is not that of a measurement in RGB.
    """
    return _fields(Path(path))["phi_i"].shape[0] <= MOST_ISOTROPIC


def tabulate(measured: Measurement, grid: HalfDifference | Directional) -> Table:
    """Table of a measurement on a grid: its BRDF at the centres of cells, or at the directions."""
    if isinstance(grid, Directional):
        shape = (*grid.shape, 3)
        light = np.broadcast_to(grid.light[:, :, None, None], shape).reshape(-1, 3)
        view = np.broadcast_to(grid.view, shape).reshape(-1, 3)
        return Table(measured.brdf(light, view).reshape(3, *grid.shape), grid)
    above = grid.above_horizon
    places = (grid.theta_h[:, None, None], grid.theta_d[:, None], grid.phi_d)
    light, view = angles.directions(*(np.broadcast_to(a, grid.shape)[above] for a in places))
    values = np.full((3, *grid.shape), INVALID)
    values[:, above] = measured.brdf(light, view)
    return Table(values, grid)


def _fields(path: Path) -> dict[str, Field]:
    """Fields of a file, all there and of the shapes that belong together."""
    fields = read_header(path, WHAT)
    if "spectra" in fields and "rgb" not in fields:
        raise NpfmError(
            f"{path}: has spectra, which are not read; take the file of the same material that "
            "ends in _rgb.bsdf"
        )
    for name, axes in AXES.items():
        if name not in fields:
            raise NpfmError(f"{path}: has no field '{name}'; it is not {WHAT} in RGB")
        wanted = "u" if name == "jacobian" else "f"
        if fields[name].type.kind != wanted or len(fields[name].shape) != axes:
            raise _wrong(path, name, fields)
    lights = fields["phi_i"].shape + fields["theta_i"].shape
    for name, before in (("vndf", lights), ("rgb", (*lights, 3)), ("ndf", ()), ("sigma", ())):
        shape = fields[name].shape
        if shape[: len(before)] != before or min(shape[-2:]) < 2:
            raise _wrong(path, name, fields)
    for name in ("phi_i", "theta_i", "jacobian"):
        if not fields[name].shape[0]:
            raise _wrong(path, name, fields)
    return fields


def _wrong(path: Path, name: str, fields: dict[str, Field]) -> NpfmError:
    shape = " x ".join(map(str, fields[name].shape)) or "a single value"
    return NpfmError(
        f"{path}: the field '{name}' is {shape} of {fields[name].type}, which does not belong to "
        f"{WHAT} in RGB"
    )


def _check_numbers(path: Path, arrays: dict[str, NDArray]) -> None:
    """Refuse numbers that cannot be what their field says."""
    for name, array in arrays.items():
        if not np.isfinite(array).all():
            raise NpfmError(f"{path}: the field '{name}' holds a NaN or an infinity")
    phi_i, theta_i, vndf = arrays["phi_i"], arrays["theta_i"], arrays["vndf"]
    ascending = all((np.diff(nodes) > 0).all() for nodes in (phi_i, theta_i))
    if not ascending or theta_i[0] < 0 or theta_i[-1] > np.pi / 2 + ROUNDING:
        raise NpfmError(f"{path}: 'theta_i' and 'phi_i' are no ascending angles of a hemisphere")
    if len(phi_i) > MOST_ISOTROPIC and not _symmetry(phi_i):
        raise NpfmError(
            f"{path}: 'phi_i' goes from {np.degrees(phi_i[0]):.1f} to "
            f"{np.degrees(phi_i[-1]):.1f} degrees; known are -180 to 180, to 0 and to -90"
        )
    if min(arrays["ndf"].min(), vndf.min()) < 0 or arrays["sigma"].min() <= 0:
        raise NpfmError(f"{path}: 'ndf', 'vndf' or 'sigma' have values that no density has")
    # What counts is the area of the patches: a density at one corner alone has some.
    if not (vndf.sum(axis=(-2, -1)) > 0).all():
        raise NpfmError(f"{path}: 'vndf' is 0 for a whole direction of the light")


def _symmetry(phi_i: Array) -> int:
    """Parts of a turn that azimuths stand for: one of `SYMMETRIES`, or 0."""
    if abs(phi_i[0] + np.pi) > ROUNDING:
        return 0
    spans = {parts: 2 * np.pi / parts for parts in SYMMETRIES}
    covered = phi_i[-1] - phi_i[0]
    return next((parts for parts, span in spans.items() if abs(covered - span) < ROUNDING), 0)


def _spherical(vectors: Array) -> tuple[Array, Array]:
    """Angle with the normal and azimuth in [-pi, pi] of vectors (n, 3) of any length."""
    x, y, z = vectors.T
    return np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)


def _on_square(theta: Array, phi: Array) -> tuple[Array, Array]:
    """Directions on the unit square: x = sqrt(2 theta / pi), y = (phi + pi) / 2 pi modulo 1."""
    y = (phi + np.pi) / (2 * np.pi)
    return np.sqrt(theta * (2 / np.pi)), y - np.floor(y)


def _sampled(values: Array, x: Array, y: Array) -> Array:
    return bilinear(values, between(np.zeros(1), x), x, y)
