"""A warm room of blocks and wood with large windows, after the Ennis house."""

import numpy as np

from npfm.rendering.lights.places.shapes import (
    Array,
    Hit,
    lit,
    noise,
    on_floor,
    repeat,
    round_arch,
    vault,
)

EYE = np.array([0.6, 0.0, 0.8])
FLOOR, HALF_WIDTH, SPRING, ENDS = -1.5, 4.2, 1.1, (-5.2, 4.6)
BLOCK = 0.45
CONCRETE = np.array([0.50, 0.36, 0.22])
WOOD = np.array([0.36, 0.13, 0.03])
SKY = np.array([46.0, 48.0, 52.0])
#: What the windows, the lamp on the shelf and the fire throw on the room: position, and light
#: cast at a distance of 1.
LAMPS = np.array(
    [
        [0.0, 0.6, -5.0, 11.0, 10.0, 9.0],
        [4.0, 0.3, -1.6, 3.6, 3.3, 3.0],
        [4.0, 0.3, 1.8, 3.0, 2.7, 2.5],
        [-3.9, -1.0, 0.2, 1.6, 0.55, 0.12],
        [-1.2, 0.9, 4.0, 1.0, 0.65, 0.3],
    ]
)
AMBIENT = np.array([0.06, 0.042, 0.028])


def radiance(direction: Array) -> Array:
    """Radiance from unit vectors of shape (n, 3), in the units of the Ennis probe."""
    return on_floor(EYE, direction, FLOOR, _room, _paint, _floor)


def _room(eye: Array, direction: Array) -> Hit:
    return vault(eye, direction, HALF_WIDTH, SPRING, ENDS)


def _floor(points: Array) -> tuple[Array, Array, Array]:
    x, _, z = points.T
    plank = np.floor(x / 0.14)
    board = np.stack([plank, np.floor(z / 1.7 + 0.37 * plank), 0 * x], axis=1)
    tone = 0.55 + 0.9 * noise(board * 7.3 + 0.5, 41)
    tone *= 0.8 + 0.4 * noise(points * (30, 1, 2), 43, 2)
    tone *= np.where(np.abs(repeat(x, 0.14)) > 0.066, 0.5, 1)
    rug = (np.abs(x - 0.4) < 1.3) & (np.abs(z + 1.2) < 1.9)
    albedo = tone[:, None] * WOOD * 1.3
    albedo[rug] = _rug(x[rug] - 0.4, z[rug] + 1.2)
    up = np.broadcast_to([0.0, 1.0, 0.0], points.shape)
    tilt = np.stack([noise(points * (8, 1, 2), s) - 0.5 for s in (45, 46, 47)], axis=1)
    return albedo * lit(points, up, AMBIENT, LAMPS), 1.0 - rug, 0.05 * tilt


def _rug(x: Array, z: Array) -> Array:
    edge = np.minimum(1.3 - np.abs(x), 1.9 - np.abs(z))
    diamonds = (np.floor((x + z) / 0.25) + np.floor((x - z) / 0.25)) % 2
    field = np.where(diamonds[:, None] > 0, (0.36, 0.05, 0.04), (0.25, 0.16, 0.09))
    band = (edge < 0.22) & (edge > 0.1)
    return np.where(band[:, None], (0.5, 0.42, 0.28), field)


def _paint(eye: Array, direction: Array, hit: Hit) -> Array:
    distance, normal = hit
    points = eye + distance[:, None] * direction
    front, back = normal[:, 2] > 0.5, normal[:, 2] < -0.5
    ceiling = (points[:, 1] > SPRING) & ~front & ~back
    right, left = (~ceiling & (normal[:, 0] < -0.5)), (~ceiling & (normal[:, 0] > 0.5))
    along = np.where(front | back, points[:, 0], points[:, 2])
    albedo = _blocks(points, along, points[:, 1] - FLOOR)
    albedo[ceiling] = _beams(points[ceiling])
    result = albedo * lit(points, normal, AMBIENT, LAMPS)
    for wall, dress in ((front, _window), (right, _side_windows), (back, _shelf), (left, _hearth)):
        result[wall] = dress(points[wall], direction[wall], result[wall])
    return result


def _blocks(points: Array, along: Array, height: Array) -> Array:
    """Cast blocks; the rows at the frieze and some others carry a relief of nested squares."""
    u, v = repeat(along, BLOCK) / BLOCK, repeat(height, BLOCK) / BLOCK
    row = np.floor(height / BLOCK)
    nested = np.maximum(np.abs(u), np.abs(v))
    relief = np.where((row % 6 == 5) & (np.mod(nested * 8, 1) > 0.5), 0.6, 1.0)
    joint = np.where(nested > 0.475, 0.55, 1.0)
    grain = 0.7 + 0.6 * noise(points * 2.5, 51, 4)
    return (relief * joint * grain)[:, None] * CONCRETE


def _beams(points: Array) -> Array:
    x, y, z = points.T
    turn = np.arctan2(x, y - SPRING)
    beam = np.abs(repeat(z + 0.3, 1.4)) < 0.16
    purlin = np.abs(repeat(turn, np.pi / 7)) < 0.035
    boards = 0.5 + 0.3 * (np.abs(repeat(turn * HALF_WIDTH, 0.2)) < 0.09)
    tone = np.where(beam, 1.5, np.where(purlin, 1.2, boards))
    return (tone * (0.6 + 0.8 * noise(points * (8, 8, 1.5), 53, 3)))[:, None] * WOOD


def _view(direction: Array) -> Array:
    """Bright hazy sky over hills with trees and houses."""
    up, turn = direction[:, 1], np.arctan2(direction[:, 0], -direction[:, 2])
    around = np.stack([6 * turn, 9 * up, 0 * up], axis=1)
    hills = -0.02 + 0.12 * noise(around * (1, 0, 0) + 3, 61, 4)
    haze = np.exp(-np.maximum(hills - up, 0) * 7)[:, None]
    trees = (0.4 + 1.6 * noise(around * 12, 63, 3) ** 2)[:, None] * (0.9, 1.25, 0.5)
    houses = (noise(np.floor(around * (14, 20, 1)) * 5.7, 65) > 0.8)[:, None]
    land = np.where(houses, (4.0, 3.3, 2.8), trees) * (1 - 0.6 * haze) + 3.5 * haze
    glow = 1 + 0.8 * np.exp(-((turn - 0.25) ** 2 + (up - 0.45) ** 2) / 0.05)
    sky = SKY * (glow * (0.8 + 0.4 * noise(around * (0.7, 2, 1), 67, 4)))[:, None]
    return np.where((up > hills)[:, None], sky, land)


def _window(points: Array, direction: Array, wall: Array) -> Array:
    x, height = points[:, 0], points[:, 1] - FLOOR
    middle = round_arch(x, height - 0.15, 0.95, 3.6)
    sides = (np.abs(np.abs(x) - 1.55) < 0.4) & (np.abs(height - 1.9) < 1.7)
    frame = (np.abs(repeat(x + 0.475, 0.95)) > 0.435) | (np.abs(repeat(height, 0.75)) > 0.345)
    frame &= middle | (np.abs(repeat(x, 0.4)) > 0.17) | (np.abs(repeat(height, 0.75)) > 0.345)
    opening = (middle | sides)[:, None]
    leading = frame[:, None]
    return np.where(opening, np.where(leading, 0.4 * wall, _view(direction)), wall)


def _side_windows(points: Array, direction: Array, wall: Array) -> Array:
    z, height = points[:, 2], points[:, 1] - FLOOR
    along = np.minimum(np.abs(z + 1.6), np.abs(z - 1.8))
    opening = (along < 0.75) & (np.abs(height - 1.45) < 0.75)
    bars = (np.abs(along - 0.25) < 0.025) | (np.abs(height - 1.7) < 0.025) | (along > 0.7)
    seen = np.where(bars[:, None], 0.3 * wall, 0.8 * _view(direction[:, [2, 1, 0]]))
    return np.where(opening[:, None], seen, wall)


def _shelf(points: Array, direction: Array, wall: Array) -> Array:
    x, height = points[:, 0], points[:, 1] - FLOOR
    case = (np.abs(x + 0.2) < 2.2) & (height < 2.7)
    volume = np.floor(x / 0.045)
    book = np.stack([volume, np.floor(height / 0.45), 0 * x], axis=1) * 3.7 + 0.5
    tall = np.mod(height, 0.45) < 0.22 + 0.16 * noise(book, 71)
    hue = np.stack([noise(book, s) for s in (72, 73, 74)], axis=1) ** 2
    books = 1.6 * wall * np.where(tall[:, None], hue * (2.2, 1.3, 0.9), 0.12)
    boards = (np.mod(height, 0.45) > 0.415) | (np.abs(repeat(x, 1.1)) > 0.53)
    lamp = np.hypot(x + 1.2, height - 2.95) < 0.14
    result = np.where(case[:, None], np.where(boards[:, None], 0.6 * wall, books), wall)
    return np.where(lamp[:, None], (9.0, 6.0, 3.0), result)


def _hearth(points: Array, direction: Array, wall: Array) -> Array:
    z, height = points[:, 2] - 0.2, points[:, 1] - FLOOR
    surround = (np.abs(z) < 1.1) & (height < 1.5)
    opening = (np.abs(z) < 0.7) & (height < 1.0)
    tongues = noise(points * (1, 3, 9), 77, 3) - height / (0.75 - 0.5 * np.abs(z))
    fire = np.clip(4 * tongues, 0, 1)[:, None] ** 2 * (7.0, 2.2, 0.35)
    result = np.where(surround[:, None], 0.55 * wall, wall)
    return np.where(opening[:, None], 0.08 * wall + fire, result)
