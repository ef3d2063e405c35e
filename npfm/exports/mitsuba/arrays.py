"""Tables of numbers that Mitsuba's code looks up, compiled or interpreted.

Compiled variants work on arrays of many paths at once, interpreted ones on plain numbers, which
Dr.Jit cannot gather.
"""

from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import ArrayLike


def buffer(values: ArrayLike) -> Any:
    """Numbers to be looked up by `take`, in float32 and C order."""
    flat = np.ascontiguousarray(values, dtype=np.float32).ravel()
    return mi.Float(flat) if dr.is_jit_v(mi.Float) else memoryview(flat.data)


def take(numbers: Any, index: Any) -> Any:
    """Numbers of a buffer at an index that is in range."""
    return (
        numbers[index] if isinstance(numbers, memoryview) else dr.gather(mi.Float, numbers, index)
    )


def bin_of(fraction: Any, bins: int) -> Any:
    """Which of some equal bins a fraction from 0 to 1 falls into; beyond 1, the last."""
    return mi.UInt32(dr.minimum(fraction * bins, bins - 1))


def drawn(cumulative: Any, start: Any, count: int, u: Any) -> tuple[Any, Any]:
    """Invert one of the distributions of a buffer.

    Parameters
    ----------
    cumulative : buffer
        Sums up to and with each entry, the last of each distribution 1.
    start : int or mi.UInt32
        Where the distribution begins.
    count : int
        Entries that it has.
    u : mi.Float
        In [0, 1).

    Returns
    -------
    k : mi.UInt32
        The entry.
    part : mi.Float
        How far `u` is on the way through its share: uniform in [0, 1] again.
    """
    k = mi.UInt32(0)
    for power in reversed(range(count.bit_length())):
        probe = k + (1 << power)
        passed = take(cumulative, start + dr.minimum(probe, count) - 1) <= u
        k = dr.select((probe < count) & passed, probe, k)
    lower = dr.select(k > 0, take(cumulative, start + dr.maximum(k, 1) - 1), 0.0)
    upper = take(cumulative, start + k)
    return k, dr.clip((u - lower) / dr.maximum(upper - lower, 1e-30), 0, 1)
