"""A material that varies over an object: per pixel, a mixture of a few tables by a texture."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.table import Table
from npfm.rendering.geometry import Shape, nearest
from npfm.rendering.scenes import CAMERA
from npfm.rendering.transport import Transport, render

Array = NDArray[np.float64]

#: Rows and columns of the project's own texture, and blotches along its columns.
OWN_SIZE, OWN_BLOTCHES = (128, 256), 6


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
        Between two neighbours, adding up to 1. Where there is no object all is of the first.
    """
    u, v = np.moveaxis(np.nan_to_num(places), -1, 0)
    rows, columns = texture.shape
    value = texture[(v * rows).astype(int), (u * columns).astype(int)]
    value = np.where(np.isnan(places[..., 0]), 0.0, value) * (count - 1)
    return np.maximum(1 - np.abs(value - np.arange(count)[:, None, None]), 0.0)


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
