"""A bright domed crossing of marble with coffered vaults and many lamps, after St. Peter's."""

import numpy as np

from npfm.rendering.lights.places.shapes import (
    Array,
    Hit,
    Mask,
    bulbs,
    dome,
    lit,
    noise,
    on_floor,
    repeat,
    round_arch,
    vault,
)

EYE = np.array([1.2, 0.0, 2.5])
FLOOR = -1.6
#: The arms of the cross and the drum under the dome; every one of them contains the eye, so that
#: a ray ends where it leaves the last of them.
HALF_WIDTH, SPRING = 7.0, 10.0
NAVE_ENDS, TRANSEPT_ENDS = (-19.0, 44.0), (-25.0, 25.0)
DRUM_RADIUS, DOME_SPRING = 8.6, 24.0
MARBLE = np.array([0.66, 0.52, 0.45])
RED, WHITE, GREY = (0.42, 0.20, 0.17), (0.70, 0.60, 0.54), (0.40, 0.36, 0.35)
LAMPS = np.array(
    [[x, 5.5, z, 2.2, 1.6, 1.1] for x in (-5.6, 5.6) for z in (-16, -10, 10, 18, 26, 36)]
    + [[z, 5.5, x, 2.2, 1.6, 1.1] for x in (-5.6, 5.6) for z in (-18, -10, 10, 18)]
)
BULB_RADIUS = 0.07
#: Light of the windows in the drum, in the vaults and at the ends of the arms.
SKYLIGHT = np.array(
    [[x, 17.0, z, 15.0, 15.0, 16.0] for x, z in ((6, 3), (-6, -3), (3, -6), (-3, 6))]
    + [[x, 9.0, z, 24.0, 23.0, 24.0] for x, z in ((22, 0), (-22, 0), (0, 38), (0, -16))]
)
AMBIENT = np.array([0.36, 0.27, 0.235])


def radiance(direction: Array) -> Array:
    """Radiance from unit vectors of shape (n, 3), in the units of the St. Peter's probe."""
    return on_floor(EYE, direction, FLOOR, _room, _paint, _floor)


def _room(eye: Array, direction: Array) -> Hit:
    distance, normal = vault(eye, direction, HALF_WIDTH, SPRING, NAVE_ENDS)
    # The transept is a nave with x and z exchanged.
    reach, turned = vault(eye[::-1], direction[:, ::-1], HALF_WIDTH, SPRING, TRANSEPT_ENDS)
    for far, facing in ((reach, turned[:, ::-1]), dome(eye, direction, DRUM_RADIUS, DOME_SPRING)):
        beyond = far > distance
        distance = np.where(beyond, far, distance)
        normal = np.where(beyond[:, None], facing, normal)
    return distance, normal


def _floor(points: Array) -> tuple[Array, float, Array]:
    x, _, z = points.T
    radius, turn = np.hypot(x, z), np.arctan2(x, z)
    colour = np.where(((np.floor(x / 2.4) + np.floor(z / 2.4)) % 2)[:, None] > 0, WHITE, GREY)
    cell = np.hypot(repeat(x, 2.4), repeat(z, 2.4))
    colour = np.where(((cell < 0.9) & (cell > 0.6))[:, None], RED, colour)
    star = radius * (1 + 0.22 * np.cos(16 * turn))
    for inner, outer, tone in ((0, 6.6, WHITE), (5.9, 6.3, RED), (3.0, 5.2, GREY), (0, 2.6, RED)):
        shape = star if tone == GREY else radius
        colour = np.where(((shape >= inner) & (shape < outer))[:, None], tone, colour)
    veins = 0.75 + 0.5 * noise(points * 0.8 + 2 * noise(points * 2, 401)[:, None], 403, 4)
    up = np.broadcast_to([0.0, 1.0, 0.0], points.shape)
    tilt = np.stack([noise(points * 1.2, s) - 0.5 for s in (405, 406, 407)], axis=1)
    return colour * veins[:, None] * _light(points, up), 1.0, 0.04 * tilt


def _light(points: Array, normal: Array) -> Array:
    return lit(points, normal, AMBIENT, np.concatenate([LAMPS, SKYLIGHT]))


def _paint(eye: Array, direction: Array, hit: Hit) -> Array:
    distance, normal = hit
    points = eye + distance[:, None] * direction
    x, y, z = points.T
    central = np.hypot(x, z) < DRUM_RADIUS + 0.01
    across = np.where(np.abs(normal[:, 2]) > np.abs(normal[:, 0]), x, z)
    albedo = (0.7 + 0.6 * noise(points * 0.9, 411, 4))[:, None] * MARBLE
    glow = np.zeros_like(points)
    cap = central & (y > DOME_SPRING)
    drum = central & ~cap & (y > SPRING)
    end = ~central & (np.abs(normal[:, 1]) < 0.01) & (np.abs(across) < HALF_WIDTH)
    barrel = ~central & ~end & (y > SPRING)
    side = ~(cap | drum | barrel | end)
    parts = ((cap, _cap), (drum, _drum), (barrel, _barrel), (end, _end), (side, _side))
    for where, part in parts:
        shade, shine = part(points[where], across[where])
        albedo[where] *= shade[:, None]
        glow[where] = shine
    result = albedo * _light(points, normal) + glow
    bulb = bulbs(eye, direction, distance, LAMPS, BULB_RADIUS)
    result[bulb >= 0] = 900 * LAMPS[bulb[bulb >= 0], 3:]
    return result


def _daylight(points: Array, inside: Mask, brightness: float) -> Array:
    panes = (np.abs(repeat(points[:, 1], 0.8)) < 0.36) & inside
    return (panes * brightness)[:, None] * np.array([1.0, 1.05, 1.2])


def _coffers(u: Array, v: Array) -> Array:
    """Shade of sunk square panels with a rosette; `u` and `v` run from -1/2 to 1/2 in each."""
    edge = np.maximum(np.abs(u), np.abs(v))
    shade = np.where(edge > 0.41, 1.15, np.where(edge > 0.32, 0.6 + 0.5 * (v > 0), 0.8))
    return np.where(np.hypot(u, v) < 0.14, 1.25, shade)


def _cap(points: Array, across: Array) -> tuple[Array, Array]:
    turn = np.arctan2(points[:, 0], points[:, 2])
    rise = np.arctan2(points[:, 1] - DOME_SPRING, np.hypot(points[:, 0], points[:, 2]))
    lantern = rise > 1.5
    shade = _coffers(repeat(turn, np.pi / 12) / (np.pi / 12), repeat(rise, 0.2) / 0.2)
    shade = np.where(np.abs(repeat(turn, np.pi / 6)) > 0.235, 1.3, shade)
    return np.where(lantern, 0.0, shade), _daylight(points, lantern, 9.0)


def _drum(points: Array, across: Array) -> tuple[Array, Array]:
    turn, height = np.arctan2(points[:, 0], points[:, 2]) * DRUM_RADIUS, points[:, 1]
    period = np.pi / 8 * DRUM_RADIUS
    bay = repeat(turn, period)
    window = round_arch(bay, height - 19.2, 0.75, 2.0)
    pilaster = (np.abs(np.abs(bay) - 1.35) < 0.22) & (height > 18.3) & (height < 23)
    cornice = (np.abs(repeat(height - 18.0, 5.4)) > 2.5) | (np.abs(height - 17.4) < 0.12)
    frieze = (np.abs(height - 17.0) < 0.3) & (noise(points * 5, 421) > 0.45)
    shade = np.where(pilaster | cornice, 1.3, np.where(frieze, 0.55, 0.95))
    return np.where(window, 0.0, shade), _daylight(points, window, 26.0)


def _barrel(points: Array, across: Array) -> tuple[Array, Array]:
    nave = np.abs(points[:, 0]) < HALF_WIDTH
    along = np.where(nave, points[:, 2], points[:, 0])
    around = np.arctan2(np.where(nave, points[:, 0], points[:, 2]), points[:, 1] - SPRING)
    arc, bay = around * HALF_WIDTH, repeat(along, 9.0)
    shade = _coffers(repeat(arc, 1.1) / 1.1, repeat(along, 1.125) / 1.125)
    shade = np.where(np.abs(bay) > 3.9, 1.2, shade)
    window = np.hypot(bay / 0.6, (np.abs(around) - 1.05) * HALF_WIDTH / 0.9) < 1
    return np.where(window, 0.0, shade), _daylight(points, window, 26.0)


def _end(points: Array, across: Array) -> tuple[Array, Array]:
    height = points[:, 1] - FLOOR
    window = round_arch(np.abs(across) - 2.4, height - 8.0, 0.9, 2.6)
    window |= np.hypot(across, height - 14.2) < 1.5
    apse = round_arch(across, height, 2.2, 4.2) & ~window
    cornice = np.abs(height - 7.2) < 0.25
    gold = apse * (0.3 + 2.5 * noise(points * 2.5, 431, 3) ** 3)
    shade = np.where(apse, 0.4, np.where(cornice, 1.3, 0.9))
    shine = _daylight(points, window, 28.0) + gold[:, None] * (0.9, 0.55, 0.25)
    return np.where(window, 0.0, shade), shine


def _side(points: Array, across: Array) -> tuple[Array, Array]:
    """Walls and piers: fluted pilasters, niches with statues, and an entablature on top."""
    height = points[:, 1] - FLOOR
    bay = repeat(across, 6.0)
    pilaster = (np.abs(np.abs(bay) - 2.35) < 0.5) & (height < 9.4)
    flutes = 1.15 + 0.2 * np.cos((np.abs(bay) - 2.35) * 45)
    niche = round_arch(bay, height - 1.4, 1.1, 2.9)
    statue = np.hypot(bay / 0.5, (height - 3.1) / 1.5) < 0.8 + 0.5 * noise(points * 2.5, 441, 2)
    upper = (np.abs(bay) < 1.2) & (np.abs(height - 7.6) < 0.9)
    shade = np.where(niche, np.where(statue, 1.2, 0.35 + 0.12 * (bay + 1)), 0.85)
    shade = np.where(upper, 0.6 + 0.3 * (noise(points * 3, 443, 2) > 0.5), shade)
    shade = np.where(pilaster, flutes, shade)
    mouldings = 1.1 + 0.35 * np.sign(np.sin(height * 14))
    return np.where(height > 9.8, mouldings, shade), np.zeros_like(points)
