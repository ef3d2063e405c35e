"""Rays, patterns, noise and shading for the rooms and woods of the generated lights.

Rays leave one eye point: `eye` has shape (3,), `direction` (n, 3). Lengths are in metres, y is
up. A room is convex and open below; the floor is a mirror plane under all of them, so that a
reflection is what an eye below the floor sees through it.
"""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import map_coordinates

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Hit = tuple[Array, Array]
Triple = tuple[float, float, float]
#: Cells of a noise lattice along an axis, after which the noise repeats.
PERIOD = 48
#: Stands for zero where it would be divided by.
TINY = 1e-9


@cache
def _lattice(seed: int) -> Array:
    return np.random.default_rng(seed).random((PERIOD,) * 3)


def noise(points: Array, seed: int, octaves: int = 1) -> Array:
    """Smooth noise between 0 and 1 that changes over a distance of about 1.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Where; scale them to choose how fine the noise is.
    seed : int
        Another seed gives other noise.
    octaves : int
        How many layers are added, each twice as fine and half as strong as the last.

    Returns
    -------
    ndarray, shape (n,)
        Values with a mean of about 1/2.
    """
    total = np.zeros(len(points))
    for octave in range(octaves):
        scaled = points.T * 2.0**octave
        cell = np.floor(scaled)
        place = scaled - cell
        smooth = cell + place * place * (3 - 2 * place)
        layer = map_coordinates(_lattice(seed + octave), smooth, order=1, mode="grid-wrap")
        total += layer * 0.5**octave
    return total / (2 - 0.5 ** (octaves - 1))


def walls(eye: Array, direction: Array, half_width: float, ends: tuple[float, float]) -> Hit:
    """Where rays leave a hall between x = -half_width, x = half_width and two end walls in z.

    Returns
    -------
    distance : ndarray, shape (n,)
        Distance along the ray.
    normal : ndarray, shape (n, 3)
        Normal of the wall that is hit, pointing inwards.
    """
    dx, dz = (np.where(np.abs(d) < TINY, TINY, d) for d in (direction[:, 0], direction[:, 2]))
    side = (np.sign(dx) * half_width - eye[0]) / dx
    end = (np.where(dz > 0, ends[1], ends[0]) - eye[2]) / dz
    normal = np.zeros_like(direction)
    normal[:, 0] = np.where(side < end, -np.sign(dx), 0)
    normal[:, 2] = np.where(side < end, 0, -np.sign(dz))
    return np.minimum(side, end), normal


def vault(
    eye: Array, direction: Array, half_width: float, spring: float, ends: tuple[float, float]
) -> Hit:
    """Where rays leave a hall as in `walls` under a barrel vault that begins at y = spring."""
    distance, normal = walls(eye, direction, half_width, ends)
    curve = _leaving(eye, direction, (0, spring, 0), (1, 1, 0), half_width)
    return _covered(eye, direction, (distance, normal), curve, spring)


def dome(eye: Array, direction: Array, radius: float, spring: float) -> Hit:
    """Where rays leave a round room about the y axis under a dome that begins at y = spring."""
    wall = _leaving(eye, direction, (0, 0, 0), (1, 0, 1), radius)
    cap = _leaving(eye, direction, (0, spring, 0), (1, 1, 1), radius)
    return _covered(eye, direction, wall, cap, spring)


def pillar(eye: Array, direction: Array, x: float, z: float, radius: float) -> Hit:
    """Where rays meet an endless upright cylinder that the eye is outside of.

    Returns
    -------
    distance : ndarray, shape (n,)
        Distance along the ray, infinite where it misses.
    normal : ndarray, shape (n, 3)
        Outward normal.
    """
    across, offset = direction[:, [0, 2]], eye[[0, 2]] - (x, z)
    a = np.maximum(np.einsum("ij,ij->i", across, across), TINY)
    b, c = across @ offset, offset @ offset - radius**2
    root = b * b - a * c
    met = (root > 0) & (b < 0)
    distance = np.where(met, (-b - np.sqrt(np.where(met, root, 0))) / a, np.inf)
    normal = np.zeros_like(direction)
    reach = np.where(met, distance, 0)
    normal[:, [0, 2]] = (offset + reach[:, None] * across) / radius
    return distance, normal


def _leaving(eye: Array, direction: Array, centre: Triple, axes: Triple, radius: float) -> Hit:
    """Where rays leave a sphere, or a cylinder along the axis whose entry in `axes` is zero."""
    across, offset = direction * axes, (eye - centre) * axes
    a = np.maximum(np.einsum("ij,ij->i", across, across), TINY)
    b, c = across @ offset, offset @ offset - radius**2
    distance = (-b + np.sqrt(np.maximum(b * b - a * c, 0))) / a
    return distance, -(offset + distance[:, None] * across) / radius


def _covered(eye: Array, direction: Array, below: Hit, above: Hit, spring: float) -> Hit:
    """Put a cover over a room where the rays that leave the room do so above its spring."""
    up = (eye[1] + below[0] * direction[:, 1] > spring) & (above[0] < below[0])
    return np.where(up, above[0], below[0]), np.where(up[:, None], above[1], below[1])


def pointed_arch(across: Array, up: Array, half_width: float, spring: float) -> Mask:
    """Points inside an equilateral pointed arch (`up` from its foot, `across` from its middle)."""
    point = np.hypot(np.abs(across) + half_width, up - spring) < 2 * half_width
    return (np.abs(across) < half_width) & (up > 0) & ((up < spring) | point)


def round_arch(across: Array, up: Array, half_width: float, spring: float) -> Mask:
    """Points inside a round arch (`up` from its foot, `across` from its middle)."""
    curve = np.hypot(across, up - spring) < half_width
    return (np.abs(across) < half_width) & (up > 0) & ((up < spring) | curve)


def repeat(along: Array, period: float) -> Array:
    """Distance from the middle of the bay of length `period` that each place lies in."""
    return np.mod(along, period) - period / 2


def lit(points: Array, normal: Array, ambient: ArrayLike, lamps: ArrayLike) -> Array:
    """Light reflected by white matt surfaces under lamps that nothing shadows.

    Parameters
    ----------
    points, normal : ndarray, shape (n, 3)
        The surface.
    ambient : array_like, shape (3,)
        What every surface gets.
    lamps : array_like, shape (k, 6)
        Position and RGB strength: the radiance they cause face on at a distance of 1.

    Returns
    -------
    ndarray, shape (n, 3)
        Linear RGB radiance.
    """
    lamps = np.asarray(lamps, dtype=float)
    place, strength = lamps[:, :3], lamps[:, 3:]
    height = normal @ place.T - np.einsum("ij,ij->i", normal, points)[:, None]
    square = np.einsum("ij,ij->i", points, points)[:, None] - 2 * points @ place.T
    square += np.einsum("ij,ij->i", place, place) + 0.05
    return ambient + (np.maximum(height, 0) / (square * np.sqrt(square))) @ strength


def bulbs(eye: Array, direction: Array, distance: Array, lamps: ArrayLike, radius: float) -> Array:
    """Index of the lamp that each ray sees as a small ball, or -1.

    Parameters
    ----------
    eye, direction : ndarray
        The rays.
    distance : ndarray, shape (n,)
        Where the rays end; lamps behind are hidden.
    lamps : array_like, shape (k, 6)
        As for `lit`.
    radius : float
        Radius of the balls.

    Returns
    -------
    ndarray of int, shape (n,)
        Index into `lamps`.
    """
    seen = np.full(len(direction), -1)
    for index, lamp in enumerate(np.asarray(lamps, dtype=float)):
        towards = lamp[:3] - eye
        along = direction @ towards
        near = towards @ towards - along**2 < radius**2
        seen[near & (along > 0) & (along < distance)] = index
    return seen


def on_floor(
    eye: Array,
    direction: Array,
    level: float,
    room: Callable[[Array, Array], Hit],
    paint: Callable[[Array, Array, Hit], Array],
    floor: Callable[[Array], tuple[Array, Array | float, Array]],
) -> Array:
    """See a room that stands on a polished floor.

    Parameters
    ----------
    eye, direction : ndarray
        The rays.
    level : float
        The floor is the plane y = level.
    room : callable
        Maps eye and direction to the distance (n,) and normal (n, 3) of the room without floor.
    paint : callable
        Maps eye, direction and what `room` gave to the radiance (n, 3) seen there.
    floor : callable
        Maps points of the floor to its matt radiance (n, 3), its polish from 0 to 1 (n,), and
        what unevenness adds to mirrored directions (n, 3).

    Returns
    -------
    ndarray, shape (n, 3)
        Linear RGB radiance.
    """
    hit = room(eye, direction)
    below = eye[1] + hit[0] * direction[:, 1] < level
    radiance = np.empty_like(direction)
    radiance[~below] = paint(eye, direction[~below], (hit[0][~below], hit[1][~below]))
    down = direction[below]
    matt, polish, tilt = floor(eye + ((level - eye[1]) / down[:, 1])[:, None] * down)
    mirrored = down * (1, -1, 1) + tilt
    mirrored /= np.linalg.norm(mirrored, axis=1, keepdims=True)
    under = eye * (1, -1, 1) + (0, 2 * level, 0)
    seen = paint(under, mirrored, room(under, mirrored))
    # Schlick's Fresnel term of a polished stone or lacquer of refractive index 1.5.
    fresnel = 0.04 + 0.96 * (1 + down[:, 1]) ** 5
    radiance[below] = matt + (polish * fresnel)[:, None] * seen
    return radiance
