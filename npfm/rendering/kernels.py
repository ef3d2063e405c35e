"""Passes over all light directions of a scene, compiled.

A transport matrix takes some hundred operations for each of ten million directions and more. Here a
strip of directions, which stays in the processor's own memory, goes through all of them. What is
computed is defined elsewhere, and tests hold these passes to it: the strategies `light` and
`half-vector` of `npfm.rendering.sampling`, combined by the balance heuristic, and the cells of
`npfm.reflectance.half_difference`.

Loops without branches do several directions at a time if each fills one array; so sines and arc
tangents are series here, and loops are many and short. All of it stands in one file because of
`npfm.compilation.compiled`.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import types
from numpy.typing import NDArray

from npfm.compilation import ARITHMETIC, compiled, inner

Array = NDArray[np.float64]
Indices = NDArray[np.int32]
Counts = NDArray[np.int64]
#: cos_o, cos_limit and bins of one of `Points`.
At = tuple[float, float, int]

#: Taylor series in t^2 of arctan(t) / t, sin(t) / t and cos(t), from the last coefficient. Where
#: they are used, |t| is at most tan(pi/8), pi/4 and pi/4, and what is left out below 1e-14.
ARCTAN_EVEN = tuple(1 / (2 * n + 1) for n in range(14, -1, -2))
ARCTAN_ODD = tuple(-1 / (2 * n + 1) for n in range(15, 0, -2))
SINE = tuple((-1.0) ** n / math.factorial(2 * n + 1) for n in reversed(range(8)))
COSINE = tuple((-1.0) ** n / math.factorial(2 * n) for n in reversed(range(8)))
TAN_PI_8 = math.tan(math.pi / 8)
#: Keeps 0 / 0 from being asked for.
TINY = 1e-300
#: The half range of azimuths is taken for no less, as in `HalfVectorSampling.pdf`.
LEAST_LIMIT = 1e-9
#: Directions of a strategy that are treated at once.
STRIP = 512


class Light(NamedTuple):
    """What light directions are sampled and looked up by.

    Parameters
    ----------
    heights : ndarray, shape (rows + 1,)
        Cosines of the polar angles between the rows of the map.
    row_starts : ndarray, shape (rows + 1,)
        Probability that the row of a sample comes before row k.
    cumulative : ndarray, shape (rows * columns + 1,)
        Probability that the texel of a sample comes before texel k.
    guide : ndarray of int32, shape (rows * columns,)
        Texel in which k / columns of the probability of a row has been reached, for all k and rows.
    density : ndarray, shape (rows * columns,)
        Probability density over each texel in 1/sr.
    """

    heights: Array
    row_starts: Array
    cumulative: Array
    guide: Indices
    density: Array


class Bins(NamedTuple):
    """Bins of theta_h that half vectors are spread over.

    Parameters
    ----------
    edges, cosines : ndarray, shape (bins + 1,)
        Edges from 0 to pi/2, and their cosines.
    guide : ndarray of int32, shape (n + 1,)
        Bin that ends at the angle (k / n)^2 pi or holds it, for all k, of which the next angle is
        no more than one bin away.
    """

    edges: Array
    cosines: Array
    guide: Indices


class Points(NamedTuple):
    """Surface points, and which half vectors are of use there.

    Parameters
    ----------
    frames : ndarray, shape (p, 3, 3)
        As `npfm.rendering.shading.Shading` has them.
    views : ndarray, shape (p, 3)
    cos_o, cos_limit : ndarray, shape (p,)
        Cosines of theta_o, and of the largest theta_h that is of use.
    bins : ndarray of int64, shape (p,)
        Number of bins of theta_h up to there.
    """

    frames: Array
    views: Array
    cos_o: Array
    cos_limit: Array
    bins: Counts


_f1, _f2, _f3 = (types.Array(types.float64, n, "C") for n in (1, 2, 3))
_i1, _n1 = types.Array(types.int32, 1, "C"), types.Array(types.int64, 1, "C")
_f2b = types.Array(types.float64, 2, "A")
_LIGHT = types.NamedTuple([_f1, _f1, _f1, _i1, _f1], Light)
_BINS = types.NamedTuple([_f1, _f1, _i1], Bins)
_POINTS = types.NamedTuple([_f3, _f2, _f1, _f1, _n1], Points)


@inner
def _series(coefficients: tuple[float, ...], x: float) -> float:
    total = 0.0
    for coefficient in coefficients:
        total = total * x + coefficient
    return total


@inner
def _arctan2(y: float, x: float) -> float:
    """Angle of (x, y) from the x axis, in [-pi, pi]; 0 for (0, 0)."""
    wide, high = abs(x), abs(y)
    least, most = min(wide, high), max(wide, high)
    turned = least > TAN_PI_8 * most
    t = (least - (most if turned else 0.0)) / ((least if turned else 0.0) + most + TINY)
    t2 = t * t
    angle = t * (_series(ARCTAN_EVEN, t2 * t2) + t2 * _series(ARCTAN_ODD, t2 * t2))
    angle += math.pi / 4 if turned else 0.0
    angle = (math.pi / 2 if high > wide else 0.0) + (-angle if high > wide else angle)
    angle = (math.pi if x < 0 else 0.0) + (-angle if x < 0 else angle)
    return -angle if y < 0 else angle


@inner
def _sine(cosine: float) -> float:
    """Sine of an angle in [0, pi]."""
    return math.sqrt(max((1 - cosine) * (1 + cosine), 0.0))


@inner
def _arccos(cosine: float) -> float:
    return _arctan2(_sine(cosine), cosine)


@inner
def _sin_cos(angle: float) -> tuple[float, float]:
    """Sine and cosine of an angle in [-pi, pi]."""
    quarter = math.floor(angle * (2 / math.pi) + 0.5)
    t = angle - quarter * (math.pi / 2)
    sine, cosine = t * _series(SINE, t * t), _series(COSINE, t * t)
    turns = int(quarter)
    first, second = (cosine, sine) if turns & 1 else (sine, cosine)
    return -first if turns & 2 else first, -second if (turns + 1) & 2 else second


@inner
def _azimuth_limit(cos_h: float, cos_o: float, sin_o: float) -> float:
    """As `npfm.rendering.sampling.half_vector.azimuth_limit`."""
    sine = 2 * _sine(cos_h) * cos_h * sin_o
    cosine = (1 - 2 * cos_h * cos_h) * cos_o
    return _arccos(max(min(cosine / max(sine, 1e-12), 1.0), -1.0))


@inner
def _dot(x: Array, y: Array, z: Array, axis: Array, out: Array) -> None:
    for s in range(len(out)):
        out[s] = x[s] * axis[0] + y[s] * axis[1] + z[s] * axis[2]


@inner
def _rotated(value: float, shift: float) -> float:
    moved = value + shift
    return moved - (1.0 if moved >= 1 else 0.0)


@inner
def _sample_light(
    square: Array,
    shift: Array,
    light: Light,
    texel: Indices,
    work: Array,
    x: Array,
    y: Array,
    z: Array,
) -> None:
    """Directions of points of the unit square, as `Environment.sample`."""
    heights, row_starts, cumulative, guide, _ = light
    place, azimuth = work[0], work[1]
    rows = heights.size - 1
    columns = guide.size // rows
    below_one = np.nextafter(row_starts[rows], 0.0)
    row = 0
    for s in range(len(x)):
        u = min(_rotated(square[s, 0], shift[0]), below_one)
        v = _rotated(square[s, 1], shift[1])
        # Points ascend in u, but for a step back where they are rotated beyond 1.
        if u < row_starts[row]:
            row = 0
        while row_starts[row + 1] <= u:
            row += 1
        start = row_starts[row]
        mass = row_starts[row + 1] - start
        place[s] = min(start + v * mass, below_one)
        texel[s] = guide[row * columns + min(int(v * columns), columns - 1)]
        y[s] = heights[row] + (u - start) / mass * (heights[row + 1] - heights[row])
        azimuth[s] = row * columns
    # Only to have it in the cache before it is asked for: several are fetched at once here.
    for s in range(len(x)):
        x[s] = cumulative[texel[s]]
    for s in range(len(x)):
        at = texel[s]
        while cumulative[at + 1] <= place[s]:
            at += 1
        while cumulative[at] > place[s]:
            at -= 1
        low = cumulative[at]
        across = at - azimuth[s] + (place[s] - low) / (cumulative[at + 1] - low)
        azimuth[s] = across * (2 * math.pi / columns) - math.pi
    for s in range(len(x)):
        x[s] = _sine(y[s]) * _sin_cos(azimuth[s])[0]
    for s in range(len(x)):
        z[s] = -_sine(y[s]) * _sin_cos(azimuth[s])[1]


@inner
def _mirrored(
    a: Array, b: Array, c: Array, cos_o: float, sin_o: float, axes: Array, out: Array
) -> None:
    """A component of view directions mirrored in half vectors, by components of their frame."""
    first, second, third = axes[0], axes[1], axes[2]
    view = sin_o * first + cos_o * third
    for s in range(len(out)):
        cos_d = a[s] * sin_o + c[s] * cos_o
        out[s] = 2 * cos_d * (a[s] * first + b[s] * second + c[s] * third) - view


@inner
def _sample_half_vector(
    square: Array,
    shift: Array,
    frame: Array,
    at: At,
    cosines: Array,
    work: Array,
    x: Array,
    y: Array,
    z: Array,
) -> None:
    """Directions of points of the unit square, as `HalfVectorSampling.sample`."""
    cos_o, cos_limit, bins = at
    sin_o = _sine(cos_o)
    a, b, c = work[0], work[1], work[2]
    for s in range(len(square)):
        place = _rotated(square[s, 0], shift[0]) * bins
        k = min(int(place), bins - 1)
        lower = max(cosines[k + 1], cos_limit)
        c[s] = cosines[k] + (place - k) * (lower - cosines[k])
    for s in range(len(square)):
        b[s] = (2 * _rotated(square[s, 1], shift[1]) - 1) * _azimuth_limit(c[s], cos_o, sin_o)
    for s in range(len(square)):
        a[s] = _sine(c[s]) * _sin_cos(b[s])[1]
    for s in range(len(square)):
        b[s] = _sine(c[s]) * _sin_cos(b[s])[0]
    # The view is at b = 0 of the frame: the mirrored direction is 2 (h . o) h - o.
    _mirrored(a, b, c, cos_o, sin_o, frame[:, 0], x)
    _mirrored(a, b, c, cos_o, sin_o, frame[:, 1], y)
    _mirrored(a, b, c, cos_o, sin_o, frame[:, 2], z)


@inner
def _above_horizon(x: Array, y: Array, z: Array, normal: Array) -> int:
    """Move the directions above the horizon to the front; their number."""
    kept = 0
    for s in range(len(x)):
        x[kept], y[kept], z[kept] = x[s], y[s], z[s]
        kept += x[s] * normal[0] + y[s] * normal[1] + z[s] * normal[2] > 0
    return kept


@inner
def _texels(
    x: Array, y: Array, z: Array, rows: int, columns: int, place: Array, texel: Indices
) -> None:
    """As `Environment.texel`."""
    for s in range(len(texel)):
        place[s] = _arctan2(math.sqrt(x[s] * x[s] + z[s] * z[s]), y[s]) * (rows / math.pi)
    for s in range(len(texel)):
        texel[s] = min(int(place[s]), rows - 1) * columns
    for s in range(len(texel)):
        place[s] = (_arctan2(x[s], -z[s]) + math.pi) * (columns / (2 * math.pi))
    for s in range(len(texel)):
        texel[s] += int(place[s]) if place[s] < columns else 0


@inner
def _half_vector_density(
    cos_i: Array, cos_io: Array, at: At, bins: Bins, work: Array, density: Array
) -> None:
    """As `HalfVectorSampling.pdf`, of directions above the horizon."""
    cos_o, cos_limit, count = at
    sin_o = _sine(cos_o)
    edges, cosines, guide = bins
    cos_h, angle = work[0], work[1]
    for s in range(len(density)):
        cos_h[s] = min((cos_i[s] + cos_o) / math.sqrt(2 * (1 + cos_io[s])), 1.0)
    for s in range(len(density)):
        angle[s] = _arccos(cos_h[s])
    for s in range(len(density)):
        cos_h[s] = max(_azimuth_limit(cos_h[s], cos_o, sin_o), LEAST_LIMIT)
    for s in range(len(density)):
        density[s] = math.sqrt(angle[s] * (1 / math.pi)) * (len(guide) - 1)
    for s in range(len(density)):
        k = guide[int(density[s])]
        k = min(k + (1 if edges[k + 1] <= angle[s] else 0), count - 1)
        angle[s] = cosines[k] - max(cosines[k + 1], cos_limit)
    for s in range(len(density)):
        azimuths, cos_d4 = 2 * cos_h[s], 2 * math.sqrt(2 * (1 + cos_io[s]))
        density[s] = 1 / (count * angle[s] * azimuths * cos_d4)


@compiled(
    types.Tuple([_i1, _f2b, _i1, _f1])(_f2, _POINTS, _f3, _n1, _n1, _LIGHT, _BINS), **ARITHMETIC
)
def light_directions(
    square: Array,
    points: Points,
    shifts: Array,
    first: Counts,
    counts: Counts,
    light: Light,
    bins: Bins,
) -> tuple[Indices, Array, Indices, Array]:
    """Directions of the strategies `light` and `half-vector`, those above the horizon.

    Parameters
    ----------
    square : ndarray, shape (m, 2)
        Points of the unit square.
    points : Points
    shifts : ndarray, shape (p, 2, 2)
        By which those are rotated, for either strategy.
    first, counts : ndarray of int64, shape (p,)
        The first that a surface point takes, and how many for either strategy.
    light : Light
    bins : Bins

    Returns
    -------
    point : ndarray of int32, shape (n,)
        The surface point that each is for, ascending.
    direction : ndarray, shape (3, size)
        Of which the first n columns are filled.
    texel : ndarray of int32, shape (n,)
        Texel of the light that it points into.
    weight : ndarray, shape (n,)
        Cosine over samples per steradian, by the balance heuristic.
    """
    size = 2 * counts.sum()
    point, texel = np.empty(size, np.int32), np.empty(size, np.int32)
    direction, weight = np.empty((3, size)), np.empty(size)
    x, y, z = direction[0], direction[1], direction[2]
    work = np.empty((4, 2 * STRIP))
    rows = light.heights.size - 1
    columns = light.density.size // rows
    n = 0
    for p in range(len(points.views)):
        frame, view, shift = points.frames[p], points.views[p], shifts[p]
        at = points.cos_o[p], points.cos_limit[p], points.bins[p]
        end = first[p] + counts[p]
        for begin in range(first[p], end, STRIP):
            strip = square[begin : min(begin + STRIP, end)]
            middle, last = n + len(strip), n + 2 * len(strip)
            _sample_light(
                strip, shift[0], light, texel[n:middle], work, x[n:middle], y[n:middle], z[n:middle]
            )
            _sample_half_vector(
                strip,
                shift[1],
                frame,
                at,
                bins.cosines,
                work,
                x[middle:last],
                y[middle:last],
                z[middle:last],
            )
            kept = _above_horizon(x[n:last], y[n:last], z[n:last], frame[2])
            last = n + kept
            texels, weights = texel[n:last], weight[n:last]
            cos_i, cos_io = work[2, :kept], work[3, :kept]
            _texels(x[n:last], y[n:last], z[n:last], rows, columns, weights, texels)
            _dot(x[n:last], y[n:last], z[n:last], frame[2], cos_i)
            _dot(x[n:last], y[n:last], z[n:last], view, cos_io)
            _half_vector_density(cos_i, cos_io, at, bins, work, weights)
            for s in range(kept):
                density = light.density[texels[s]] + weights[s]
                weights[s] = cos_i[s] / (counts[p] * density)
            point[n:last] = p
            n = last
    return point[:n], direction[:, :n], texel[:n], weight[:n]


@compiled(_i1(_f2b, _i1, _f2, _f2, _f2, _n1), **ARITHMETIC)
def half_difference_cells(
    direction: Array, point: Indices, normal: Array, view: Array, across: Array, shape: Counts
) -> Indices:
    """As `HalfDifference.cells`, of directions (3, n) at points whose axes are given, (p, 3) each.

    Points ascend.
    """
    cells = np.empty(len(point), np.int32)
    work = np.empty((5, STRIP))
    first = 0
    while first < len(point):
        p, last = point[first], first + 1
        while last < min(len(point), first + STRIP) and point[last] == p:
            last += 1
        x, y, z = direction[0, first:last], direction[1, first:last], direction[2, first:last]
        out = cells[first:last]
        cos_i, cos_io, volume = work[0, : len(x)], work[1, : len(x)], work[2, : len(x)]
        cos_h, place = work[3], work[4]
        _dot(x, y, z, normal[p], cos_i)
        _dot(x, y, z, view[p], cos_io)
        _dot(x, y, z, across[p], volume)
        cos_o = (view[p] * normal[p]).sum()
        for s in range(len(out)):
            cos_h[s] = min((cos_i[s] + cos_o) / math.sqrt(max(2 * (1 + cos_io[s]), 0.0)), 1.0)
        for s in range(len(out)):
            place[s] = math.sqrt(_arccos(cos_h[s]) * (2 / math.pi)) * shape[0]
        for s in range(len(out)):
            out[s] = min(int(place[s]), shape[0] - 1) * shape[1]
        for s in range(len(out)):
            cos_d = min(math.sqrt(max((1 + cos_io[s]) / 2, 0.0)), 1.0)
            place[s] = _arccos(cos_d) * (2 / math.pi * shape[1])
        for s in range(len(out)):
            out[s] = (out[s] + min(int(place[s]), shape[1] - 1)) * shape[2]
        for s in range(len(out)):
            cos_d = math.sqrt(max((1 + cos_io[s]) / 2, 0.0))
            phi_d = _arctan2(volume[s] / (2 * cos_d), cos_h[s] * cos_d - cos_i[s])
            place[s] = (phi_d + (math.pi if phi_d < 0 else 0.0)) / math.pi * shape[2]
        for s in range(len(out)):
            out[s] += min(int(place[s]), shape[2] - 1)
        first = last
    return cells


@compiled(_f1(_f2, _POINTS, _BINS, types.int64, types.int64, _f1), **ARITHMETIC)
def highlights(
    square: Array, points: Points, bins: Bins, rows: int, columns: int, luminance: Array
) -> Array:
    """Mean luminance that half vectors show at each point, shape (p,).

    `square` (m, 2) are points of the unit square, and `luminance` is that of the texels of a light.
    """
    shown = np.empty(len(points.views))
    x, y, z = np.empty(len(square)), np.empty(len(square)), np.empty(len(square))
    work = np.empty((3, len(square)))
    texel, still = np.empty(len(square), np.int32), np.zeros(2)
    for p in range(len(shown)):
        at = points.cos_o[p], points.cos_limit[p], points.bins[p]
        _sample_half_vector(square, still, points.frames[p], at, bins.cosines, work, x, y, z)
        _texels(x, y, z, rows, columns, work[0], texel)
        total = 0.0
        for s in range(len(square)):
            total += luminance[texel[s]]
        shown[p] = total / len(square)
    return shown
