"""A wood with gaps of sky in the leaves and dappled ground, after the Eucalyptus Grove."""

from collections.abc import Callable
from functools import partial

import numpy as np

from npfm.rendering.lights.places.shapes import Array, Mask, noise, pillar

EYE = np.zeros(3)
GROUND = -1.6
#: Towards the sun, behind the trees.
SUN = np.array([0.56, 0.47, -0.68])
SUN /= np.linalg.norm(SUN)
#: Rings of leaves around (radius) and layers of leaves overhead (height), from near to far.
LEAVES = (("ring", 9), ("layer", 4.5), ("ring", 14), ("layer", 6.5), ("ring", 22), ("layer", 9.5))
TRUNKS = 34
BARK = np.array([0.30, 0.25, 0.20])
LEAF = np.array([0.13, 0.16, 0.055])
LITTER = np.array([0.40, 0.25, 0.13])
MIST = np.array([0.55, 0.60, 0.58])
#: Which of some directions meet a part of the wood, and its colour where they do.
Part = Callable[[Array], tuple[Mask, Array]]


def radiance(direction: Array) -> Array:
    """Radiance from unit vectors of shape (n, 3), in the units of the Eucalyptus Grove probe."""
    result = np.empty_like(direction)
    free = np.arange(len(direction))
    leaves: list[Part] = [partial(_leaves, 100 + 10 * k, *place) for k, place in enumerate(LEAVES)]
    for part in [_trunks, _ground, *leaves, _sky]:
        seen, colour = part(direction[free])
        result[free[seen]] = colour
        free = free[~seen]
    return result


def _towards_sun(direction: Array, width: float) -> Array:
    return np.exp((direction @ SUN - 1) / width)


def _sky(direction: Array) -> tuple[Mask, Array]:
    veil = noise(direction * (4, 9, 4), 91, 4)[:, None]
    blue = np.array([3.4, 5.4, 8.4]) + np.array([8.6, 7.0, 4.6]) * veil
    blue = blue * (1.2 - 0.6 * np.maximum(direction[:, 1], 0))[:, None]
    glow = _towards_sun(direction, 0.10)[:, None] * (15.0, 13.0, 10.0)
    disc = _towards_sun(direction, 0.0025)[:, None] * (260.0, 225.0, 170.0)
    # Far trees in the mist close the view.
    around = direction * (1, 0, 1)
    top = 0.05 + 0.3 * noise(around * 7, 95, 5) * noise(around * 2, 97)
    depth = np.clip((top - direction[:, 1]) / 0.15, 0, 1)[:, None]
    trees = MIST * (1.1 - 0.8 * depth) * (0.6 + 0.8 * noise(direction * 40, 98, 2))[:, None]
    sky = np.where(depth > 0, trees, blue + glow + disc)
    return np.ones(len(direction), dtype=bool), sky


def _leaves(seed: int, kind: str, size: float, direction: Array) -> tuple[Mask, Array]:
    """Leaves of a ring or a layer: in the shade of others, or bright before the sun."""
    reach = np.hypot(direction[:, 0], direction[:, 2]) if kind == "ring" else direction[:, 1]
    points = direction * (size / np.maximum(reach, 0.1))[:, None]
    cover = 0.5 * noise(points * 0.35, seed) + 0.5 * noise(points * 2.2, seed + 1, 4)
    if kind == "ring":
        height = points[:, 1] - GROUND
        bushes = 0.66 - 0.5 * np.exp(-np.maximum(height, 0) / (0.11 * size))
        threshold = np.minimum(bushes, 0.66 - 0.085 * np.clip((height - 3) / 5, 0, 1))
    else:
        threshold = np.array(0.565)
    seen = (reach > 0.1) & (cover > threshold)
    points, direction = points[seen], direction[seen]
    tone = 2.2 * noise(points * 6, seed + 5, 2) ** 2 + 0.12
    through = 1 + 6 * _towards_sun(direction, 0.12) + 0.9 * np.maximum(direction @ SUN, 0)
    warmth = 0.6 + 0.8 * noise(points * 0.5, seed + 8)[:, None]
    return seen, (tone * through)[:, None] * LEAF * warmth ** (1, 0, -1)


def _ground(direction: Array) -> tuple[Mask, Array]:
    seen = direction[:, 1] < -0.01
    points = direction[seen] * (GROUND / direction[seen, 1])[:, None]
    leaves = noise(points * (9, 1, 14), 201, 4) * noise(points * (17, 1, 9), 205, 3)
    litter = 0.15 + 6 * leaves**1.5 * (0.5 + noise(points * 0.9, 206, 2))
    grass = np.clip(6 * noise(points * 0.35, 207, 2) - 3.2, 0, 1)[:, None]
    albedo = litter[:, None] * ((1 - grass) * LITTER + grass * (0.17, 0.24, 0.08))
    # Rounds of sun, drawn out towards it, with the leaves' shadows in them.
    patches = noise(points * (0.5, 1, 0.4), 209) * (0.2 + 0.8 * noise(points * (5, 1, 4), 213, 3))
    spots = np.clip(12 * (patches - 0.42), 0, 1)[:, None]
    light = albedo * (np.array([0.78, 0.82, 0.9]) + spots * (6.0, 4.6, 2.6))
    haze = 1 - np.exp(-np.linalg.norm(points, axis=1) / 60)[:, None]
    return seen, light * (1 - haze) + haze * MIST


def _trunks(direction: Array) -> tuple[Mask, Array]:
    rng = np.random.default_rng(301)
    reach = 2.8 * (32 / 2.8) ** np.sqrt(rng.random(TRUNKS))
    turn = 2 * np.pi * (np.arange(TRUNKS) * 0.618034 + 0.02 * rng.random(TRUNKS))
    radius = 0.12 + 0.28 * rng.random(TRUNKS)
    lean = 0.12 * (rng.random((TRUNKS, 2)) - 0.5)
    places = reach[:, None] * np.stack([np.sin(turn), -np.cos(turn)], axis=1)
    nearest, colour = np.full(len(direction), np.inf), np.empty_like(direction)
    flat = np.hypot(direction[:, 0], direction[:, 2])
    for k, place in enumerate(places):
        width = np.cos(min(np.pi, (1.3 * radius[k] + 0.8) / reach[k]))
        (near,) = np.nonzero(direction[:, [0, 2]] @ place > width * reach[k] * flat)
        # A leaning trunk is an upright one for rays that lean the other way.
        sheared = direction[near]
        sheared[:, [0, 2]] -= sheared[:, 1:2] * lean[k]
        distance, normal = pillar(EYE, sheared, place[0], place[1], radius[k])
        (hit,) = np.nonzero(distance < nearest[near])
        points = direction[near[hit]] * distance[hit, None]
        height = points[:, 1]
        tattered = 3 * (noise(points * 3.5, 303, 4) - 0.5) + 0.5
        bare = (height > GROUND) & (height < 4 + 9 * tattered)
        hit, points = hit[bare], points[bare]
        nearest[near[hit]] = distance[hit]
        colour[near[hit]] = _bark(points, normal[hit], k)
    seen = np.isfinite(nearest)
    return seen, colour[seen]


def _bark(points: Array, normal: Array, seed: int) -> Array:
    furrows = 0.3 + 1.1 * noise(points * (16, 1.6, 16) + seed, 311, 3) ** 1.5
    peeling = np.where(noise(points * (4, 0.8, 4) + seed, 317, 2) > 0.6, 1.7, 0.9)
    sky = 0.6 + 0.3 * normal[:, 0]
    rim = np.maximum(normal @ SUN, 0) ** 2
    light = sky[:, None] * (0.62, 0.68, 0.78) + rim[:, None] * (7.0, 5.2, 3.0)
    haze = 1 - np.exp(-np.linalg.norm(points, axis=1) / 45)[:, None]
    return (furrows * peeling)[:, None] * BARK * light * (1 - haze) + haze * MIST
