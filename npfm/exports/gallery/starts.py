"""D, G and F of every start, iteration by iteration, packed into a page."""

import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from npfm.exports.gallery import page
from npfm.figures.figure06 import LARGEST_ANGLE
from npfm.fitting.iterations import Iterations
from npfm.reflectance.table import CHANNELS

#: Factors are clamped at 1e-6 of their largest value, and next to the horizon, where no sample
#: counts, may exceed the scale of the figures.
LEAST, LARGEST = 1e-7, 1e2
#: Decades between words of 16 bits: a step is 0.03 %.
STEPS = 65535 / np.log10(LARGEST / LEAST)
DIGITS = 6  # of an objective
#: Of Okabe and Ito 2008, "Color Universal Design", as in the figures; the second half is dashed.
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")


def relative(found: Iterations) -> dict[str, NDArray[np.float64]]:
    """Factors of every state as Figure 6 draws them: the largest value up to 80 degrees is 1."""
    made = {}
    for name, angles in found.angles.items():
        values = np.asarray(getattr(found, name), dtype=float)
        made[name] = values / values[:, angles <= LARGEST_ANGLE].max(axis=1, keepdims=True)
    return made


def described(found: Iterations) -> dict[str, Any]:
    """What a page is told of the states, beside their factors."""
    return {
        "names": list(found.names),
        "channels": list(CHANNELS),
        "best": [found.best(channel) for channel in range(len(CHANNELS))],
        "channel": found.channel.tolist(),
        "start": found.start.tolist(),
        "run": found.run.tolist(),
        "objective": [page.number(float(f"{v:.{DIGITS}g}")) for v in found.objective],
        "angles": {name: np.round(angles, 3).tolist() for name, angles in found.angles.items()},
        "least": LEAST,
        "steps": float(STEPS),
    }


def looks(names: tuple[str, ...]) -> list[dict[str, str | None]]:
    """Colour and dashes of each start: those told apart by the colour-blind."""
    count = len(COLORS)
    return [
        {"color": COLORS[k % count], "dashes": "5 2" if k // count % 2 else None}
        for k in range(len(names))
    ]


def packed(found: Iterations) -> bytes:
    """Return the factors as a zlib stream.

    Logarithms as words of 16 bits, D, G and F one after the other; of each all high bytes and
    then all low ones, as differences, modulo 2^16, from the state before: near the end of a fit
    these are next to nothing.
    """
    parts = []
    for values in relative(found).values():
        logarithms = np.log10(np.clip(values, LEAST, LARGEST) / LEAST)
        words = np.rint(logarithms * STEPS).astype("<u2")
        words[1:] -= words[:-1].copy()
        parts += [(words >> 8).astype(np.uint8), (words & 255).astype(np.uint8)]
    return zlib.compress(b"".join(part.tobytes() for part in parts), 9)
