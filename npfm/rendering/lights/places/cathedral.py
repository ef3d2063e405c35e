"""A dark nave with small brilliant windows and lamps, after Grace Cathedral."""

import numpy as np

from npfm.rendering.lights.places.shapes import (
    Array,
    Hit,
    Mask,
    bulbs,
    lit,
    noise,
    on_floor,
    pointed_arch,
    repeat,
    vault,
)

EYE = np.array([-1.3, 0.0, 0.0])
FLOOR, HALF_WIDTH, SPRING, ENDS, BAY = -1.6, 6.0, 11.0, (-34.0, 11.0), 6.0
STONE = np.array([0.34, 0.28, 0.25])
GLASS = np.array([[2.0, 3.0, 9.0], [7.0, 8.0, 14.0], [12.0, 6.0, 4.0], [14.0, 15.0, 20.0]])
#: Hanging lamps and, last, the candles of the altar: position, and light cast at a distance of 1.
LAMPS = np.array(
    [[x, 3.2, z, 2.6, 1.5, 0.7] for z in (-21.0, -12.0, -4.5, 5.0) for x in (-4.3, 4.3)]
    + [[x, 1.2, -31.0, 2.6, 1.7, 0.9] for x in (-2.0, -1.2, 1.2, 2.0)]
)
BULB_RADIUS = 0.06
#: Light that the windows throw on the walls across.
SKYLIGHT = np.array(
    [[5.0, 9.0, z, 2.6, 2.8, 4.2] for z in (-9.0, -3.0, 3.0)] + [[0.0, 7.0, 10.0, 2.0, 2.0, 2.8]]
)
AMBIENT = np.array([0.016, 0.014, 0.015])


def radiance(direction: Array) -> Array:
    """Radiance from unit vectors of shape (n, 3), in the units of the Grace probe."""
    return on_floor(EYE, direction, FLOOR, _room, _paint, _floor)


def _light(points: Array, normal: Array) -> Array:
    return lit(points, normal, AMBIENT, np.concatenate([LAMPS, SKYLIGHT]))


def _floor(points: Array) -> tuple[Array, float, Array]:
    x, _, z = points.T
    checks = (np.floor(x / 0.8) + np.floor(z / 0.8)) % 2
    albedo = (0.12 + 0.16 * checks + 0.1 * noise(points * 3, 5, 3))[:, None] * (1, 0.85, 0.75)
    up = np.broadcast_to([0.0, 1.0, 0.0], points.shape)
    albedo[np.abs(x - 0.8) < 0.8] *= (1.4, 0.45, 0.35)
    tilt = np.stack([noise(points * 1.5, s) - 0.5 for s in (11, 12, 13)], axis=1)
    return albedo * _light(points, up), 1.0, 0.03 * tilt


def _room(eye: Array, direction: Array) -> Hit:
    return vault(eye, direction, HALF_WIDTH, SPRING, ENDS)


def _paint(eye: Array, direction: Array, hit: Hit) -> Array:
    distance, normal = hit
    points = eye + distance[:, None] * direction
    height = points[:, 1] - FLOOR
    along = np.where(np.abs(normal[:, 2]) > 0.5, points[:, 0], points[:, 2])
    grain = 0.6 + 0.8 * noise(points * 1.3, 21, 4)
    joints = (np.abs(repeat(height, 0.6)) > 0.28) | (np.abs(repeat(along, 1.2)) > 0.58)
    albedo = (grain * np.where(joints, 0.7, 1))[:, None] * STONE
    shade, glow = np.ones(len(points)), np.zeros_like(points)
    for part, where in (
        (_vaulting, points[:, 1] > SPRING),
        (_side_wall, (points[:, 1] <= SPRING) & (np.abs(normal[:, 0]) > 0.5)),
        (_altar_wall, (points[:, 1] <= SPRING + 9) & (normal[:, 2] > 0.5)),
        (_west_wall, normal[:, 2] < -0.5),
    ):
        shade[where], glow[where] = part(points[where], height[where])
    result = (albedo * shade[:, None]) * _light(points, normal) + glow
    bulb = bulbs(eye, direction, distance, LAMPS, BULB_RADIUS)
    result[bulb >= 0] = 300 * LAMPS[bulb[bulb >= 0], 3:]
    return result


def _glass(points: Array, inside: Mask, brightness: Array | float) -> Array:
    """Leaded panes in four colours."""
    panes = np.floor(points * 2.2) / 2.2
    colour = GLASS[np.clip((noise(panes * 3.1, 31) * 4.8 - 0.4).astype(int), 0, 3)]
    lead = (np.abs(repeat(points[:, 1], 0.45)) > 0.2)[:, None]
    glow = colour * np.where(lead, 0.15, 1) * (0.5 + noise(points * 0.9, 33))[:, None]
    return glow * (inside * brightness)[:, None]


def _vaulting(points: Array, height: Array) -> tuple[Array, Array]:
    turn = np.arctan2(points[:, 0], points[:, 1] - SPRING) / (np.pi / 2)
    bay = repeat(points[:, 2], BAY) / (BAY / 2)
    rib = (
        (np.abs(np.abs(bay) - np.abs(turn)) < 0.045) | (np.abs(bay) > 0.93) | (np.abs(turn) < 0.02)
    )
    hollow = np.abs(np.abs(bay) - np.abs(turn))
    return np.where(rib, 1.5, 0.65 + 0.4 * hollow), np.zeros_like(points)


def _side_wall(points: Array, height: Array) -> tuple[Array, Array]:
    x, _, z = points.T
    bay, small = repeat(z, BAY), repeat(z, 1.5)
    shaft = np.abs(bay) > 2.5
    shade = np.where(shaft, 1.25 * np.sqrt(np.maximum(1 - ((np.abs(bay) - 3) / 0.5) ** 2, 0)), 1.0)
    aisle = pointed_arch(bay, height, 2.15, 3.4)
    shade = np.where(aisle, 0.2, shade)
    shade = np.where(pointed_arch(small, height - 7.6, 0.45, 0.7) & ~shaft, 0.1, shade)
    window = pointed_arch(np.abs(bay) - 1.15, height - 9.4, 0.8, 1.4)
    beyond = pointed_arch(np.abs(bay) - 0.55, height - 2.2, 0.3, 1.0)
    sunny = np.where(x > 0, 2.2, 0.7) * (0.3 + 1.4 * noise(np.floor(points / BAY) * 1.7, 35))
    sunny = np.where(beyond, 0.04, sunny)
    return np.where(window, 0.0, shade), _glass(points, window | beyond, sunny)


def _altar_wall(points: Array, height: Array) -> tuple[Array, Array]:
    x = points[:, 0]
    radius, turn = np.hypot(x, height - 11.5), np.arctan2(x, height - 11.5)
    spokes = np.abs(repeat(turn, np.pi / 6)) < 0.2
    rose = (radius < 3.4) & (spokes | (radius > 2.6) | (radius < 0.7))
    rose &= np.abs(radius - 2.6) > 0.12
    screen = pointed_arch(x, height, 3.2, 2.0)
    gold = (screen * (0.15 + 1.2 * noise(points * 2, 37, 3) ** 3))[:, None] * (2.6, 1.5, 0.5)
    return np.where(rose, 0.0, 1.0), _glass(points, rose, 2.0) + gold


def _west_wall(points: Array, height: Array) -> tuple[Array, Array]:
    x = points[:, 0]
    lancet = pointed_arch(repeat(x + 1.5, 3.0), height - 6.5, 0.7, 4.5) & (np.abs(x) < 4)
    curtain = (np.abs(x - 2.2) < 1.0) & (height < 3.6)
    folds = (0.55 + 0.45 * np.sin(x * 22)) * (0.3 + 0.2 * height)
    red = (curtain * folds)[:, None] * (2.4, 0.5, 0.08)
    return np.where(lancet | curtain, 0.0, 1.0), _glass(points, lancet, 0.8) + red
