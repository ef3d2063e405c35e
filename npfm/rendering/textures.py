"""A material that varies over an object: per pixel, a mixture of a few tables by a texture."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from npfm.errors import NpfmError
from npfm.reflectance.table import Table
from npfm.rendering.geometry import Shape, nearest
from npfm.rendering.scenes import CAMERA
from npfm.rendering.transport import Transport, render
from npfm.storage.pictures import read_bands

Array = NDArray[np.float64]

#: Rows and columns of the project's own texture, and blotches along its columns.
OWN_SIZE, OWN_BLOTCHES = (128, 256), 6
#: Materials that a texture of weights chooses between, and how often the project's own has each of
#: them around.
COUNT, OWN_TURNS = 4, 3


def own_texture() -> Array:
    """Blotches with soft rims, as wear leaves them: values from 0 to 1, the same on every machine.

    Returns
    -------
    ndarray, shape OWN_SIZE
        Without a seam from the last column to the first.
    """
    v, u = ((np.arange(n) + 0.5) / n for n in OWN_SIZE)
    u, v = 2 * np.pi * u, np.pi * v[:, None]
    waves = np.sin(OWN_BLOTCHES * u + 2 * np.sin(3 * v)) * np.sin(OWN_BLOTCHES * v)
    fine = np.sin(17 * u + 5 * np.cos(4 * v)) * np.cos(13 * v)
    return 1 / (1 + np.exp(-8 * (waves + 0.4 * fine)))


def own_weights() -> Array:
    """Wavy stripes of four materials with soft rims, the same on every machine.

    Returns
    -------
    ndarray, shape (*OWN_SIZE, COUNT)
        Weights of the materials at each texel, adding up to 1. Beside the stripe of a material are
        those of its neighbours in the list, which is closed to a ring; `OWN_TURNS` times around.
    """
    v, u = ((np.arange(n) + 0.5) / n for n in OWN_SIZE)
    place = COUNT * (OWN_TURNS * u + 0.15 * np.sin(4 * np.pi * v[:, None]))
    away = np.abs((place[..., None] - np.arange(COUNT) + COUNT / 2) % COUNT - COUNT / 2)
    return np.clip(1.5 - 2 * away, 0, 1)


def weights_of(bands: NDArray) -> Array:
    """Read a picture as the weights of four materials.

    Parameters
    ----------
    bands : ndarray, shape (rows, columns, 1, 3 or 4)
        From 0 to 1. Of four bands each is the weight of a material. Of three too, and the last
        material has what they leave of 1. A single one goes from the first material at 0 to the
        last at 1, by way of those between.

    Returns
    -------
    ndarray, shape (rows, columns, COUNT)
        Adding up to 1.

    Raises
    ------
    NpfmError
        If a texel has no weight at all.
    """
    if bands.shape[-1] == 1:
        return _between(bands[..., 0], COUNT)
    if bands.shape[-1] == COUNT - 1:
        rest = np.maximum(1 - bands.sum(axis=-1, keepdims=True), 0)
        bands = np.concatenate([bands, rest], axis=-1)
    total = bands.sum(axis=-1, keepdims=True)
    if not total.all():
        row, column = np.argwhere(total[..., 0] == 0)[0]
        raise NpfmError(
            f"no material at column {column}, row {row}; give one of the four bands a value there"
        )
    return bands / total


def read_weights(path: str | Path) -> Array:
    """Read the `weights_of` a PNG picture.

    Raises
    ------
    NpfmError
        If the file is absent, is no such picture, or is too large; or as `weights_of`.
    """
    bands = read_bands(path)
    try:
        return weights_of(bands)
    except NpfmError as error:
        raise NpfmError(f"{path}: {error}") from error


def coordinates(objects: Sequence[Shape], resolution: int) -> Array:
    """Where a texture lies on what the camera sees at the middle of each pixel.

    The texture is wrapped around the y axis through the origin, its first row at the top: v runs
    with the angle from that axis, u with the azimuth around it.

    Returns
    -------
    ndarray, shape (resolution, resolution, 2)
        u and v in [0, 1); NaN where there is no object.
    """
    middle = np.full((1, 2), 0.5)
    direction = CAMERA.directions(np.arange(resolution**2), middle, resolution).reshape(-1, 3)
    distance = nearest(objects, np.broadcast_to(CAMERA.position, direction.shape), direction)[0]
    hit = np.isfinite(distance)
    x, y, z = (CAMERA.position + np.where(hit, distance, 0.0)[:, None] * direction).T
    u = np.arctan2(x, z) / (2 * np.pi) % 1
    v = np.arctan2(np.hypot(x, z), y) / np.pi
    wrapped = np.stack([u, np.minimum(v, np.nextafter(1, 0))], axis=-1)
    return np.where(hit[:, None], wrapped, np.nan).reshape(resolution, resolution, 2)


def shares(texture: NDArray, places: NDArray, count: int) -> Array:
    """Share of each of some tables at each pixel: 0 in the texture is the first, 1 the last.

    Parameters
    ----------
    texture : ndarray, shape (rows, columns)
        Values from 0 to 1; the nearest one counts.
    places : ndarray, shape (h, w, 2)
        As `coordinates` gives them.
    count : int
        Number of tables.

    Returns
    -------
    ndarray, shape (count, h, w)
        Between two neighbours, adding up to 1; where there is no object, as in `shares_of_weights`.
    """
    return shares_of_weights(_between(texture, count), places)


def shares_of_weights(weights: NDArray, places: NDArray) -> Array:
    """Share of each of some materials at each pixel, by the weights of the nearest texel.

    Parameters
    ----------
    weights : ndarray, shape (rows, columns, count)
        As `own_weights` and `weights_of` give them.
    places : ndarray, shape (h, w, 2)
        As `coordinates` gives them.

    Returns
    -------
    ndarray, shape (count, h, w)
        Where there is no object, as at the nearest pixel with one: objects that miss the middle of
        a pixel may cover a part of it.
    """
    u, v = np.moveaxis(_filled(places), -1, 0)
    rows, columns, _ = weights.shape
    found = weights[(v * rows).astype(int), (u * columns).astype(int)]
    return np.moveaxis(found, -1, 0)


def _filled(places: NDArray) -> Array:
    """Places without a gap: there, those of the nearest pixel that has one, and 0 if none has."""
    gaps = np.isnan(places[..., 0])
    beside = distance_transform_edt(gaps, return_distances=False, return_indices=True)
    return np.nan_to_num(places[tuple(beside)])


def _between(value: NDArray, count: int) -> Array:
    """Weights of neighbours on a new last axis of length `count`, for values from 0 to 1."""
    return np.maximum(1 - np.abs(value[..., None] * (count - 1) - np.arange(count)), 0.0)


def render_varying(matrix: Transport, tables: Sequence[Table], parts: NDArray) -> Array:
    """Picture of a material whose table differs from pixel to pixel.

    Parameters
    ----------
    matrix : Transport
        Scene and light; nothing in it knows of the texture.
    tables : sequence of Table
    parts : ndarray, shape (tables, h, w)
        As `shares` gives them.

    Returns
    -------
    ndarray, shape (h, w, 4)
        As `npfm.rendering.transport.render`.
    """
    pictures = (render(matrix, table) for table in tables)
    return sum(part[..., None] * picture for part, picture in zip(parts, pictures, strict=True))
