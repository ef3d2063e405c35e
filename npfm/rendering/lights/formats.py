"""Light probes in the formats they are published in, converted to latitude-longitude maps."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, map_coordinates

from npfm.errors import NpfmError, suggest
from npfm.rendering.lights.environment import Environment, tabulate
from npfm.storage.pictures import read_radiance

#: Faces of a vertical cross: its row and column in the cross, the axis it looks along and the
#: sign on it, and the axes and signs of "right" and "up" in the stored face. The back face is
#: stored upside down, as if the cross were rolled on from the bottom face.
CROSS_FACES = (
    # row, column, (axis, sign), right, up
    (0, 1, (1, +1), (0, +1), (2, +1)),  # top, +y
    (1, 0, (0, -1), (2, -1), (1, +1)),  # left, -x
    (1, 1, (2, -1), (0, +1), (1, +1)),  # front, -z
    (1, 2, (0, +1), (2, +1), (1, +1)),  # right, +x
    (2, 1, (1, -1), (0, +1), (2, -1)),  # bottom, -y
    (3, 1, (2, +1), (0, +1), (1, -1)),  # back, +z
)

Shape = tuple[int, int]
Position = tuple[NDArray, NDArray]


@dataclass(frozen=True)
class Layout:
    """How the sphere of directions lies in a picture.

    Parameters
    ----------
    aspect : tuple of int
        Width and height in the smallest whole numbers.
    holds_data : callable
        Maps the picture's (rows, columns) to a mask of the pixels that are data.
    position : callable
        Maps unit vectors (n, 3) and (rows, columns) to rows and columns, where pixel (i, j) has
        its centre at exactly (i, j), and beyond the last pixel comes the first.
    """

    aspect: tuple[int, int]
    holds_data: Callable[[Shape], NDArray[np.bool_]]
    position: Callable[[NDArray, Shape], Position]


def load_probe(path: str | Path, layout: str, height: int) -> Environment:
    """Read a light probe and convert it to a latitude-longitude map.

    Each texel is the mean of at least 4 x 4 bilinear look-ups in the probe, no farther apart than
    its pixels, so that small brilliant windows keep their energy.

    Parameters
    ----------
    path : str or Path
        A Radiance ``.hdr`` or OpenEXR file.
    layout : {"angular-map", "vertical-cross", "lat-long"}
        How the sphere lies in the picture. Angular map: the centre looks along -z, the distance
        from the centre is proportional to the angle, the rim looks along +z, and what lies
        outside the rim is never read (Debevec, "Light Probe Image Gallery", 1998). Vertical
        cross: six faces, 3 wide and 4 high. Lat-long: as in `npfm.rendering.lights.environment`.
    height : int
        Rows of the map; it has twice as many columns.

    Returns
    -------
    Environment
        The light, in the units of the file.

    Raises
    ------
    NpfmError
        If the layout is unknown, or the file is absent, is not a picture of radiance, has not
        the proportions of its layout, or has negative, infinite, NaN or only black pixels.
    """
    if layout not in LAYOUTS:
        raise NpfmError(
            f"{path}: unknown layout '{layout}' of a light probe; {suggest(str(layout), LAYOUTS)}"
        )
    pixels = read_radiance(path)[..., :3]
    shape = pixels.shape[:2]
    _check_proportions(path, layout, shape)
    known = LAYOUTS[layout].holds_data(shape)
    _check_values(path, pixels[known])
    if layout == "lat-long" and shape[0] == height:
        return Environment(pixels.astype(np.float64))
    filled = np.moveaxis(_filled(pixels, known), -1, 0)

    def radiance(direction: NDArray) -> NDArray:
        position = LAYOUTS[layout].position(direction, shape)
        looked_up = [
            map_coordinates(plane, position, order=1, mode="grid-wrap") for plane in filled
        ]
        return np.stack(looked_up, axis=-1)

    subsamples = max(4, -(-shape[0] // height))
    return Environment(tabulate(radiance, height, subsamples))


def _check_proportions(path: str | Path, layout: str, shape: Shape) -> None:
    rows, columns = shape
    wide, high = LAYOUTS[layout].aspect
    if columns * high != rows * wide or columns % wide:
        raise NpfmError(
            f"{path}: {columns} x {rows} pixels, but the width and height of the layout {layout} "
            f"are as {wide} to {high}; crop the picture or give the layout it has"
        )


def _check_values(path: str | Path, values: NDArray) -> None:
    if wrong := np.count_nonzero(~np.isfinite(values)):
        raise NpfmError(f"{path}: {wrong} values are NaN or infinite; repair the light probe")
    if wrong := np.count_nonzero(values < 0):
        raise NpfmError(f"{path}: {wrong} values are negative; clamp the light probe at zero")
    if not values.any():
        raise NpfmError(f"{path}: every pixel is black; give a light probe with light in it")


def _filled(pixels: NDArray, known: NDArray[np.bool_]) -> NDArray:
    """Replace what is not data by the nearest data, so that no look-up can mix it in."""
    if known.all():
        return pixels
    nearest = distance_transform_edt(~known, return_distances=False, return_indices=True)
    return pixels[tuple(nearest)]


def _all(shape: Shape) -> NDArray[np.bool_]:
    return np.ones(shape, dtype=bool)


def _disc(shape: Shape) -> NDArray[np.bool_]:
    # A pixel is data where the whole of it lies inside the rim: those that the rim crosses are
    # darkened by what lies outside.
    farthest = [(np.abs(2 * np.arange(n) + 1 - n) + 1) / n for n in shape]
    return np.hypot(*np.meshgrid(*farthest, indexing="ij")) <= 1


def _faces(shape: Shape) -> NDArray[np.bool_]:
    size = shape[1] // 3
    known = np.zeros(shape, dtype=bool)
    for row, column, *_ in CROSS_FACES:
        known[row * size : (row + 1) * size, column * size : (column + 1) * size] = True
    return known


def _in_angular_map(direction: NDArray, shape: Shape) -> Position:
    x, y, z = direction.T
    across = np.hypot(x, y)
    # Straight ahead and straight back have no azimuth, and any will do.
    scale = np.arctan2(across, -z) / (np.pi * np.maximum(across, 1e-12))
    size = shape[0]
    row, column = ((1 + fraction) * (size / 2) - 0.5 for fraction in (-y * scale, x * scale))
    return np.clip(row, 0, size - 1), np.clip(column, 0, size - 1)


def _in_vertical_cross(direction: NDArray, shape: Shape) -> Position:
    size = shape[1] // 3
    largest = np.abs(direction).argmax(axis=1)
    position = np.empty((2, len(direction)))
    for row, column, (axis, sign), right, up in CROSS_FACES:
        (here,) = np.nonzero((largest == axis) & (direction[:, axis] * sign > 0))
        inside = direction[here]
        depth = np.abs(inside[:, axis])
        for k, corner, fraction in (
            (0, row, -up[1] * inside[:, up[0]] / depth),
            (1, column, right[1] * inside[:, right[0]] / depth),
        ):
            # Faces that meet in the picture need not meet on the sphere: stay within this one.
            within = np.clip((1 + fraction) * (size / 2) - 0.5, 0, size - 1)
            position[k, here] = corner * size + within
    return position[0], position[1]


def _in_lat_long(direction: NDArray, shape: Shape) -> Position:
    x, y, z = direction.T
    rows, columns = shape
    row = np.arccos(np.clip(y, -1, 1)) * (rows / np.pi) - 0.5
    return np.clip(row, 0, rows - 1), (np.arctan2(x, -z) / (2 * np.pi) + 0.5) * columns - 0.5


LAYOUTS = {
    "angular-map": Layout((1, 1), _disc, _in_angular_map),
    "vertical-cross": Layout((3, 4), _faces, _in_vertical_cross),
    "lat-long": Layout((2, 1), _all, _in_lat_long),
}
